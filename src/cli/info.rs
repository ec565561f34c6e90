//! `runset info`: what a document holds.

use std::path::PathBuf;

use runset::input::{ModelOptions, is_model, read_tree};
use runset::job::{Entry, Info, info, model_info};
use runset::scene::{BUILT_IN, Limits};

use super::input::{FontOptions, Limit, Source};
use super::messages::{Ends, Failure, print};
use super::scad;
use super::table::{number, table};
use super::tree;

const EXAMPLES: &str = "\
Examples:
  runset info poster.svg
  runset info poster.svg --json | jq -r '.ids[] | select(.kind == \"group\") | .id'
  runset info bracket.csg";

/// Show what a document holds: the ids of a drawing or a scene, the tree of a model
///
/// Ids have their kind, bounds and edge count. They are shown as an expression takes them: in double quotes where they are not plain words. Bounds are in user units (px), sizes
/// in mm too; edges are counted at scale 1. The ink is that of ids that are painted with a single one. A model
/// (OpenSCAD .csg or .scad, STL) is shown as its operators and primitives with their lines, faces and colours.
#[derive(clap::Args)]
#[command(after_long_help = EXAMPLES)]
pub struct Inspect {
    /// Drawing, scene or model to read; - is standard input
    #[arg(value_name = "INPUT", value_hint = clap::ValueHint::FilePath)]
    input: PathBuf,

    /// One JSON object instead of a table, ids as they are in the document
    #[arg(long)]
    json: bool,

    #[command(flatten)]
    fonts: FontOptions,

    #[command(flatten)]
    limit: Limit,
}

/// Runs the subcommand.
///
/// # Errors
/// The document is refused, or standard output.
pub fn run(args: &Inspect) -> Result<(), Failure> {
    let source = Source::find(&args.input)?;
    let name = source.name();
    let ends = Ends { input: &name, output: "<stdout>" };
    let limits = Limits { input: args.limit.max_input, ..Limits::default() };
    let bytes = match scad::is_program(&args.input) {
        true => scad::tree(&args.input, limits.input)?,
        false => source.read(limits.input)?,
    };
    if is_model(&bytes) {
        return model(args, &bytes, &ModelOptions { limits, folder: source.folder() }, ends);
    }
    let fonts = args.fonts.load(&args.limit)?;
    let mut warnings = Vec::new();
    let scene = runset::input::read_with(bytes, &limits, &fonts, &mut warnings).map_err(|error| ends.failure(&error))?;
    let info = info(&scene).map_err(|error| ends.failure(&error))?;
    drop(scene);
    ends.warn(&warnings, false)?;
    if args.json { print(&(serde_json::to_string(&info).expect("text and numbers are JSON") + "\n")) } else { print(&describe(&info)) }
}

/// The same for a model.
fn model(args: &Inspect, bytes: &[u8], options: &ModelOptions, ends: Ends<'_>) -> Result<(), Failure> {
    let mut warnings = Vec::new();
    let reading = read_tree(bytes, options, &mut warnings).map_err(|error| ends.failure(&error))?;
    let info = model_info(&reading, &mut warnings);
    drop(reading);
    ends.warn(&warnings, false)?;
    if args.json {
        print(&(serde_json::to_string(&info).expect("text and numbers are JSON") + "\n"))
    } else {
        print(&tree::describe(&info))
    }
}

fn describe(info: &Info) -> String {
    /// A user unit is 1/96 inch.
    const MM: f64 = 25.4 / 96.0;
    let [width, height, width_mm, height_mm] = [info.width, info.height, info.width * MM, info.height * MM].map(|x| {
        let mut text = String::new();
        number(x, &mut text);
        text
    });
    let size = format!("{width} x {height} user units ({width_mm} x {height_mm} mm)\n");
    if info.ids.is_empty() {
        return size + "no ids\n";
    }
    let heading = ["id", "kind", "left", "top", "right", "bottom", "mm", "edges", "ink"];
    let right = [false, false, true, true, true, true, true, true, false];
    let cells = |i: usize, cells: &mut [String; 9]| match i.checked_sub(1) {
        Some(i) => row(&info.ids[i], cells),
        None => *cells = heading.map(str::to_owned),
    };
    size + "\n" + &table(1 + info.ids.len(), right, cells)
}

/// Adds what is told of an id to empty cells.
fn row(entry: &Entry, [id, kind, left, top, right, bottom, mm, edges, ink]: &mut [String; 9]) {
    /// Deepest indentation.
    const DEEPEST: u32 = 12;
    id.extend(std::iter::repeat_n("  ", entry.depth.min(DEEPEST) as usize));
    id.push_str(&quoted(&entry.id));
    kind.push_str(entry.kind);
    for (cell, i) in [left, top, right, bottom].into_iter().zip(0_usize..) {
        match entry.bounds {
            Some(bounds) => number(bounds[i], cell),
            None => cell.push('-'),
        }
    }
    if let Some([left, top, right, bottom]) = entry.bounds_mm {
        number(right - left, mm);
        mm.push_str(" x ");
        number(bottom - top, mm);
    } else {
        mm.push('-');
    }
    edges.push_str(itoa::Buffer::new().format(entry.edges));
    ink.push_str(entry.ink.as_deref().unwrap_or("-"));
}

/// An id as an expression takes it; control characters, which would break the table, are replaced.
fn quoted(id: &str) -> String {
    let word = |c: char| c.is_ascii_alphanumeric() || "_.:".contains(c);
    let plain = id.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_') && id.chars().all(word);
    if plain && !BUILT_IN.contains(&id) {
        return id.to_owned();
    }
    let escaped = id.replace('\\', "\\\\").replace('"', "\\\"").replace(char::is_control, "\u{fffd}");
    format!("\"{escaped}\"")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_are_shown_as_an_expression_takes_them() {
        for (id, shown) in [
            ("a_1.b:c", "a_1.b:c"),
            ("_", "_"),
            ("any", "any"),
            ("page", "\"page\""),
            ("layer-1", "\"layer-1\""),
            ("1a", "\"1a\""),
            ("", "\"\""),
            ("é", "\"é\""),
            ("a\"b\\", "\"a\\\"b\\\\\""),
            ("a\nb", "\"a\u{fffd}b\""),
        ] {
            assert_eq!(quoted(id), shown);
        }
    }

    #[test]
    fn a_document_is_described_as_a_tree() {
        let entry = |id: &str, depth, bounds: Option<[f64; 4]>, ink: Option<&str>| Entry {
            id: id.to_owned(),
            kind: "path",
            depth,
            bounds,
            bounds_mm: bounds.map(|b| b.map(|x| x / 2.0)),
            edges: 4,
            ink: ink.map(str::to_owned),
        };
        let ids = vec![entry("a", 0, Some([0.0, 1.0, 2.5, 1e12]), Some("#102030")), entry("b-c", 1, None, None)];
        let text = describe(&Info { width: 96.0, height: 48.0, ids });
        let expected = "\
96.00 x 48.00 user units (25.40 x 12.70 mm)

id       kind  left   top  right       bottom                  mm  edges  ink
a        path  0.00  1.00   2.50  1.000000e12  1.25 x 5.000000e11      4  #102030
  \"b-c\"  path     -     -      -            -                   -      4  -
";
        assert_eq!(text, expected);
    }
}
