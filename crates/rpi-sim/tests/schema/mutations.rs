//! Changed descriptions: a schema never rejects what the reader accepts.

use rpi_sim::robot::RobotFiles;
use toml::{Table, Value};

use crate::samples::{self, ROBOTS};
use crate::{Kind, cells, checker, json, robot_folder, robots};

/// Values of all types, with and without units, that replace a value.
fn replacements() -> Vec<Value> {
    let text = "[true, false, 0, 1, -1, 7, 1001, 0.5, -0.5, 1e300, 'text', '', '30 deg', '3 m', '5 ms', '2', '1 N m', \
        '1e-3', 'arm', 'io', 'noise', 'ur5e', 'position', 'x.urdf', [], [1], [true], ['position'], [0, 0, 0], \
        [1, 2, 3, 4, 5, 6, 7], [1, 2, 3, 4, 5, 6, 7, 8], [{}], {}, { x = 1 }, { position = [0, 0, 0] }, 1979-05-27]";
    let table: Table = format!("all = {text}").parse().expect("valid TOML");
    table["all"].as_array().expect("a list").clone()
}

/// Step into a value: a key of a table, or an index of a list.
#[derive(Clone)]
enum Step {
    Key(String),
    Index(usize),
}

/// Returns the paths of all values within a value.
fn paths(value: &Value) -> Vec<Vec<Step>> {
    let steps: Vec<(Step, &Value)> = match value {
        Value::Table(table) => table
            .iter()
            .map(|(key, value)| (Step::Key(key.clone()), value))
            .collect(),
        Value::Array(list) => list
            .iter()
            .enumerate()
            .map(|(index, value)| (Step::Index(index), value))
            .collect(),
        _ => Vec::new(),
    };
    let mut all = Vec::new();
    for (step, value) in steps {
        all.push(vec![step.clone()]);
        let below = paths(value).into_iter();
        all.extend(below.map(|path| [vec![step.clone()], path].concat()));
    }
    all
}

/// Returns the value that contains the value at a path.
fn parent<'a>(root: &'a mut Value, path: &[Step]) -> Option<&'a mut Value> {
    let above = &path[..path.len() - 1];
    above.iter().try_fold(root, |value, step| match step {
        Step::Key(key) => value.get_mut(key),
        Step::Index(index) => value.get_mut(*index),
    })
}

/// Change of the value at a path.
enum Change<'a> {
    Remove,
    Rename,
    Replace(&'a Value),
}

/// Returns a description with one change; `None` if the change does not apply.
fn changed(root: &Value, path: &[Step], change: &Change<'_>) -> Option<Value> {
    let mut root = root.clone();
    let parent = parent(&mut root, path)?;
    match (parent, path.last()?, change) {
        (Value::Table(table), Step::Key(key), Change::Remove) => drop(table.remove(key)?),
        (Value::Table(table), Step::Key(key), Change::Rename) => {
            let value = table.remove(key)?;
            table.insert(format!("{key}s"), value);
        }
        (Value::Table(table), Step::Key(key), Change::Replace(value)) => {
            *table.get_mut(key)? = (*value).clone();
        }
        (Value::Array(list), Step::Index(index), Change::Remove) if *index < list.len() => {
            list.remove(*index);
        }
        (Value::Array(list), Step::Index(index), Change::Replace(value)) => {
            *list.get_mut(*index)? = (*value).clone();
        }
        _ => return None,
    }
    Some(root)
}

/// Number of descriptions that the schema and the reader reject.
#[derive(Debug, Default)]
struct Rejections {
    schema: usize,
    reader: usize,
}

impl Rejections {
    /// Checks one description: if the schema rejects it, the reader must reject it, too. The reader also reads other
    /// descriptions if `reads_all` is true.
    fn check(&mut self, kind: &Kind, value: &Value, files: &dyn RobotFiles, reads_all: bool) {
        let verdict = checker::check(&kind.schema, &json(value));
        if verdict.is_ok() && !reads_all {
            return;
        }
        let text = toml::to_string(value).expect("a table");
        let accepted = (kind.accepts)(&text, files);
        self.reader += usize::from(accepted.is_err());
        if let Err(reason) = verdict {
            self.schema += 1;
            assert!(accepted.is_err(), "the reader accepts\n{text}\n{reason}");
        }
    }
}

fn sample(text: &str) -> Value {
    toml::from_str(text).expect("valid TOML")
}

/// Checks every single change of a description.
fn check_single(kind: &Kind, text: &str, reads_all: bool) -> Rejections {
    let (root, files, values) = (sample(text), robot_folder(), replacements());
    let mut all = Rejections::default();
    for path in paths(&root) {
        let replaced = values.iter().map(Change::Replace);
        for change in replaced.chain([Change::Remove, Change::Rename]) {
            if let Some(value) = changed(&root, &path, &change) {
                all.check(kind, &value, &files, reads_all);
            }
        }
    }
    all
}

/// Returns cells with one device each: a change of a large cell takes long to check.
fn small_cells() -> Vec<String> {
    let root: Table = samples::cell().parse().expect("valid TOML");
    let devices = root["devices"].as_table().expect("a table");
    let single = devices.iter().map(|(name, device)| {
        let devices = Table::from_iter([(name.clone(), device.clone())]);
        let cell = Table::from_iter([("devices".to_owned(), Value::Table(devices))]);
        toml::to_string(&cell).expect("a table")
    });
    let mut top = root.clone();
    top.insert("devices".to_owned(), Value::Table(Table::new()));
    single
        .chain([toml::to_string(&top).expect("a table")])
        .collect()
}

#[test]
fn no_single_change_of_a_cell_is_rejected_by_the_schema_alone() {
    let kind = cells();
    let mut all = Rejections::default();
    for cell in small_cells() {
        // The keys of all arms are the same, and each arm takes as long again.
        if ["udp-arm", "ur-arm", "scara", "positioner"]
            .iter()
            .any(|word| cell.contains(word))
        {
            continue;
        }
        let own = check_single(&kind, &cell, true);
        all.schema += own.schema;
        all.reader += own.reader;
    }
    println!("{all:?}");
    // Most errors are errors of one value, which a schema can find.
    assert!(all.schema * 10 > all.reader * 9, "{all:?}");
}

/// The reader keeps each model that it accepts, so it reads only what the schema rejects.
#[test]
fn no_single_change_of_a_robot_description_is_rejected_by_the_schema_alone() {
    for robot in ROBOTS {
        let all = check_single(&robots(), robot, false);
        assert!(all.schema > 100, "{all:?}");
    }
}

/// Random number generator (xorshift), the same on every run.
struct Random(u64);

impl Random {
    fn below(&mut self, count: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % count as u64) as usize
    }
}

/// Several changes at once, such as another kind with a key of the kind before.
#[test]
fn no_random_changes_are_rejected_by_the_schema_alone() {
    let (kind, files, values) = (cells(), robot_folder(), replacements());
    let cells: Vec<Value> = small_cells().iter().map(|cell| sample(cell)).collect();
    let mut random = Random(0x9E37_79B9_7F4A_7C15);
    let mut all = Rejections::default();
    for _ in 0..5000 {
        let mut value = cells[random.below(cells.len())].clone();
        for _ in 0..1 + random.below(3) {
            let paths = paths(&value);
            if paths.is_empty() {
                continue;
            }
            let path = &paths[random.below(paths.len())];
            let change = match random.below(4) {
                0 => Change::Remove,
                1 => Change::Rename,
                _ => Change::Replace(&values[random.below(values.len())]),
            };
            value = changed(&value, path, &change).unwrap_or(value);
        }
        all.check(&kind, &value, &files, true);
    }
    println!("{all:?}");
    assert!(all.schema > 1000, "{all:?}");
}
