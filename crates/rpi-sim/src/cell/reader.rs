//! Reader for one table of a cell description: typed keys, errors with positions, detection of unknown keys.
//!
//! A recording reader has no table. It records the shapes of the keys that a function reads, for the schema. The methods
//! for numbers are in `numbers`, those for words in `words`, and the checks of one value in `value`.

use super::collector::ErrorCollector;
use super::error::CellErrors;
use super::shape::{ListLength, TableShape, ValueShape};
use super::value::{Node, Value};
use super::words::did_you_mean;
use core::ops::{Range, RangeInclusive};
use std::rc::Rc;
use toml::Spanned;
use toml::de::DeTable;

/// Reader for one table of a TOML description. All keys that are read count as known; the others are errors.
pub(super) struct TableReader<'a> {
    table: Option<&'a DeTable<'a>>,
    span: Range<usize>,
    known_keys: Vec<&'static str>,
    pub(super) errors: &'a ErrorCollector,
    /// Shape in which the keys are recorded; `None` for a reader that does not record.
    pub(super) recorder: Option<Rc<TableShape>>,
}

/// Name and position of an entry of a table whose keys are names, with a reader for the entry; `None` if the entry is
/// not a table.
pub(super) type NamedTable<'a> = (&'a str, Range<usize>, Option<TableReader<'a>>);

impl<'a> TableReader<'a> {
    pub(super) fn new(
        table: &'a DeTable<'a>,
        span: Range<usize>,
        faults: &'a ErrorCollector,
    ) -> Self {
        Self {
            table: Some(table),
            span,
            ..Self::empty(faults)
        }
    }

    /// Creates a reader without entries, to find out which keys a function reads.
    pub(super) fn empty(faults: &'a ErrorCollector) -> Self {
        Self {
            table: None,
            span: 0..0,
            known_keys: Vec::new(),
            errors: faults,
            recorder: None,
        }
    }

    /// Creates a reader without entries that records the keys that a function reads, with the shapes of their values.
    pub(super) fn recording(shape: Rc<TableShape>, faults: &'a ErrorCollector) -> Self {
        Self {
            recorder: Some(shape),
            ..Self::empty(faults)
        }
    }

    /// Marks all keys that the function `read` would read as known, without reading their values. A recording reader
    /// records them.
    pub(super) fn mark_known(&mut self, read: impl FnOnce(&mut TableReader<'_>)) {
        let faults = ErrorCollector::default();
        let mut other = TableReader::empty(&faults);
        other.recorder.clone_from(&self.recorder);
        read(&mut other);
        for key in other.known_keys {
            self.add_known(key);
        }
    }

    fn add_known(&mut self, key: &'static str) {
        if !self.known_keys.contains(&key) {
            self.known_keys.push(key);
        }
    }

    /// Returns all entries of the table in text order (key, position, value), for a table whose keys are names.
    pub(super) fn entries(&self) -> Vec<(&'a str, Range<usize>, Node<'a>)> {
        let entries = self.table.into_iter().flatten();
        let mut all: Vec<_> = entries
            .map(|(key, value)| (key.get_ref().as_ref(), key.span(), value))
            .collect();
        all.sort_by_key(|(_, span, _)| span.start);
        all
    }

    /// Returns a reader for each entry of the table in text order, for a table whose keys are names. A recording reader
    /// returns one recording reader, for all entries.
    pub(super) fn named_tables(&self) -> Vec<NamedTable<'a>> {
        if let Some(shape) = &self.recorder {
            let entry = Self::recording(shape.entry(), self.errors);
            return vec![("", 0..0, Some(entry))];
        }
        let entries = self.entries().into_iter();
        entries
            .map(|(name, span, node)| (name, span, Self::from_node(node, self.errors)))
            .collect()
    }

    /// True if the table has this key, whatever its value.
    pub(super) fn has(&self, key: &str) -> bool {
        self.peek(key).is_some()
    }

    /// Returns the value of a key without marking the key as known; `None` if it is missing.
    pub(super) fn peek(&self, key: &str) -> Option<Node<'a>> {
        self.table?.get(key)
    }

    /// Marks a key as known and returns its value; `None` if it is missing. A recording reader records the shape.
    pub(super) fn get(
        &mut self,
        key: &'static str,
        shape: impl FnOnce() -> ValueShape,
    ) -> Option<Value<'a>> {
        self.add_known(key);
        if let Some(recorder) = &self.recorder {
            recorder.record(key, shape());
        }
        let node = self.peek(key)?;
        Some(Value::new(key, node, self.errors))
    }

    /// Reports an error if the key is missing; `help` states what is expected. The key must have been read before.
    /// Returns true if the table has the key.
    pub(super) fn require(&mut self, key: &'static str, help: &str) -> bool {
        if let Some(recorder) = &self.recorder {
            recorder.require(key);
        }
        let has = self.has(key);
        if !has {
            self.error_at(key, format!("`{key}` is missing"), Some(help.to_owned()));
        }
        has
    }

    /// Records the title of the table for the schema, if the reader records.
    pub(super) fn record_title(&self, title: &'static str) {
        if let Some(recorder) = &self.recorder {
            recorder.set_title(title);
        }
    }

    /// Records the description of a key and its numerical default for the schema, if the reader records. The key must
    /// have been read before.
    pub(super) fn record_description(
        &self,
        key: &'static str,
        description: impl FnOnce() -> String,
        default: Option<f64>,
    ) {
        if let Some(recorder) = &self.recorder {
            recorder.describe(key, description(), default);
        }
    }

    /// Reports an error at the value of `key`, or at the head of the table if the key is missing.
    pub(super) fn error_at(&self, key: &str, message: String, help: Option<String>) {
        let place = self.peek(key).map_or(self.span.clone(), Spanned::span);
        self.errors.add(place, message, help);
    }

    /// Reports an error at the entry with the index `entry` of the list at `key`, or at the value of `key` if it is not
    /// such a list.
    pub(super) fn error_at_entry(
        &self,
        key: &str,
        entry: usize,
        message: String,
        help: Option<String>,
    ) {
        let list = self.peek(key).and_then(|node| node.get_ref().as_array());
        match list.and_then(|list| list.get(entry)) {
            Some(node) => self.errors.add(node.span(), message, help),
            None => self.error_at(key, message, help),
        }
    }

    pub(super) fn text(&mut self, key: &'static str) -> Option<&'a str> {
        self.get(key, || ValueShape::Text)?.text()
    }

    pub(super) fn boolean(&mut self, key: &'static str) -> Option<bool> {
        self.get(key, || ValueShape::Boolean)?.truth()
    }

    /// Reads a list of truth values of any length; `None` if the key is missing or invalid.
    pub(super) fn booleans(&mut self, key: &'static str) -> Option<Vec<bool>> {
        let shape = || ValueShape::list(ValueShape::Boolean, ListLength::ANY);
        let list = self.get(key, shape)?.list("a list of true and false")?;
        let values: Vec<Option<bool>> = list.iter().map(Value::truth).collect();
        values.into_iter().collect()
    }

    /// Reads an integer from 0 to `bound` - 1; `None` if the key is missing or invalid. With a bound of 0, which is that of
    /// an empty list, no value is valid; for the schema, the bound is unknown then.
    pub(super) fn index(&mut self, key: &'static str, bound: u64) -> Option<u64> {
        if let Some(last) = bound.checked_sub(1) {
            return self.integer(key, 0..=last, "");
        }
        let value = self.get(key, || ValueShape::Integer(0..=u64::MAX))?;
        value.integer(|_| false, "the list of valid values is empty".to_owned())
    }

    /// Reads an integer of a range; `None` if the key is missing or invalid. `what` names the counted things in the
    /// message, with a space before them.
    pub(super) fn integer(
        &mut self,
        key: &'static str,
        range: RangeInclusive<u64>,
        what: &str,
    ) -> Option<u64> {
        let value = self.get(key, || ValueShape::Integer(range.clone()))?;
        let help = format!("the range is {} to {}{what}", range.start(), range.end());
        value.integer(|value| range.contains(&value), help)
    }

    /// Reads a key by `first` if its value passes `is_first`, otherwise by `second`. A recording reader walks both.
    pub(super) fn either<T>(
        &mut self,
        key: &'static str,
        is_first: impl FnOnce(Node<'a>) -> bool,
        first: impl FnOnce(&mut Self) -> T,
        second: impl FnOnce(&mut Self) -> T,
    ) -> T {
        if self.recorder.is_some() {
            first(self);
            return second(self);
        }
        match self.peek(key).is_some_and(is_first) {
            true => first(self),
            false => second(self),
        }
    }

    /// Reports the errors of another file at the value of `key`, which names this file.
    pub(super) fn nested_errors(&self, key: &str, nested: &CellErrors) {
        let place = self.peek(key).map_or(self.span.clone(), Spanned::span);
        self.errors.add_nested(place, nested);
    }

    /// Reads a nested table; `None` if the key is missing or not a table.
    pub(super) fn table(&mut self, key: &'static str) -> Option<TableReader<'a>> {
        if let Some(shape) = &self.recorder {
            let inner = Self::recording(shape.table(key), self.errors);
            self.add_known(key);
            return Some(inner);
        }
        let value = self.get(key, || ValueShape::Text)?;
        let inner = Self::from_node(value.node, self.errors);
        if inner.is_none() {
            value.wrong_type("a table", None);
        }
        inner
    }

    /// Reads a list of tables, `[[...]]`, and returns a reader for each; empty if the key is missing.
    pub(super) fn tables(&mut self, key: &'static str) -> Vec<TableReader<'a>> {
        self.tables_within(key, ListLength::ANY, "")
            .unwrap_or_default()
    }

    /// Reads a list of tables, `[[...]]`, whose number must be within `length`, and returns a reader for each. Reports an
    /// error with `help` and returns `None` if there are more or fewer. Returns `None` without an error if the list is
    /// missing and must have entries.
    pub(super) fn tables_within(
        &mut self,
        key: &'static str,
        length: ListLength,
        help: &str,
    ) -> Option<Vec<TableReader<'a>>> {
        if let Some(shape) = &self.recorder {
            let inner = Self::recording(shape.tables(key, length), self.errors);
            self.add_known(key);
            return Some(vec![inner]);
        }
        let Some(value) = self.get(key, || ValueShape::Text) else {
            return length.contains(0).then(Vec::new);
        };
        let list = value.list("a list of tables")?;
        if !length.contains(list.len()) {
            let message = format!("`{key}` has {} entries", list.len());
            self.error_at(key, message, Some(help.to_owned()));
            return None;
        }
        let readers = list.iter().filter_map(|value| {
            let inner = Self::from_node(value.node, self.errors);
            if inner.is_none() {
                value.wrong_type("a table", None);
            }
            inner
        });
        Some(readers.collect())
    }

    /// Creates a reader for a TOML value; `None` if the value is not a table.
    pub(super) fn from_node(node: Node<'a>, faults: &'a ErrorCollector) -> Option<Self> {
        let table = node.get_ref().as_table()?;
        Some(Self::new(table, node.span(), faults))
    }

    /// Reports every key of the table that was not read as unknown.
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
