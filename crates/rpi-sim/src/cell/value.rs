//! One value of a description: checks of its type, range and unit.

use super::collector::ErrorCollector;
use super::quantity::{self, Dimension};
use super::words::did_you_mean;
use core::fmt;
use toml::Spanned;
use toml::de::DeValue;

pub(super) type Node<'a> = &'a Spanned<DeValue<'a>>;

/// Value of a key, or an entry of the list at a key. Each method reports an error and returns `None` if the value is
/// invalid.
#[derive(Clone, Copy)]
pub(super) struct Value<'a> {
    key: &'static str,
    /// Index of the entry of the list, from 0; `None` for the whole value.
    entry: Option<usize>,
    pub(super) node: Node<'a>,
    errors: &'a ErrorCollector,
}

/// The name of the value in messages, such as `joints` or `joints[2]`.
impl fmt::Display for Value<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.entry {
            Some(entry) => write!(f, "{}[{entry}]", self.key),
            None => f.write_str(self.key),
        }
    }
}

impl<'a> Value<'a> {
    pub(super) fn new(key: &'static str, node: Node<'a>, errors: &'a ErrorCollector) -> Self {
        Self {
            key,
            entry: None,
            node,
            errors,
        }
    }

    /// Reports an error at the value.
    pub(super) fn error(&self, message: String, help: Option<String>) {
        self.errors.add(self.node.span(), message, help);
    }

    /// Reports that the value has another type than the expected one, `wanted`.
    pub(super) fn wrong_type(&self, wanted: &str, help: Option<String>) {
        let found = self.node.get_ref().type_str();
        let message = format!("expected {wanted} for `{self}`, found {found}");
        self.error(message, help);
    }

    pub(super) fn text(&self) -> Option<&'a str> {
        let text = self.node.get_ref().as_str();
        if text.is_none() {
            self.wrong_type("a string", None);
        }
        text
    }

    pub(super) fn truth(&self) -> Option<bool> {
        let truth = self.node.get_ref().as_bool();
        if truth.is_none() {
            self.wrong_type("true or false", None);
        }
        truth
    }

    /// Returns the entries of a list. `wanted` names the list in the message.
    pub(super) fn list(&self, wanted: &str) -> Option<Vec<Self>> {
        let Some(list) = self.node.get_ref().as_array() else {
            self.wrong_type(wanted, None);
            return None;
        };
        let entries = list.iter().enumerate();
        let entries = entries.map(|(entry, node)| Self {
            entry: Some(entry),
            node,
            ..*self
        });
        Some(entries.collect())
    }

    /// Returns the word of `known` that the value is.
    pub(super) fn word(&self, known: &[&'static str]) -> Option<&'static str> {
        let text = self.text()?;
        let found = known.iter().copied().find(|word| *word == text);
        if found.is_none() {
            let message = format!("unknown value \"{text}\" for `{self}`");
            self.error(message, Some(did_you_mean(text, known)));
        }
        found
    }

    /// Returns an integer that is not negative and passes `is_valid`. `help` states the valid range.
    pub(super) fn integer(&self, is_valid: impl Fn(u64) -> bool, help: String) -> Option<u64> {
        let value = integer(self.node);
        let valid = value.and_then(|value| u64::try_from(value).ok());
        let valid = valid.filter(|value| is_valid(*value));
        if valid.is_none() {
            match value {
                Some(value) => self.error(format!("`{self}` is {value}, out of range"), Some(help)),
                None => self.wrong_type("an integer", Some(help)),
            }
        }
        valid
    }

    /// Returns a finite number in the SI unit of its dimension.
    pub(super) fn number(&self, dimension: Dimension) -> Option<f64> {
        let expected = || quantity::expectation(&[dimension]);
        let value = match self.node.get_ref() {
            DeValue::String(text) => {
                quantity::parse(text, dimension).map_err(|error| error.to_string())
            }
            DeValue::Float(float) => {
                let number = float.as_str().replace('_', "").parse();
                number.map_err(|_| expected())
            }
            DeValue::Integer(_) => {
                let value = integer(self.node);
                value.map(|value| value as f64).ok_or_else(expected)
            }
            _ => {
                let wanted = format!("a number{}", in_unit(&[dimension]));
                self.wrong_type(&wanted, None);
                return None;
            }
        };
        let (message, help) = match value {
            Ok(value) if value.is_finite() => return Some(value),
            Ok(_) => (format!("`{self}` is not a finite number"), expected()),
            Err(help) => (format!("`{self}` is not a valid number"), help),
        };
        self.error(message, Some(help));
        None
    }
}

/// Returns the SI unit of numbers for a message, such as ` (in rad)`; empty without a unit or for different units.
pub(super) fn in_unit(dimensions: &[Dimension]) -> String {
    let mut units = dimensions
        .iter()
        .map(|dimension| quantity::si_unit(*dimension));
    let unit = units.next().unwrap_or("");
    match unit.is_empty() || units.any(|other| other != unit) {
        true => String::new(),
        false => format!(" (in {unit})"),
    }
}

/// Returns the value of an integer in any base; `None` for values of other types or on overflow.
pub(super) fn integer(node: Node<'_>) -> Option<i64> {
    let integer = node.get_ref().as_integer()?;
    let digits = integer.as_str().replace('_', "");
    i64::from_str_radix(&digits, integer.radix()).ok()
}
