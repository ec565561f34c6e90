//! Expressions over names: text to operators in postfix order.
//!
//! Operator precedence by explicit stack (Dijkstra's shunting yard, 1961): operands go straight to the output, operators
//! wait until one that binds less tightly, or a closing parenthesis, sends them after. Nothing recurses, so depth costs memory
//! alone; time is linear in the text.
//!
//! ```text
//! tightest  !a    a - b    a & b    a ^ b    a | b  loosest       left-associative, parentheses
//! all(a, …)   any(a, …)   odd(a, …)   atleast(k, a, …)            functions only where "(" follows
//! ```

use super::Limits;
use super::token::{Token, Tokens, malformed, quoted};
use crate::error::{Error, Kind, Place, Result};

/// A parsed expression, not yet bound to a scene: operands and operators in postfix order.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Expression {
    steps: Vec<Step>,
    /// All ids, one behind the other; [`Name`] cuts them out.
    ids: String,
}

/// An operand, or an operator over the values before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Step {
    /// The whole page.
    Page,
    /// Everything painted.
    Art,
    /// The area of that id.
    Name(Name),
    /// Where the value before does not hold.
    Not,
    /// The values before, joined from left to right.
    Join(Join, u32),
    /// At least `k` of the `n` values before; `at` is where `k` stands.
    AtLeast { k: u32, n: u32, at: Place },
}

/// An id and where it stands in the expression.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Name {
    start: usize,
    end: usize,
    pub(super) at: Place,
}

/// What joins operands to a chain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Join {
    Difference,
    All,
    Odd,
    Any,
}

/// What waits on the stack for its operands.
enum Pending {
    Not,
    Binary(Join),
    Paren(Place),
    Call { function: Function, open: Place, n: u32 },
}

#[derive(Clone, Copy)]
enum Function {
    Join(Join),
    AtLeast { k: u32, at: Place },
}

impl Join {
    fn of_sign(sign: char) -> Option<Join> {
        match sign {
            '-' => Some(Join::Difference),
            '&' => Some(Join::All),
            '^' => Some(Join::Odd),
            '|' => Some(Join::Any),
            _ => None,
        }
    }

    /// Rank among the operators, the tightest lowest. All are left-associative.
    fn rank(self) -> u8 {
        self as u8
    }
}

impl Expression {
    /// Parses the text of an expression. Places in it are lines and columns in characters, from 1.
    ///
    /// # Errors
    /// What does not belong, with its place; more than [`Limits::nodes`] operands and operators.
    pub fn parse(text: &str, limits: &Limits) -> Result<Expression> {
        Parser { tokens: Tokens::new(text), pending: Vec::new(), out: Expression::default(), limit: limits.nodes }.run()
    }

    pub(super) fn steps(&self) -> &[Step] {
        &self.steps
    }

    pub(super) fn id(&self, name: Name) -> &str {
        &self.ids[name.start..name.end]
    }
}

struct Parser<'a> {
    tokens: Tokens<'a>,
    pending: Vec<Pending>,
    out: Expression,
    limit: u64,
}

impl Parser<'_> {
    fn run(mut self) -> Result<Expression> {
        loop {
            self.operand()?;
            if self.operators()? {
                return Ok(self.out);
            }
        }
    }

    /// Reads up to and with the next operand: signs `!`, opening parentheses, then a name.
    fn operand(&mut self) -> Result<()> {
        loop {
            let (token, at) = self.tokens.next()?;
            match token {
                Token::Sign('!') => self.pending.push(Pending::Not),
                Token::Sign('(') => self.pending.push(Pending::Paren(at)),
                Token::Bare(word) => match self.function(&word, at)? {
                    Some(call) => self.pending.push(call),
                    None if word == "page" => return self.emit(Step::Page, at),
                    None if word == "art" => return self.emit(Step::Art, at),
                    None => return self.name(&word, at),
                },
                Token::Quoted(id) => return self.name(&id, at),
                other => return Err(self.no_operand(&other).at(at)),
            }
        }
    }

    /// Reads what may stand behind an operand, up to and with a sign that wants another one. True at the end of the text.
    fn operators(&mut self) -> Result<bool> {
        loop {
            let (token, at) = self.tokens.next()?;
            match token {
                Token::Sign(')') => {
                    self.reduce(None, at)?;
                    match self.pending.pop() {
                        Some(Pending::Paren(_)) => {}
                        Some(Pending::Call { function, n, .. }) => self.call(function, n, at)?,
                        _ => return Err(malformed("this \")\" closes nothing: remove it, or add a \"(\" before it").at(at)),
                    }
                }
                Token::Sign(',') => {
                    self.reduce(None, at)?;
                    let Some(Pending::Call { n, .. }) = self.pending.last_mut() else {
                        let what = "a comma stands only between the arguments of all, any, odd and atleast: write an operator, - & ^ or |";
                        return Err(malformed(what).at(at));
                    };
                    *n += 1;
                    return Ok(false);
                }
                Token::End => {
                    self.reduce(None, at)?;
                    return match self.pending.last() {
                        Some(&Pending::Paren(open) | &Pending::Call { open, .. }) => {
                            Err(malformed("this \"(\" is never closed: add a \")\"").at(open))
                        }
                        _ => Ok(true),
                    };
                }
                Token::Sign(sign) if let Some(join) = Join::of_sign(sign) => {
                    self.reduce(Some(join), at)?;
                    self.pending.push(Pending::Binary(join));
                    return Ok(false);
                }
                other => return Err(no_operator(&other).at(at)),
            }
        }
    }

    /// Emits the waiting operators that bind at least as tightly as `join`; all of them, up to the parenthesis, for none.
    fn reduce(&mut self, join: Option<Join>, at: Place) -> Result<()> {
        loop {
            let step = match self.pending.last() {
                Some(Pending::Not) => Step::Not,
                Some(&Pending::Binary(waiting)) if join.is_none_or(|j| waiting.rank() <= j.rank()) => Step::Join(waiting, 2),
                _ => return Ok(()),
            };
            self.pending.pop();
            self.emit(step, at)?;
        }
    }

    /// The call that `word` begins, read up to its first shape; none if the word is a plain name.
    fn function(&mut self, word: &str, at: Place) -> Result<Option<Pending>> {
        if !matches!(word, "all" | "any" | "odd" | "atleast") || !self.tokens.opens() {
            return Ok(None);
        }
        let (_, open) = self.tokens.next()?;
        let function = match word {
            "all" => Function::Join(Join::All),
            "any" => Function::Join(Join::Any),
            "odd" => Function::Join(Join::Odd),
            _ => Function::AtLeast { k: self.count()?, at },
        };
        Ok(Some(Pending::Call { function, open, n: 1 }))
    }

    /// The first argument of `atleast` and the comma behind it.
    fn count(&mut self) -> Result<u32> {
        let (token, at) = self.tokens.next()?;
        let k = match &token {
            // More than fits is more than there can be operands.
            Token::Number(digits) if digits.bytes().all(|b| b.is_ascii_digit()) => Some(digits.parse().unwrap_or(u32::MAX)),
            _ => None,
        };
        let k = k.filter(|&k| k >= 1).ok_or_else(|| {
            let what = format!("expected a whole number of at least 1, found {}: write atleast(2, a, b, c)", found(&token));
            malformed(what).at(at)
        })?;
        match self.tokens.next()? {
            (Token::Sign(','), _) => Ok(k),
            (other, at) => Err(malformed(format!("expected a comma and shapes after the number, found {}", found(&other))).at(at)),
        }
    }

    fn call(&mut self, function: Function, n: u32, close: Place) -> Result<()> {
        let step = match function {
            Function::Join(join) => Step::Join(join, n),
            Function::AtLeast { k, at } => Step::AtLeast { k, n, at },
        };
        self.emit(step, close)
    }

    fn name(&mut self, id: &str, at: Place) -> Result<()> {
        let start = self.out.ids.len();
        self.out.ids.push_str(id);
        self.emit(Step::Name(Name { start, end: self.out.ids.len(), at }), at)
    }

    fn emit(&mut self, step: Step, at: Place) -> Result<()> {
        if self.out.steps.len() as u64 >= self.limit {
            let what = format!("the expression has more than {} operands and operators: draw it in several runs", self.limit);
            return Err(Error::expression(Kind::Limit, what).at(at));
        }
        self.out.steps.push(step);
        Ok(())
    }

    fn no_operand(&self, token: &Token) -> Error {
        let begun = !self.out.steps.is_empty() || !self.pending.is_empty();
        let hint = match token {
            Token::End if !begun => return malformed("the expression is empty: write the name of a shape, or page, or art"),
            Token::Sign(')') if matches!(self.pending.last(), Some(Pending::Paren(_) | Pending::Call { n: 1, .. })) => {
                "name at least one shape in the parentheses"
            }
            Token::Number(_) => "an id with a digit in front or a - inside is written in double quotes",
            Token::Sign('\'' | '`' | '“' | '”' | '„' | '‘' | '’') => "ids are quoted with \"",
            Token::Sign('~' | '¬') => "the complement is !a",
            Token::Sign('&' | '|' | '^' | '-' | ',' | ')') | Token::End => "add one, or remove the sign before it",
            _ => "an id with such characters is written in double quotes",
        };
        malformed(format!("expected a shape, found {}: {hint}", found(token)))
    }
}

fn no_operator(token: &Token) -> Error {
    let hint = match token {
        Token::Sign('(') => "only all, any, odd and atleast are functions",
        Token::Sign('+') => "a union is a | b",
        Token::Sign('*') => "an intersection is a & b",
        Token::Sign('\\' | '/') => "a difference is a - b",
        Token::Bare(word) if word.eq_ignore_ascii_case("and") => "an intersection is a & b",
        Token::Bare(word) if word.eq_ignore_ascii_case("or") => "a union is a | b",
        Token::Bare(word) if word.eq_ignore_ascii_case("not") => "a difference is a - b",
        Token::Bare(word) if word.eq_ignore_ascii_case("xor") => "where one of two holds is a ^ b",
        Token::Bare(_) | Token::Quoted(_) | Token::Sign('!') => "write one between the two shapes",
        _ => "an id with such characters is written in double quotes",
    };
    malformed(format!("expected an operator, - & ^ or |, found {}: {hint}", found(token)))
}

fn found(token: &Token) -> String {
    match token {
        Token::Bare(word) | Token::Number(word) if word.len() <= 60 => word.clone(),
        Token::Bare(_) => "a name".to_owned(),
        Token::Number(_) => "a number".to_owned(),
        Token::Quoted(id) => quoted(id),
        Token::Sign(sign) => format!("'{sign}'"),
        Token::End => "the end".to_owned(),
    }
}
