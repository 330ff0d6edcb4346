//! The LP format: an objective, constraints and bounds written as algebra, one token at a time.
//!
//! ```text
//! Maximize obj: 3 x + 1/2 y + 4
//! Subject To  c1: x + y <= 10   c2: -1 <= x - 22/7 y <= 5
//! Bounds      -inf <= x <= 4    y free
//! End
//! ```
//!
//! Coefficients may be rational literals. A bound given here replaces only its own side: unlike
//! in MPS a negative upper bound leaves the lower bound at zero. A variable that appears twice in
//! one row is refused.

use super::{At, clip, number};
use crate::lp::model::{Model, Range};
use crate::number::Rat;
use std::collections::HashMap;

#[derive(Clone, Debug, PartialEq)]
enum Token<'a> {
    Number(&'a str),
    Name(&'a str),
    Plus,
    Minus,
    Colon,
    Less,
    Greater,
    Equal,
    End,
}

struct Spanned<'a> {
    token: Token<'a>,
    line: usize,
    column: usize,
}

/// Reads an LP text.
pub(super) fn read(text: &str) -> Result<Model, At> {
    let tokens = tokenize(text)?;
    let mut parser = Parser {
        tokens,
        at: 0,
        model: Model::default(),
        columns: HashMap::new(),
        row_names: HashMap::new(),
        seen: Vec::new(),
    };
    parser.file()?;
    Ok(parser.model)
}

fn name_byte(b: u8) -> bool {
    b.is_ascii_alphanumeric() || b"!\"#$%&(),.;?@_'`{}~[]|/".contains(&b) || b >= 0x80
}

fn tokenize(text: &str) -> Result<Vec<Spanned<'_>>, At> {
    let mut out = Vec::new();
    let mut last = 1;
    for (index, raw) in text.lines().enumerate() {
        let line = raw.split('\\').next().unwrap_or("");
        last = index + 1;
        let bytes = line.as_bytes();
        let (mut i, mut counted, mut column) = (0, 0, 1);
        while i < bytes.len() {
            if bytes[i].is_ascii_whitespace() {
                i += 1;
                continue;
            }
            column += line.get(counted..i).map_or(0, |s| s.chars().count());
            counted = i;
            let start = i;
            let token = match bytes[i] {
                b'+' => Token::Plus,
                b'-' => Token::Minus,
                b':' => Token::Colon,
                b'<' => Token::Less,
                b'>' => Token::Greater,
                b'=' => Token::Equal,
                b'0'..=b'9' | b'.' => {
                    i = number_end(bytes, i);
                    Token::Number(&line[start..i])
                }
                b if name_byte(b) => {
                    while i < bytes.len() && name_byte(bytes[i]) {
                        i += 1;
                    }
                    Token::Name(&line[start..i])
                }
                _ => {
                    let c = line[i..].chars().next().unwrap_or(' ');
                    return Err(At {
                        line: last,
                        column,
                        message: format!("unexpected `{c}`"),
                    });
                }
            };
            match token {
                Token::Number(_) | Token::Name(_) => {}
                Token::Less | Token::Greater | Token::Equal => {
                    // <=, =<, >=, => are one sign.
                    i += 1;
                    let mut sign = token.clone();
                    if let Some(&b) = bytes.get(i) {
                        let pair = (bytes[start], b);
                        if matches!(pair, (b'<' | b'>', b'=')) {
                            i += 1;
                        } else if pair == (b'=', b'<') {
                            sign = Token::Less;
                            i += 1;
                        } else if pair == (b'=', b'>') {
                            sign = Token::Greater;
                            i += 1;
                        }
                    }
                    out.push(Spanned {
                        token: sign,
                        line: last,
                        column,
                    });
                    continue;
                }
                _ => i += 1,
            }
            out.push(Spanned {
                token,
                line: last,
                column,
            });
        }
    }
    out.push(Spanned {
        token: Token::End,
        line: last,
        column: 1,
    });
    Ok(out)
}

/// The end of the longest numeric literal: digits, point, exponent, or a fraction of integers.
fn number_end(bytes: &[u8], start: usize) -> usize {
    let digits = |mut i: usize| {
        while i < bytes.len() && bytes[i].is_ascii_digit() {
            i += 1;
        }
        i
    };
    let mut i = digits(start);
    if bytes.get(i) == Some(&b'/') && bytes.get(i + 1).is_some_and(u8::is_ascii_digit) {
        return digits(i + 1);
    }
    if bytes.get(i) == Some(&b'.') {
        i = digits(i + 1);
    }
    if matches!(bytes.get(i), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(bytes.get(i + 1), Some(b'+' | b'-')));
        if bytes.get(i + 1 + sign).is_some_and(u8::is_ascii_digit) {
            return digits(i + 1 + sign);
        }
    }
    i
}

#[derive(Clone, Copy, PartialEq, Debug)]
enum Heading {
    Maximise,
    Minimise,
    SubjectTo,
    Bounds,
    Integers,
    Binaries,
    Problem,
    End,
    Refused,
}

/// A linear expression: terms in order, and a constant.
struct Expression {
    terms: Vec<(usize, Rat)>,
    constant: Rat,
    constants: usize,
}

struct Parser<'a> {
    tokens: Vec<Spanned<'a>>,
    at: usize,
    model: Model,
    columns: HashMap<&'a str, usize>,
    row_names: HashMap<String, usize>,
    /// For each column the serial number of the last expression that used it.
    seen: Vec<usize>,
}

impl<'a> Parser<'a> {
    fn peek(&self, ahead: usize) -> &Token<'a> {
        let i = (self.at + ahead).min(self.tokens.len() - 1);
        &self.tokens[i].token
    }

    fn line(&self) -> usize {
        self.tokens[self.at.min(self.tokens.len() - 1)].line
    }

    fn fault<T>(&self, message: impl Into<String>) -> Result<T, At> {
        let t = &self.tokens[self.at.min(self.tokens.len() - 1)];
        Err(At {
            line: t.line,
            column: t.column,
            message: message.into(),
        })
    }

    /// A fault at the cursor, or just before it where a word that means no finite number stands in
    /// a number's place.
    fn misplaced<T>(&self, message: &str) -> Result<T, At> {
        let before = self.at.checked_sub(1).map(|i| &self.tokens[i]);
        if let (Some(t), Token::Name(_)) = (before, self.peek(0))
            && let Token::Name(word) = t.token
            && ["nan", "inf", "infinity"].contains(&word.to_ascii_lowercase().as_str())
        {
            return Err(At {
                line: t.line,
                column: t.column,
                message: format!("`{word}` is not a number"),
            });
        }
        self.fault(message)
    }

    /// A section heading at the cursor and the number of tokens it takes. Headings stand at the
    /// start of a line, and a word that is followed by a colon is a row's name.
    fn heading(&self) -> Option<(Heading, usize)> {
        let Token::Name(word) = self.peek(0) else {
            return None;
        };
        if *self.peek(1) == Token::Colon {
            return None;
        }
        if self.at > 0 && self.tokens[self.at - 1].line == self.tokens[self.at].line {
            return None;
        }
        let next = match self.peek(1) {
            Token::Name(n) => n.to_ascii_lowercase(),
            _ => String::new(),
        };
        Some(match (word.to_ascii_lowercase().as_str(), next.as_str()) {
            ("maximize" | "maximise" | "maximum" | "max", _) => (Heading::Maximise, 1),
            ("minimize" | "minimise" | "minimum" | "min", _) => (Heading::Minimise, 1),
            ("subject", "to") | ("such", "that") => (Heading::SubjectTo, 2),
            ("st" | "s.t." | "st.", _) => (Heading::SubjectTo, 1),
            ("bounds" | "bound", _) => (Heading::Bounds, 1),
            ("general" | "generals" | "gen" | "integer" | "integers" | "int", _) => {
                (Heading::Integers, 1)
            }
            ("binary" | "binaries" | "bin", _) => (Heading::Binaries, 1),
            ("problem", _) => (Heading::Problem, 1),
            ("end", _) => (Heading::End, 1),
            ("semi-continuous" | "semis" | "sos" | "sec", _) => (Heading::Refused, 1),
            _ => return None,
        })
    }

    fn file(&mut self) -> Result<(), At> {
        let mut objective = false;
        let mut rows = false;
        loop {
            if *self.peek(0) == Token::End {
                return if objective {
                    Ok(())
                } else {
                    self.fault("the file has no objective")
                };
            }
            let Some((heading, length)) = self.heading() else {
                return self.misplaced(if objective {
                    "an operator or a section heading (Subject To, Bounds, …) is missing before this"
                } else {
                    "a section heading (Maximize, Subject To, Bounds, …) is missing"
                });
            };
            if heading == Heading::Refused {
                return self.fault("this section is not linear programming");
            }
            if !objective
                && !matches!(
                    heading,
                    Heading::Problem | Heading::Maximise | Heading::Minimise
                )
                || objective && matches!(heading, Heading::Maximise | Heading::Minimise)
                || rows && heading == Heading::SubjectTo
            {
                return self.fault("this section does not belong here");
            }
            self.at += length;
            match heading {
                Heading::Problem => {
                    while self.heading().is_none() && *self.peek(0) != Token::End {
                        if let Token::Name(n) = self.peek(0) {
                            self.model.name = n.to_string();
                        }
                        self.at += 1;
                    }
                }
                Heading::Maximise | Heading::Minimise => {
                    objective = true;
                    self.model.maximise = heading == Heading::Maximise;
                    self.label()?;
                    if self.heading().is_none() && *self.peek(0) != Token::End {
                        let e = self.expression(1, false)?;
                        for (j, v) in e.terms {
                            self.model.columns[j].cost = v;
                        }
                        self.model.constant = e.constant;
                    }
                }
                Heading::SubjectTo => {
                    rows = true;
                    while self.heading().is_none() && *self.peek(0) != Token::End {
                        self.constraint()?;
                    }
                }
                Heading::Bounds => {
                    while self.heading().is_none() && *self.peek(0) != Token::End {
                        self.bound()?;
                    }
                }
                Heading::Integers | Heading::Binaries => {
                    self.model.relaxed = true;
                    while self.heading().is_none() {
                        let Token::Name(name) = *self.peek(0) else {
                            break;
                        };
                        let j = self.column(name);
                        if heading == Heading::Binaries {
                            self.model.columns[j].range = Range {
                                lower: Some(Rat::zero()),
                                upper: Some(Rat::one()),
                            };
                        }
                        self.at += 1;
                    }
                }
                _ => return Ok(()),
            }
        }
    }

    fn column(&mut self, name: &'a str) -> usize {
        if let Some(&j) = self.columns.get(name) {
            return j;
        }
        let j = self
            .model
            .add_column(name, Rat::zero(), Range::at_least(Rat::zero()));
        self.columns.insert(name, j);
        self.seen.push(0);
        j
    }

    fn label(&mut self) -> Result<Option<String>, At> {
        let label = match (self.peek(0), self.peek(1)) {
            (Token::Name(n) | Token::Number(n), Token::Colon) => n.to_string(),
            _ => return Ok(None),
        };
        self.at += 2;
        Ok(Some(label))
    }

    /// Signs before a term: the product, or None where there is none.
    fn signs(&mut self) -> Option<i64> {
        let mut sign = None;
        loop {
            let s = match self.peek(0) {
                Token::Plus => 1,
                Token::Minus => -1,
                _ => return sign,
            };
            sign = Some(sign.unwrap_or(1) * s);
            self.at += 1;
        }
    }

    /// A linear expression; `serial` is a number no other row has, `right` says that it follows
    /// a relation.
    fn expression(&mut self, serial: usize, right: bool) -> Result<Expression, At> {
        let mut out = Expression {
            terms: Vec::new(),
            constant: Rat::zero(),
            constants: 0,
        };
        let mut first = true;
        loop {
            let sign = self.signs();
            if sign.is_none() && !first {
                return Ok(out);
            }
            let mut value = Rat::from(sign.unwrap_or(1));
            let mut coefficient = false;
            let line = self.tokens[self.at.min(self.tokens.len() - 1)].line;
            if let Token::Number(text) = *self.peek(0) {
                match number(text) {
                    Ok(v) => value = &value * &v,
                    Err(m) => return self.fault(m),
                }
                coefficient = true;
                self.at += 1;
            }
            let name = match *self.peek(0) {
                // `<= 0` at the end of a line is a number, not a coefficient of the next row.
                Token::Name(_) if right && coefficient && line != self.line() => None,
                Token::Name(name) if *self.peek(1) != Token::Colon && self.heading().is_none() => {
                    Some(name)
                }
                _ => None,
            };
            match name {
                Some(name) => {
                    let j = self.column(name);
                    if self.seen[j] == serial {
                        return self.fault(format!("`{}` appears twice in this row", clip(name)));
                    }
                    self.seen[j] = serial;
                    self.at += 1;
                    out.terms.push((j, value));
                }
                None if coefficient => {
                    out.constant = &out.constant + &value;
                    out.constants += 1;
                }
                None => return self.fault("a term is missing"),
            }
            first = false;
        }
    }

    fn relation(&mut self) -> Option<Token<'a>> {
        let t = self.peek(0).clone();
        if matches!(t, Token::Less | Token::Greater | Token::Equal) {
            self.at += 1;
            Some(t)
        } else {
            None
        }
    }

    fn constraint(&mut self) -> Result<(), At> {
        let row = self.model.rows.len();
        let start = self.at;
        let name = self.label()?;
        let name = name.unwrap_or_else(|| format!("R{}", row + 1));
        if self.row_names.insert(name.clone(), row).is_some() {
            self.at = start;
            return self.fault(format!("row `{}` appears twice", clip(&name)));
        }
        let serial = row + 2;
        let mut left = self.expression(serial, false)?;
        let Some(relation) = self.relation() else {
            return self.misplaced("a constraint needs <=, >= or =");
        };
        let right = self.expression(serial, true)?;
        let second = self.relation();
        let range;
        if let Some(second) = second {
            let middle = right;
            if !left.terms.is_empty() || second != relation || relation == Token::Equal {
                return self.fault("a double constraint is number <= expression <= number");
            }
            let last = self.expression(serial, true)?;
            if !last.terms.is_empty() {
                return self.fault("a double constraint ends with a number");
            }
            let a = &left.constant - &middle.constant;
            let b = &last.constant - &middle.constant;
            let (lower, upper) = if relation == Token::Less {
                (a, b)
            } else {
                (b, a)
            };
            range = Range {
                lower: Some(lower),
                upper: Some(upper),
            };
            left = middle;
        } else {
            let b = &right.constant - &left.constant;
            for (j, v) in right.terms {
                left.terms.push((j, -v));
            }
            range = match relation {
                Token::Less => Range::at_most(b),
                Token::Greater => Range::at_least(b),
                _ => Range::fixed(b),
            };
        }
        self.model.add_row(&name, range);
        for (j, v) in left.terms {
            self.model.set(row, j, v);
        }
        Ok(())
    }

    /// A number or an infinity in a bound: Some(None) is infinite, with its sign.
    fn bound_value(&mut self) -> Result<Option<(i64, Option<Rat>)>, At> {
        let start = self.at;
        let sign = self.signs().unwrap_or(1);
        match *self.peek(0) {
            Token::Number(text) => {
                let v = match number(text) {
                    Ok(v) => v,
                    Err(m) => return self.fault(m),
                };
                self.at += 1;
                Ok(Some((sign, Some(&Rat::from(sign) * &v))))
            }
            Token::Name(n)
                if (n.eq_ignore_ascii_case("inf") || n.eq_ignore_ascii_case("infinity"))
                    && !self.columns.contains_key(n) =>
            {
                self.at += 1;
                Ok(Some((sign, None)))
            }
            _ => {
                self.at = start;
                Ok(None)
            }
        }
    }

    fn bound(&mut self) -> Result<(), At> {
        let left = self.bound_value()?;
        let mut sides: Vec<(Token<'a>, (i64, Option<Rat>))> = Vec::new();
        if let Some(value) = left {
            let Some(r) = self.relation() else {
                return self.fault("a bound needs <=, >= or =");
            };
            let flipped = match r {
                Token::Less => Token::Greater,
                Token::Greater => Token::Less,
                other => other,
            };
            sides.push((flipped, value));
        }
        let Token::Name(name) = *self.peek(0) else {
            return self.fault("a bound needs a variable");
        };
        let j = self.column(name);
        self.at += 1;
        if let Token::Name(word) = *self.peek(0)
            && sides.is_empty()
            && word.eq_ignore_ascii_case("free")
        {
            self.at += 1;
            self.model.columns[j].range = Range::free();
            return Ok(());
        }
        if let Some(r) = self.relation() {
            match self.bound_value()? {
                Some(value) => sides.push((r, value)),
                None => return self.fault("a bound needs a number"),
            }
        }
        if sides.is_empty() {
            return self.fault("a bound needs <=, >=, = or `free`");
        }
        for (relation, (sign, value)) in sides {
            let wrong = value.is_none()
                && match relation {
                    Token::Less => sign < 0,
                    Token::Greater => sign > 0,
                    _ => true,
                };
            if wrong {
                return self.fault("this infinity leaves the variable no value");
            }
            let range = &mut self.model.columns[j].range;
            match relation {
                Token::Less => range.upper = value,
                Token::Greater => range.lower = value,
                _ => {
                    range.lower = value.clone();
                    range.upper = value;
                }
            }
        }
        Ok(())
    }
}
