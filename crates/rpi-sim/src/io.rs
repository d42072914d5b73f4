//! Terminals with digital and analogue inputs and outputs.

use crate::bank::CellDevice;
use crate::cell::{InputChange, IoSpec, TerminalSpec};
use crate::device::{Device, PortIndex, PortSpec, PortValue, Report, find_port, is_in_row};
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
    /// Simulated time, s.
    time: f64,
    /// Error code of the last set-point.
    code: ErrorCode,
    /// Rejection of a set-point that was not reported yet.
    report: Option<Report>,
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

/// Name of the actuators of programs: all outputs, or one.
const SET: &str = "set";

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
    bank_row(SET, PortKind::Actuator, Scalar::Bool, 0, true),
    bank_row(SET, PortKind::Actuator, Scalar::Real, 1, true),
    // Programs access arrays element by element.
    terminal_row("get", PortKind::Sensor, Scalar::Bool, 0, false),
    terminal_row("get", PortKind::Sensor, Scalar::Real, 1, false),
    terminal_row(SET, PortKind::Actuator, Scalar::Bool, 0, true),
    terminal_row(SET, PortKind::Actuator, Scalar::Real, 1, true),
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
            time: 0.0,
            code: ErrorCode::OK,
            report: None,
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

    /// Returns the row of the port table for a port, and the first number of a set-point for it that is not finite; `None` if
    /// there is none.
    fn not_finite(&self, slot: PortIndex, value: &[u64]) -> Option<(&'static PortRow, f64)> {
        let (line, _) = self.terminals(slot).filter(|(line, _)| line.bank == 1)?;
        let mut numbers = value.iter().map(|bits| f64::from_bits(*bits));
        Some((line, numbers.find(|number| !number.is_finite())?))
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
        let terminals = self.terminals(slot);
        let Some((line, bad)) = self.not_finite(slot, value) else {
            // A digital output says nothing about the analogue ones.
            if terminals.is_some_and(|(line, _)| line.bank == 1) {
                self.code = ErrorCode::OK;
            }
            return Rejection::NONE;
        };
        if self.code == ErrorCode::OK {
            self.code = ErrorCode::NOT_A_NUMBER;
            self.report = Some(Report {
                time: self.time,
                axis: None,
                code: self.code,
                value: bad,
                limit: 0.0,
            });
        }
        // The primitives of nets have out-ports for the rejection, programs have none.
        match line.spec.name {
            SET => Rejection::ILLEGAL_VALUE.union(Rejection::KEEPS_VALUE),
            _ => Rejection::ILLEGAL_VALUE,
        }
    }

    fn port_code(&self, _slot: PortIndex) -> ErrorCode {
        self.code
    }

    fn code(&self) -> ErrorCode {
        self.code
    }

    fn begin_command(&mut self, _resource: u32, _ticks: u32) {
        self.code = ErrorCode::OK;
    }

    fn reports(&mut self, each: &mut dyn FnMut(Report)) -> u64 {
        self.report.take().into_iter().for_each(each);
        0
    }

    fn write(&mut self, slot: PortIndex, value: &[u64]) {
        let accepted = self.not_finite(slot, value).is_none();
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
        self.time = time;
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
