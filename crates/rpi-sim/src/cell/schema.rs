//! JSON schemas of cell and robot descriptions, for editors, made by the code that reads the descriptions.
//!
//! The schemas use draft 7, with which the language server Taplo validates. They never reject what the reader accepts, and
//! accept more where a rule connects several values.
//!
//! A table with variants, such as a device with its `kind`, has them twice. `if`, `then` and `else` select the variant to
//! validate with, so that an error has its own place; an error of `oneOf` would be one of the whole table. Taplo does not
//! complete by `if`, so that `anyOf` lists the variants for completion. Its first alternative accepts every table.

use super::collector::ErrorCollector;
use super::descriptions;
use super::json::Json;
use super::quantity::{self, Dimension};
use super::reader::TableReader;
use super::shape::{KeyShape, ListLength, Sign, TableShape, ValueShape};
use std::rc::Rc;

/// Returns the schema of the descriptions that the function `read` reads, as JSON. `root` is the first part of the paths
/// of their keys, and `title` the title of the schema.
pub(super) fn schema(root: &str, title: &str, read: impl FnOnce(TableReader<'_>)) -> String {
    let shape = Rc::new(TableShape::default());
    let errors = ErrorCollector::default();
    read(TableReader::recording(Rc::clone(&shape), &errors));
    let mut writer = SchemaWriter::default();
    let table = writer.table(&shape, root);
    let mut schema = Json::object([
        (
            "$schema",
            Json::text("http://json-schema.org/draft-07/schema#"),
        ),
        ("title", Json::text(title)),
    ]);
    schema.extend(table);
    schema.add("definitions", Json::Object(writer.definitions));
    schema.document()
}

/// Writer of a schema, with the definitions to which its tables refer.
#[derive(Default)]
struct SchemaWriter {
    /// Schemas of the variants of tables, by their paths.
    definitions: Vec<(String, Json)>,
}

impl SchemaWriter {
    /// Returns the schema of a table. `path` is the path of the table, such as `cell.devices.arm.limits`.
    fn table(&mut self, shape: &TableShape, path: &str) -> Json {
        let keys = located(shape, path);
        let Some((tag, variants)) = shape.variants() else {
            return self.plain_table(&keys, shape, path, None);
        };
        let words: Vec<&str> = variants.iter().map(|(word, _)| *word).collect();
        let mut alternatives = vec![Json::object([("type", Json::text("object"))])];
        let mut choice = Json::object([("properties", one_of_words(tag, &words))]);
        for (word, variant) in variants.iter().rev() {
            let path = format!("{path}.{word}");
            let all = [keys.clone(), located(variant, &path)].concat();
            let schema = self.plain_table(&all, variant, &path, Some((tag, word)));
            let reference = Json::object([("$ref", Json::text(format!("#/definitions/{path}")))]);
            self.definitions.push((path, schema));
            alternatives.insert(1, reference.clone());
            let condition = Json::object([("properties", one_of_words(tag, &[word]))]);
            choice = Json::object([("if", condition), ("then", reference), ("else", choice)]);
        }
        let mut out = Json::object([
            ("type", Json::text("object")),
            ("required", Json::texts([tag])),
            ("anyOf", Json::List(alternatives)),
        ]);
        out.extend(choice);
        out
    }

    /// Returns the schema of a table without variants, or of one variant. `keys` are its keys with their paths, and `tag`
    /// is the key that selects the variant, with its value.
    fn plain_table(
        &mut self,
        keys: &[(String, KeyShape)],
        shape: &TableShape,
        path: &str,
        tag: Option<(&'static str, &str)>,
    ) -> Json {
        let mut properties = Vec::new();
        if let Some((key, word)) = tag {
            let text = description(&format!("{path}.{key}"));
            let value = Json::object([
                ("description", Json::text(text)),
                ("type", Json::text("string")),
                ("const", Json::text(word)),
            ]);
            properties.push((key.to_owned(), value));
        }
        for (path, key) in keys {
            properties.push((key.name.to_owned(), self.property(key, path)));
        }
        let required = keys.iter().map(|(_, key)| key);
        let required = required.filter(|key| key.is_required).map(|key| key.name);
        let required: Vec<&str> = tag.iter().map(|(key, _)| *key).chain(required).collect();
        let mut out = Json::Object(Vec::new());
        if let Some(title) = shape.title() {
            out.add("title", Json::text(title));
        }
        out.add("type", Json::text("object"));
        if !properties.is_empty() {
            out.add("properties", Json::Object(properties));
        }
        if !required.is_empty() {
            out.add("required", Json::texts(required));
        }
        let others = match shape.entry_shape() {
            Some(entry) => self.table(&entry, path),
            None => Json::Bool(false),
        };
        out.add("additionalProperties", others);
        out
    }

    /// Returns the schema of the value of a key, with its description.
    fn property(&mut self, key: &KeyShape, path: &str) -> Json {
        let text = key.description.clone();
        let text = text.unwrap_or_else(|| description(path).to_owned());
        let units = key.values.iter().find_map(units).unwrap_or_default();
        let mut out = Json::object([("description", Json::text(format!("{text}{units}")))]);
        if let Some(default) = key.default {
            out.add("default", Json::Number(default));
        }
        match key.values.as_slice() {
            [single] => out.extend(self.value(single, path)),
            several => {
                let all = several.iter().map(|one| self.value(one, path));
                let all: Vec<Json> = all.collect();
                match merged(&all) {
                    Some(merged) => out.extend(merged),
                    None => out.add("anyOf", Json::List(all)),
                }
            }
        }
        out
    }

    fn value(&mut self, shape: &ValueShape, path: &str) -> Json {
        let of_type = |name: &str| Json::object([("type", Json::text(name))]);
        match shape {
            ValueShape::Text => of_type("string"),
            ValueShape::Boolean => of_type("boolean"),
            ValueShape::Word(words) => {
                let mut out = of_type("string");
                out.add("enum", Json::texts(words.iter().copied()));
                out
            }
            ValueShape::File(extensions) => {
                let ends = extensions.iter().map(|end| end.trim_start_matches('.'));
                let ends: Vec<&str> = ends.collect();
                let mut out = of_type("string");
                out.add("pattern", Json::text(format!("\\.({})$", ends.join("|"))));
                out
            }
            ValueShape::Integer(range) => {
                let mut out = of_type("integer");
                out.add("minimum", Json::Integer(*range.start()));
                // An integer of TOML has 64 bits with a sign.
                if *range.end() < u64::MAX >> 1 {
                    out.add("maximum", Json::Integer(*range.end()));
                }
                out
            }
            ValueShape::Number(dimensions, sign) => number(dimensions, *sign),
            ValueShape::List(entry, length) => list(self.value(entry, path), *length),
            ValueShape::Table(shape) => self.table(shape, path),
        }
    }
}

/// Returns one schema for values of different types, each with its own keywords; `None` if the same keyword
/// would concern two of them. Editors list a key once for each alternative, so that one schema is better than several.
fn merged(alternatives: &[Json]) -> Option<Json> {
    let mut types: Vec<Json> = Vec::new();
    let mut others: Vec<(String, Json)> = Vec::new();
    for alternative in alternatives {
        let Json::Object(entries) = alternative else {
            return None;
        };
        for (key, value) in entries {
            let own = match value {
                Json::List(list) if key == "type" => list.as_slice(),
                value => core::slice::from_ref(value),
            };
            let is_known = match key.as_str() {
                "type" => own.iter().any(|one| types.contains(one)),
                // An enumeration concerns values of all types.
                key => key == "enum" || others.iter().any(|(other, _)| other == key),
            };
            match key.as_str() {
                _ if is_known => return None,
                "type" => types.extend_from_slice(own),
                _ => others.push((key.clone(), value.clone())),
            }
        }
    }
    let mut merged = Json::object([("type", Json::List(types))]);
    merged.extend(Json::Object(others));
    Some(merged)
}

/// Returns the schema of the properties of a table whose value of the key `tag` is one of `words`.
fn one_of_words(tag: &'static str, words: &[&str]) -> Json {
    let word = match words {
        [word] => ("const", Json::text(*word)),
        _ => ("enum", Json::texts(words.iter().copied())),
    };
    Json::object([(tag, Json::object([word]))])
}

/// Returns the keys of the table at `path`, each with its own path.
fn located(shape: &TableShape, path: &str) -> Vec<(String, KeyShape)> {
    let keys = shape.keys().into_iter();
    keys.map(|key| (format!("{path}.{}", key.name), key))
        .collect()
}

/// Returns the schema of a number in the SI unit, or a string with a unit. The sign of a string is not checked.
fn number(dimensions: &[Dimension], sign: Sign) -> Json {
    let mut out = Json::object([("type", Json::texts(["number", "string"]))]);
    match sign {
        Sign::Any => (),
        Sign::NotNegative => out.add("minimum", Json::Integer(0)),
        Sign::Positive => out.add("exclusiveMinimum", Json::Integer(0)),
    }
    out.add("pattern", Json::text(quantity::pattern(dimensions)));
    out
}

fn list(entry: Json, length: ListLength) -> Json {
    let mut out = Json::object([("type", Json::text("array")), ("items", entry)]);
    if length.least > 0 {
        out.add("minItems", Json::Integer(length.least as u64));
    }
    if let Some(most) = length.most {
        out.add("maxItems", Json::Integer(most as u64));
    }
    out
}

/// Returns a sentence with the units of a number, or of the numbers of a list; `None` for other values.
fn units(shape: &ValueShape) -> Option<String> {
    match shape {
        ValueShape::List(entry, _) => units(entry),
        ValueShape::Number(dimensions, _) => {
            let of = dimensions.iter().map(|of| quantity::unit_names(*of));
            let of: Vec<String> = of
                .filter_map(|names| {
                    let (si_unit, others) = names.split_first()?;
                    let others: Vec<String> =
                        others.iter().map(|unit| format!("\"{unit}\"")).collect();
                    Some(match others.is_empty() {
                        true => (*si_unit).to_owned(),
                        false => format!("{si_unit} (as a string also {})", others.join(", ")),
                    })
                })
                .collect();
            (!of.is_empty()).then(|| format!(". Unit: {}", of.join("; or ")))
        }
        _ => None,
    }
}

/// Returns the description of the key at a path.
fn description(path: &str) -> &'static str {
    descriptions::of(path).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    /// Adds the paths of all keys of a table that need a description of the list.
    fn paths(shape: &TableShape, path: &str, all: &mut BTreeSet<String>) {
        for key in shape.keys() {
            let path = format!("{path}.{}", key.name);
            for value in &key.values {
                nested(value, &path, all);
            }
            if key.description.is_none() {
                all.insert(path);
            }
        }
        if let Some((tag, variants)) = shape.variants() {
            for (word, variant) in variants {
                all.insert(format!("{path}.{word}.{tag}"));
                paths(&variant, &format!("{path}.{word}"), all);
            }
        }
        if let Some(entry) = shape.entry_shape() {
            paths(&entry, path, all);
        }
    }

    fn nested(value: &ValueShape, path: &str, all: &mut BTreeSet<String>) {
        match value {
            ValueShape::Table(table) => paths(table, path, all),
            ValueShape::List(entry, _) => nested(entry, path, all),
            _ => (),
        }
    }

    fn all_paths() -> BTreeSet<String> {
        let mut all = BTreeSet::new();
        let errors = ErrorCollector::default();
        let (cell, robot) = (
            Rc::new(TableShape::default()),
            Rc::new(TableShape::default()),
        );
        super::super::Cell::read(TableReader::recording(Rc::clone(&cell), &errors));
        super::super::robot::walk(TableReader::recording(Rc::clone(&robot), &errors));
        paths(&cell, "cell", &mut all);
        paths(&robot, "robot", &mut all);
        all
    }

    #[test]
    fn every_key_has_a_description_and_every_description_a_key() {
        let paths = all_paths();
        let without: Vec<&String> = paths
            .iter()
            .filter(|path| descriptions::of(path).is_none())
            .collect();
        assert!(without.is_empty(), "no description: {without:#?}");
        let used: BTreeSet<&str> = paths
            .iter()
            .filter_map(|path| descriptions::of(path))
            .collect();
        let unused: Vec<_> = descriptions::DESCRIPTIONS
            .iter()
            .filter(|(_, text)| !used.contains(text))
            .collect();
        assert!(unused.is_empty(), "no key: {unused:#?}");
    }
}
