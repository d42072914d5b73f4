//! Reader for one table of a cell description: typed keys, errors with positions, detection of unknown keys.

use super::error::CellError;
use super::quantity::{self, Dimension};
use super::suggestion::nearest;
use core::ops::Range;
use std::cell::RefCell;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Collector of the errors that are found while a cell description is parsed.
#[derive(Default)]
pub(super) struct ErrorCollector(RefCell<Vec<CellError>>);

impl ErrorCollector {
    pub(super) fn add(&self, span: Range<usize>, message: String, help: Option<String>) {
        self.0.borrow_mut().push(CellError {
            span,
            message,
            help,
        });
    }

    /// All errors, in the order of their positions.
    pub(super) fn sorted(self) -> Vec<CellError> {
        let mut all = self.0.into_inner();
        all.sort_by_key(|fault| (fault.span.start, fault.span.end));
        all
    }
}

/// Reader for one table of a cell description. The keys that are read are the known keys of the table.
pub(super) struct TableReader<'a> {
    table: Option<&'a DeTable<'a>>,
    span: Range<usize>,
    known_keys: Vec<&'static str>,
    errors: &'a ErrorCollector,
}

pub(super) type Node<'a> = &'a Spanned<DeValue<'a>>;

impl<'a> TableReader<'a> {
    pub(super) fn new(
        table: &'a DeTable<'a>,
        span: Range<usize>,
        faults: &'a ErrorCollector,
    ) -> Self {
        Self {
            table: Some(table),
            span,
            known_keys: Vec::new(),
            errors: faults,
        }
    }

    /// A reader without entries, to find out which keys a function reads.
    pub(super) fn empty(faults: &'a ErrorCollector) -> Self {
        Self {
            table: None,
            span: 0..0,
            known_keys: Vec::new(),
            errors: faults,
        }
    }

    pub(super) fn span(&self) -> Range<usize> {
        self.span.clone()
    }

    pub(super) fn errors(&self) -> &'a ErrorCollector {
        self.errors
    }

    /// Marks the keys that `read` reads as known, without reading them.
    pub(super) fn mark_known(&mut self, read: impl FnOnce(&mut TableReader<'_>)) {
        let faults = ErrorCollector::default();
        let mut other = TableReader::empty(&faults);
        read(&mut other);
        self.known_keys.append(&mut other.known_keys);
    }

    /// The keys read so far.
    pub(super) fn known_keys(self) -> Vec<&'static str> {
        self.known_keys
    }

    /// All entries in text order, for a table whose keys are names.
    pub(super) fn entries(&self) -> Vec<(&'a str, Range<usize>, Node<'a>)> {
        let entries = self.table.into_iter().flatten();
        let mut all: Vec<_> = entries
            .map(|(key, value)| (key.get_ref().as_ref(), key.span(), value))
            .collect();
        all.sort_by_key(|(_, span, _)| span.start);
        all
    }

    /// True if the text has this key, whatever its value.
    pub(super) fn has(&self, key: &str) -> bool {
        self.peek(key).is_some()
    }

    /// The value of a key, without marking the key as known.
    pub(super) fn peek(&self, key: &str) -> Option<Node<'a>> {
        self.table?.get(key)
    }

    fn get(&mut self, key: &'static str) -> Option<Node<'a>> {
        self.known_keys.push(key);
        self.peek(key)
    }

    /// Reports an error at the value of `key`, or at the head of the table if the key is missing.
    pub(super) fn error_at(&self, key: &str, message: String, help: Option<String>) {
        let place = self.peek(key).map_or(self.span(), Spanned::span);
        self.errors.add(place, message, help);
    }

    fn wrong_type(&self, key: &str, node: Node<'a>, wanted: &str) {
        let found = node.get_ref().type_str();
        self.errors.add(
            node.span(),
            format!("expected {wanted} for `{key}`, found {found}"),
            None,
        );
    }

    pub(super) fn text(&mut self, key: &'static str) -> Option<&'a str> {
        let node = self.get(key)?;
        let text = node.get_ref().as_str();
        if text.is_none() {
            self.wrong_type(key, node, "a string");
        }
        text
    }

    pub(super) fn boolean(&mut self, key: &'static str) -> Option<bool> {
        let node = self.get(key)?;
        let value = node.get_ref().as_bool();
        if value.is_none() {
            self.wrong_type(key, node, "true or false");
        }
        value
    }

    /// Reads an integer from 0 to `bound` - 1.
    pub(super) fn index(&mut self, key: &'static str, bound: u64) -> Option<u64> {
        let node = self.get(key)?;
        let Some(value) = integer(node) else {
            self.wrong_type(key, node, "an integer");
            return None;
        };
        let inside = u64::try_from(value).ok().filter(|index| *index < bound);
        if inside.is_none() {
            let help = match bound {
                0 => "no value is valid here".to_owned(),
                _ => format!("the range is 0 to {}", bound - 1),
            };
            self.errors.add(
                node.span(),
                format!("`{key}` is {value}, out of range"),
                Some(help),
            );
        }
        inside
    }

    /// Reads a finite number in SI units.
    pub(super) fn real(&mut self, key: &'static str, dimension: Dimension) -> Option<f64> {
        let node = self.get(key)?;
        self.number(key, node, dimension)
    }

    /// Reads a finite number in SI units that is not negative.
    pub(super) fn magnitude(&mut self, key: &'static str, dimension: Dimension) -> Option<f64> {
        let node = self.get(key)?;
        let value = self.number(key, node, dimension)?;
        if value < 0.0 {
            self.errors
                .add(node.span(), format!("`{key}` is negative"), None);
            return None;
        }
        Some(value)
    }

    /// Reads a finite number in SI units that is greater than zero.
    pub(super) fn positive(&mut self, key: &'static str, dimension: Dimension) -> Option<f64> {
        let value = self.magnitude(key, dimension)?;
        if value == 0.0 {
            self.error_at(key, format!("`{key}` must be greater than zero"), None);
            return None;
        }
        Some(value)
    }

    /// Reads a list of exactly `count` numbers.
    pub(super) fn reals(
        &mut self,
        key: &'static str,
        dimension: Dimension,
        count: usize,
    ) -> Option<Vec<f64>> {
        let node = self.get(key)?;
        let Some(list) = node.get_ref().as_array() else {
            self.wrong_type(key, node, &format!("a list of {count} numbers"));
            return None;
        };
        if list.len() != count {
            let message = format!("`{key}` has {} entries, expected {count}", list.len());
            self.errors.add(node.span(), message, None);
            return None;
        }
        list.iter()
            .map(|entry| self.number(key, entry, dimension))
            .collect()
    }

    /// Reads one number for all, or a list of exactly `count` numbers.
    pub(super) fn one_or_list(
        &mut self,
        key: &'static str,
        dimension: Dimension,
        count: usize,
    ) -> Option<Vec<f64>> {
        let is_list = self.peek(key).is_some_and(|node| node.get_ref().is_array());
        if is_list {
            return self.reals(key, dimension, count);
        }
        self.real(key, dimension).map(|value| vec![value; count])
    }

    fn number(&self, key: &str, node: Node<'a>, dimension: Dimension) -> Option<f64> {
        let value = match node.get_ref() {
            DeValue::String(text) => quantity::parse(text, dimension),
            DeValue::Float(float) => float
                .as_str()
                .replace('_', "")
                .parse()
                .map_err(|_| String::new()),
            DeValue::Integer(_) => integer(node)
                .map(|value| value as f64)
                .ok_or_else(String::new),
            _ => {
                let unit = quantity::si_unit(dimension);
                let wanted = if unit.is_empty() {
                    "a number".to_owned()
                } else {
                    format!("a number (in {unit})")
                };
                self.wrong_type(key, node, &wanted);
                return None;
            }
        };
        match value {
            Ok(value) if value.is_finite() => Some(value),
            Ok(_) => {
                self.errors
                    .add(node.span(), format!("`{key}` is not a finite number"), None);
                None
            }
            Err(help) => {
                let help = Some(help).filter(|help| !help.is_empty());
                self.errors
                    .add(node.span(), format!("`{key}` is not a valid number"), help);
                None
            }
        }
    }

    /// Reads a string that must be one of `known`.
    pub(super) fn keyword(
        &mut self,
        key: &'static str,
        known: &[&'static str],
    ) -> Option<&'static str> {
        let node = self.get(key)?;
        self.known(key, node, known)
    }

    /// Reads a list of strings that must be in `known`.
    pub(super) fn keywords(
        &mut self,
        key: &'static str,
        known: &[&'static str],
    ) -> Option<Vec<&'static str>> {
        let node = self.get(key)?;
        let Some(list) = node.get_ref().as_array() else {
            self.wrong_type(key, node, "a list of strings");
            return None;
        };
        Some(
            list.iter()
                .filter_map(|entry| self.known(key, entry, known))
                .collect(),
        )
    }

    fn known(&self, key: &str, node: Node<'a>, known: &[&'static str]) -> Option<&'static str> {
        let Some(text) = node.get_ref().as_str() else {
            self.wrong_type(key, node, "a string");
            return None;
        };
        let found = known.iter().copied().find(|word| *word == text);
        if found.is_none() {
            let help = did_you_mean(text, known);
            self.errors.add(
                node.span(),
                format!("unknown value \"{text}\" for `{key}`"),
                Some(help),
            );
        }
        found
    }

    /// Reads a list of values of any type.
    pub(super) fn list(&mut self, key: &'static str) -> Option<Vec<Node<'a>>> {
        let node = self.get(key)?;
        let list = node.get_ref().as_array().map(|list| list.iter().collect());
        if list.is_none() {
            self.wrong_type(key, node, "a list");
        }
        list
    }

    /// Reads a nested table.
    pub(super) fn table(&mut self, key: &'static str) -> Option<TableReader<'a>> {
        let node = self.get(key)?;
        let inner = Self::from_node(node, self.errors);
        if inner.is_none() {
            self.wrong_type(key, node, "a table");
        }
        inner
    }

    /// Reads a list of tables, `[[...]]`.
    pub(super) fn tables(&mut self, key: &'static str) -> Vec<TableReader<'a>> {
        let nodes = self.list(key).unwrap_or_default();
        let readers = nodes.into_iter().filter_map(|node| {
            let inner = Self::from_node(node, self.errors);
            if inner.is_none() {
                self.wrong_type(key, node, "a list of tables");
            }
            inner
        });
        readers.collect()
    }

    /// A reader for a node; `None` if the node is not a table.
    pub(super) fn from_node(node: Node<'a>, faults: &'a ErrorCollector) -> Option<Self> {
        let table = node.get_ref().as_table()?;
        Some(Self::new(table, node.span(), faults))
    }

    /// Reports every key that was not read as unknown.
    pub(super) fn finish(self) {
        for (key, span, _) in self.entries() {
            if !self.known_keys.contains(&key) {
                let help = did_you_mean(key, &self.known_keys);
                self.errors
                    .add(span, format!("unknown key `{key}`"), Some(help));
            }
        }
    }
}

pub(super) fn did_you_mean(word: &str, known: &[&str]) -> String {
    match nearest(word, known) {
        Some(near) => format!("did you mean `{near}`?"),
        None => format!("expected one of {}", known.join(", ")),
    }
}

/// Value of an integer in any base; `None` for other nodes or on overflow.
pub(super) fn integer(node: Node<'_>) -> Option<i64> {
    let integer = node.get_ref().as_integer()?;
    let digits = integer.as_str().replace('_', "");
    i64::from_str_radix(&digits, integer.radix()).ok()
}
