//! `runset formats`, `completions` and `man`: what the program says about itself.

use clap_complete::Shell;
use runset::encode::{FORMATS, Format};
use runset::mesh::stl;

use super::messages::{Failure, print};
use super::table::table;

/// List the formats: name, extensions, media type, compressions
#[derive(clap::Args)]
pub struct Formats {}

const COMPLETIONS: &str = "\
Examples:
  runset completions bash > ~/.local/share/bash-completion/completions/runset
  runset completions zsh > \"${fpath[1]}/_runset\"
  runset completions fish > ~/.config/fish/completions/runset.fish";

/// Print a script that completes arguments in a shell
#[derive(clap::Args)]
#[command(after_long_help = COMPLETIONS)]
pub struct Completions {
    /// The shell
    shell: Shell,
}

const MAN: &str = "\
Examples:
  runset man fill | man -l -
  runset man > /usr/local/share/man/man1/runset.1";

/// Print the manual page of the program or of a subcommand, in roff
#[derive(clap::Args)]
#[command(after_long_help = MAN)]
pub struct Man {
    /// The subcommand
    subcommand: Option<String>,
}

/// Lists the formats.
///
/// # Errors
/// Standard output fails.
pub fn formats() -> Result<(), Failure> {
    let heading = ["format", "extensions", "media type", "compression", "about"].map(str::to_owned);
    let row = |f: &Format| {
        let compressions: Vec<_> = f.compressions.iter().filter_map(|format| format.compression_name()).collect();
        [f.name, &f.extensions.join(" "), f.media_type, &compressions.join(" "), f.about].map(str::to_owned)
    };
    let surface = [stl::NAME, stl::EXTENSION, stl::MEDIA_TYPE, "", stl::ABOUT].map(str::to_owned);
    let rows: Vec<_> = std::iter::once(heading).chain(FORMATS.iter().map(row)).chain([surface]).collect();
    print(&table(rows.len(), [false; 5], |i, cells| cells.clone_from(&rows[i])))
}

/// Prints the completions of a shell.
///
/// # Errors
/// Standard output fails.
pub fn completions(args: &Completions, mut program: clap::Command) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut program, "runset", &mut script);
    print(&String::from_utf8_lossy(&script))
}

/// Prints a manual page.
///
/// # Errors
/// There is no such subcommand; standard output fails.
pub fn man(args: &Man, program: clap::Command) -> Result<(), Failure> {
    let mut program = program.disable_help_subcommand(true);
    program.build();
    let command = match &args.subcommand {
        None => program,
        Some(name) => {
            let unknown = || {
                let names: Vec<_> = program.get_subcommands().map(clap::Command::get_name).collect();
                Failure::Usage(format!("no subcommand '{name}'; the subcommands are {}", names.join(", ")))
            };
            program.find_subcommand(name).ok_or_else(unknown)?.clone()
        }
    };
    let examples = command.get_after_long_help().map(ToString::to_string).unwrap_or_default();
    let mut page = Vec::new();
    let version = concat!("runset ", env!("CARGO_PKG_VERSION"));
    // An empty date would be left out, and the version taken for it.
    let man = clap_mangen::Man::new(command.after_long_help(None::<&str>)).date(" ").source(version);
    man.render(&mut page).map_err(|error| Failure::io("<stdout>", &error))?;
    print(&(String::from_utf8_lossy(&page).into_owned() + &sections(&examples)))
}

/// The text behind the help as sections of a manual page: a line that ends in a colon is a heading, the rest is shown as it is.
fn sections(text: &str) -> String {
    let mut roff = String::new();
    for line in text.lines() {
        if let Some(heading) = line.strip_suffix(':').filter(|heading| !heading.starts_with(' ')) {
            let heading = heading.split(',').next().unwrap_or(heading).to_uppercase();
            roff += if roff.is_empty() { "" } else { ".fi\n" };
            roff += &format!(".SH {heading}\n.nf\n");
        } else {
            let line = line.strip_prefix("  ").unwrap_or(line).replace('\\', "\\e").replace('-', "\\-");
            // Behind \& nothing is taken for a request.
            roff += &format!("\\&{line}\n");
        }
    }
    roff + if text.is_empty() { "" } else { ".fi\n" }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_behind_the_help_is_shown_as_it_is() {
        let text = "Examples:\n  a -b 'c\\d'\n\nWords, in order:\n  .x\n";
        let roff = ".SH EXAMPLES\n.nf\n\\&a \\-b 'c\\ed'\n\\&\n.fi\n.SH WORDS\n.nf\n\\&.x\n.fi\n";
        assert_eq!(sections(text), roff);
        assert_eq!(sections(""), "");
    }
}
