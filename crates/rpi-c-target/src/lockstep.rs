//! The same cycles in the core and in C, compared bit by bit.
//!
//! Samples of sensors, responses of devices and results of device functions are those of the core's run. Two values
//! that are not a number count as equal: their bits depend on the processor and the order of operands.

use super::compiler::{CCompiler, CTargetError};
use super::process::CProcess;
use rpi_codegen::{CType, Direction, Field, Meaning, Options};
use rpi_core::{CycleContext, Instance, LoadError, Verdict};
use rpi_device::{DeviceBank, PortId, PortKind, PortQuery, Rejection, ResolveError};
use rpi_image::image::{Image, Signal, TRUE};
use rpi_image::{Scalar, Type};
use rpi_prims::FaultCode;
use std::fmt;
use std::ops::Range;
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

/// Image that runs in the core and in C.
pub struct Lockstep {
    machine: Instance,
    process: CProcess,
    functions: Vec<PortId>,
    actuators: Vec<PortId>,
}

impl Lockstep {
    /// Loads an image in the core and starts it as a C program.
    ///
    /// # Errors
    /// Returns the reason why the image cannot be loaded or compiled.
    pub fn start(
        image: &Arc<Image>,
        bank: &mut dyn DeviceBank,
        options: &Options<'_>,
        compiler: &CCompiler,
    ) -> Result<Lockstep, CTargetError> {
        let text = |errors: Vec<LoadError>| {
            let texts: Vec<String> = errors.iter().map(ToString::to_string).collect();
            CTargetError(texts.join("\n"))
        };
        let machine = Instance::load(Arc::clone(image), bank).map_err(text)?;
        let mut resolve = |port, kind| {
            let found = bank.resolve(&PortQuery::new(port, kind));
            found.map_err(|e| CTargetError(e.to_string()))
        };
        let functions = image.functions.iter();
        let functions = functions.map(|f| resolve(&f.port, PortKind::Function));
        let functions = functions.collect::<Result<_, _>>()?;
        let actuators = image.actuators.iter();
        let actuators = actuators.map(|a| resolve(&a.port, PortKind::Actuator));
        let actuators = actuators.collect::<Result<_, _>>()?;
        Ok(Lockstep {
            machine,
            process: CProcess::start(image, options, compiler)?,
            functions,
            actuators,
        })
    }

    /// Returns the instance in the core, to set its inputs.
    pub fn instance(&mut self) -> &mut Instance {
        &mut self.machine
    }

    /// Restores the initial state on both sides, as after a fault.
    ///
    /// # Errors
    /// If the program in C has ended.
    pub fn reset(&mut self) -> Result<(), CTargetError> {
        self.machine.reset();
        self.process.reset()
    }

    /// Returns the program in C.
    pub fn process(&mut self) -> &mut CProcess {
        &mut self.process
    }

    /// Runs one cycle on both sides. Returns whether the command continues.
    ///
    /// # Errors
    /// Returns the first difference.
    pub fn cycle(
        &mut self,
        bank: &mut dyn DeviceBank,
        context: &CycleContext,
    ) -> Result<bool, Difference> {
        let cycle = self.machine.cycle();
        let differs = |text: String| Difference { cycle, text };
        let mut observed = ObservedBank {
            bank,
            calls: Vec::new(),
            set_points: Vec::new(),
        };
        self.machine.read(&mut observed, context);
        let before = self.externals();
        self.machine.evaluate(&mut observed);
        let inputs = self.inputs(&before);
        let mut calls = observed.calls.into_iter();
        let mut problem = None;
        let mut call = |number: usize, arguments: &[u64]| {
            let (port, expected, results) = calls.next()?;
            if port != self.functions[number] || !same_words(&expected, arguments) {
                problem = Some(format!(
                    "call {number}: expected {expected:x?}, found {arguments:x?}"
                ));
            }
            results
        };
        let found = self.process.step(&inputs, &mut call);
        let found = found.map_err(|e| differs(e.to_string()))?;
        if let Some(text) = problem {
            return Err(differs(text));
        }
        let fault = self.machine.fault().map_or(0, |f| code_number(f.code));
        if fault != found.fault {
            return Err(differs(format!(
                "fault: expected {fault}, found {}",
                found.fault
            )));
        }
        let verdict = self.machine.verdict(&[]);
        if fault == 0 {
            self.compare(&observed.set_points, &found.outputs)
                .map_err(differs)?;
        }
        self.machine.commit();
        self.machine.hand_over(observed.bank);
        Ok(verdict.is_none())
    }

    fn fields(&self, direction: Direction) -> Vec<Field> {
        self.process
            .emitted
            .interface
            .of(direction)
            .cloned()
            .collect()
    }

    fn words(&self, start: u32, len: u32) -> Vec<u64> {
        let signal = Signal {
            start,
            present: TRUE,
            ty: Type::Array(Scalar::Real, len),
        };
        self.machine
            .value(signal)
            .map_or_else(Vec::new, <[u64]>::to_vec)
    }

    /// Returns the words of the external slots, in the order of the input struct; empty for other fields.
    fn externals(&self) -> Vec<Vec<u64>> {
        let fields = self.fields(Direction::Input);
        let words = fields.iter().map(|field| match field.meaning {
            Meaning::External(start) => self.words(start, field.len),
            Meaning::ExternalPresence(slot) => self.words(slot, 1),
            _ => Vec::new(),
        });
        words.collect()
    }

    /// Returns the input struct of a cycle that the core has evaluated.
    fn inputs(&self, externals: &[Vec<u64>]) -> Vec<u64> {
        let fields = self.fields(Direction::Input);
        let words = fields
            .iter()
            .zip(externals)
            .flat_map(|(field, words)| match field.meaning {
                Meaning::Response(actuator, response) => {
                    let actuators = &self.machine.image().actuators;
                    let port = &actuators[actuator as usize].port;
                    let same = actuators.iter().filter(|a| a.port == *port);
                    let slots = same.flat_map(|a| &a.responses).filter(|r| r.0 == response);
                    // An inactive step has no response; two active ones are a fault.
                    let values = slots.map(|r| self.words(r.1, 1)[0]);
                    vec![values.max().unwrap_or(0)]
                }
                Meaning::HasSuccessor => vec![0],
                _ => words.clone(),
            });
        words.collect()
    }

    fn compare(&self, set_points: &[(PortId, Vec<u64>)], outputs: &[u64]) -> Result<(), String> {
        let mut rest = outputs;
        for field in self.fields(Direction::Output) {
            let (found, others) = rest.split_at((field.len as usize).min(rest.len()));
            rest = others;
            let expected = self.expected(&field, set_points);
            let Some(expected) = expected else { continue };
            let same = match field.ty {
                CType::Real => same_words(&expected, found),
                _ => expected == found,
            };
            if !same {
                return Err(format!(
                    "{}: expected {expected:x?}, found {found:x?}",
                    field.name
                ));
            }
        }
        Ok(())
    }

    /// Returns the words that a field must have; `None` if it has no defined value in this cycle.
    fn expected(&self, field: &Field, set_points: &[(PortId, Vec<u64>)]) -> Option<Vec<u64>> {
        let image = self.machine.image();
        let is_present = |signal: Signal| self.machine.value(signal).is_some();
        let set_point = |actuator: u32| {
            let port = self.actuators[actuator as usize];
            set_points
                .iter()
                .rev()
                .find(|s| s.0 == port)
                .map(|s| s.1.clone())
        };
        let verdict = self.machine.verdict(&[]);
        match field.meaning {
            Meaning::Export(k) => {
                let signal = image.exports[k as usize].value;
                self.machine
                    .value(signal)
                    .map(|words| normalised(field.ty, words))
            }
            Meaning::ExportPresence(k) => {
                Some(vec![u64::from(is_present(image.exports[k as usize].value))])
            }
            Meaning::SetPoint(k) => set_point(k),
            Meaning::SetPointPresence(k) => Some(vec![u64::from(set_point(k).is_some())]),
            Meaning::Result => Some(vec![match verdict {
                Some(Verdict::Result(k)) => k as u64 + 1,
                _ => 0,
            }]),
            Meaning::Terminated => Some(vec![u64::from(matches!(
                verdict,
                Some(Verdict::Terminate(_))
            ))]),
            Meaning::ErrorNumber => match verdict {
                Some(Verdict::Terminate(number)) => Some(vec![number.cast_unsigned()]),
                _ => None,
            },
            _ => None,
        }
    }
}

fn normalised(ty: CType, words: &[u64]) -> Vec<u64> {
    match ty {
        CType::Bool => words.iter().map(|w| u64::from(*w != 0)).collect(),
        _ => words.to_vec(),
    }
}

/// Returns whether words are equal; reals that are not a number are equal to each other.
fn same_words(a: &[u64], b: &[u64]) -> bool {
    let same =
        |(a, b): (&u64, &u64)| a == b || f64::from_bits(*a).is_nan() && f64::from_bits(*b).is_nan();
    a.len() == b.len() && a.iter().zip(b).all(same)
}

/// Returns the number of a fault in C (`enum rpi_fault_code`).
fn code_number(code: FaultCode) -> i32 {
    match code {
        FaultCode::IntegerOverflow => 1,
        FaultCode::DivisionByZero => 2,
        FaultCode::LossyConversion => 3,
        FaultCode::IndexOutOfRange => 4,
        FaultCode::ShapeMismatch => 5,
        FaultCode::ConcurrentAccess => 6,
        FaultCode::MissingSample => 7,
        FaultCode::DeviceFailed => 8,
        FaultCode::SetPointMissing => 9,
        FaultCode::Discontinuity => 10,
        FaultCode::AssertionFailed => 11,
        FaultCode::OutsideSubrange => 12,
        FaultCode::EmergencyStop => 13,
    }
}

/// Call of a device function: port, arguments and results.
type ObservedCall = (PortId, Vec<u64>, Option<Vec<u64>>);

/// Bank of devices that records the calls and set-points of a cycle.
struct ObservedBank<'a> {
    bank: &'a mut dyn DeviceBank,
    calls: Vec<ObservedCall>,
    set_points: Vec<(PortId, Vec<u64>)>,
}

impl DeviceBank for ObservedBank<'_> {
    fn resolve(&mut self, name: &PortQuery<'_>) -> Result<PortId, ResolveError> {
        self.bank.resolve(name)
    }

    fn resource(&self, port: PortId) -> u32 {
        self.bank.resource(port)
    }

    fn resources(&self, port: PortId) -> Range<u32> {
        self.bank.resources(port)
    }

    fn read(&mut self, port: PortId, value: &mut [u64]) -> bool {
        self.bank.read(port, value)
    }

    fn check_set_point(&mut self, port: PortId, value: &[u64]) -> Rejection {
        self.set_points.push((port, value.to_vec()));
        self.bank.check_set_point(port, value)
    }

    fn error_code(&self, port: PortId) -> i64 {
        self.bank.error_code(port)
    }

    fn write(&mut self, port: PortId, value: &[u64]) {
        self.bank.write(port, value);
    }

    fn call(&mut self, port: PortId, arguments: &[u64], result: &mut [u64]) -> bool {
        let found = self.bank.call(port, arguments, result);
        let results = found.then(|| result.to_vec());
        self.calls.push((port, arguments.to_vec(), results));
        found
    }

    fn is_moving(&self, resource: u32) -> bool {
        self.bank.is_moving(resource)
    }

    fn stop(&mut self, resource: u32) {
        self.bank.stop(resource);
    }
}
