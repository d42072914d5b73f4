//! Constant folding: evaluates a primitive on constant inputs at compile time.

use crate::context::{Context, CycleTime, FaultCode};
use crate::registry::{PrimId, RunFn};
use alloc::vec::Vec;
use rpi_device::NoDevices;
use rpi_image::{Role, StateSize, Type, Value};

/// Returns the values of the out-ports of a primitive for constant in-ports. `outputs` are the types of the out-ports.
///
/// Returns `None` if the result may be absent, or depends on more than in-ports and parameters. The latter is detected
/// by a comparison of the results at two different times.
///
/// # Errors
/// Returns the fault that the primitive raises on these values.
#[must_use]
pub fn fold(
    prim: PrimId,
    inputs: &[&Value],
    params: &[Value],
    outputs: &[Type],
) -> Option<Result<Vec<Value>, FaultCode>> {
    let desc = prim.desc();
    if desc.role != Role::Compute || !matches!(desc.state, StateSize::None) {
        return None;
    }
    let code = prim.prim().total?;
    let mut memory = Memory::default();
    for value in inputs.iter().copied().chain(params) {
        memory.operand(value.ty(), value.slots());
    }
    let first = memory.cells.len();
    for ty in outputs {
        memory.operand(Some(*ty), Value::neutral(*ty).slots());
    }
    let Memory { mut cells, words } = memory;
    let mut others = cells.clone();
    let fault = run(code, &mut cells, &words, TIMES[0]);
    let other = run(code, &mut others, &words, TIMES[1]);
    let same = fault == other && cells[first..] == others[first..];
    same.then(|| match fault {
        Some(code) => Err(code),
        None => Ok(results(&cells[first..], outputs)),
    })
}

/// Runs the code of a primitive once, on the memory `cells` with the operands `words`, in a cycle with the times
/// `clock`. Returns the fault that it raises; `None` without a fault.
fn run(code: RunFn, cells: &mut [u64], words: &[u32], clock: CycleTime) -> Option<FaultCode> {
    let mut cx = Context {
        slots: cells,
        time: clock,
        devices: &mut NoDevices,
        fault: None,
    };
    code(&mut cx, words);
    cx.fault.map(|fault| fault.code)
}

/// Two cycle times that differ in every field, to detect results that depend on the time.
const TIMES: [CycleTime; 2] = [
    CycleTime {
        dt: 0.001,
        // The shortest and the longest tick: a number of ticks that is equal for both is equal for all.
        tick_ns: 1,
        period_ticks: 1_000_000,
        cycle_index: 0,
        net_ns: 0,
        wall_ns: 0,
    },
    CycleTime {
        dt: 0.01,
        tick_ns: 3_600_000_000_000,
        period_ticks: 1,
        cycle_index: 7,
        net_ns: 70_000_000,
        wall_ns: 71_000_000,
    },
];

/// Memory slots and operand words for one call of a primitive at compile time.
#[derive(Default)]
struct Memory {
    cells: Vec<u64>,
    words: Vec<u32>,
}

impl Memory {
    /// Appends an operand with the slots `cells` to the call. `ty` is `None` for a text, which has no slots and no
    /// operand word.
    fn operand(&mut self, ty: Option<Type>, cells: &[u64]) {
        let Some(ty) = ty else {
            return;
        };
        self.words
            .push(u32::try_from(self.cells.len()).unwrap_or(u32::MAX));
        match ty {
            Type::Scalar(_) => {}
            Type::Array(_, n) => self.words.push(n),
            Type::Matrix(rows, cols) => self.words.extend([rows, cols]),
        }
        self.cells.extend_from_slice(cells);
    }
}

fn results(mut cells: &[u64], outputs: &[Type]) -> Vec<Value> {
    let mut values = Vec::with_capacity(outputs.len());
    for ty in outputs {
        let (own, rest) = cells.split_at(ty.slots() as usize);
        values.push(Value::Slots {
            ty: *ty,
            cells: own.into(),
        });
        cells = rest;
    }
    values
}

#[cfg(test)]
mod tests {
    use super::*;
    use rpi_image::Scalar;

    fn folded(name: &str, inputs: &[Value], out: Scalar) -> Option<Result<Value, FaultCode>> {
        let inputs: Vec<&Value> = inputs.iter().collect();
        let result = fold(PrimId::from_name(name)?, &inputs, &[], &[Type::Scalar(out)])?;
        Some(result.map(|values| values[0].clone()))
    }

    #[test]
    fn pure_primitives_fold() {
        let sum = folded(
            "Core::DoubleAdd",
            &[Value::real(1.0), Value::real(2.0)],
            Scalar::Real,
        );
        assert_eq!(sum, Some(Ok(Value::real(3.0))));
        let ones = [Value::bool(true), Value::bool(false)];
        assert_eq!(
            folded("Core::BooleanAnd", &ones, Scalar::Bool),
            Some(Ok(Value::bool(false)))
        );
    }

    #[test]
    fn faults_are_told() {
        let by_zero = folded(
            "Core::IntDivide",
            &[Value::int(1), Value::int(0)],
            Scalar::Int,
        );
        assert_eq!(by_zero, Some(Err(FaultCode::DivisionByZero)));
    }

    #[test]
    fn state_and_clocks_do_not_fold() {
        let clock = [Value::bool(false), Value::real(1.0)];
        assert_eq!(folded("Core::Clock", &clock, Scalar::Real), None);
        assert_eq!(folded("Core::CycleTime", &[], Scalar::Real), None);
        let pose = Value::neutral(Type::Scalar(Scalar::Pose));
        let mut moved = pose.clone();
        if let Value::Slots { cells, .. } = &mut moved {
            cells[0] = 1.0f64.to_bits();
        }
        assert_eq!(
            folded("World::TwistFromFrames", &[pose, moved], Scalar::Twist),
            None
        );
    }
}
