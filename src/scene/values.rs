//! The values that sections are made of: strings, numbers, points, rings. Each is judged where it
//! stands; a list is read to its end even if an item of it is bad.

use super::convert::{Conversion, clip};
use super::read::{MAX_TOTAL_BITS, MAX_VERTICES};
use super::source::Span;
use super::tree::{Kind, Node};
use crate::geometry::Vec2;
use crate::number::Rat;
use crate::number::literal::{self, LiteralError, MAX_DIGITS, MAX_EXPONENT};

const PAIR_HELP: &str = "write [\"x\", \"y\"]";

impl<'a> Conversion<'a> {
    pub(crate) fn wrong_type(&mut self, node: &Node, wanted: &str, help: &str) {
        self.error(
            node.span,
            "wrong-type",
            format!("expected {wanted}, found {}", node.describe()),
            help,
        );
    }

    pub(crate) fn string(&mut self, node: &'a Node) -> Option<String> {
        match &node.kind {
            Kind::String(s) => Some(s.clone()),
            _ => {
                self.wrong_type(node, "a string", "put it in double quotes");
                None
            }
        }
    }

    pub(crate) fn boolean(&mut self, node: &'a Node) -> Option<bool> {
        match &node.kind {
            Kind::Bool(b) => Some(*b),
            _ => {
                self.wrong_type(node, "true or false", "without quotes");
                None
            }
        }
    }

    pub(crate) fn number(&mut self, node: &'a Node) -> Option<Rat> {
        let text = match &node.kind {
            Kind::String(s) | Kind::Number(s) => s,
            _ => {
                self.wrong_type(
                    node,
                    "a number",
                    "a number is written \"3\", \"-0.125\", \"1e-30\", \"22/7\" or 3",
                );
                return None;
            }
        };
        match literal::parse(text) {
            Ok(value) => {
                self.bits = self
                    .bits
                    .saturating_add(value.numer().bits())
                    .saturating_add(value.denom().bits());
                if self.bits <= MAX_TOTAL_BITS {
                    return Some(value);
                }
                // Said once: the first number past the limit.
                if self.bits != u64::MAX {
                    self.bits = u64::MAX;
                    self.error(
                        node.span,
                        "number-too-large",
                        format!(
                            "up to here all numbers have more than {MAX_TOTAL_BITS} bits together"
                        ),
                        "use fewer digits or smaller exponents",
                    );
                }
                None
            }
            Err(error) => {
                self.bad_number(node.span, text, &error);
                None
            }
        }
    }

    fn bad_number(&mut self, span: Span, text: &str, error: &LiteralError) {
        let shown = clip(text);
        let (code, message, help) = match error {
            LiteralError::Malformed => (
                "malformed-number",
                format!("`{shown}` is not a number of this format"),
                "write [+-]digits[.digits][e[+-]digits] or integer/integer, without blanks, underscores, hex, inf or nan".to_owned(),
            ),
            LiteralError::BadDenominator => (
                "bad-denominator",
                format!("the denominator of `{shown}` is not positive"),
                "put the sign in front, and divide by a positive integer".to_owned(),
            ),
            LiteralError::TooManyDigits => (
                "number-too-large",
                format!("`{shown}` has too many digits"),
                format!("at most {MAX_DIGITS} digits are read"),
            ),
            LiteralError::ExponentTooLarge => (
                "number-too-large",
                format!("the exponent of `{shown}` is too large"),
                format!("exponents go up to {MAX_EXPONENT} in size"),
            ),
        };
        self.error(span, code, message, help);
    }

    /// Two numbers in an array.
    pub(crate) fn pair(&mut self, node: &'a Node) -> Option<(Rat, Rat)> {
        match &node.kind {
            Kind::Array(items) if items.len() == 2 => {
                let first = self.number(&items[0]);
                let second = self.number(&items[1]);
                Some((first?, second?))
            }
            Kind::Array(items) => {
                let message = format!("expected two numbers, found {}", items.len());
                self.error(node.span, "wrong-type", message, PAIR_HELP);
                None
            }
            _ => {
                self.wrong_type(node, "two numbers", PAIR_HELP);
                None
            }
        }
    }

    pub(crate) fn point(&mut self, node: &'a Node) -> Option<Vec2> {
        self.pair(node).map(|(x, y)| Vec2::new(x, y))
    }

    pub(crate) fn ring(&mut self, node: &'a Node) -> Option<Vec<Vec2>> {
        if let Kind::Array(items) = &node.kind {
            let before = self.vertices;
            self.vertices += items.len();
            if self.vertices > MAX_VERTICES {
                if before <= MAX_VERTICES {
                    self.error(
                        node.span,
                        "too-many-vertices",
                        format!("up to here the file has more than {MAX_VERTICES} vertices"),
                        "simplify the polygons",
                    );
                }
                return None;
            }
        }
        self.list(node, "a list of vertices", Self::point)
    }

    /// An array; None if any of its items cannot be read.
    pub(crate) fn list<T>(
        &mut self,
        node: &'a Node,
        wanted: &str,
        read: fn(&mut Self, &'a Node) -> Option<T>,
    ) -> Option<Vec<T>> {
        match &node.kind {
            Kind::Array(items) => {
                // Not collected straight into an Option: every item is to be judged.
                let read: Vec<Option<T>> = items.iter().map(|item| read(self, item)).collect();
                read.into_iter().collect()
            }
            _ => {
                self.wrong_type(node, wanted, "put it in square brackets");
                None
            }
        }
    }
}
