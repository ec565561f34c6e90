//! The statements of a `.csg`, as a flat list in document order.
//!
//! ```text
//! document   = { statement }
//! statement  = ";" | { "!" "#" "%" "*" } name "(" [ argument { "," argument } ] ")" ( ";" | statement | "{" { statement } "}" )
//! argument   = [ name "=" ] value
//! value      = number | name | "text" | "[" [ value { "," value } ] "]"
//! ```
//!
//! Nothing recurses: open statements and open lists stand on stacks.

use super::modules::{Kind as Module, MODULES};
use super::words::{Word, Words};
use crate::error::{Error, Kind, Places, Result};
use crate::scene::Limits;

/// A value, or the head of a list, whose items follow it. The first number is the byte where it begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Item {
    Number(u32, f64),
    Bool(u32, bool),
    Undefined(u32),
    /// Bytes of the text between the quotes.
    Text(u32, u32),
    /// How many items follow that belong to it, those of lists inside it too.
    List(u32, u32),
}

impl Item {
    pub(super) fn at(&self) -> usize {
        let (Item::Number(at, _) | Item::Bool(at, _) | Item::Undefined(at) | Item::Text(at, _) | Item::List(at, _)) = self;
        *at as usize
    }
}

/// An argument.
#[derive(Clone, Copy, Debug)]
pub(super) struct Argument {
    /// Bytes of its name; empty if it has none.
    pub(super) name: [u32; 2],
    /// Which of [`Tree::items`].
    pub(super) value: u32,
}

/// Marks before a statement.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Marks {
    /// `!`: only this.
    pub(super) root: bool,
    /// `%` or `*`: not this.
    pub(super) out: bool,
}

/// A statement.
#[derive(Clone, Copy, Debug)]
pub(super) struct Statement {
    /// Bytes from its name to the end of its arguments.
    pub(super) text: [u32; 2],
    /// What it names.
    pub(super) module: u16,
    /// Which of [`Tree::arguments`].
    pub(super) arguments: [u32; 2],
    /// Marks before it.
    pub(super) marks: Marks,
    /// The statement behind it and all that it holds.
    pub(super) end: u32,
}

/// A document, parsed.
#[derive(Debug)]
pub(super) struct Tree<'t> {
    pub(super) text: &'t [u8],
    pub(super) statements: Vec<Statement>,
    pub(super) arguments: Vec<Argument>,
    pub(super) items: Vec<Item>,
}

/// Parses a document.
///
/// # Errors
/// With its place: what does not belong, an unknown module, more than the limits allow.
pub(super) fn parse<'t>(text: &'t [u8], limits: &Limits) -> Result<Tree<'t>> {
    if u32::try_from(text.len()).is_err() {
        return Err(Error::input(Kind::Limit, "a .csg of more than 4 GiB: split the model"));
    }
    let tree = Tree { text, statements: Vec::new(), arguments: Vec::new(), items: Vec::new() };
    Parser { words: Words::new(text)?, tree, limits }.document()
}

struct Parser<'t, 'l> {
    words: Words<'t>,
    tree: Tree<'t>,
    limits: &'l Limits,
}

/// A statement whose end has not been seen.
struct Open {
    statement: usize,
    /// Where its brace stands; without one it ends with the next statement.
    brace: Option<usize>,
}

impl<'t> Parser<'t, '_> {
    fn document(mut self) -> Result<Tree<'t>> {
        let mut open: Vec<Open> = Vec::new();
        loop {
            let complete = match self.words.peek() {
                (Word::End, at) => match open.pop() {
                    None => return Ok(self.tree),
                    Some(Open { brace: Some(brace), .. }) => return Err(self.malformed("this { is never closed: add a }", brace)),
                    Some(_) => return Err(self.malformed("the document ends here; expected ; or {", at)),
                },
                (Word::Sign(b'}'), at) => match open.pop() {
                    Some(Open { statement, brace: Some(_) }) => {
                        self.words.take()?;
                        self.close(statement);
                        true
                    }
                    _ => return Err(self.malformed("this } closes nothing", at)),
                },
                (Word::Sign(b';'), _) => {
                    self.words.take()?;
                    true
                }
                _ => {
                    let statement = self.statement()?;
                    let brace = self.words.peek();
                    if self.words.sign(b';')? {
                        self.close(statement);
                        true
                    } else {
                        if open.len() as u64 >= u64::from(self.limits.depth) {
                            let what = format!("statements nested more than {} deep: flatten the model", self.limits.depth);
                            return Err(self.error(Kind::Limit, what, self.tree.statements[statement].text[0] as usize));
                        }
                        let brace = self.words.sign(b'{')?.then_some(brace.1);
                        open.push(Open { statement, brace });
                        false
                    }
                }
            };
            // What had no brace held this one statement.
            while complete && let Some(Open { statement, brace: None }) = open.last() {
                let statement = *statement;
                self.close(statement);
                open.pop();
            }
        }
    }

    fn close(&mut self, statement: usize) {
        self.tree.statements[statement].end = index(self.tree.statements.len());
    }

    /// Marks, name and arguments.
    fn statement(&mut self) -> Result<usize> {
        let mut marks = Marks::default();
        while let (Word::Sign(sign @ (b'!' | b'#' | b'%' | b'*')), _) = self.words.peek() {
            marks.root |= sign == b'!';
            marks.out |= matches!(sign, b'%' | b'*');
            self.words.take()?;
        }
        let (name, at) = match self.words.take()? {
            (Word::Name(name), at) => (name, at),
            (_, at) => return Err(self.unexpected("a statement, as in cube(size = 1);", at)),
        };
        if !self.words.sign(b'(')? {
            let what = match self.words.peek().0 {
                _ if matches!(name, "module" | "function" | "use" | "include") => {
                    "this is an OpenSCAD program, not a .csg: run openscad -o model.csg"
                }
                Word::Sign(b'=') => "variables are OpenSCAD's, a .csg has none: run openscad -o model.csg",
                _ => return Err(self.unexpected(&format!("( after {name}"), self.words.peek().1)),
            };
            return Err(self.malformed(what, at));
        }
        let Some(module) = MODULES.iter().position(|module| module.name == name) else {
            let what = match name {
                "translate" | "rotate" | "scale" | "mirror" | "for" | "let" | "echo" | "assert" | "children" | "intersection_for" => {
                    format!("{name} belongs to OpenSCAD programs, a .csg has none: run openscad -o model.csg")
                }
                _ => {
                    let near = nearest(name).map_or_else(String::new, |near| format!("; did you mean {near}?"));
                    format!("unknown module {}{near}", crate::scene::quoted(name))
                }
            };
            return Err(self.error(Kind::Refused, what, at));
        };
        if self.tree.statements.len() as u64 >= self.limits.nodes {
            return Err(self.error(Kind::Limit, format!("more than {} statements: split the model", self.limits.nodes), at));
        }
        let first = index(self.tree.arguments.len());
        if !self.words.sign(b')')? {
            loop {
                self.argument()?;
                if self.words.sign(b')')? {
                    break;
                }
                let at = self.words.peek().1;
                if !self.words.sign(b',')? {
                    return Err(self.unexpected(", or )", at));
                }
                if self.words.sign(b')')? {
                    break;
                }
            }
        }
        let end = index(self.words.peek().1);
        let statement = Statement {
            text: [index(at), end],
            module: u16::try_from(module).expect("a short list"),
            arguments: [first, index(self.tree.arguments.len())],
            marks,
            end: 0,
        };
        self.tree.statements.push(statement);
        Ok(self.tree.statements.len() - 1)
    }

    fn argument(&mut self) -> Result<()> {
        let mut name = [0, 0];
        if let (Word::Name(word), at) = self.words.peek() {
            self.words.take()?;
            if self.words.sign(b'=')? {
                name = [index(at), index(at + word.len())];
            } else {
                let value = index(self.tree.items.len());
                let item = self.word(word, at)?;
                self.tree.items.push(item);
                self.tree.arguments.push(Argument { name, value });
                return Ok(());
            }
        }
        let value = index(self.tree.items.len());
        self.value()?;
        self.tree.arguments.push(Argument { name, value });
        Ok(())
    }

    /// A value, with all that it holds.
    fn value(&mut self) -> Result<()> {
        let mut open: Vec<usize> = Vec::new();
        loop {
            let (word, at) = self.words.take()?;
            let start = index(at);
            let item = match word {
                Word::Number(x) => Item::Number(start, x),
                Word::Text(inside) => Item::Text(start + 1, index(inside.len())),
                Word::Name(name) => self.word(name, at)?,
                // Minus infinity.
                Word::Sign(b'-') if matches!(self.words.peek().0, Word::Name("inf" | "nan")) => {
                    self.words.take()?;
                    Item::Number(start, f64::NEG_INFINITY)
                }
                Word::Sign(b'[') => {
                    open.push(self.tree.items.len());
                    self.tree.items.push(Item::List(start, 0));
                    if !self.words.sign(b']')? {
                        continue;
                    }
                    open.pop();
                    if self.more(&mut open)? {
                        continue;
                    }
                    return Ok(());
                }
                _ => return Err(self.unexpected("a number, a list, a text, true, false or undef", at)),
            };
            self.tree.items.push(item);
            if !self.more(&mut open)? {
                return Ok(());
            }
        }
    }

    /// Behind a value: closes lists. Whether another value follows.
    fn more(&mut self, open: &mut Vec<usize>) -> Result<bool> {
        while let Some(&list) = open.last() {
            let at = self.words.peek().1;
            let comma = self.words.sign(b',')?;
            if self.words.sign(b']')? {
                let within = index(self.tree.items.len() - list - 1);
                if let Item::List(_, count) = &mut self.tree.items[list] {
                    *count = within;
                }
                open.pop();
            } else if comma {
                return Ok(true);
            } else {
                return Err(match self.words.peek().0 {
                    Word::Sign(b':') => {
                        self.malformed("ranges belong to OpenSCAD programs, a .csg has none: run openscad -o model.csg", at)
                    }
                    _ => self.unexpected(", or ]", at),
                });
            }
        }
        Ok(false)
    }

    fn word(&self, name: &str, at: usize) -> Result<Item> {
        let start = index(at);
        Ok(match name {
            "true" | "false" => Item::Bool(start, name == "true"),
            "undef" => Item::Undefined(start),
            "nan" => Item::Number(start, f64::NAN),
            "inf" => Item::Number(start, f64::INFINITY),
            _ => return Err(self.malformed(&format!("the variable {} has no value: a .csg has none", crate::scene::quoted(name)), at)),
        })
    }

    fn unexpected(&self, wanted: &str, at: usize) -> Error {
        let found = match self.tree.text.get(at) {
            None => "the document ends here".to_owned(),
            Some(b) if b.is_ascii_graphic() => format!("unexpected {}", *b as char),
            Some(b) if *b < 128 => "unexpected control character".to_owned(),
            Some(_) => "unexpected character that is not ASCII".to_owned(),
        };
        self.malformed(&format!("{found}; expected {wanted}"), at)
    }

    fn malformed(&self, what: &str, at: usize) -> Error {
        self.error(Kind::Malformed, what.to_owned(), at)
    }

    fn error(&self, kind: Kind, what: String, at: usize) -> Error {
        Error::input(kind, what).at(Places::new(self.tree.text).of_byte(at))
    }
}

fn index(n: usize) -> u32 {
    u32::try_from(n).expect("no document has 2^32 bytes, and no word less than one")
}

/// The module whose name is most like an unknown one.
fn nearest(name: &str) -> Option<&'static str> {
    let distance = |other: &str| {
        let [a, b] = [name.as_bytes(), other.as_bytes()];
        let mut row: Vec<usize> = (0..=b.len()).collect();
        for (i, x) in a.iter().enumerate() {
            let mut corner = i;
            row[0] = i + 1;
            for (j, y) in b.iter().enumerate() {
                let here = row[j + 1];
                row[j + 1] = (corner + usize::from(x != y)).min(row[j] + 1).min(here + 1);
                corner = here;
            }
        }
        row[b.len()]
    };
    let known = MODULES.iter().filter(|m| m.kind != Module::Unsupported).map(|m| m.name);
    let near = (name.len() < 40).then(|| known.map(|other| (distance(other), other)).min())?;
    near.filter(|(distance, _)| *distance <= 2).map(|(_, other)| other)
}
