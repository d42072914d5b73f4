//! JSON schemas of cell and robot descriptions: what the reader accepts, the schema accepts.

mod checker;
mod mutations;
mod samples;

use std::collections::BTreeSet;
use std::path::Path;

use checker::{check, places};
use rpi_sim::Cell;
use rpi_sim::robot::{FolderFiles, NoFiles, RobotDescription, RobotFiles};
use samples::{ROBOTS, WRONG_CELLS, WRONG_ROBOTS};
use serde_json::Value;

/// A kind of descriptions: its schema, and its reader.
pub(crate) struct Kind {
    pub(crate) schema: Value,
    pub(crate) accepts: fn(&str, &dyn RobotFiles) -> Result<(), String>,
}

pub(crate) fn cells() -> Kind {
    Kind {
        schema: serde_json::from_str(&Cell::schema()).expect("valid JSON"),
        accepts: |text, files| match Cell::parse_with("cell.toml", text, files) {
            Ok(_) => Ok(()),
            Err(errors) => Err(errors.to_string()),
        },
    }
}

pub(crate) fn robots() -> Kind {
    Kind {
        schema: serde_json::from_str(&RobotDescription::schema()).expect("valid JSON"),
        accepts: |text, files| match RobotDescription::parse("robot.toml", text, files) {
            Ok(_) => Ok(()),
            Err(errors) => Err(errors.to_string()),
        },
    }
}

/// Returns a TOML value as JSON, as language servers for TOML do. A number without a JSON form becomes null.
pub(crate) fn json(value: &toml::Value) -> Value {
    match value {
        toml::Value::String(text) => Value::from(text.as_str()),
        toml::Value::Integer(value) => Value::from(*value),
        toml::Value::Float(value) => Value::from(*value),
        toml::Value::Boolean(value) => Value::from(*value),
        toml::Value::Datetime(value) => Value::from(value.to_string()),
        toml::Value::Array(list) => list.iter().map(json).collect(),
        toml::Value::Table(table) => {
            let entries = table.iter().map(|(key, value)| (key.clone(), json(value)));
            Value::Object(entries.collect())
        }
    }
}

impl Kind {
    pub(crate) fn check(&self, text: &str) -> checker::Checked {
        let value: toml::Value = toml::from_str(text).map_err(|error| error.to_string())?;
        check(&self.schema, &json(&value))
    }

    /// Checks that the schema accepts a text that the reader accepts. Returns whether the reader accepts it.
    fn agrees(&self, text: &str, files: &dyn RobotFiles, name: &str) -> bool {
        let is_accepted = (self.accepts)(text, files).is_ok();
        if is_accepted {
            let checked = self.check(text);
            assert!(checked.is_ok(), "{name}: {}", checked.unwrap_err());
        }
        is_accepted
    }
}

/// Checks all files below the folders with one of the ends. Returns the number of files that the reader accepts.
fn check_files(kind: &Kind, folders: &[&str], ends: &[&str]) -> usize {
    let files = folders
        .iter()
        .flat_map(|folder| rpi_testkit::files_below(folder, ends));
    let accepted = files.filter(|path: &std::path::PathBuf| {
        let text = std::fs::read_to_string(path).expect("a readable file");
        kind.agrees(
            &text,
            &FolderFiles::beside(path),
            &path.display().to_string(),
        )
    });
    accepted.count()
}

#[test]
fn every_cell_of_the_repository_is_accepted() {
    let folders = ["examples", "tests", "crates/rpic/template"];
    assert!(check_files(&cells(), &folders, &["cell.toml"]) > 15);
}

#[test]
fn every_robot_description_of_the_repository_is_accepted() {
    assert!(check_files(&robots(), &["robots"], &[".toml"]) > 14);
}

/// The descriptions in the chapters of the book.
#[test]
fn every_description_of_the_book_is_accepted() {
    let [mut cell_count, mut robot_count] = [0, 0];
    let (cells, robots) = (cells(), robots());
    for path in rpi_testkit::files_below("docs/src", &[".md"]) {
        let text = std::fs::read_to_string(&path).expect("a readable file");
        let name = path.display().to_string();
        for block in text.split("```").skip(1).step_by(2) {
            let (_, block) = block.split_once('\n').unwrap_or_default();
            let of_cell = block.contains("[devices.");
            cell_count += usize::from(of_cell && cells.agrees(block, &NoFiles, &name));
            let of_robot = block.contains("[dh]") || block.contains("[opw]");
            robot_count += usize::from(of_robot && robots.agrees(block, &NoFiles, &name));
        }
    }
    assert!(
        cell_count >= 3 && robot_count >= 1,
        "{cell_count}, {robot_count}"
    );
}

/// Checks samples that use every key of the schema with every type of its values.
fn check_coverage(kind: &Kind, samples: &[&str], files: &dyn RobotFiles) {
    let mut used = BTreeSet::new();
    for sample in samples {
        let accepted = (kind.accepts)(sample, files);
        assert_eq!(accepted, Ok(()), "{sample}");
        used.extend(kind.check(sample).unwrap_or_else(|why| panic!("{why}")));
    }
    let all = places(&kind.schema, "#");
    let unused: Vec<_> = all.difference(&used).collect();
    assert!(unused.is_empty(), "no sample uses {unused:#?}");
}

/// Folder with the built-in robot descriptions, as the folder of a cell.
pub(crate) fn robot_folder() -> FolderFiles {
    FolderFiles::beside(&Path::new(&rpi_testkit::workspace_root()).join("robots/cell.toml"))
}

#[test]
fn every_key_of_a_cell_is_accepted() {
    check_coverage(&cells(), &[&samples::cell()], &robot_folder());
}

#[test]
fn every_key_of_a_robot_description_is_accepted() {
    check_coverage(&robots(), ROBOTS, &robot_folder());
}

/// Adds the names of all keys of a schema.
fn add_keys(schema: &Value, all: &mut BTreeSet<String>) {
    match schema {
        Value::Object(entries) => {
            if let Some(Value::Object(keys)) = entries.get("properties") {
                all.extend(keys.keys().cloned());
            }
            entries.values().for_each(|value| add_keys(value, all));
        }
        Value::Array(list) => list.iter().for_each(|value| add_keys(value, all)),
        _ => (),
    }
}

/// The book names every key: as a word in a code span or in a block of code.
#[test]
fn the_book_names_every_key() {
    let pages = ["devices.md", "device-kinds.md"].map(|page| {
        let path = rpi_testkit::workspace_root().join("docs/src").join(page);
        std::fs::read_to_string(path).expect("a page of the book")
    });
    let code: Vec<&str> = pages
        .iter()
        .flat_map(|page| page.split('`').skip(1).step_by(2))
        .collect();
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    let words: BTreeSet<&str> = code
        .iter()
        .flat_map(|code| code.split(|c: char| !is_word(c)))
        .collect();
    let mut keys = BTreeSet::new();
    add_keys(&cells().schema, &mut keys);
    add_keys(&robots().schema, &mut keys);
    let missing: Vec<&String> = keys
        .iter()
        .filter(|key| !words.contains(key.as_str()))
        .collect();
    assert!(missing.is_empty(), "not in the book: {missing:?}");
}

fn check_wrong(kind: &Kind, texts: &[&str]) {
    for text in texts {
        let accepted = (kind.accepts)(text, &robot_folder());
        assert!(accepted.is_err(), "the reader accepts {text}");
        assert!(kind.check(text).is_err(), "the schema accepts {text}");
    }
}

#[test]
fn wrong_descriptions_are_rejected_by_reader_and_schema() {
    check_wrong(&cells(), WRONG_CELLS);
    check_wrong(&robots(), WRONG_ROBOTS);
}
