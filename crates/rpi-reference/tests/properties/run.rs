//! Execution of a program as an optimised image and in the reference interpreter.

use std::sync::Arc;

use rpi_c_target::{CCompiler, Lockstep};
use rpi_core::{CycleContext, Instance, Verdict};
use rpi_device::NoDevices;
use rpi_driver::{
    ClaimPolicy, Input, InputKind, Node, TypedProgram, check_typed, compile, compile_node,
    lower_for_execution,
};
use rpi_image::{Image, Scalar, Type};
use rpi_reference::{EvalError, Interpreter, Leaf, Value};

use crate::random::Random;

/// Period of all programs in ns: 1 ms.
const PERIOD_NS: u64 = 1_000_000;
/// Period in seconds.
const DT: f64 = 1e-3;

/// Values of the in-ports in each cycle.
pub(crate) type Rows = Vec<Vec<Value>>;

/// Result of a cycle: the bits of the out-ports, or `None` if it faulted.
pub(crate) type CycleResult = Option<Vec<Option<u64>>>;

pub(crate) fn input(text: &str, kind: InputKind) -> Input {
    Input {
        path: "random.rpi".into(),
        kind,
        bytes: text.as_bytes().to_vec(),
    }
}

/// Compiled node of a program.
pub(crate) struct CompiledNode {
    pub(crate) image: Arc<Image>,
    node: Node,
}

impl CompiledNode {
    /// Compiles a node of an RPI program.
    ///
    /// # Errors
    /// The messages of the compiler.
    pub(crate) fn new(text: &str, name: &str) -> Result<CompiledNode, String> {
        CompiledNode::of_kind(text, name, InputKind::Rpi)
    }

    /// Compiles a node of an RPI or Lustre program.
    ///
    /// # Errors
    /// The messages of the compiler.
    pub(crate) fn of_kind(text: &str, name: &str, kind: InputKind) -> Result<CompiledNode, String> {
        let made = compile_node(&input(text, kind), Some(name), ClaimPolicy::Report, false)
            .map_err(|e| e.to_string())?;
        let errors = made
            .diagnostics
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
        let image = lower_for_execution(&node.net, PERIOD_NS).map_err(|e| e.to_string())?;
        Ok(CompiledNode {
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
                .map(|c| value(random, c.scalar, c.enum_values.len()))
                .collect()
        };
        (0..cycles).map(|_| row(random)).collect()
    }

    /// Runs the image, up to a fault.
    pub(crate) fn run(&self, rows: &Rows) -> Vec<CycleResult> {
        let mut machine =
            Instance::load(Arc::clone(&self.image), &mut NoDevices).expect("it verifies");
        let mut results = Vec::new();
        for row in rows {
            for (column, value) in self.node.inputs.iter().zip(row) {
                let ports = &self.image.inputs;
                if let Some(port) = ports.iter().position(|port| port.key == column.key) {
                    machine.set_input(port, &[value.bits()], 0);
                }
            }
            machine.read(&mut NoDevices, &CycleContext::default());
            machine.evaluate(&mut NoDevices);
            results.push(self.results(&machine));
            machine.commit();
            machine.hand_over(&mut NoDevices);
            if results.last() == Some(&None) {
                break;
            }
        }
        results
    }

    /// Runs the image in the core and in C, up to a fault.
    ///
    /// # Errors
    /// The first difference, or the messages of the C compiler.
    pub(crate) fn run_in_c(&self, rows: &Rows, compiler: &CCompiler) -> Result<(), String> {
        let both = Lockstep::start(&self.image, &mut NoDevices, compiler);
        let mut both = both.map_err(|e| format!("C: {e}"))?;
        for row in rows {
            for (column, value) in self.node.inputs.iter().zip(row) {
                let ports = &self.image.inputs;
                if let Some(port) = ports.iter().position(|port| port.key == column.key) {
                    both.instance().set_input(port, &[value.bits()], 0);
                }
            }
            let same = both.cycle(&mut NoDevices, &CycleContext::default());
            if !same.map_err(|e| format!("C: {e}"))? {
                break;
            }
        }
        Ok(())
    }

    fn results(&self, machine: &Instance) -> CycleResult {
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
        Type::Scalar(Scalar::Real) if f64::from_bits(bits).is_nan() => f64::NAN.to_bits(),
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
pub(crate) fn reference(text: &str, name: &str, rows: &Rows) -> Result<Vec<CycleResult>, String> {
    reference_of_kind(text, name, rows, InputKind::Rpi)
}

/// Runs a node of an RPI or Lustre program in the reference interpreter, up to a fault.
///
/// # Errors
/// If the interpreter does not support it.
pub(crate) fn reference_of_kind(
    text: &str,
    name: &str,
    rows: &Rows,
    kind: InputKind,
) -> Result<Vec<CycleResult>, String> {
    let typed = checked(text, kind)?;
    let unit = typed.unit(name).ok_or("no such node")?;
    let mut reference = Interpreter::new(&typed.units, unit, DT);
    let mut results = Vec::new();
    for row in rows {
        let row: Vec<Leaf> = row.iter().copied().map(Some).collect();
        match reference.cycle(&row) {
            Ok(cycle) => results.push(Some(bits(&cycle.outputs))),
            Err(EvalError::Fault(_)) => {
                results.push(None);
                break;
            }
            Err(stop) => return Err(format!("{stop:?}")),
        }
    }
    Ok(results)
}

fn checked(text: &str, kind: InputKind) -> Result<TypedProgram, String> {
    let typed = check_typed(&input(text, kind)).map_err(|e| e.to_string())?;
    typed.map_err(|diagnostics| format!("{diagnostics:?}"))
}

fn bits(leaves: &[Leaf]) -> Vec<Option<u64>> {
    let plain = |value| match value {
        Value::Real(real) if real.is_nan() => f64::NAN.to_bits(),
        other => other.bits(),
    };
    leaves.iter().map(|leaf| leaf.map(plain)).collect()
}

/// Result of a cycle of a command: its exports, and the result with which it ended.
pub(crate) type CommandCycleResult = Option<(Vec<Option<u64>>, Option<usize>)>;

/// Runs the command of a program as an image, up to its end.
///
/// # Errors
/// If there is not exactly one command, or it does not compile.
pub(crate) fn run_command(text: &str, cycles: usize) -> Result<Vec<CommandCycleResult>, String> {
    let compiled = compile(&input(text, InputKind::Rpi)).map_err(|e| e.to_string())?;
    let [net] = compiled.nets() else {
        return Err("not one command".to_owned());
    };
    let image = Arc::new(lower_for_execution(net, PERIOD_NS).map_err(|e| e.to_string())?);
    let mut machine = Instance::load(Arc::clone(&image), &mut NoDevices).expect("it verifies");
    let mut results = Vec::new();
    for _ in 0..cycles {
        machine.read(&mut NoDevices, &CycleContext::default());
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
        results.push((!faulted).then(|| (exports.collect(), end)));
        if faulted || end.is_some() {
            break;
        }
        machine.commit();
        machine.hand_over(&mut NoDevices);
    }
    Ok(results)
}

/// Runs the command of a program in the reference interpreter, up to its end.
///
/// # Errors
/// If the interpreter does not support it.
pub(crate) fn reference_command(
    text: &str,
    cycles: usize,
) -> Result<Vec<CommandCycleResult>, String> {
    let typed = checked(text, InputKind::Rpi)?;
    let unit = typed.unit("Run").ok_or("no command")?;
    let mut reference = Interpreter::new(&typed.units, unit, DT);
    let mut results = Vec::new();
    for _ in 0..cycles {
        match reference.cycle(&[]) {
            Ok(cycle) => {
                let end = cycle.end;
                results.push(Some((bits(&cycle.exports), end)));
                if end.is_some() {
                    break;
                }
            }
            Err(EvalError::Fault(_)) => {
                results.push(None);
                break;
            }
            Err(stop) => return Err(format!("{stop:?}")),
        }
    }
    Ok(results)
}
