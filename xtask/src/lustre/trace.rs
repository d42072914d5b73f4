//! Recorded inputs and outputs in two formats: a table of strings (Lustre V6), or a list of values per flow (Kind 2).

use serde_json::Value;

/// Flow of a trace: its name, and its value in each cycle as text.
pub(crate) struct Flow {
    pub(crate) name: String,
    pub(crate) values: Vec<String>,
}

/// Recorded inputs, outputs and local flows of a node, cycle by cycle.
pub(crate) struct Trace {
    pub(crate) node: String,
    pub(crate) inputs: Vec<Flow>,
    pub(crate) outputs: Vec<Flow>,
    pub(crate) locals: Vec<Flow>,
    pub(crate) cycles: usize,
}

impl Trace {
    /// Reads the trace of a program from a trace file, in the format of Kind 2 or of Lustre V6. `entry` is the JSON
    /// value for the program; `None` if it has another format.
    pub(crate) fn read(entry: &Value) -> Option<Trace> {
        match entry.get("node") {
            Some(node) => tables(entry, node.as_str()?),
            None => lists(entry, entry.get("main")?.as_str()?),
        }
    }

    /// Returns true if an output is undefined in some cycle, because the program reads a delay before its first value.
    pub(crate) fn has_undefined(&self) -> bool {
        let values = self.outputs.iter().flat_map(|flow| &flow.values);
        values.into_iter().any(|value| value == UNDEFINED)
    }

    /// Returns the inputs as a table of comma-separated values with a header, as `rpi run --inputs` reads it.
    pub(crate) fn table(&self) -> String {
        let names: Vec<&str> = self.inputs.iter().map(|flow| flow.name.as_str()).collect();
        let mut text = names.join(",");
        for cycle in 0..self.cycles {
            let row: Vec<&str> = self.inputs.iter().filter_map(|f| f.at(cycle)).collect();
            text.push('\n');
            text.push_str(&row.join(","));
        }
        text.push('\n');
        text
    }
}

/// Text of an undefined value in a trace.
pub(crate) const UNDEFINED: &str = "nil";

impl Flow {
    pub(crate) fn at(&self, cycle: usize) -> Option<&str> {
        self.values.get(cycle).map(String::as_str)
    }
}

/// Reads a trace in the format of Lustre V6: `inputs` and `outputs` hold the name and type of each column, `in` and
/// `out` the rows of values as strings. `node` is the name of the node; `None` for another format.
fn tables(entry: &Value, node: &str) -> Option<Trace> {
    let rows = entry.get("in")?.as_array()?.len();
    Some(Trace {
        node: node.to_owned(),
        inputs: columns(entry.get("inputs")?, entry.get("in")?)?,
        outputs: columns(entry.get("outputs")?, entry.get("out")?)?,
        locals: Vec::new(),
        cycles: rows,
    })
}

fn columns(names: &Value, rows: &Value) -> Option<Vec<Flow>> {
    let column = |(k, name): (usize, &Value)| {
        let cell = |row: &Value| Some(text(row.get(k)?));
        Some(Flow {
            name: name.get(0)?.as_str()?.to_owned(),
            values: rows.as_array()?.iter().map(cell).collect::<Option<_>>()?,
        })
    };
    names.as_array()?.iter().enumerate().map(column).collect()
}

/// Reads a trace in the format of Kind 2: `inputs` is a list with an object for each cycle, `outputs` and `locals` hold
/// a list of values for each flow. `node` is the name of the node; `None` for another format.
fn lists(entry: &Value, node: &str) -> Option<Trace> {
    let rows = entry.get("inputs")?.as_array()?;
    let names = rows.first().and_then(Value::as_object);
    let names = names.map(|row| row.keys().cloned().collect::<Vec<_>>());
    let input = |name: String| {
        let values = rows.iter().filter_map(|row| row.get(&name)).map(text);
        let values = values.collect();
        Flow { name, values }
    };
    Some(Trace {
        node: node.to_owned(),
        inputs: names.unwrap_or_default().into_iter().map(input).collect(),
        outputs: listed(entry.get("outputs")?)?,
        locals: entry.get("locals").and_then(listed).unwrap_or_default(),
        cycles: rows.len(),
    })
}

fn listed(flows: &Value) -> Option<Vec<Flow>> {
    let flow = |(name, values): (&String, &Value)| {
        Some(Flow {
            name: name.clone(),
            values: values.as_array()?.iter().map(text).collect(),
        })
    };
    flows.as_object()?.iter().map(flow).collect()
}

/// Returns a JSON value of a trace as text in the format of the tables of `rpi run`. An object `{"num": 1, "den": 2}`
/// is a real (1/2).
fn text(value: &Value) -> String {
    let part = |name: &str| value.get(name).and_then(number);
    match (value, part("num"), part("den")) {
        (_, Some(num), Some(den)) => format!("{:?}", num / den),
        (Value::String(text), ..) => normalised(text),
        (other, ..) => other.to_string(),
    }
}

fn number(value: &Value) -> Option<f64> {
    match value {
        Value::String(text) => text.parse().ok(),
        other => other.as_f64(),
    }
}

/// Converts a value of a trace to the format of the tables of `rpi run`: `t` and `f` become `true` and `false`, a
/// fraction such as `1/2` becomes a real.
fn normalised(text: &str) -> String {
    let fraction = text.split_once('/').and_then(|(num, den)| {
        let (num, den): (f64, f64) = (num.parse().ok()?, den.parse().ok()?);
        Some(format!("{:?}", num / den))
    });
    match text {
        "t" => "true".to_owned(),
        "f" => "false".to_owned(),
        _ => fraction.unwrap_or_else(|| text.to_owned()),
    }
}
