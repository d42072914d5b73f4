//! Program in C that repeats the cycles of an instance in the core, compared bit by bit.
//!
//! Samples of sensors, responses of devices and results of device functions are those of the core, so the program in C
//! needs no devices. Two values that are not a number count as equal: their bits depend on the processor and the order
//! of operands.

use super::compiler::{CCompiler, CTargetError};
use super::core_cycle::CoreCycle;
use super::process::{CCycle, CProcess, CProgram};
use rpi_codegen::{CType, Direction, Field};
use rpi_core::Instance;
use rpi_image::Image;
use std::fmt;
use std::sync::Arc;

/// Difference between a cycle in the core and in C.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Difference {
    /// Number of the cycle, counted from 0.
    pub cycle: u64,
    /// What differs, with both values.
    pub text: String,
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "cycle {}: {}", self.cycle, self.text)
    }
}

impl std::error::Error for Difference {}

/// Program in C beside an instance in the core.
pub struct Shadow {
    process: CProcess,
    inputs: Vec<Field>,
    outputs: Vec<Field>,
}

impl Shadow {
    /// Translates an image to C, compiles it and starts it.
    ///
    /// # Errors
    /// Returns the messages of the C compiler, or the reason why the program does not start.
    pub fn start(image: &Image, compiler: &CCompiler) -> Result<Shadow, CTargetError> {
        Shadow::new(Arc::new(CProgram::compile(image, compiler)?))
    }

    /// Starts a compiled program.
    ///
    /// # Errors
    /// Returns the reason why the program does not start.
    pub fn new(program: Arc<CProgram>) -> Result<Shadow, CTargetError> {
        let interface = &program.emitted.interface;
        let fields = |direction| interface.of(direction).cloned().collect();
        Ok(Shadow {
            inputs: fields(Direction::Input),
            outputs: fields(Direction::Output),
            process: CProcess::start(program)?,
        })
    }

    /// Returns the program in C.
    pub fn process(&mut self) -> &mut CProcess {
        &mut self.process
    }

    /// Runs the cycle in C that the core has just evaluated, before the core stores its delays. In the first cycle of the
    /// instance, the program begins with its initial state.
    ///
    /// # Errors
    /// Returns the first difference.
    pub fn cycle(&mut self, instance: &Instance) -> Result<(), Difference> {
        let core = CoreCycle::new(instance);
        let run = self.run(&core);
        run.map_err(|text| Difference {
            cycle: core.number(),
            text,
        })
    }

    fn run(&mut self, core: &CoreCycle<'_>) -> Result<(), String> {
        if core.number() == 0 {
            self.process.reset().map_err(|e| e.to_string())?;
        }
        let (mut calls, mut problem) = (0.., None);
        let mut call = |number: usize, arguments: &[u64]| {
            let expected = calls.next().and_then(|k| core.call(k));
            match expected {
                Some((function, expected, results))
                    if core.shared(function) == number && same_words(&expected, arguments) =>
                {
                    results
                }
                other => {
                    problem = Some(format!(
                        "call of device function {number} with {arguments:x?}, expected {other:x?}"
                    ));
                    None
                }
            }
        };
        let found = self.process.step(&core.inputs(&self.inputs), &mut call);
        let found = found.map_err(|e| e.to_string())?;
        match problem {
            Some(text) => Err(text),
            None => self.compare(core, &found),
        }
    }

    fn compare(&self, core: &CoreCycle<'_>, found: &CCycle) -> Result<(), String> {
        if core.has_fault() {
            // A fault that only the core raises has no values to compare.
            return match core.fault() {
                Some(code) if code != found.fault => Err(fault_difference(code, found.fault)),
                _ => Ok(()),
            };
        }
        if found.fault != 0 {
            return Err(fault_difference(0, found.fault));
        }
        let mut rest = &found.outputs[..];
        for field in &self.outputs {
            let (found, others) = rest.split_at((field.len as usize).min(rest.len()));
            rest = others;
            let Some(expected) = core.expected(field) else {
                continue;
            };
            let is_same = match field.ty {
                CType::Real => same_words(&expected, found),
                _ => expected == found,
            };
            if !is_same {
                let name = &field.name;
                return Err(format!("{name}: expected {expected:x?}, found {found:x?}"));
            }
        }
        Ok(())
    }
}

fn fault_difference(expected: i32, found: i32) -> String {
    format!("fault: expected {expected}, found {found}")
}

/// Returns whether words are equal; reals that are not a number are equal to each other.
fn same_words(a: &[u64], b: &[u64]) -> bool {
    let same =
        |(a, b): (&u64, &u64)| a == b || f64::from_bits(*a).is_nan() && f64::from_bits(*b).is_nan();
    a.len() == b.len() && a.iter().zip(b).all(same)
}
