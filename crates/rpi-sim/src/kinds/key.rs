//! Keys of small devices in a cell: types, defaults and meanings, and the values that a cell gives them.

use crate::cell::quantity::{Dimension, si_unit};
use nalgebra::Vector6;

/// Declaration of a key that a cell may give to a device.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Key {
    /// Name of the key in the table of the device.
    pub(crate) name: &'static str,
    /// Values that the key accepts.
    pub(crate) ty: KeyType,
    /// Value that the key has if the cell does not give it.
    pub(crate) default: KeyDefault,
    /// Meaning of the value for the manual, without unit and default.
    pub(crate) meaning: &'static str,
}

/// Type of the value of a key.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum KeyType {
    /// Number of this dimension that is not negative.
    NotNegative(Dimension),
    /// Number of this dimension that is greater than zero.
    Positive(Dimension),
    /// Number of periods, from 1 to 1000.
    Periods,
    /// Script of forces and torques: a list of `{ at, force, torque }`.
    Wrenches,
    /// Script of truth values: a list of `{ at, value }`.
    Switches,
}

/// Value that a key has if the cell does not give it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum KeyDefault {
    /// This number, in the SI unit of the key.
    Number(f64),
    /// Value of the key with this name, which is declared before.
    SameAs(&'static str),
    /// No value; the text describes the effect for the manual.
    Absent(&'static str),
}

impl Key {
    /// Creates a key for a number greater than zero, with its default value in the SI unit.
    pub(crate) const fn positive(
        name: &'static str,
        dimension: Dimension,
        default: f64,
        meaning: &'static str,
    ) -> Self {
        let ty = KeyType::Positive(dimension);
        Self::new(name, ty, KeyDefault::Number(default), meaning)
    }

    pub(crate) const fn new(
        name: &'static str,
        ty: KeyType,
        default: KeyDefault,
        meaning: &'static str,
    ) -> Self {
        Self {
            name,
            ty,
            default,
            meaning,
        }
    }

    /// Returns the meaning of the key with its unit, for the manual.
    pub(crate) fn description(&self) -> String {
        match self.unit() {
            "" => self.meaning.to_owned(),
            unit => format!("{}, {unit}", self.meaning),
        }
    }

    /// Returns the meaning and the default of the key, for the schema. The schema states the unit.
    pub(crate) fn schema_description(&self) -> String {
        let mut characters = self.meaning.chars();
        let first = characters.next().into_iter().flat_map(char::to_uppercase);
        let meaning: String = first.chain(characters).collect();
        format!("{meaning}. Default: {}", self.default_text())
    }

    /// Returns the default of the key as a text, for the manual.
    pub(crate) fn default_text(&self) -> String {
        match self.default {
            KeyDefault::Number(value) => value.to_string(),
            KeyDefault::SameAs(other) => format!("`{other}`"),
            KeyDefault::Absent(words) => words.to_owned(),
        }
    }

    /// Returns the SI unit of the value; empty without one.
    pub(crate) fn unit(&self) -> &'static str {
        match self.ty {
            KeyType::NotNegative(dimension) | KeyType::Positive(dimension) => si_unit(dimension),
            KeyType::Periods | KeyType::Wrenches | KeyType::Switches => "",
        }
    }
}

/// Value of a key of a small device.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Setting {
    /// A number in SI units.
    Number(f64),
    /// Forces (N) and torques (N m) with the times (s) at which they begin, in order of time.
    Wrenches(Vec<(f64, Vector6<f64>)>),
    /// Truth values with the times (s) at which they begin, in order of time.
    Switches(Vec<(f64, bool)>),
}

/// Values of the keys of a small device, by key.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Settings(Vec<(&'static str, Setting)>);

impl Settings {
    pub(crate) fn add(&mut self, key: &'static str, value: Setting) {
        self.0.push((key, value));
    }

    fn get(&self, key: &str) -> Option<&Setting> {
        let found = self.0.iter().find(|(name, _)| *name == key);
        found.map(|(_, value)| value)
    }

    /// Returns the number at `key`, in its SI unit; `None` if the key has neither a value nor a default.
    pub(crate) fn optional(&self, key: &str) -> Option<f64> {
        match self.get(key) {
            Some(Setting::Number(value)) => Some(*value),
            _ => None,
        }
    }

    /// Returns the number at `key`, in its SI unit; 0 if the key has neither a value nor a default.
    pub(crate) fn number(&self, key: &str) -> f64 {
        self.optional(key).unwrap_or_default()
    }

    /// Returns the script of forces and torques at `key`, each with its time; empty if it is missing.
    pub(crate) fn wrenches(&self, key: &str) -> &[(f64, Vector6<f64>)] {
        match self.get(key) {
            Some(Setting::Wrenches(list)) => list,
            _ => &[],
        }
    }

    /// Returns the script of truth values at `key`, each with its time; empty if it is missing.
    pub(crate) fn switches(&self, key: &str) -> &[(f64, bool)] {
        match self.get(key) {
            Some(Setting::Switches(list)) => list,
            _ => &[],
        }
    }
}
