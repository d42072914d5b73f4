//! The clock calculus: in which cycles of its unit each expression has a value.
//!
//! A clock is all cycles of the unit, or those of another clock in which a flow has a value (`x when c`). Operands of an
//! operator have one clock; outside Lustre those of slower ones may be absent where they meet. `merge` and `current` lead
//! back to the clock that was sampled. A call has a clock of its own to which the clocks of the callee's ports are
//! relative. Clocks are inferred by unification; two that do not meet are reported, both named. After Caspi and Pouzet,
//! Synchronous Kahn networks (1996), with the names of Lustre V6: a constant has every clock.
//!
//! | file | idea |
//! |---|---|
//! | `terms.rs` | clocks on their way |
//! | `infer.rs` | expressions and equations |
//! | `lift.rs` | operands of other clocks, which may be absent |
//! | `order.rs` | equations behind those that they read |
//! | `calls.rs` | clocks of ports seen by the caller |
//! | `targets.rs` | what equations give their clocks to |
//! | `covered.rs` | whether something around a place has been told |

mod calls;
mod covered;
mod infer;
mod lift;
mod order;
mod targets;
mod terms;

use crate::typed::{ClockOn, ExprId, FlowId, Kind, Unit};
use rpi_diag::Finding;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::ops::Range;

/// The clocks of a unit. Empty where nothing is sampled.
#[derive(Clone, Debug, Default)]
pub struct Clocks {
    exprs: Vec<Vec<ClockOn>>,
    values: Vec<Vec<ClockOn>>,
    flows: Vec<Vec<ClockOn>>,
    /// Expressions of which leaves are read by a faster clock.
    lifted: BTreeMap<ExprId, Vec<Lifted>>,
}

/// Leaves of a value that are read by a faster clock than theirs, and so are optional there.
#[derive(Clone, Debug)]
pub struct Lifted {
    /// Which leaves.
    pub leaves: Range<usize>,
    /// Their clock.
    own: Vec<ClockOn>,
    /// How many of its samplings the reader's clock has, too.
    outer: usize,
}

impl Lifted {
    /// The clock of the reader.
    #[must_use]
    pub fn outer(&self) -> &[ClockOn] {
        &self.own[..self.outer]
    }

    /// What the leaves are sampled by beyond that.
    #[must_use]
    pub fn beyond(&self) -> &[ClockOn] {
        &self.own[self.outer..]
    }
}

impl Clocks {
    /// Whether something is sampled.
    #[must_use]
    pub fn any(&self) -> bool {
        !self.exprs.is_empty()
    }

    /// The clock by which an expression is computed: what is sampled one after the other, from all cycles of the unit on.
    #[must_use]
    pub fn of_expr(&self, id: ExprId) -> &[ClockOn] {
        self.exprs.get(id.0 as usize).map_or(&[], Vec::as_slice)
    }

    /// The clock of an expression's value; a call may give values of other clocks than its own.
    #[must_use]
    pub fn of_value(&self, id: ExprId) -> &[ClockOn] {
        self.values.get(id.0 as usize).map_or(&[], Vec::as_slice)
    }

    /// What the clock of an operand is sampled by beyond what the clock of the operator that reads it has in common with it.
    #[must_use]
    pub fn beyond(&self, operand: ExprId, reader: ExprId) -> &[ClockOn] {
        let (own, read) = (self.of_value(operand), self.of_expr(reader));
        let common = own.iter().zip(read).take_while(|(a, b)| a == b);
        &own[common.count()..]
    }

    /// The leaves of an expression that are read by a faster clock.
    #[must_use]
    pub fn lifted(&self, id: ExprId) -> &[Lifted] {
        self.lifted.get(&id).map_or(&[], Vec::as_slice)
    }

    /// The clock of a flow.
    #[must_use]
    pub fn of_flow(&self, id: FlowId) -> &[ClockOn] {
        self.flows.get(id.0 as usize).map_or(&[], Vec::as_slice)
    }
}

/// The clocks of a unit, and where they do not meet.
#[must_use]
pub fn find(units: &[Unit], unit: &Unit) -> (Clocks, Vec<Finding>) {
    match unit.has_clocks || calls_sampled(units, unit) {
        true => infer::infer(units, unit),
        false => (Clocks::default(), Vec::new()),
    }
}

/// Whether a unit calls one with sampled ports.
fn calls_sampled(units: &[Unit], unit: &Unit) -> bool {
    unit.exprs.iter().any(|expr| match &expr.kind {
        Kind::Call(call) => {
            let callee = &units[call.unit.0 as usize];
            let mut ports = callee.inputs.iter().chain(&callee.outputs);
            ports.any(|port| callee.flow(*port).clock.is_some())
        }
        _ => false,
    })
}

/// A clock as it is written, `when c when not d`; nothing for all cycles.
#[must_use]
pub fn print(unit: &Unit, clock: &[ClockOn]) -> String {
    let mut text = String::new();
    for on in clock {
        let _ = write!(text, " when {}", condition(unit, *on));
    }
    text.trim_start().to_owned()
}

/// The condition of a sampling: `c`, `not c`, `Value(c)`.
fn condition(unit: &Unit, on: ClockOn) -> String {
    let flow = unit.flow(on.flow);
    // What the compiler made of an argument is called like the port that it is for.
    let name = flow.name.split('#').next().unwrap_or_default();
    let value = usize::try_from(on.value).unwrap_or(usize::MAX);
    match &flow.ty {
        crate::ty::Ty::Enum(e) => match e.values.get(value) {
            Some(value) => format!("{value}({name})"),
            None => name.to_owned(),
        },
        _ if on.value == 0 => format!("not {name}"),
        _ => name.to_owned(),
    }
}
