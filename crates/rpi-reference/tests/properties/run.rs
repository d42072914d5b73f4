//! Execution of a program as an optimised image and in the reference interpreter.

use std::sync::Arc;

use rpi_core::{Machine, Moment, Verdict};
use rpi_device::NoDevices;
use rpi_driver::{Claims, Input, Kind, Node, Typed, compile, compile_node, lower_to_run, typed};
use rpi_image::{Image, Scalar, Type};
use rpi_reference::{Leaf, Reference, Stop, Value};

use crate::random::Random;

/// Period of all programs in ns: 1 ms.
const PERIOD_NS: u64 = 1_000_000;
/// Period in seconds.
const DT: f64 = 1e-3;

/// Values of the in-ports in each cycle.
pub(crate) type Rows = Vec<Vec<Value>>;

/// Result of a cycle: the bits of the out-ports, or `None` if it faulted.
pub(crate) type Seen = Option<Vec<Option<u64>>>;

pub(crate) fn input(text: &str, kind: Kind) -> Input {
    Input {
        path: "random.rpi".into(),
        kind,
        bytes: text.as_bytes().to_vec(),
    }
}

/// Compiled node of a program.
pub(crate) struct Ready {
    pub(crate) image: Arc<Image>,
    node: Node,
}

impl Ready {
    /// Compiles a node of an RPI program.
    ///
    /// # Errors
    /// The messages of the compiler.
    pub(crate) fn new(text: &str, name: &str) -> Result<Ready, String> {
        Ready::of_kind(text, name, Kind::Rpi)
    }

    /// Compiles a node of an RPI or Lustre program.
    ///
    /// # Errors
    /// The messages of the compiler.
    pub(crate) fn of_kind(text: &str, name: &str, kind: Kind) -> Result<Ready, String> {
        let made = compile_node(&input(text, kind), Some(name), Claims::Report, false)
            .map_err(|e| e.to_string())?;
        let errors = made
            .findings
            .iter()
            .filter(|f| f.severity() == rpi_diag::Severity::Error);
        let errors: Vec<String> = errors
            .map(|f| {
                format!(
                    "does not compile, {}: {} {:?}",
                    f.code,
                    f.message,
                    made.sources.slice(f.span())
                )
            })
            .collect();
        let node = made.node.ok_or_else(|| errors.join("\n"))?;
        let image = lower_to_run(&node.net, PERIOD_NS)?;
        Ok(Ready {
            image: Arc::new(image),
            node,
        })
    }

    /// Returns the number of leaves of the out-ports.
    pub(crate) fn width(&self) -> usize {
        self.node.outputs.len()
    }

    /// Returns random values for all in-ports and the given number of cycles.
    pub(crate) fn rows(&self, random: &mut Random, cycles: usize) -> Rows {
        let row = |random: &mut Random| {
            let columns = self.node.inputs.iter();
            columns
                .map(|c| value(random, c.ty, c.values.len()))
                .collect()
        };
        (0..cycles).map(|_| row(random)).collect()
    }

    /// Runs the image, up to a fault.
    pub(crate) fn run(&self, rows: &Rows) -> Vec<Seen> {
        let mut machine =
            Machine::load(Arc::clone(&self.image), &mut NoDevices).expect("it verifies");
        let mut seen = Vec::new();
        for row in rows {
            for (column, value) in self.node.inputs.iter().zip(row) {
                let ports = &self.image.inputs;
                if let Some(port) = ports.iter().position(|port| port.key == column.key) {
                    machine.set_input(port, &[value.bits()], 0);
                }
            }
            machine.read(&mut NoDevices, &Moment::default());
            machine.evaluate(&mut NoDevices);
            seen.push(self.seen(&machine));
            machine.commit();
            machine.hand_over(&mut NoDevices);
            if seen.last() == Some(&None) {
                break;
            }
        }
        seen
    }

    fn seen(&self, machine: &Machine) -> Seen {
        if machine.fault().is_some() {
            return None;
        }
        let leaf = |key: &str| {
            let export = self.image.exports.iter().find(|e| e.key == key)?;
            machine
                .value(export.value)
                .map(|cells| plain(export.value.ty, cells[0]))
        };
        let columns = self.node.outputs.iter();
        Some(columns.map(|column| leaf(&column.key)).collect())
    }
}

/// Returns the bits of a value, with a single representation of NaN: IEEE 754 leaves open which NaN an operation
/// returns, and processors and compilers differ.
fn plain(ty: Type, bits: u64) -> u64 {
    match ty {
        Type::One(Scalar::Real) if f64::from_bits(bits).is_nan() => f64::NAN.to_bits(),
        _ => bits,
    }
}

/// Returns a random value: mostly small ones, so that conditions often hold, and sometimes extreme ones.
fn value(random: &mut Random, ty: Scalar, values: usize) -> Value {
    let small = random.below(9) as i64 - 3;
    match ty {
        Scalar::Bool => Value::Bool(random.one_in(2)),
        Scalar::Real if random.one_in(40) => Value::Real(f64::NAN),
        Scalar::Real if random.one_in(40) => Value::Real(f64::INFINITY),
        Scalar::Real => Value::Real(small as f64 * 0.75),
        _ if values > 0 => Value::Int(random.below(values) as i64),
        _ if random.one_in(60) => Value::Int(i64::MAX - 2),
        _ => Value::Int(small),
    }
}

/// Runs a node in the reference interpreter, up to a fault.
///
/// # Errors
/// If the interpreter does not support it.
pub(crate) fn reference(text: &str, name: &str, rows: &Rows) -> Result<Vec<Seen>, String> {
    reference_of_kind(text, name, rows, Kind::Rpi)
}

/// Runs a node of an RPI or Lustre program in the reference interpreter, up to a fault.
///
/// # Errors
/// If the interpreter does not support it.
pub(crate) fn reference_of_kind(
    text: &str,
    name: &str,
    rows: &Rows,
    kind: Kind,
) -> Result<Vec<Seen>, String> {
    let typed = checked(text, kind)?;
    let unit = typed.unit(name).ok_or("no such node")?;
    let mut reference = Reference::new(&typed.units, unit, DT);
    let mut seen = Vec::new();
    for row in rows {
        let row: Vec<Leaf> = row.iter().copied().map(Some).collect();
        match reference.cycle(&row) {
            Ok(cycle) => seen.push(Some(bits(&cycle.outputs))),
            Err(Stop::Fault(_)) => {
                seen.push(None);
                break;
            }
            Err(stop) => return Err(format!("{stop:?}")),
        }
    }
    Ok(seen)
}

fn checked(text: &str, kind: Kind) -> Result<Typed, String> {
    let typed = typed(&input(text, kind)).map_err(|e| e.to_string())?;
    typed.map_err(|findings| format!("{findings:?}"))
}

fn bits(leaves: &[Leaf]) -> Vec<Option<u64>> {
    let plain = |value| match value {
        Value::Real(real) if real.is_nan() => f64::NAN.to_bits(),
        other => other.bits(),
    };
    leaves.iter().map(|leaf| leaf.map(plain)).collect()
}

/// Result of a cycle of a command: its exports, and the result with which it ended.
pub(crate) type Ended = Option<(Vec<Option<u64>>, Option<usize>)>;

/// Runs the command of a program as an image, up to its end.
///
/// # Errors
/// If there is not exactly one command, or it does not compile.
pub(crate) fn run_command(text: &str, cycles: usize) -> Result<Vec<Ended>, String> {
    let compiled = compile(&input(text, Kind::Rpi)).map_err(|e| e.to_string())?;
    let [net] = compiled.nets() else {
        return Err("not one command".to_owned());
    };
    let image = Arc::new(lower_to_run(net, PERIOD_NS)?);
    let mut machine = Machine::load(Arc::clone(&image), &mut NoDevices).expect("it verifies");
    let mut seen = Vec::new();
    for _ in 0..cycles {
        machine.read(&mut NoDevices, &Moment::default());
        machine.evaluate(&mut NoDevices);
        let end = match machine.verdict(&[]) {
            Some(Verdict::Result(k)) => Some(k),
            _ => None,
        };
        let value = |e: &rpi_image::image::Export| {
            machine
                .value(e.value)
                .map(|cells| plain(e.value.ty, cells[0]))
        };
        let exports = image.exports.iter().map(value);
        let faulted = machine.fault().is_some();
        seen.push((!faulted).then(|| (exports.collect(), end)));
        if faulted || end.is_some() {
            break;
        }
        machine.commit();
        machine.hand_over(&mut NoDevices);
    }
    Ok(seen)
}

/// Runs the command of a program in the reference interpreter, up to its end.
///
/// # Errors
/// If the interpreter does not support it.
pub(crate) fn reference_command(text: &str, cycles: usize) -> Result<Vec<Ended>, String> {
    let typed = checked(text, Kind::Rpi)?;
    let unit = typed.unit("Run").ok_or("no command")?;
    let mut reference = Reference::new(&typed.units, unit, DT);
    let mut seen = Vec::new();
    for _ in 0..cycles {
        match reference.cycle(&[]) {
            Ok(cycle) => {
                let end = cycle.end;
                seen.push(Some((bits(&cycle.exports), end)));
                if end.is_some() {
                    break;
                }
            }
            Err(Stop::Fault(_)) => {
                seen.push(None);
                break;
            }
            Err(stop) => return Err(format!("{stop:?}")),
        }
    }
    Ok(seen)
}
