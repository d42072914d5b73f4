//! The clock calculus: in which cycles of its unit each leaf of each expression has a value.
//!
//! A clock is all cycles of the unit, or those of another clock in which a flow has a value (`x when c`). `T on c` is a
//! subtype of `T?`: a flow has the clock of its defining expression, whatever it is called and wherever it is kept, and
//! only an operator that reads it together with a faster one sees it as optional. So the clock of an operator is the
//! slowest that those of all its operands are sampled from; a delay or an initialisation does not mix clocks. The clocks
//! are the greatest solution of these equations, which does not depend on their order. In Lustre operands of different
//! clocks are an error. After Caspi and Pouzet, Synchronous Kahn networks (1996), with the names of Lustre V6: a constant
//! has every clock.
//!
//! | file | idea |
//! |---|---|
//! | `clock.rs`, `row.rs` | clocks being worked out; the clocks of a value, leaf by leaf |
//! | `solve.rs`, `calls.rs` | the greatest solution; clocks of ports as the caller sees them |
//! | `decider.rs` | one name for each flow that decides, whatever it is called |
//! | `place.rs` | constants take the clock of who reads them |
//! | `check.rs`, `mixed.rs`, `covered.rs` | clocks that do not meet |
//! | `borders.rs` | flows of blocks that may be inactive |

mod borders;
mod calls;
mod check;
mod clock;
mod covered;
mod decider;
mod mixed;
mod place;
mod row;
mod solve;

pub use borders::Borders;
pub(crate) use calls::may_be_inactive;
pub use clock::{Decider, Tick};
pub use row::Row;

use crate::facts::Facts;
use crate::hash::Map;
use crate::typed::{ExprId, FlowId, Kind, Unit};
use rpi_diag::Finding;
use std::fmt::Write as _;

/// Number of a clock of a unit.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct ClockId(u32);

impl ClockId {
    /// All cycles of the unit.
    pub const BASE: ClockId = ClockId(0);
}

/// The clocks of a unit. Empty where nothing is sampled.
#[derive(Clone, Debug, Default)]
pub struct Clocks {
    /// Of each clock what is sampled one after the other, from all cycles of the unit on.
    paths: Vec<Vec<Tick>>,
    exprs: Vec<Row<ClockId>>,
    flows: Vec<Row<ClockId>>,
    /// Of each call the clock by which it runs.
    calls: Map<ExprId, ClockId>,
    /// What decides about out-ports, with its clock.
    exposed: Vec<(Decider, ClockId)>,
    /// Reads of flows of blocks that may be inactive meanwhile.
    outside: Vec<bool>,
}

impl Clocks {
    /// Whether something is sampled.
    #[must_use]
    pub fn any(&self) -> bool {
        !self.exprs.is_empty()
    }

    /// The clocks of the leaves of an expression.
    #[must_use]
    pub fn row(&self, id: ExprId) -> Row<ClockId> {
        let known = self.exprs.get(id.0 as usize);
        known.cloned().unwrap_or(Row::All(ClockId::BASE))
    }

    /// The clock of a leaf of an expression.
    #[must_use]
    pub fn leaf(&self, id: ExprId, k: usize) -> ClockId {
        let known = self.exprs.get(id.0 as usize);
        known.map_or(ClockId::BASE, |row| row.leaf(k))
    }

    /// The clock by which an expression is computed that has one: a call may give values of other clocks than its own.
    #[must_use]
    pub fn place(&self, id: ExprId) -> ClockId {
        match self.calls.get(&id) {
            Some(clock) => *clock,
            None => self.leaf(id, 0),
        }
    }

    /// The clocks of the leaves of a flow.
    #[must_use]
    pub fn flow(&self, id: FlowId) -> Row<ClockId> {
        let known = self.flows.get(id.0 as usize);
        known.cloned().unwrap_or(Row::All(ClockId::BASE))
    }

    /// What a clock samples one after the other.
    #[must_use]
    pub fn path(&self, clock: ClockId) -> &[Tick] {
        self.paths.get(clock.0 as usize).map_or(&[], Vec::as_slice)
    }

    /// What a clock is sampled by beyond what it has in common with a reader's.
    #[must_use]
    pub fn beyond(&self, clock: ClockId, reader: ClockId) -> &[Tick] {
        let (own, read) = (self.path(clock), self.path(reader));
        let common = own.iter().zip(read).take_while(|(a, b)| a == b);
        &own[common.count()..]
    }

    /// For a leaf of what is sampled (`x when c`) the clock that it has in common with what decides, and what it is sampled
    /// by beyond that.
    #[must_use]
    pub fn beyond_sampled(&self, value: ExprId, k: usize, when: ExprId) -> (&[Tick], &[Tick]) {
        let own = self.path(self.leaf(value, k));
        let of_when = self.path(self.leaf(when, 0));
        let decides = &of_when[..of_when.len().saturating_sub(1)];
        let common = own.iter().zip(decides).take_while(|(a, b)| a == b).count();
        own.split_at(common)
    }

    /// Whether a reader of one clock sees a leaf of another as optional: it is absent where its clock does not tick.
    #[must_use]
    pub fn is_slower(&self, clock: ClockId, reader: ClockId) -> bool {
        clock != reader && !self.beyond(clock, reader).is_empty()
    }

    /// Whether an expression reads a flow of a block that may be inactive meanwhile.
    #[must_use]
    pub fn is_outside(&self, id: ExprId) -> bool {
        self.outside.get(id.0 as usize).copied().unwrap_or(false)
    }

    /// What decides about the clocks of the out-ports, with the clock of what decides.
    #[must_use]
    pub fn exposed(&self) -> &[(Decider, ClockId)] {
        &self.exposed
    }
}

/// The clocks of a unit, and where they do not meet. `facts` has those of the units that it calls.
#[must_use]
pub fn find(units: &[Unit], facts: &[Facts], unit: &Unit) -> (Clocks, Vec<Finding>) {
    match unit.has_clocks || calls_sampled(units, facts, unit) {
        true => solve::solve(units, facts, unit),
        false => (Clocks::default(), Vec::new()),
    }
}

/// Whether a unit calls one with sampled ports.
fn calls_sampled(units: &[Unit], facts: &[Facts], unit: &Unit) -> bool {
    unit.exprs.iter().any(|expr| match &expr.kind {
        Kind::Call(call) => {
            let callee = &units[call.unit.0 as usize];
            let mut ports = callee.inputs.iter().chain(&callee.outputs);
            let exposed = &facts[call.unit.0 as usize].clocks.exposed;
            !exposed.is_empty() || ports.any(|port| callee.flow(*port).clock.is_some())
        }
        _ => false,
    })
}

/// A clock as it is written, `when c when not d`; nothing for all cycles.
#[must_use]
pub fn print(units: &[Unit], facts: &[Facts], unit: &Unit, path: &[Tick]) -> String {
    let mut text = String::new();
    for tick in path {
        let _ = write!(text, " when {}", condition(units, facts, unit, *tick));
    }
    text.trim_start().to_owned()
}

/// The condition of a sampling: `c`, `not c`, `Value(c)`; what decides inside of a call is named after its unit, `Call.c`.
fn condition(units: &[Unit], facts: &[Facts], unit: &Unit, tick: Tick) -> String {
    let Decider::Flow(flow) = tick.by else {
        return inner_condition(units, facts, unit, tick);
    };
    let flow = unit.flow(flow);
    // What the compiler made of an argument is called like the port that it is for.
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

fn inner_condition(units: &[Unit], facts: &[Facts], unit: &Unit, tick: Tick) -> String {
    let Decider::Inside(call, number) = tick.by else {
        return String::new();
    };
    let Kind::Call(call) = &unit.expr(call).kind else {
        return String::new();
    };
    let (callee, clocks) = (
        &units[call.unit.0 as usize],
        &facts[call.unit.0 as usize].clocks,
    );
    let Some((by, _)) = clocks.exposed.get(number as usize) else {
        return callee.name.to_string();
    };
    let inner = condition(units, facts, callee, Tick { by: *by, ..tick });
    match inner.strip_prefix("not ") {
        Some(inner) => format!("not {}.{inner}", callee.name),
        None => format!("{}.{inner}", callee.name),
    }
}
