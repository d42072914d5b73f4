//! Terminals with digital and analogue inputs and outputs.

use crate::bank::CellDevice;
use crate::cell::{InputChange, IoSpec, TerminalSpec};
use crate::device::{Device, PortIndex, PortSpec, PortValue, find_port, is_in_row};
use crate::error_code::ErrorCode;
use core::ops::Range;
use rpi_device::{PortKind, PortQuery, Rejection, ResolveError};
use rpi_image::Scalar;

/// Terminal block of a simulated cell: a bank of digital inputs and outputs, then a bank of analogue ones.
#[derive(Clone, Debug)]
pub(crate) struct IoDevice {
    banks: [TerminalBank; 2],
    /// True if an output has changed to its safe value since the last step.
    has_made_safe: bool,
}

/// Inputs and outputs of one type in a terminal block, one memory slot each.
#[derive(Clone, Debug)]
struct TerminalBank {
    initial_inputs: Vec<u64>,
    inputs: Vec<u64>,
    outputs: Vec<u64>,
    /// Safe value of each output; `None` for an output that keeps its value.
    safe: Vec<Option<u64>>,
    script: Vec<InputChange<u64>>,
    repeat: f64,
}

/// Row of the port table of a terminal block: name, type and terminals of a port.
struct PortRow {
    spec: PortSpec,
    bank: usize,
    output: bool,
}

/// Creates a row for a port that is a single terminal, selected by its index. `bank` is 0 for digital and 1 for
/// analogue terminals.
const fn terminal_row(
    name: &'static str,
    kind: PortKind,
    scalar: Scalar,
    bank: usize,
    output: bool,
) -> PortRow {
    let carries = PortValue::One(scalar);
    PortRow {
        spec: PortSpec {
            name,
            kind,
            value: carries,
            indexed: true,
        },
        bank,
        output,
    }
}

/// Creates a row for a port that consists of all inputs or all outputs. `bank` is 0 for digital and 1 for analogue
/// terminals.
const fn bank_row(
    name: &'static str,
    kind: PortKind,
    scalar: Scalar,
    bank: usize,
    output: bool,
) -> PortRow {
    let carries = PortValue::PerTerminal(scalar);
    PortRow {
        spec: PortSpec {
            name,
            kind,
            value: carries,
            indexed: false,
        },
        bank,
        output,
    }
}

const PORTS: &[PortRow] = &[
    terminal_row("in.bool", PortKind::Sensor, Scalar::Bool, 0, false),
    terminal_row("out.bool", PortKind::Sensor, Scalar::Bool, 0, true),
    terminal_row("out.bool", PortKind::Actuator, Scalar::Bool, 0, true),
    terminal_row("in.real", PortKind::Sensor, Scalar::Real, 1, false),
    terminal_row("out.real", PortKind::Sensor, Scalar::Real, 1, true),
    terminal_row("out.real", PortKind::Actuator, Scalar::Real, 1, true),
    // Ports of the device types of `.rpi`.
    bank_row("get", PortKind::Sensor, Scalar::Bool, 0, false),
    bank_row("get", PortKind::Sensor, Scalar::Real, 1, false),
    bank_row("set", PortKind::Actuator, Scalar::Bool, 0, true),
    bank_row("set", PortKind::Actuator, Scalar::Real, 1, true),
    // Programs access arrays element by element.
    terminal_row("get", PortKind::Sensor, Scalar::Bool, 0, false),
    terminal_row("get", PortKind::Sensor, Scalar::Real, 1, false),
    terminal_row("set", PortKind::Actuator, Scalar::Bool, 0, true),
    terminal_row("set", PortKind::Actuator, Scalar::Real, 1, true),
];

/// Returns the descriptions of the ports of a terminal block, for the manual.
pub(crate) fn ports() -> impl Iterator<Item = crate::device::PortInfo> {
    PORTS.iter().map(|line| line.spec.info())
}

impl IoDevice {
    pub(crate) fn new(spec: &IoSpec) -> Self {
        let mut io = Self {
            banks: [
                TerminalBank::new(&spec.digital, u64::from),
                TerminalBank::new(&spec.analogue, f64::to_bits),
            ],
            has_made_safe: false,
        };
        io.banks.iter_mut().for_each(|bank| bank.step(0.0));
        io
    }
}

impl TerminalBank {
    fn new<T: Copy>(signal: &TerminalSpec<T>, bits: fn(T) -> u64) -> Self {
        let cells = |values: &[T]| {
            values
                .iter()
                .map(|value| bits(*value))
                .collect::<Vec<u64>>()
        };
        let change = |change: &InputChange<T>| InputChange {
            at: change.at,
            input: change.input,
            value: bits(change.value),
        };
        Self {
            initial_inputs: cells(&signal.inputs),
            inputs: cells(&signal.inputs),
            outputs: cells(&signal.outputs),
            safe: signal.safe.iter().map(|value| value.map(bits)).collect(),
            script: signal.script.iter().map(change).collect(),
            repeat: signal.repeat,
        }
    }

    /// Sets the inputs to their scripted values at the simulated time `time` (s). The result depends on the time only,
    /// not on earlier calls.
    fn step(&mut self, time: f64) {
        let since = if self.repeat.is_finite() && self.repeat > 0.0 {
            time % self.repeat
        } else {
            time
        };
        if self.script.is_empty() {
            return;
        }
        self.inputs.copy_from_slice(&self.initial_inputs);
        for change in self.script.iter().take_while(|change| change.at <= since) {
            self.inputs[change.input] = change.value;
        }
    }
}

impl IoDevice {
    /// Returns the number of terminals to which the row with index `line` of the port table refers.
    fn size(&self, line: usize) -> usize {
        let line = &PORTS[line];
        self.banks[line.bank].values(line.output).len()
    }

    /// Returns the row of the port table for a port, and the range of its terminals: all of its bank, or one if the
    /// port is indexed. `None` if there are no such terminals.
    fn terminals(&self, slot: PortIndex) -> Option<(&'static PortRow, Range<usize>)> {
        let line = PORTS.get(usize::from(slot.row))?;
        let count = self.banks[line.bank].values(line.output).len();
        let first = usize::from(slot.index);
        let end = if line.spec.indexed { first + 1 } else { count };
        (end <= count).then_some((line, first..end))
    }
}

impl CellDevice for IoDevice {
    fn make_all_safe(&mut self) -> bool {
        let changed = self
            .banks
            .iter_mut()
            .map(|bank| bank.make_safe(0..bank.outputs.len()));
        self.has_made_safe |= changed.fold(false, |any, changed| any | changed);
        self.has_made_safe
    }
}

impl Device for IoDevice {
    fn resolve(&self, name: &PortQuery<'_>) -> Result<PortIndex, ResolveError> {
        find_port(PORTS.iter().map(|line| &line.spec), name, |line| {
            self.size(line)
        })
    }

    fn has_port(&self, slot: PortIndex) -> bool {
        let line = PORTS.get(usize::from(slot.row));
        is_in_row(line.map(|line| &line.spec), slot, |line| self.size(line))
    }

    fn resources(&self, slot: PortIndex) -> Range<u32> {
        let terminals = self.terminals(slot);
        let Some((line, own)) = terminals.filter(|(line, _)| line.spec.kind == PortKind::Actuator)
        else {
            return 0..0;
        };
        let before: usize = self.banks[..line.bank]
            .iter()
            .map(|bank| bank.outputs.len())
            .sum();
        (before + own.start) as u32..(before + own.end) as u32
    }

    fn read(&self, slot: PortIndex, value: &mut [u64]) -> bool {
        let Some((line, own)) = self.terminals(slot) else {
            return false;
        };
        let ports = &self.banks[line.bank].values(line.output)[own];
        value
            .iter_mut()
            .zip(ports)
            .for_each(|(cell, bits)| *cell = *bits);
        true
    }

    fn check(&mut self, slot: PortIndex, value: &[u64]) -> Rejection {
        let real = self.terminals(slot).is_some_and(|(line, _)| line.bank == 1);
        let finite = value.iter().all(|bits| f64::from_bits(*bits).is_finite());
        if real && !finite {
            Rejection::ILLEGAL_VALUE
        } else {
            Rejection::NONE
        }
    }

    fn port_code(&self, _slot: PortIndex) -> ErrorCode {
        ErrorCode::OK
    }

    fn write(&mut self, slot: PortIndex, value: &[u64]) {
        let accepted = self.check(slot, value) == Rejection::NONE;
        let terminals = self
            .terminals(slot)
            .filter(|(line, _)| line.spec.kind == PortKind::Actuator);
        if let Some((line, own)) = terminals.filter(|_| accepted) {
            let outputs = &mut self.banks[line.bank].outputs[own];
            outputs
                .iter_mut()
                .zip(value)
                .for_each(|(output, bits)| *output = *bits);
        }
    }

    fn make_safe(&mut self, resource: u32) {
        let number = resource as usize;
        let [digital, analogue] = &mut self.banks;
        let (bank, output) = match number.checked_sub(digital.outputs.len()) {
            Some(output) => (analogue, output),
            None => (digital, number),
        };
        self.has_made_safe |= bank.make_safe(output..output + 1);
    }

    fn step(&mut self, time: f64) {
        self.has_made_safe = false;
        self.banks.iter_mut().for_each(|bank| bank.step(time));
    }
}

impl TerminalBank {
    /// Sets the outputs of this range that have a safe value to it. Returns true if one of them changes.
    fn make_safe(&mut self, range: Range<usize>) -> bool {
        let outputs = self.outputs.iter_mut().zip(&self.safe);
        let outputs = outputs.skip(range.start).take(range.len());
        let mut changed = false;
        for (output, safe) in outputs {
            let value = safe.unwrap_or(*output);
            changed |= value != *output;
            *output = value;
        }
        changed
    }

    fn values(&self, output: bool) -> &[u64] {
        if output { &self.outputs } else { &self.inputs }
    }
}
