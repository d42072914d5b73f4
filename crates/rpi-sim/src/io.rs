//! Terminals of digital and analogue inputs and outputs.

use crate::cell::{Change, IoSpec, Signal};
use crate::device::{Carries, Device, Head, Slot, find};
use core::ops::Range;
use rpi_device::{PortKind, PortName, Refusal, ResolveError};
use rpi_image::Scalar;

/// A terminal: its digital bank, then its analogue one.
#[derive(Clone, Debug)]
pub(crate) struct Io {
    banks: [Bank; 2],
}

/// Inputs and outputs of one type, as cells.
#[derive(Clone, Debug)]
struct Bank {
    first: Vec<u64>,
    inputs: Vec<u64>,
    outputs: Vec<u64>,
    script: Vec<Change<u64>>,
    repeat: f64,
}

/// A line of the table of ports.
struct Line {
    head: Head,
    bank: usize,
    output: bool,
}

const fn line(
    name: &'static str,
    kind: PortKind,
    scalar: Scalar,
    bank: usize,
    output: bool,
) -> Line {
    Line {
        head: Head {
            name,
            kind,
            carries: Carries::One(scalar),
            indexed: true,
        },
        bank,
        output,
    }
}

const PORTS: &[Line] = &[
    line("in.bool", PortKind::Sensor, Scalar::Bool, 0, false),
    line("out.bool", PortKind::Sensor, Scalar::Bool, 0, true),
    line("out.bool", PortKind::Actuator, Scalar::Bool, 0, true),
    line("in.real", PortKind::Sensor, Scalar::Real, 1, false),
    line("out.real", PortKind::Sensor, Scalar::Real, 1, true),
    line("out.real", PortKind::Actuator, Scalar::Real, 1, true),
];

/// The ports of a terminal, for people.
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

    fn port(&self, slot: Slot) -> Option<(&'static Line, &Bank)> {
        let line = PORTS.get(usize::from(slot.line))?;
        Some((line, &self.banks[line.bank]))
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

    /// The inputs as the script wants them at a time (s): a function of the time alone.
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

impl Device for Io {
    fn resolve(&self, name: &PortName<'_>) -> Result<Slot, ResolveError> {
        let count = |head: &Head| {
            let line = PORTS
                .iter()
                .find(|line| line.head.name == head.name && line.head.kind == head.kind);
            line.map_or(0, |line| self.banks[line.bank].ports(line.output).len())
        };
        find(PORTS.iter().map(|line| &line.head), name, count, 0)
    }

    fn resources(&self) -> u32 {
        self.banks
            .iter()
            .map(|bank| bank.outputs.len() as u32)
            .sum()
    }

    fn resources_of(&self, slot: Slot) -> Range<u32> {
        let Some((line, _)) = self
            .port(slot)
            .filter(|(line, _)| line.head.kind == PortKind::Actuator)
        else {
            return 0..0;
        };
        let before: usize = self.banks[..line.bank]
            .iter()
            .map(|bank| bank.outputs.len())
            .sum();
        let own = before as u32 + u32::from(slot.index);
        own..own + 1
    }

    fn read(&self, slot: Slot, value: &mut [u64]) -> bool {
        let read = self
            .port(slot)
            .and_then(|(line, bank)| bank.ports(line.output).get(usize::from(slot.index)));
        read.zip(value.first_mut())
            .map(|(bits, cell)| *cell = *bits)
            .is_some()
    }

    fn check(&mut self, slot: Slot, value: &[u64]) -> Refusal {
        let real = self
            .port(slot)
            .is_some_and(|(line, _)| line.head.carries == Carries::One(Scalar::Real));
        let first = value.first().copied().unwrap_or_default();
        if real && !f64::from_bits(first).is_finite() {
            Refusal::ILLEGAL_VALUE
        } else {
            Refusal::NONE
        }
    }

    fn error(&self, _slot: Slot) -> i64 {
        0
    }

    fn write(&mut self, slot: Slot, value: &[u64]) {
        if self.check(slot, value) != Refusal::NONE {
            return;
        }
        let Some(line) = PORTS
            .get(usize::from(slot.line))
            .filter(|line| line.head.kind == PortKind::Actuator)
        else {
            return;
        };
        let output = self.banks[line.bank]
            .outputs
            .get_mut(usize::from(slot.index));
        output
            .zip(value.first())
            .into_iter()
            .for_each(|(output, bits)| *output = *bits);
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
