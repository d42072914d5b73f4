//! Terminals: `kind = "digital-io"`, `"analogue-io"`, and `"io"` with both.

use super::quantity::Dimension::{Number, Time};
use super::reader::{TableReader, integer};

/// Description of a block of input and output terminals.
#[derive(Clone, Debug, PartialEq)]
pub struct IoSpec {
    /// Digital inputs and outputs.
    pub digital: TerminalSpec<bool>,
    /// Analogue inputs and outputs, in the unit of the wired signal.
    pub analogue: TerminalSpec<f64>,
}

/// Inputs and outputs of one type.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TerminalSpec<T> {
    /// Initial values of the inputs.
    pub inputs: Vec<T>,
    /// Initial values of the outputs.
    pub outputs: Vec<T>,
    /// Changes of the inputs, in order of time.
    pub script: Vec<InputChange<T>>,
    /// Period of the script, in s; infinity if it does not repeat.
    pub repeat: f64,
}

/// Change of a simulated input at a time of the script.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InputChange<T> {
    /// Time of the change in s, since the start of the cell or of the repeated script.
    pub at: f64,
    /// Index of the input, from 0.
    pub input: usize,
    /// New value of the input.
    pub value: T,
}

/// Type of the values of inputs: Boolean or real.
pub(super) trait InputValue: Sized + Copy + Default {
    const EXPECTED: &'static str;
    fn list(reader: &mut TableReader<'_>, key: &'static str, count: usize) -> Option<Vec<Self>>;
    fn one(reader: &mut TableReader<'_>, key: &'static str) -> Option<Self>;
}

impl InputValue for bool {
    const EXPECTED: &'static str = "true or false";

    fn list(reader: &mut TableReader<'_>, key: &'static str, _count: usize) -> Option<Vec<Self>> {
        let nodes = reader.list(key)?;
        let values = nodes.iter().map(|node| node.get_ref().as_bool());
        let values: Option<Vec<bool>> = values.collect();
        if values.is_none() {
            reader.error_at(
                key,
                format!("expected a number of ports or a list of Booleans for `{key}`"),
                None,
            );
        }
        values
    }

    fn one(reader: &mut TableReader<'_>, key: &'static str) -> Option<Self> {
        reader.boolean(key)
    }
}

impl InputValue for f64 {
    const EXPECTED: &'static str = "a number";

    fn list(reader: &mut TableReader<'_>, key: &'static str, count: usize) -> Option<Vec<Self>> {
        reader.reals(key, Number, count)
    }

    fn one(reader: &mut TableReader<'_>, key: &'static str) -> Option<Self> {
        reader.real(key, Number)
    }
}

/// Maximum number of inputs or outputs of a terminal block.
const MAX_TERMINALS: u64 = 4096;

pub(super) fn read_digital(reader: &mut TableReader<'_>) -> Option<IoSpec> {
    Some(IoSpec {
        digital: read_signal(reader),
        analogue: TerminalSpec::none(),
    })
}

pub(super) fn read_analogue(reader: &mut TableReader<'_>) -> Option<IoSpec> {
    Some(IoSpec {
        digital: TerminalSpec::none(),
        analogue: read_signal(reader),
    })
}

pub(super) fn read_both(reader: &mut TableReader<'_>) -> Option<IoSpec> {
    Some(IoSpec {
        digital: read_inner(reader, "digital"),
        analogue: read_inner(reader, "analogue"),
    })
}

fn read_inner<T: InputValue>(reader: &mut TableReader<'_>, key: &'static str) -> TerminalSpec<T> {
    let Some(mut inner) = reader.table(key) else {
        return TerminalSpec::none();
    };
    let signal = read_signal(&mut inner);
    inner.finish();
    signal
}

impl<T> TerminalSpec<T> {
    fn none() -> Self {
        Self {
            inputs: Vec::new(),
            outputs: Vec::new(),
            script: Vec::new(),
            repeat: f64::INFINITY,
        }
    }
}

fn read_signal<T: InputValue>(reader: &mut TableReader<'_>) -> TerminalSpec<T> {
    let inputs: Vec<T> = read_ports(reader, "inputs");
    let outputs = read_ports(reader, "outputs");
    let changes = reader.tables("script").into_iter();
    let mut script: Vec<InputChange<T>> = changes
        .filter_map(|change| read_change(change, inputs.len()))
        .collect();
    script.sort_by(|one, other| one.at.total_cmp(&other.at));
    let repeat = reader.magnitude("repeat", Time).unwrap_or(f64::INFINITY);
    if script.last().is_some_and(|last| last.at >= repeat) {
        let message = "`repeat` must be later than the last change of the script".to_owned();
        reader.error_at("repeat", message, None);
    }
    TerminalSpec {
        inputs,
        outputs,
        script,
        repeat,
    }
}

/// Reads a number of ports, all initially 0, or a list of their initial values.
fn read_ports<T: InputValue>(reader: &mut TableReader<'_>, key: &'static str) -> Vec<T> {
    let count = match reader.peek(key) {
        Some(node) if integer(node).is_some() => {
            let count = reader.index(key, MAX_TERMINALS + 1).unwrap_or(0);
            return vec![T::default(); usize::try_from(count).unwrap_or(0)];
        }
        Some(node) => node.get_ref().as_array().map_or(0, |list| list.len()),
        None => 0,
    };
    T::list(reader, key, count).unwrap_or_default()
}

fn read_change<T: InputValue>(
    mut reader: TableReader<'_>,
    inputs: usize,
) -> Option<InputChange<T>> {
    let at = reader.magnitude("at", Time);
    let input = reader.index("input", inputs as u64);
    let value = T::one(&mut reader, "value");
    for key in ["at", "input", "value"] {
        if !reader.has(key) {
            let help = (key == "value").then(|| format!("expected {}", T::EXPECTED));
            reader.error_at(key, format!("`{key}` is missing"), help);
        }
    }
    reader.finish();
    Some(InputChange {
        at: at?,
        input: usize::try_from(input?).ok()?,
        value: value?,
    })
}
