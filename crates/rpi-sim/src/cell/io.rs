//! Terminals: `kind = "digital-io"`, `"analogue-io"`, and `"io"` with both.

use super::quantity::Dimension::{Number, Time};
use super::reader::TableReader;
use super::value::{Node, integer};

/// Description of a block of input and output terminals.
#[derive(Clone, Debug, PartialEq)]
pub struct IoSpec {
    /// Digital (Boolean) inputs and outputs.
    pub digital: TerminalSpec<bool>,
    /// Analogue inputs and outputs, in the unit of the wired signal.
    pub analogue: TerminalSpec<f64>,
}

/// Inputs and outputs of one type in a terminal block.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TerminalSpec<T> {
    /// Initial values of the inputs, by index.
    pub inputs: Vec<T>,
    /// Initial values of the outputs, by index.
    pub outputs: Vec<T>,
    /// Safe value of each output, by index; `None` for an output that keeps its value.
    pub safe: Vec<Option<T>>,
    /// Scripted changes of the inputs, in order of time.
    pub script: Vec<InputChange<T>>,
    /// Period of the script, in s; infinity if it does not repeat.
    pub repeat: f64,
}

/// Change of a simulated input at a time of the script.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InputChange<T> {
    /// Time of the change in s, since the start of the cell or of the repetition of the script.
    pub at: f64,
    /// Index of the input, from 0.
    pub input: usize,
    /// New value of the input.
    pub value: T,
}

/// Type of the values of inputs and outputs: Boolean or real.
pub(super) trait InputValue: Sized + Copy + Default {
    const EXPECTED: &'static str;
    fn list(reader: &mut TableReader<'_>, key: &'static str) -> Option<Vec<Self>>;
    fn one(reader: &mut TableReader<'_>, key: &'static str) -> Option<Self>;
}

impl InputValue for bool {
    const EXPECTED: &'static str = "true or false";

    fn list(reader: &mut TableReader<'_>, key: &'static str) -> Option<Vec<Self>> {
        reader.booleans(key)
    }

    fn one(reader: &mut TableReader<'_>, key: &'static str) -> Option<Self> {
        reader.boolean(key)
    }
}

impl InputValue for f64 {
    const EXPECTED: &'static str = "a number";

    fn list(reader: &mut TableReader<'_>, key: &'static str) -> Option<Vec<Self>> {
        reader.reals_of_any_length(key, Number)
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
            safe: Vec::new(),
            script: Vec::new(),
            repeat: f64::INFINITY,
        }
    }
}

fn read_signal<T: InputValue>(reader: &mut TableReader<'_>) -> TerminalSpec<T> {
    let inputs: Vec<T> = read_ports(reader, "inputs");
    let outputs: Vec<T> = read_ports(reader, "outputs");
    let safe = read_safe_values(reader, outputs.len());
    let changes = reader.tables("script").into_iter();
    let mut script: Vec<InputChange<T>> = changes
        .filter_map(|change| read_change(change, inputs.len()))
        .collect();
    script.sort_by(|one, other| one.at.total_cmp(&other.at));
    let repeat = reader.magnitude("repeat", Time).unwrap_or(f64::INFINITY);
    if script.last().is_some_and(|last| last.at >= repeat) {
        let last = script.last().map_or(0.0, |last| last.at);
        let message = format!("`repeat` is {repeat} s, expected more than {last} s");
        let help = "the script restarts after its last change".to_owned();
        reader.error_at("repeat", message, Some(help));
    }
    TerminalSpec {
        inputs,
        outputs,
        safe,
        script,
        repeat,
    }
}

/// Reads the key `safe`, a list of tables with an output and its value. Returns the safe value of each of `outputs` outputs.
fn read_safe_values<T: InputValue>(reader: &mut TableReader<'_>, outputs: usize) -> Vec<Option<T>> {
    let mut safe = vec![None; outputs];
    for mut table in reader.tables("safe") {
        let output = table.index("output", outputs as u64);
        let value = T::one(&mut table, "value");
        table.require("output", "expected the index of an output, from 0");
        table.require("value", &format!("expected {}", T::EXPECTED));
        let slot = output.and_then(|output| safe.get_mut(usize::try_from(output).ok()?));
        if slot.as_ref().is_some_and(|slot| slot.is_some()) {
            let help = "give each output one safe value".to_owned();
            table.error_at(
                "output",
                "this output has a safe value already".to_owned(),
                Some(help),
            );
        }
        slot.into_iter().for_each(|slot| *slot = value);
        table.finish();
    }
    safe
}

/// Reads the inputs or outputs at `key`: a number of terminals, all initially 0, or a list of their initial values.
fn read_ports<T: InputValue>(reader: &mut TableReader<'_>, key: &'static str) -> Vec<T> {
    let is_count = |node: Node<'_>| integer(node).is_some();
    let zeros = |reader: &mut TableReader<'_>| {
        let count = reader.integer(key, 0..=MAX_TERMINALS, "").unwrap_or(0);
        vec![T::default(); usize::try_from(count).unwrap_or(0)]
    };
    let listed = |reader: &mut TableReader<'_>| T::list(reader, key).unwrap_or_default();
    reader.either(key, is_count, zeros, listed)
}

fn read_change<T: InputValue>(
    mut reader: TableReader<'_>,
    inputs: usize,
) -> Option<InputChange<T>> {
    let at = reader.magnitude("at", Time);
    let input = reader.index("input", inputs as u64);
    let value = T::one(&mut reader, "value");
    reader.require("at", "expected a time in s, or a string such as \"5 ms\"");
    reader.require("input", "expected the index of an input, from 0");
    reader.require("value", &format!("expected {}", T::EXPECTED));
    reader.finish();
    Some(InputChange {
        at: at?,
        input: usize::try_from(input?).ok()?,
        value: value?,
    })
}
