//! Cycle that the core has evaluated: the values that the program in C receives, and those that it must compute.

use rpi_codegen::{CType, Field, Meaning};
use rpi_core::{Instance, Verdict};
use rpi_image::image::{Signal, SlotRange, Step, TRUE};
use rpi_image::{Scalar, Type};
use rpi_prims::FaultCode;

/// Evaluated cycle of an instance, before its delays are stored.
pub(crate) struct CoreCycle<'a> {
    instance: &'a Instance,
    /// Actuator ports with a set-point in this cycle, as indices in the image, in the order of the steps.
    actuators: Vec<u32>,
    /// Device functions that were called in this cycle, as indices in the image, in the order of the steps.
    functions: Vec<u32>,
}

impl<'a> CoreCycle<'a> {
    pub(crate) fn new(instance: &'a Instance) -> CoreCycle<'a> {
        let mut cycle = CoreCycle {
            instance,
            actuators: Vec::new(),
            functions: Vec::new(),
        };
        let image = instance.image();
        if image.actuators.is_empty() && image.functions.is_empty() {
            return cycle;
        }
        let mut at = 0;
        while let Some(step) = image.steps.get(at) {
            at += 1;
            match *step {
                Step::Skip { unless, target } if cycle.word(unless) == 0 => at = target as usize,
                Step::Actuate { actuator } => cycle.actuators.push(actuator),
                Step::Call { function } => cycle.functions.push(function),
                _ => {}
            }
        }
        cycle
    }

    /// Returns the number of the cycle, counted from 0.
    pub(crate) fn number(&self) -> u64 {
        self.instance.cycle()
    }

    /// Returns the fault code of the cycle as a number in C (`enum rpi_fault_code`); `None` without a fault, and for a
    /// fault that only the core raises, such as a missing sample.
    pub(crate) fn fault(&self) -> Option<i32> {
        match self.instance.fault()?.code {
            FaultCode::IntegerOverflow => Some(1),
            FaultCode::DivisionByZero => Some(2),
            FaultCode::LossyConversion => Some(3),
            FaultCode::IndexOutOfRange => Some(4),
            FaultCode::ShapeMismatch => Some(5),
            FaultCode::ConcurrentAccess => Some(6),
            FaultCode::AssertionFailed => Some(11),
            FaultCode::OutsideSubrange => Some(12),
            FaultCode::MissingSample
            | FaultCode::DeviceFailed
            | FaultCode::SetPointMissing
            | FaultCode::Discontinuity
            | FaultCode::EmergencyStop => None,
        }
    }

    /// Returns whether the cycle has a fault.
    pub(crate) fn has_fault(&self) -> bool {
        self.instance.fault().is_some()
    }

    /// Returns the words of the input struct, element by element.
    pub(crate) fn inputs(&self, fields: &[Field]) -> Vec<u64> {
        let words = fields.iter().flat_map(|field| match field.meaning {
            Meaning::External(start) => self.words(start, field.len),
            Meaning::ExternalPresence(slot) => self.words(slot, 1),
            Meaning::Response(actuator, response) => {
                let actuators = &self.instance.image().actuators;
                let port = &actuators[actuator as usize].port;
                let same = actuators.iter().filter(|a| a.port == *port);
                let slots = same.flat_map(|a| &a.responses);
                let slots = slots.filter(|r| r.0 == response);
                // An inactive step has no response; two active ones are a fault.
                vec![slots.map(|r| self.word(r.1)).max().unwrap_or(0)]
            }
            _ => vec![0; field.len as usize],
        });
        words.collect()
    }

    /// Returns the call with the index `k` in this cycle: number of the device function, arguments, and results.
    pub(crate) fn call(&self, k: usize) -> Option<(usize, Vec<u64>, Option<Vec<u64>>)> {
        let number = *self.functions.get(k)? as usize;
        let function = &self.instance.image().functions[number];
        let is_found = function.present == TRUE || self.word(function.present) != 0;
        let results = is_found.then(|| self.parts(&function.results));
        Some((number, self.parts(&function.arguments), results))
    }

    /// Returns the number under which the program in C calls a function of the image.
    pub(crate) fn shared(&self, function: usize) -> usize {
        rpi_codegen::shared_function(self.instance.image(), function)
    }

    /// Returns the words that a field of the output struct must have; `None` if it has no defined value in this cycle.
    pub(crate) fn expected(&self, field: &Field) -> Option<Vec<u64>> {
        let image = self.instance.image();
        let export = |k: u32| self.instance.value(image.exports[k as usize].value);
        let verdict = self.instance.verdict(&[]);
        match field.meaning {
            Meaning::Export(k) => export(k).map(|words| normalised(field.ty, words)),
            Meaning::ExportPresence(k) => Some(vec![u64::from(export(k).is_some())]),
            Meaning::SetPoint(k) => self.set_point(k),
            Meaning::SetPointPresence(k) => Some(vec![u64::from(self.set_point(k).is_some())]),
            Meaning::Result => Some(vec![match verdict {
                Some(Verdict::Result(k)) => k as u64 + 1,
                _ => 0,
            }]),
            Meaning::Terminated => {
                let is_ended = matches!(verdict, Some(Verdict::Terminate(_)));
                Some(vec![u64::from(is_ended)])
            }
            Meaning::ErrorNumber => match verdict {
                Some(Verdict::Terminate(number)) => Some(vec![number.cast_unsigned()]),
                _ => None,
            },
            _ => None,
        }
    }

    /// Returns the last set-point of this cycle for the port of an actuator of the image.
    fn set_point(&self, actuator: u32) -> Option<Vec<u64>> {
        let actuators = &self.instance.image().actuators;
        let port = &actuators[actuator as usize].port;
        let active = self.actuators.iter().map(|k| &actuators[*k as usize]);
        let last = active.rev().find(|a| a.port == *port)?;
        Some(self.parts(&last.inputs))
    }

    fn parts(&self, parts: &[SlotRange]) -> Vec<u64> {
        let words = parts.iter().flat_map(|p| self.words(p.start, p.len));
        words.collect()
    }

    fn word(&self, slot: u32) -> u64 {
        self.words(slot, 1).first().copied().unwrap_or(0)
    }

    fn words(&self, start: u32, len: u32) -> Vec<u64> {
        let signal = Signal {
            start,
            present: TRUE,
            ty: Type::Array(Scalar::Real, len),
        };
        let words = self.instance.value(signal);
        words.map_or_else(Vec::new, <[u64]>::to_vec)
    }
}

fn normalised(ty: CType, words: &[u64]) -> Vec<u64> {
    match ty {
        CType::Bool => words.iter().map(|w| u64::from(*w != 0)).collect(),
        _ => words.to_vec(),
    }
}
