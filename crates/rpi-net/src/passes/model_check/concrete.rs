//! Concrete domain: computes cycles of a net over plain values with the code of the primitives. A value that depends on
//! something that cannot be computed here is marked as not exact.

use super::domain::{Domain, Flow, Source};
use super::double_order;
use crate::net::{Node, PortRef};
use rpi_image::{CommandFlow, Scalar, Type, Value};
use std::collections::BTreeMap;

/// Boolean in an execution with concrete values. If `exact` is false, the value is a guess, because it depends on a
/// primitive that is not modelled.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct ConcreteBool {
    pub(super) value: bool,
    pub(super) exact: bool,
}

/// Value in an execution with concrete values. If `exact` is false, the value is a guess, because it depends on a
/// primitive that is not modelled.
#[derive(Clone, Debug)]
pub(super) struct ConcreteValue {
    pub(super) value: Value,
    pub(super) exact: bool,
}

/// External inputs of a run, by source and index of the cycle (from 0); `None` if the input is absent in the cycle.
pub(super) type InputScript = BTreeMap<(Source, usize), Option<Value>>;

/// Values by type from which random inputs are derived: the constants of the net, near which its conditions change.
#[derive(Clone, Debug, Default)]
pub(super) struct BoundaryValues {
    pub(super) integers: Vec<i64>,
    pub(super) reals: Vec<f64>,
}

/// Pseudo-random number generator SplitMix64 (Steele et al. 2014).
#[derive(Clone, Debug)]
pub(super) struct Random(pub(super) u64);

impl Random {
    pub(super) fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Returns a pseudo-random number from 0 to `bound - 1`. The bound 0 counts as 1.
    pub(super) fn below(&mut self, bound: usize) -> usize {
        usize::try_from(self.next() % (bound.max(1) as u64)).unwrap_or(0)
    }

    fn pick<T: Copy>(&mut self, values: &[T]) -> Option<T> {
        values.get(self.below(values.len())).copied()
    }
}

/// Probability, in eighths, that an input has the value of the previous cycle in long runs.
pub(super) const LONG_RUN_HOLD: usize = 7;

/// Length of a tick in simulated runs, in nanoseconds: 1 ms, the default of a robot cell.
pub(super) const TICK_NS: u64 = 1_000_000;

/// Execution of a net with concrete values: the current cycle, the inputs so far, and the generator of missing inputs.
pub(super) struct ConcreteDomain<'a> {
    pub(super) cycle: usize,
    /// External inputs of the run so far. An input that is missing is generated when it is read.
    pub(super) script: InputScript,
    pub(super) random: Random,
    pub(super) pool: &'a BoundaryValues,
    /// Probability, in eighths, that a generated input has the value of the previous cycle.
    pub(super) hold_probability: usize,
    /// Whether a primitive has raised a fault since the start of the run.
    pub(super) is_faulty: bool,
    /// Whether generated inputs are neutral values, such as 0 and false, instead of random ones.
    pub(super) use_neutral_inputs: bool,
}

impl<'a> ConcreteDomain<'a> {
    pub(super) fn new(
        script: InputScript,
        seed: u64,
        pool: &'a BoundaryValues,
    ) -> ConcreteDomain<'a> {
        ConcreteDomain {
            cycle: 0,
            script,
            random: Random(seed),
            pool,
            hold_probability: 4,
            is_faulty: false,
            use_neutral_inputs: false,
        }
    }

    /// Returns a random value of a type: a constant of the net, or a value near one. Types other than Booleans,
    /// integers and reals give their neutral value.
    fn random_value(&mut self, ty: Type) -> Value {
        if self.use_neutral_inputs {
            return Value::neutral(ty);
        }
        match ty {
            Type::Scalar(Scalar::Bool) => Value::bool(self.random.below(2) == 1),
            Type::Scalar(Scalar::Int) => {
                let pool = self.pool;
                let base = self.random.pick(&pool.integers).unwrap_or(0);
                Value::int(match self.random.below(8) {
                    0 => base.saturating_neg(),
                    1 | 2 => base.saturating_sub(1),
                    3 | 4 => base.saturating_add(1),
                    _ => base,
                })
            }
            Type::Scalar(Scalar::Real) => {
                let pool = self.pool;
                Value::real(self.real(&pool.reals))
            }
            _ => Value::neutral(ty),
        }
    }

    fn real(&mut self, pool: &[f64]) -> f64 {
        let base = self.random.pick(pool).unwrap_or(0.0);
        let place = double_order::position(if base.is_nan() { 0.0 } else { base });
        match self.random.below(16) {
            0 => f64::NAN,
            1 | 2 => base + 1.0,
            3 | 4 => base - 1.0,
            // The adjacent doubles distinguish `<` from `<=`.
            5 => double_order::double_at((place + 1).min(double_order::max_position())),
            6 => double_order::double_at((place - 1).max(-double_order::max_position())),
            7 => -base,
            8 => base * 2.0,
            9 => base * 0.5,
            _ => base,
        }
    }

    fn read(&mut self, source: &Source, ty: Type, may_be_absent: bool) -> Option<Value> {
        let before = self.cycle.checked_sub(1);
        let before = before.and_then(|cycle| self.script.get(&(source.clone(), cycle)));
        let before = before.cloned();
        match source {
            Source::Core(CommandFlow::Time) => {
                let then = before.flatten().and_then(|v| v.as_real());
                return Some(Value::real(then.map_or(0.0, |then| self.later(then))));
            }
            Source::Core(CommandFlow::Elapsed) => {
                let then = before.flatten().and_then(|v| v.as_int());
                return Some(Value::int(then.map_or(0, |then| self.later_ticks(then))));
            }
            Source::Core(CommandFlow::Period) => return Some(Value::real(0.001)),
            Source::Core(CommandFlow::PeriodTicks) => return Some(Value::int(1)),
            Source::Core(CommandFlow::SpeedOverride) if self.use_neutral_inputs => {
                return Some(Value::real(1.0));
            }
            Source::Core(CommandFlow::SpeedOverride) => {
                let share = self.random.pick(&[0.0, 0.5, 1.0]);
                return Some(Value::real(share.unwrap_or(1.0)));
            }
            Source::Core(CommandFlow::Cancel) => {
                let was = before.flatten().and_then(|v| v.as_bool()) == Some(true);
                return Some(Value::bool(
                    was || (!self.use_neutral_inputs && self.random.below(8) == 0),
                ));
            }
            Source::Core(CommandFlow::Predecessor) if self.cycle > 0 => return before.flatten(),
            _ => {}
        }
        if let Some(before) = before
            && (self.use_neutral_inputs || self.random.below(8) < self.hold_probability)
        {
            return before;
        }
        let is_there = !may_be_absent || self.use_neutral_inputs || self.random.below(4) > 0;
        is_there.then(|| self.random_value(ty))
    }

    /// Returns a random time in seconds after the time `then`: one tick later, or a constant with which the net may
    /// compare times.
    fn later(&mut self, then: f64) -> f64 {
        let pool = self.pool;
        let next = then + 0.001;
        match self.random.pick(&pool.reals) {
            // In long runs time advances in single steps, so that late events are not preceded by the end of the
            // command.
            Some(constant)
                if !self.use_neutral_inputs
                    && self.hold_probability < LONG_RUN_HOLD
                    && constant >= next
                    && constant < 1e9 =>
            {
                match self.random.below(3) {
                    0 => constant,
                    1 => constant + 0.001,
                    _ => next,
                }
            }
            _ => next,
        }
    }
}

impl ConcreteDomain<'_> {
    fn later_ticks(&mut self, then: i64) -> i64 {
        let later = self.later(rpi_prims::seconds(then, TICK_NS));
        rpi_prims::whole_ticks(later, TICK_NS).max(then.saturating_add(1))
    }
}

/// Returns the output of a primitive that depends on the tick length; `None` for other primitives.
fn tick_operation(node: &Node, inputs: &[&Value]) -> Option<Value> {
    let input = inputs.first()?;
    match node.desc().name {
        "Rpi::WholeTicks" | "Rpi::TicksFromSeconds" => {
            let ticks = rpi_prims::whole_ticks(input.as_real()?, TICK_NS);
            Some(Value::int(ticks))
        }
        "Rpi::SecondsFromTicks" => {
            let seconds = rpi_prims::seconds(input.as_int()?, TICK_NS);
            Some(Value::real(seconds))
        }
        _ => None,
    }
}

impl Domain for ConcreteDomain<'_> {
    type Bool = ConcreteBool;
    type Value = ConcreteValue;

    fn bit(&self, value: bool) -> ConcreteBool {
        ConcreteBool { value, exact: true }
    }

    fn not(&mut self, a: ConcreteBool) -> ConcreteBool {
        ConcreteBool {
            value: !a.value,
            ..a
        }
    }

    fn and(&mut self, a: ConcreteBool, b: ConcreteBool) -> ConcreteBool {
        let refutes = |x: ConcreteBool| x.exact && !x.value;
        ConcreteBool {
            value: a.value && b.value,
            exact: (a.exact && b.exact) || refutes(a) || refutes(b),
        }
    }

    fn constant(&mut self, value: &Value) -> ConcreteValue {
        ConcreteValue {
            value: value.clone(),
            exact: true,
        }
    }

    fn boolean(&mut self, bit: ConcreteBool) -> ConcreteValue {
        ConcreteValue {
            value: Value::bool(bit.value),
            exact: bit.exact,
        }
    }

    fn truth(&mut self, value: &ConcreteValue) -> ConcreteBool {
        ConcreteBool {
            value: value.value.as_bool().unwrap_or(false),
            exact: value.exact,
        }
    }

    fn choose(
        &mut self,
        condition: ConcreteBool,
        yes: &ConcreteValue,
        no: &ConcreteValue,
    ) -> ConcreteValue {
        let chosen = if condition.value { yes } else { no };
        let same = || yes.exact && no.exact && yes.value == no.value;
        ConcreteValue {
            value: chosen.value.clone(),
            exact: (condition.exact && chosen.exact) || (!condition.exact && same()),
        }
    }

    fn source(&mut self, source: Source, ty: Type, may_be_absent: bool) -> Flow<Self> {
        let key = (source, self.cycle);
        let value = match self.script.get(&key).cloned() {
            Some(value) => value,
            None => self.read(&key.0, ty, may_be_absent),
        };
        self.script.insert(key, value.clone());
        Flow {
            present: self.bit(value.is_some()),
            value: ConcreteValue {
                value: value.unwrap_or_else(|| Value::neutral(ty)),
                exact: true,
            },
        }
    }

    fn apply(
        &mut self,
        node: &Node,
        inputs: &[ConcreteValue],
        runs: ConcreteBool,
    ) -> Vec<ConcreteValue> {
        if !runs.value {
            return neutral_outputs(node, runs.exact);
        }
        let exact = runs.exact && inputs.iter().all(|input| input.exact);
        let values: Vec<&Value> = inputs.iter().map(|input| &input.value).collect();
        if let Some(value) = tick_operation(node, &values) {
            return vec![ConcreteValue { value, exact }];
        }
        match rpi_prims::fold(node.prim, &values, &node.params, &node.outputs) {
            None => neutral_outputs(node, false),
            Some(Err(_)) => {
                self.is_faulty = true;
                neutral_outputs(node, exact)
            }
            Some(Ok(values)) => values
                .into_iter()
                .map(|value| ConcreteValue { value, exact })
                .collect(),
        }
    }

    fn unknown(
        &mut self,
        (port, node): (PortRef, &Node),
        _inputs: Option<&[Flow<Self>]>,
        surely: ConcreteBool,
        runs: ConcreteBool,
    ) -> Flow<Self> {
        let ty = node.outputs.get(usize::from(port.port)).copied();
        let value = self.random_value(ty.unwrap_or(Type::Scalar(Scalar::Bool)));
        let guess = ConcreteBool {
            value: self.random.below(2) == 1,
            exact: false,
        };
        let present = self.or(surely, guess);
        Flow {
            present: self.and(present, runs),
            value: ConcreteValue {
                value,
                exact: false,
            },
        }
    }
}

/// Returns the neutral value of each out-port of a primitive, such as 0 or false, for a primitive that does not compute
/// its outputs. `exact` is their exactness.
fn neutral_outputs(node: &Node, exact: bool) -> Vec<ConcreteValue> {
    let neutral = |ty: &Type| ConcreteValue {
        value: Value::neutral(*ty),
        exact,
    };
    node.outputs.iter().map(neutral).collect()
}
