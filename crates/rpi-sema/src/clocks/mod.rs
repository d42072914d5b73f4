//! Clock calculus: infers in which cycles of its unit each leaf of each expression has a value.
//!
//! A clock is either the base clock (all cycles of the unit) or a sampling of another clock by the value of a flow (`x
//! when c`). `T on c` is a subtype of `T?`: a flow has the clock of its defining expression, under any name and in any
//! variable, and is optional only for an operator that also reads a faster flow. The clock of an operator is therefore
//! the slowest clock from which the clocks of all its operands are sampled. A delay or an initialisation does not mix
//! clocks. The clocks are the greatest solution of these equations, which does not depend on their order. In Lustre,
//! operands of different clocks are an error. After Caspi and Pouzet, Synchronous Kahn Networks (1996), with the names
//! of Lustre V6. A constant has every clock.
//!
//! | file | idea |
//! |---|---|
//! | `clock.rs`, `leaf_clocks.rs` | clocks during inference; the clocks of a value, leaf by leaf |
//! | `solve.rs`, `calls.rs` | greatest solution; clocks of a callee's ports in the caller's terms |
//! | `canonical_condition.rs` | canonical names of deciding flows |
//! | `constants.rs` | constants take the clock of their readers |
//! | `check.rs`, `clock_help.rs`, `initialisation.rs`, `span_set.rs` | clock mismatches |
//! | `inactive_blocks.rs` | flows of blocks that may be inactive |

mod calls;
pub(crate) mod canonical_condition;
mod check;
mod clock;
mod clock_help;
pub(crate) mod constants;
pub(crate) mod inactive_blocks;
pub(crate) mod initialisation;
pub(crate) mod leaf_clocks;
mod rules;
mod solve;
pub(crate) mod span_set;

pub use crate::clocks::inactive_blocks::InactiveBlocks;
pub use crate::clocks::leaf_clocks::LeafClocks;
pub(crate) use calls::may_be_inactive;
pub use clock::{ClockCondition, Sampling};

use crate::facts::Facts;
use crate::hash::FastMap;
use crate::typed::TypedKind;
use crate::typed::{ExprId, FlowId, Unit};
use rpi_diag::Diagnostic;
use std::fmt::Write as _;
use std::rc::Rc;

/// Index of a clock in the table [`Clocks`] of a unit.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct ClockId(u32);

impl ClockId {
    /// Base clock, which ticks in all cycles of the unit.
    pub const BASE: ClockId = ClockId(0);
}

/// Clocks of all expressions and flows of a unit. Empty if no flow of the unit is sampled, so that all have values in
/// all cycles.
#[derive(Clone, Debug, Default)]
pub struct Clocks {
    /// For each clock, indexed by [`ClockId`], its samplings from the base clock of the unit on.
    paths: Vec<Vec<Sampling>>,
    exprs: Vec<LeafClocks<ClockId>>,
    flows: Vec<LeafClocks<ClockId>>,
    /// For each call expression, the clock on which the call runs.
    calls: FastMap<ExprId, ClockId>,
    /// Clock conditions of the unit's outputs, each with its own clock. Callers refer to them by their index in this
    /// list.
    exposed: Vec<(ClockCondition, ClockId)>,
    /// For each expression, whether it reads a flow of a block that may be inactive, from outside of the block.
    reads_inactive: Vec<bool>,
}

impl Clocks {
    /// Whether the unit has any sampled flow.
    #[must_use]
    pub fn has_samplings(&self) -> bool {
        !self.exprs.is_empty()
    }

    /// Returns the clocks of the leaves (scalar parts) of an expression.
    #[must_use]
    pub fn expr_clocks(&self, id: ExprId) -> LeafClocks<ClockId> {
        let known = self.exprs.get(id.0 as usize);
        known.cloned().unwrap_or(LeafClocks::Uniform(ClockId::BASE))
    }

    /// Returns the clock of the leaf (scalar part) with index `k` of an expression.
    #[must_use]
    pub fn leaf(&self, id: ExprId, k: usize) -> ClockId {
        let known = self.exprs.get(id.0 as usize);
        known.map_or(ClockId::BASE, |row| row.leaf(k))
    }

    /// Returns the clock on which an expression is evaluated. For a call, it may differ from the clocks of the results.
    #[must_use]
    pub fn computed_on(&self, id: ExprId) -> ClockId {
        match self.calls.get(&id) {
            Some(clock) => *clock,
            None => self.leaf(id, 0),
        }
    }

    /// Returns the clocks of the leaves (scalar parts) of a flow.
    #[must_use]
    pub fn flow_clocks(&self, id: FlowId) -> LeafClocks<ClockId> {
        let known = self.flows.get(id.0 as usize);
        known.cloned().unwrap_or(LeafClocks::Uniform(ClockId::BASE))
    }

    /// Returns the samplings of a clock from the base clock on; empty for the base clock.
    #[must_use]
    pub fn path(&self, clock: ClockId) -> &[Sampling] {
        self.paths.get(clock.0 as usize).map_or(&[], Vec::as_slice)
    }

    /// Returns the samplings of `clock` that remain after those that it has in common with the clock `reader`.
    #[must_use]
    pub fn samplings_beyond(&self, clock: ClockId, reader: ClockId) -> &[Sampling] {
        let (own, read) = (self.path(clock), self.path(reader));
        let common = own.iter().zip(read).take_while(|(a, b)| a == b);
        &own[common.count()..]
    }

    /// Splits the clock of the operand of `x when c` into the samplings that it has in common with the clock of `c`,
    /// and the remaining ones. `value` is the operand `x`, `k` is the index of its leaf (scalar part), and `when` is
    /// the whole expression.
    #[must_use]
    pub fn split_operand_samplings(
        &self,
        value: ExprId,
        k: usize,
        when: ExprId,
    ) -> (&[Sampling], &[Sampling]) {
        let own = self.path(self.leaf(value, k));
        let of_when = self.path(self.leaf(when, 0));
        let decides = &of_when[..of_when.len().saturating_sub(1)];
        let common = own.iter().zip(decides).take_while(|(a, b)| a == b).count();
        own.split_at(common)
    }

    /// Whether a leaf (scalar part) on `clock` is optional for an expression on the clock `reader`: absent in cycles in
    /// which only `reader` ticks.
    #[must_use]
    pub fn is_slower(&self, clock: ClockId, reader: ClockId) -> bool {
        clock != reader && !self.samplings_beyond(clock, reader).is_empty()
    }

    /// Whether an expression reads a flow of a block that may be inactive, from outside of the block.
    #[must_use]
    pub fn reads_inactive_block(&self, id: ExprId) -> bool {
        self.reads_inactive
            .get(id.0 as usize)
            .copied()
            .unwrap_or(false)
    }

    /// Returns the clock conditions of the unit's outputs, each with its own clock. Callers refer to them by their
    /// index in this list.
    #[must_use]
    pub fn exposed(&self) -> &[(ClockCondition, ClockId)] {
        &self.exposed
    }
}

/// Infers the clocks of a unit and reports mismatches. `units` are all units of the program, and `facts` are the
/// results of the analysis for the units that this unit calls.
#[must_use]
pub fn infer(units: &[Rc<Unit>], facts: &[Rc<Facts>], unit: &Unit) -> (Clocks, Vec<Diagnostic>) {
    match unit.has_clocks || calls_sampled(units, facts, unit) {
        true => solve::solve(units, facts, unit),
        false => (Clocks::default(), Vec::new()),
    }
}

/// Whether a unit calls a unit with sampled ports.
fn calls_sampled(units: &[Rc<Unit>], facts: &[Rc<Facts>], unit: &Unit) -> bool {
    unit.exprs.iter().any(|expr| match &expr.kind {
        TypedKind::Call(call) => {
            let callee = &units[call.unit.0 as usize];
            let mut ports = callee.inputs.iter().chain(&callee.outputs);
            let exposed = &facts[call.unit.0 as usize].clocks.exposed;
            !exposed.is_empty() || ports.any(|port| callee.flow(*port).clock.is_some())
        }
        _ => false,
    })
}

/// Returns a clock in the syntax of the source, such as `when c when not d`; empty for the base clock. `path` is the
/// clock as samplings from the base clock on.
#[must_use]
pub fn format_clock(
    units: &[Rc<Unit>],
    facts: &[Rc<Facts>],
    unit: &Unit,
    path: &[Sampling],
) -> String {
    let mut text = String::new();
    for tick in path {
        let _ = write!(
            text,
            " when {}",
            format_condition(units, facts, unit, *tick)
        );
    }
    text.trim_start().to_owned()
}

/// Returns the condition of a sampling in the syntax of the source: `c`, `not c` or `Value(c)`. A condition inside of a
/// call is named after the called unit: `Call.c`.
fn format_condition(
    units: &[Rc<Unit>],
    facts: &[Rc<Facts>],
    unit: &Unit,
    tick: Sampling,
) -> String {
    let ClockCondition::Flow(flow) = tick.condition else {
        return format_call_condition(units, facts, unit, tick);
    };
    let flow = unit.flow(flow);
    // A flow made by the compiler for an argument is named `port#n`; only the port's name is shown.
    let name = flow.name.split('#').next().unwrap_or_default();
    let value = usize::try_from(tick.value).unwrap_or(usize::MAX);
    match &flow.ty {
        crate::ty::Ty::Enum(e) => match e.values.get(value) {
            Some(value) => format!("{value}({name})"),
            None => name.to_owned(),
        },
        _ if tick.value == 0 => format!("not {name}"),
        _ => name.to_owned(),
    }
}

fn format_call_condition(
    units: &[Rc<Unit>],
    facts: &[Rc<Facts>],
    unit: &Unit,
    tick: Sampling,
) -> String {
    let ClockCondition::CallInternal(call, number) = tick.condition else {
        return String::new();
    };
    let TypedKind::Call(call) = &unit.expr(call).kind else {
        return String::new();
    };
    let (callee, clocks) = (
        &units[call.unit.0 as usize],
        &facts[call.unit.0 as usize].clocks,
    );
    let Some((by, _)) = clocks.exposed.get(number as usize) else {
        return callee.name.to_string();
    };
    let inner = format_condition(
        units,
        facts,
        callee,
        Sampling {
            condition: *by,
            ..tick
        },
    );
    match inner.strip_prefix("not ") {
        Some(inner) => format!("not {}.{inner}", callee.name),
        None => format!("{}.{inner}", callee.name),
    }
}
