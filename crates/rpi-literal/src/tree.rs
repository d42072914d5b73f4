//! Syntax tree of the text of a value: words, objects and arrays.

use super::LiteralError;

/// Maximum nesting depth of a literal. No type has a deeper literal; the limit prevents that a text overflows the
/// stack.
const MAX_DEPTH: usize = 8;

/// Maximum number of literals within the literal of one element, including itself. A pose has the most: nine.
const MAX_PARTS: usize = 9;

/// Syntax tree of a literal: a single word, fields in braces, or elements in brackets. The first field of each variant
/// is the byte offset of the literal in the text.
pub(super) enum LiteralTree<'a> {
    Word(usize, &'a str),
    Object(usize, Vec<(&'a str, LiteralTree<'a>)>),
    Array(usize, Vec<LiteralTree<'a>>),
}

impl<'a> LiteralTree<'a> {
    pub(super) fn is_null(&self) -> bool {
        matches!(self, LiteralTree::Word(_, "null"))
    }

    /// Returns the byte offset at which the literal begins in the text.
    fn offset(&self) -> usize {
        match self {
            LiteralTree::Word(at, _) | LiteralTree::Object(at, _) | LiteralTree::Array(at, _) => {
                *at
            }
        }
    }

    /// Returns the value that `read` makes of a literal of a single word. Returns an error if the literal has several
    /// parts or `read` returns `None`; `what` names the expected value in the error message.
    pub(super) fn word<T>(
        &self,
        what: &str,
        read: impl Fn(&str) -> Option<T>,
    ) -> Result<T, LiteralError> {
        let wrong = || LiteralError::new(self.offset(), format!("expected {what}"));
        match self {
            LiteralTree::Word(_, word) => read(word).ok_or_else(wrong),
            _ => Err(wrong()),
        }
    }

    pub(super) fn elements(&self) -> Result<&[LiteralTree<'a>], LiteralError> {
        match self {
            LiteralTree::Array(_, elements) => Ok(elements),
            _ => Err(LiteralError::new(self.offset(), "expected an array `[..]`")),
        }
    }

    /// Returns the fields with these names of a literal such as `{x:1.0,y:2.0}`, in the order of `names`. Returns an
    /// error unless the literal has exactly these fields, in any order.
    pub(super) fn fields<const N: usize>(
        &self,
        names: [&str; N],
    ) -> Result<[&LiteralTree<'a>; N], LiteralError> {
        let expected = || {
            let form = names.map(|n| format!("{n}:..")).join(",");
            LiteralError::new(self.offset(), format!("expected {{{form}}}"))
        };
        let LiteralTree::Object(_, fields) = self else {
            return Err(expected());
        };
        let find = |name: &str| fields.iter().find(|(n, _)| *n == name).map(|(_, t)| t);
        let found: Option<Vec<&LiteralTree<'a>>> = names.iter().map(|name| find(name)).collect();
        let found = found.filter(|_| fields.len() == N).ok_or_else(expected)?;
        found.try_into().map_err(|_| expected())
    }
}

/// Parses a text that must consist of exactly one literal, with at most `most` elements. The tree of a longer text can
/// take twenty times its memory.
pub(super) fn parse(text: &str, most: usize) -> Result<LiteralTree<'_>, LiteralError> {
    let mut reader = Parser {
        text,
        offset: 0,
        left: most.saturating_add(1).saturating_mul(MAX_PARTS),
    };
    let tree = reader.value(0)?;
    reader.space();
    match reader.rest().is_empty() {
        true => Ok(tree),
        false => Err(LiteralError::new(
            reader.offset,
            "expected the end of the value",
        )),
    }
}

struct Parser<'a> {
    text: &'a str,
    offset: usize,
    /// Number of literals that may follow, counting nested ones.
    left: usize,
}

impl<'a> Parser<'a> {
    fn rest(&self) -> &'a str {
        &self.text[self.offset..]
    }

    fn space(&mut self) {
        self.offset = self.text.len() - self.rest().trim_start().len();
    }

    fn eat(&mut self, sign: char) -> bool {
        self.space();
        let found = self.rest().starts_with(sign);
        self.offset += if found { sign.len_utf8() } else { 0 };
        found
    }

    fn expect(&mut self, sign: char) -> Result<(), LiteralError> {
        match self.eat(sign) {
            true => Ok(()),
            false => Err(LiteralError::new(self.offset, format!("expected `{sign}`"))),
        }
    }

    fn value(&mut self, depth: usize) -> Result<LiteralTree<'a>, LiteralError> {
        self.space();
        let at = self.offset;
        if depth > MAX_DEPTH {
            return Err(LiteralError::new(at, "nested too deeply"));
        }
        let left = self.left.checked_sub(1);
        self.left = left.ok_or_else(|| LiteralError::new(at, "too many elements"))?;
        if self.eat('{') {
            return Ok(LiteralTree::Object(at, self.list('}', |r| r.field(depth))?));
        }
        if self.eat('[') {
            return Ok(LiteralTree::Array(
                at,
                self.list(']', |r| r.value(depth + 1))?,
            ));
        }
        match self.name() {
            "" => Err(LiteralError::new(at, "expected a value")),
            word => Ok(LiteralTree::Word(at, word)),
        }
    }

    fn list<T>(
        &mut self,
        end: char,
        mut item: impl FnMut(&mut Self) -> Result<T, LiteralError>,
    ) -> Result<Vec<T>, LiteralError> {
        let mut items = Vec::new();
        while !self.eat(end) {
            if !items.is_empty() {
                self.expect(',')?;
            }
            items.push(item(self)?);
        }
        Ok(items)
    }

    fn field(&mut self, depth: usize) -> Result<(&'a str, LiteralTree<'a>), LiteralError> {
        self.space();
        let name = self.name();
        self.expect(':')?;
        Ok((name, self.value(depth + 1)?))
    }

    fn name(&mut self) -> &'a str {
        let rest = self.rest();
        let inside = |b: &u8| b.is_ascii_alphanumeric() || b"+-._".contains(b);
        let word = &rest[..rest.bytes().take_while(inside).count()];
        self.offset += word.len();
        word
    }
}
