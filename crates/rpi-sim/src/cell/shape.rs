//! Shapes of tables: the keys that a function reads, with the values that they accept.
//!
//! A recording [`TableReader`](super::reader::TableReader) records them while the code that reads cells runs without a
//! cell. A key that is read in several ways, because a value or a model decides, accepts all of them.

use super::quantity::Dimension;
use core::cell::{Cell, RefCell};
use core::ops::RangeInclusive;
use std::rc::Rc;

/// Number of entries of a list: at least `least`, and at most `most`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct ListLength {
    pub(super) least: usize,
    /// Maximum number of entries; `None` without a maximum.
    pub(super) most: Option<usize>,
}

impl ListLength {
    /// Any number of entries, also none.
    pub(super) const ANY: Self = Self {
        least: 0,
        most: None,
    };

    pub(super) fn exactly(count: usize) -> Self {
        Self {
            least: count,
            most: Some(count),
        }
    }

    pub(super) fn contains(self, count: usize) -> bool {
        count >= self.least && self.most.is_none_or(|most| count <= most)
    }

    /// Returns the length that contains both lengths.
    fn hull(self, other: Self) -> Self {
        Self {
            least: self.least.min(other.least),
            most: self.most.zip(other.most).map(|(one, other)| one.max(other)),
        }
    }
}

/// Sign that a number must have, from the strictest to the most general.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Sign {
    /// Greater than zero.
    Positive,
    /// Zero or greater.
    NotNegative,
    /// Any sign.
    Any,
}

/// Value that a key accepts.
#[derive(Clone, Debug)]
pub(super) enum ValueShape {
    /// Any string.
    Text,
    /// One of these strings.
    Word(Vec<&'static str>),
    /// Path of a file with one of these extensions.
    File(&'static [&'static str]),
    /// True or false.
    Boolean,
    /// Integer of this range; `u64::MAX` as its end means that there is no maximum.
    Integer(RangeInclusive<u64>),
    /// Finite number in the SI unit of one of the dimensions, or a string with one of their units.
    Number(Vec<Dimension>, Sign),
    /// List of equal entries.
    List(Box<ValueShape>, ListLength),
    /// Nested table.
    Table(Rc<TableShape>),
}

impl ValueShape {
    /// Creates the shape of a number with one of `dimensions`.
    pub(super) fn number(dimensions: &[Dimension], sign: Sign) -> Self {
        let mut different = Vec::new();
        add_missing(&mut different, dimensions);
        Self::Number(different, sign)
    }

    pub(super) fn list(entry: Self, length: ListLength) -> Self {
        Self::List(Box::new(entry), length)
    }

    /// Extends the shape to what `other` accepts, too, and returns true; returns false if the types differ.
    fn extend(&mut self, other: &Self) -> bool {
        match (self, other) {
            (Self::Text, Self::Text)
            | (Self::Boolean, Self::Boolean)
            | (Self::File(_), Self::File(_)) => true,
            (Self::Word(own), Self::Word(words)) => {
                add_missing(own, words);
                true
            }
            (Self::Integer(own), Self::Integer(range)) => {
                let least = (*own.start()).min(*range.start());
                *own = least..=(*own.end()).max(*range.end());
                true
            }
            (Self::Number(own, sign), Self::Number(dimensions, other)) => {
                add_missing(own, dimensions);
                *sign = (*sign).max(*other);
                true
            }
            (Self::List(own, length), Self::List(entry, other)) => {
                let is_extended = own.extend(entry);
                if is_extended {
                    *length = length.hull(*other);
                }
                is_extended
            }
            (Self::Table(own), Self::Table(table)) => Rc::ptr_eq(own, table),
            _ => false,
        }
    }
}

fn add_missing<T: Clone + PartialEq>(list: &mut Vec<T>, more: &[T]) {
    for item in more {
        if !list.contains(item) {
            list.push(item.clone());
        }
    }
}

/// Key of a table, with the values that it accepts.
#[derive(Clone, Debug)]
pub(super) struct KeyShape {
    pub(super) name: &'static str,
    /// Values of different types that the key accepts, at least one.
    pub(super) values: Vec<ValueShape>,
    /// True if the table must have the key.
    pub(super) is_required: bool,
    /// Description of the key, if the reading code has one.
    pub(super) description: Option<String>,
    /// Default of the key if it is a number, in its SI unit.
    pub(super) default: Option<f64>,
}

/// Word that selects a variant of a table, and the shape of the keys that only this variant has.
pub(super) type Variant = (&'static str, Rc<TableShape>);

/// Shape of a table: its keys, and what they accept. It is filled while functions read a table without entries.
#[derive(Debug, Default)]
pub(super) struct TableShape {
    keys: RefCell<Vec<KeyShape>>,
    /// Shape of the entries of a table whose keys are names.
    entry: RefCell<Option<Rc<TableShape>>>,
    /// Variants of the table, with the key whose value selects one.
    variants: RefCell<Option<(&'static str, Vec<Variant>)>>,
    title: Cell<Option<&'static str>>,
}

impl TableShape {
    /// Records that a key accepts values of this shape, in addition to those recorded before.
    pub(super) fn record(&self, key: &'static str, value: ValueShape) {
        self.change(key, |shape| {
            if !shape.values.iter_mut().any(|own| own.extend(&value)) {
                shape.values.push(value);
            }
        });
    }

    fn change<T>(&self, key: &'static str, change: impl FnOnce(&mut KeyShape) -> T) -> T {
        let mut keys = self.keys.borrow_mut();
        let place = keys.iter().position(|shape| shape.name == key);
        let place = place.unwrap_or_else(|| {
            keys.push(KeyShape {
                name: key,
                values: Vec::new(),
                is_required: false,
                description: None,
                default: None,
            });
            keys.len() - 1
        });
        change(&mut keys[place])
    }

    /// Records that the table must have the key, which must have been recorded. The key of variants is always required.
    pub(super) fn require(&self, key: &'static str) {
        let is_recorded = self.keys.borrow().iter().any(|shape| shape.name == key);
        if is_recorded {
            self.change(key, |shape| shape.is_required = true);
        }
    }

    pub(super) fn describe(&self, key: &'static str, description: String, default: Option<f64>) {
        self.change(key, |shape| {
            shape.description = Some(description);
            shape.default = default;
        });
    }

    pub(super) fn set_title(&self, title: &'static str) {
        self.title.set(Some(title));
    }

    pub(super) fn title(&self) -> Option<&'static str> {
        self.title.get()
    }

    /// Returns the shape of the table at `key`, and records it if it is new.
    pub(super) fn table(&self, key: &'static str) -> Rc<Self> {
        self.change(key, |shape| {
            let known = shape.values.iter().find_map(|value| match value {
                ValueShape::Table(table) => Some(Rc::clone(table)),
                _ => None,
            });
            known.unwrap_or_else(|| {
                let table = Rc::new(Self::default());
                shape.values.push(ValueShape::Table(Rc::clone(&table)));
                table
            })
        })
    }

    /// Returns the shape of the entries of the list of tables at `key`, and records the list if it is new.
    pub(super) fn tables(&self, key: &'static str, length: ListLength) -> Rc<Self> {
        self.change(key, |shape| {
            let known = shape.values.iter().find_map(|value| match value {
                ValueShape::List(entry, _) => match &**entry {
                    ValueShape::Table(table) => Some(Rc::clone(table)),
                    _ => None,
                },
                _ => None,
            });
            known.unwrap_or_else(|| {
                let table = Rc::new(Self::default());
                let entry = ValueShape::Table(Rc::clone(&table));
                shape.values.push(ValueShape::list(entry, length));
                table
            })
        })
    }

    /// Returns the shape of the entries of a table whose keys are names.
    pub(super) fn entry(&self) -> Rc<Self> {
        let mut entry = self.entry.borrow_mut();
        Rc::clone(entry.get_or_insert_with(Rc::default))
    }

    /// Returns the shape of the keys that the table has only if the value of `key` is `word`.
    pub(super) fn variant(&self, key: &'static str, word: &'static str) -> Rc<Self> {
        let mut variants = self.variants.borrow_mut();
        let (_, all) = variants.get_or_insert_with(|| (key, Vec::new()));
        if let Some((_, known)) = all.iter().find(|(own, _)| *own == word) {
            return Rc::clone(known);
        }
        let shape = Rc::new(Self::default());
        all.push((word, Rc::clone(&shape)));
        shape
    }

    /// Returns the keys in the order in which they are read.
    pub(super) fn keys(&self) -> Vec<KeyShape> {
        self.keys.borrow().clone()
    }

    /// Returns the shape of the entries of a table whose keys are names; `None` for other tables.
    pub(super) fn entry_shape(&self) -> Option<Rc<Self>> {
        self.entry.borrow().clone()
    }

    /// Returns the variants of the table with the key that selects one; `None` for a table without variants.
    pub(super) fn variants(&self) -> Option<(&'static str, Vec<Variant>)> {
        self.variants.borrow().clone()
    }
}
