//! Checker for JSON schemas with the keywords that the schemas of cells and robots use. Any other keyword is an error, so
//! that no part of a schema goes unchecked.

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};

use regex::Regex;
use serde_json::Value;

/// Result of a check: the places in the schema (JSON pointers) of the keys that the value uses, or the reason why the
/// schema rejects the value.
pub(crate) type Checked = Result<BTreeSet<String>, String>;

/// Keywords without an effect of their own on the values that a schema accepts. `if` refers to `then` and `else`.
const WITHOUT_EFFECT: [&str; 7] = [
    "$schema",
    "title",
    "description",
    "default",
    "definitions",
    "then",
    "else",
];

/// Checks a value against a schema.
pub(crate) fn check(schema: &Value, value: &Value) -> Checked {
    Checker { root: schema }.check(schema, value, "#")
}

/// Checker for the values within a document; `root` is the schema of the whole document.
struct Checker<'a> {
    root: &'a Value,
}

impl Checker<'_> {
    /// Checks a value against a schema at `place`, a JSON pointer.
    fn check(&self, schema: &Value, value: &Value, place: &str) -> Checked {
        match schema {
            Value::Bool(true) => return Ok(BTreeSet::new()),
            Value::Bool(false) => return Err(format!("{place}: nothing is accepted")),
            _ => (),
        }
        let mut used = BTreeSet::new();
        for (keyword, of) in schema.as_object().expect("an object or a Boolean") {
            if !WITHOUT_EFFECT.contains(&keyword.as_str()) {
                let at = format!("{place}/{keyword}");
                used.extend(self.check_keyword(schema, keyword, of, value, &at)?);
            }
        }
        Ok(used)
    }

    fn check_keyword(
        &self,
        schema: &Value,
        keyword: &str,
        of: &Value,
        value: &Value,
        place: &str,
    ) -> Checked {
        match keyword {
            "items" => self.check_all(value.as_array().into_iter().flatten(), of, place),
            "anyOf" => self.check_alternatives(of, value, place),
            "properties" => self.check_properties(of, value, place),
            "additionalProperties" => {
                let known = schema.get("properties");
                let entries = value.as_object().into_iter().flatten();
                let others = entries
                    .filter(|(key, _)| known.is_none_or(|known| known.get(key.as_str()).is_none()));
                self.check_all(others.map(|(_, value)| value), of, place)
            }
            "$ref" => {
                let place = of.as_str().expect("a text");
                self.check(referred(self.root, place), value, place)
            }
            "if" => {
                let is_true = self.check(of, value, place).is_ok();
                let branch = if is_true { "then" } else { "else" };
                self.check(&schema[branch], value, &format!("{place}/{branch}"))
            }
            _ if accepts(keyword, of, value) => Ok(BTreeSet::new()),
            _ => Err(format!("{place} rejects {value}")),
        }
    }

    fn check_all<'v>(
        &self,
        values: impl Iterator<Item = &'v Value>,
        schema: &Value,
        place: &str,
    ) -> Checked {
        let mut used = BTreeSet::new();
        for value in values {
            used.extend(self.check(schema, value, place)?);
        }
        Ok(used)
    }

    fn check_properties(&self, of: &Value, value: &Value, place: &str) -> Checked {
        let mut used = BTreeSet::new();
        for (key, schema) in of.as_object().expect("an object") {
            if let Some(value) = value.get(key) {
                let place = format!("{place}/{key}");
                used.extend(self.check(schema, value, &place)?);
                used.insert(place);
            }
        }
        Ok(used)
    }

    fn check_alternatives(&self, of: &Value, value: &Value, place: &str) -> Checked {
        let mut used = BTreeSet::new();
        let mut reasons = Vec::new();
        for (number, schema) in of.as_array().expect("a list").iter().enumerate() {
            let place = format!("{place}/{number}");
            match self.check(schema, value, &place) {
                Ok(places) => {
                    used.extend(places);
                    used.insert(place);
                }
                Err(reason) => reasons.push(reason),
            }
        }
        match used.is_empty() {
            true => Err(reasons.join("\n")),
            false => Ok(used),
        }
    }
}

/// Returns the schema at a JSON pointer, such as `#/definitions/cell.devices.arm`.
fn referred<'a>(root: &'a Value, place: &str) -> &'a Value {
    let pointer = place.strip_prefix('#').expect("a place in the document");
    root.pointer(pointer)
        .unwrap_or_else(|| panic!("nothing at {place}"))
}

/// Returns whether a keyword that looks at the value itself accepts it.
fn accepts(keyword: &str, of: &Value, value: &Value) -> bool {
    match keyword {
        "type" => match of {
            Value::Array(names) => names.iter().any(|name| is_of_type(value, name)),
            name => is_of_type(value, name),
        },
        "const" => value == of,
        "enum" => of.as_array().expect("a list").contains(value),
        "pattern" => value
            .as_str()
            .is_none_or(|text| is_match(of.as_str().expect("a text"), text)),
        "minimum" => value.as_f64().is_none_or(|number| number >= real(of)),
        "exclusiveMinimum" => value.as_f64().is_none_or(|number| number > real(of)),
        "maximum" => value.as_f64().is_none_or(|number| number <= real(of)),
        "minItems" => count(value).is_none_or(|count| count >= real(of)),
        "maxItems" => count(value).is_none_or(|count| count <= real(of)),
        "required" => value.as_object().is_none_or(|table| {
            let mut names = of.as_array().expect("a list").iter();
            names.all(|name| table.contains_key(name.as_str().expect("a text")))
        }),
        other => panic!("unknown keyword `{other}`"),
    }
}

thread_local! {
    /// Compiled patterns: to compile one takes much longer than to match a text.
    static PATTERNS: RefCell<BTreeMap<String, Regex>> = RefCell::default();
}

fn is_match(pattern: &str, text: &str) -> bool {
    PATTERNS.with_borrow_mut(|known| {
        let new = || Regex::new(pattern).expect("a valid pattern");
        let regex = known.entry(pattern.to_owned()).or_insert_with(new);
        regex.is_match(text)
    })
}

fn real(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

fn count(value: &Value) -> Option<f64> {
    value.as_array().map(|list| list.len() as f64)
}

fn is_of_type(value: &Value, name: &Value) -> bool {
    match name.as_str().expect("the name of a type") {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "boolean" => value.is_boolean(),
        "number" => value.is_number(),
        "integer" => value.as_f64().is_some_and(|number| number.fract() == 0.0),
        other => panic!("unknown type `{other}`"),
    }
}

/// Returns the places of all keys and alternatives of a schema, as [`check`] returns those that a value uses. `place` is
/// the place of the schema.
pub(crate) fn places(schema: &Value, place: &str) -> BTreeSet<String> {
    let mut all = BTreeSet::new();
    for (keyword, of) in schema.as_object().into_iter().flatten() {
        let at = format!("{place}/{keyword}");
        match (keyword.as_str(), of) {
            ("properties" | "definitions", Value::Object(keys)) => {
                for (key, of) in keys {
                    let place = format!("{at}/{key}");
                    all.extend(places(of, &place));
                    // A definition counts by its keys.
                    if keyword == "properties" {
                        all.insert(place);
                    }
                }
            }
            ("anyOf", Value::Array(list)) => {
                for (number, of) in list.iter().enumerate() {
                    let place = format!("{at}/{number}");
                    all.extend(places(of, &place));
                    all.insert(place);
                }
            }
            ("items" | "additionalProperties", _) => all.extend(places(of, &at)),
            _ => (),
        }
    }
    all
}
