//! The result table of a benchmark run.

use std::process::Command;

/// Table of a benchmark run: measured values with their limits.
pub struct Table {
    filters: Vec<String>,
    rows: Vec<Row>,
}

struct Row {
    name: String,
    value: f64,
    limit: f64,
    unit: &'static str,
    note: String,
}

impl Table {
    /// Creates an empty table. Only rows whose names contain one of the texts `only` are measured; all rows if there
    /// are no texts.
    #[must_use]
    pub fn new(only: Vec<String>) -> Self {
        let rows = Vec::new();
        Table {
            filters: only,
            rows,
        }
    }

    /// Returns true if the row with this name is to be measured.
    #[must_use]
    pub fn is_selected(&self, name: &str) -> bool {
        self.filters.is_empty() || self.filters.iter().any(|o| name.contains(o.as_str()))
    }

    /// Adds a row to the table and prints it to standard error. `bar` is the limit of the measured value, in the same
    /// unit; `note` explains the value.
    pub fn add_row(&mut self, name: &str, value: f64, bar: f64, unit: &'static str, note: &str) {
        eprintln!("{name}: {value:.2} {unit} ({note})");
        self.rows.push(Row {
            name: name.to_owned(),
            value,
            limit: bar,
            unit,
            note: note.to_owned(),
        });
    }

    /// Prints a line that describes the machine, then all rows.
    pub fn print(&self) {
        println!("{}", machine());
        println!("Times are processor time of the measuring thread, the best of several tries.");
        println!(
            "{:44} {:>10} {:>10}  {:4}  note",
            "what", "measured", "bar", ""
        );
        for r in &self.rows {
            let met = if r.value <= r.limit { "ok" } else { "OVER" };
            let (value, bar) = (
                format!("{:.2} {}", r.value, r.unit),
                format!("{} {}", r.limit, r.unit),
            );
            println!("{:44} {value:>10} {bar:>10}  {met:4}  {}", r.name, r.note);
        }
    }
}

/// Returns a description of the machine: processor, number of cores, operating system and C compiler.
fn machine() -> String {
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = info.lines().find(|l| l.starts_with("model name"));
    let model = model.and_then(|l| l.split_once(": ")).map(|l| l.1);
    let cores = std::thread::available_parallelism().map_or(0, usize::from);
    let compiler = Command::new("cc").arg("--version").output();
    let compiler = compiler.map_or(String::new(), |o| {
        String::from_utf8_lossy(&o.stdout).into_owned()
    });
    format!(
        "{}, {cores} cores, {} {}; C compiler: {}",
        model.unwrap_or("unknown processor"),
        std::env::consts::OS,
        std::env::consts::ARCH,
        compiler.lines().next().unwrap_or("none"),
    )
}
