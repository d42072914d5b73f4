//! Terminals with digital and analogue inputs and outputs.

use crate::cell::{Change, IoSpec, Signal};
use crate::device::{Carries, Device, Head, Slot, find, within};
use core::ops::Range;
use rpi_device::{PortKind, PortName, Refusal, ResolveError};
use rpi_image::Scalar;

/// A terminal block: a digital bank, then an analogue bank.
#[derive(Clone, Debug)]
pub(crate) struct Io {
    banks: [Bank; 2],
}

/// Inputs and outputs of one type, one memory slot each.
#[derive(Clone, Debug)]
struct Bank {
    first: Vec<u64>,
    inputs: Vec<u64>,
    outputs: Vec<u64>,
    script: Vec<Change<u64>>,
    repeat: f64,
}

/// A row of the port table.
struct Line {
    head: Head,
    bank: usize,
    output: bool,
}

/// A row for a single terminal, selected by the index.
const fn one(
    name: &'static str,
    kind: PortKind,
    scalar: Scalar,
    bank: usize,
    output: bool,
) -> Line {
    let carries = Carries::One(scalar);
    Line {
        head: Head {
            name,
            kind,
            carries,
            indexed: true,
        },
        bank,
        output,
    }
}

/// A row for all terminals.
const fn all(
    name: &'static str,
    kind: PortKind,
    scalar: Scalar,
    bank: usize,
    output: bool,
) -> Line {
    let carries = Carries::PerTerminal(scalar);
    Line {
        head: Head {
            name,
            kind,
            carries,
            indexed: false,
        },
        bank,
        output,
    }
}

const PORTS: &[Line] = &[
    one("in.bool", PortKind::Sensor, Scalar::Bool, 0, false),
    one("out.bool", PortKind::Sensor, Scalar::Bool, 0, true),
    one("out.bool", PortKind::Actuator, Scalar::Bool, 0, true),
    one("in.real", PortKind::Sensor, Scalar::Real, 1, false),
    one("out.real", PortKind::Sensor, Scalar::Real, 1, true),
    one("out.real", PortKind::Actuator, Scalar::Real, 1, true),
    // Ports of the device types of `.rpi`.
    all("get", PortKind::Sensor, Scalar::Bool, 0, false),
    all("get", PortKind::Sensor, Scalar::Real, 1, false),
    all("set", PortKind::Actuator, Scalar::Bool, 0, true),
    all("set", PortKind::Actuator, Scalar::Real, 1, true),
    // Programs access arrays element by element.
    one("get", PortKind::Sensor, Scalar::Bool, 0, false),
    one("get", PortKind::Sensor, Scalar::Real, 1, false),
    one("set", PortKind::Actuator, Scalar::Bool, 0, true),
    one("set", PortKind::Actuator, Scalar::Real, 1, true),
];

/// Descriptions of a terminal block's ports, for the manual.
pub(crate) fn ports() -> impl Iterator<Item = crate::device::PortInfo> {
    PORTS.iter().map(|line| line.head.info())
}

impl Io {
    pub(crate) fn new(spec: &IoSpec) -> Self {
        let mut io = Self {
            banks: [
                Bank::new(&spec.digital, u64::from),
                Bank::new(&spec.analogue, f64::to_bits),
            ],
        };
        io.banks.iter_mut().for_each(|bank| bank.step(0.0));
        io
    }
}

impl Bank {
    fn new<T: Copy>(signal: &Signal<T>, bits: fn(T) -> u64) -> Self {
        let cells = |values: &[T]| {
            values
                .iter()
                .map(|value| bits(*value))
                .collect::<Vec<u64>>()
        };
        let change = |change: &Change<T>| Change {
            at: change.at,
            input: change.input,
            value: bits(change.value),
        };
        Self {
            first: cells(&signal.inputs),
            inputs: cells(&signal.inputs),
            outputs: cells(&signal.outputs),
            script: signal.script.iter().map(change).collect(),
            repeat: signal.repeat,
        }
    }

    /// Sets the inputs as scripted for `time` (s). The result depends on the time only, not on earlier calls.
    fn step(&mut self, time: f64) {
        let since = if self.repeat.is_finite() && self.repeat > 0.0 {
            time % self.repeat
        } else {
            time
        };
        if self.script.is_empty() {
            return;
        }
        self.inputs.copy_from_slice(&self.first);
        for change in self.script.iter().take_while(|change| change.at <= since) {
            self.inputs[change.input] = change.value;
        }
    }
}

impl Io {
    /// Number of terminals of a table row.
    fn size(&self, line: usize) -> usize {
        let line = &PORTS[line];
        self.banks[line.bank].ports(line.output).len()
    }

    /// The terminals of a port: all of its bank, or one if the port is indexed.
    fn terminals(&self, slot: Slot) -> Option<(&'static Line, Range<usize>)> {
        let line = PORTS.get(usize::from(slot.line))?;
        let count = self.banks[line.bank].ports(line.output).len();
        let first = usize::from(slot.index);
        let end = if line.head.indexed { first + 1 } else { count };
        (end <= count).then_some((line, first..end))
    }
}

impl Device for Io {
    fn resolve(&self, name: &PortName<'_>) -> Result<Slot, ResolveError> {
        find(PORTS.iter().map(|line| &line.head), name, |line| {
            self.size(line)
        })
    }

    fn has(&self, slot: Slot) -> bool {
        let line = PORTS.get(usize::from(slot.line));
        within(line.map(|line| &line.head), slot, |line| self.size(line))
    }

    fn resources_of(&self, slot: Slot) -> Range<u32> {
        let terminals = self.terminals(slot);
        let Some((line, own)) = terminals.filter(|(line, _)| line.head.kind == PortKind::Actuator)
        else {
            return 0..0;
        };
        let before: usize = self.banks[..line.bank]
            .iter()
            .map(|bank| bank.outputs.len())
            .sum();
        (before + own.start) as u32..(before + own.end) as u32
    }

    fn read(&self, slot: Slot, value: &mut [u64]) -> bool {
        let Some((line, own)) = self.terminals(slot) else {
            return false;
        };
        let ports = &self.banks[line.bank].ports(line.output)[own];
        value
            .iter_mut()
            .zip(ports)
            .for_each(|(cell, bits)| *cell = *bits);
        true
    }

    fn check(&mut self, slot: Slot, value: &[u64]) -> Refusal {
        let real = self.terminals(slot).is_some_and(|(line, _)| line.bank == 1);
        let finite = value.iter().all(|bits| f64::from_bits(*bits).is_finite());
        if real && !finite {
            Refusal::ILLEGAL_VALUE
        } else {
            Refusal::NONE
        }
    }

    fn error(&self, _slot: Slot) -> i64 {
        0
    }

    fn write(&mut self, slot: Slot, value: &[u64]) {
        let accepted = self.check(slot, value) == Refusal::NONE;
        let terminals = self
            .terminals(slot)
            .filter(|(line, _)| line.head.kind == PortKind::Actuator);
        if let Some((line, own)) = terminals.filter(|_| accepted) {
            let outputs = &mut self.banks[line.bank].outputs[own];
            outputs
                .iter_mut()
                .zip(value)
                .for_each(|(output, bits)| *output = *bits);
        }
    }

    fn step(&mut self, time: f64) {
        self.banks.iter_mut().for_each(|bank| bank.step(time));
    }
}

impl Bank {
    fn ports(&self, output: bool) -> &[u64] {
        if output { &self.outputs } else { &self.inputs }
    }
}
