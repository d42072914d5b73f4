//! Whether a flow without declared type is a time or in seconds, where its equations leave both open: `t = 0[s]` in one state and
//! `t = last t + dt` in another, or `a = 5[s] -> pre b; b = a + dt`.
//!
//! What is fixed in seconds may be either. So a flow is a time if times go into it and nothing that is in seconds only, through whichever
//! flows; else it is in seconds. If that is another type than what was found, types are looked for once more, with this one known: the
//! order of the text decides nothing.

use super::body::Body;
use super::order::State;
use super::time::{SECONDS, is_fixed};
use crate::hash::Map;
use crate::ty::Ty;
use crate::typed::{Each, Expr, ExprId, FlowId, FlowRole, Kind, PrimCall, Unit};
use std::collections::BTreeMap;

/// How often types are looked for again; after the first time they only become seconds.
const ROUNDS: u32 = 4;

/// What goes into a flow.
#[derive(Default)]
struct Sources {
    time: bool,
    /// Seconds that are not fixed.
    seconds: bool,
    /// The flows, of those whose types are looked for, that read this one.
    readers: Vec<FlowId>,
    /// Those that it reads.
    reads: Vec<FlowId>,
    /// Whether it, or a version of it in a state, was taken as a time, and as seconds.
    taken: [bool; 2],
}

impl Body<'_, '_> {
    /// Finds the types of all flows that have none declared.
    pub(super) fn infer_with_times(&mut self) {
        let is_open =
            |k: &usize| self.pending[*k].state == State::Open && self.pending[*k].infers();
        let open: Vec<usize> = (0..self.pending.len()).filter(is_open).collect();
        let mut settled: Map<FlowId, Ty> = Map::default();
        for _ in 0..ROUNDS {
            let mark = self.mark();
            self.infer();
            if !self.has_times || !self.settle_mistaken(&open, &mut settled) {
                return;
            }
            self.put_back(mark);
            self.look_again(&open, &settled);
        }
        self.infer();
    }

    /// Adds what flows are that have been taken for something else; whether there are any.
    fn settle_mistaken(&self, open: &[usize], settled: &mut Map<FlowId, Ty>) -> bool {
        let mut all = self.sources(open, settled);
        spread_seconds(&mut all);
        spread_times(&mut all);
        let mut changed = false;
        for (flow, sources) in all {
            let is_time = sources.time && !sources.seconds && settled.get(&flow) != Some(&SECONDS);
            let ty = if is_time { Ty::Duration } else { SECONDS };
            if sources.taken[usize::from(is_time)] {
                changed |= settled.insert(flow, ty.clone()) != Some(ty);
            }
        }
        changed
    }

    /// What goes into each flow that may be either.
    fn sources(&self, open: &[usize], settled: &Map<FlowId, Ty>) -> BTreeMap<FlowId, Sources> {
        let mut all: BTreeMap<FlowId, Sources> = BTreeMap::new();
        let mut values: Vec<(FlowId, ExprId)> = Vec::new();
        for index in open {
            let pending = &self.pending[*index];
            let (State::Done(value), [Some(flow)]) = (pending.state, &pending.introduces[..])
            else {
                continue;
            };
            let outer = self.outermost(*flow);
            let types = [*flow, outer].map(|flow| &self.unit.flow(flow).ty);
            if types.into_iter().all(is_either) {
                let sources = all.entry(outer).or_default();
                sources.taken[0] |= types.contains(&&Ty::Duration);
                sources.taken[1] |= types.contains(&&SECONDS);
                // It was to be a time, and its value is none all the same.
                sources.seconds |= settled.get(&outer) == Some(&Ty::Duration)
                    && *self.ty_of(value) == SECONDS
                    && self.fixed_parts(value).is_none();
                values.push((outer, value));
            }
        }
        for (flow, value) in values {
            self.sources_of(flow, value, &mut all);
        }
        all
    }

    fn outermost(&self, flow: FlowId) -> FlowId {
        self.shared_around(flow).last().unwrap_or(flow)
    }

    fn sources_of(&self, flow: FlowId, value: ExprId, all: &mut BTreeMap<FlowId, Sources>) {
        let mut open = vec![value];
        while let Some(id) = open.pop() {
            let expr = self.unit.expr(id);
            match &expr.kind {
                Kind::Flow(read) if all.contains_key(&self.outermost(*read)) => {
                    let read = self.outermost(*read);
                    all.entry(read).or_default().readers.push(flow);
                    all.entry(flow).or_default().reads.push(read);
                    continue;
                }
                _ if goes_on(&self.unit, expr, &mut open) => continue,
                _ => {}
            }
            let sources = all.entry(flow).or_default();
            match expr.ty {
                Ty::Duration => sources.time = true,
                _ if is_time(&expr.kind) => sources.time = true,
                _ => sources.seconds |= !may_be_either(&self.unit, expr),
            }
        }
    }

    /// Forgets the types that were found, but for those that are settled.
    fn look_again(&mut self, open: &[usize], settled: &Map<FlowId, Ty>) {
        for index in open {
            self.pending[*index].state = State::Open;
            for flow in self.pending[*index]
                .introduces
                .clone()
                .into_iter()
                .flatten()
            {
                let around: Vec<FlowId> = self.shared_around(flow).collect();
                let outer = around.last().copied().unwrap_or(flow);
                let ty = settled.get(&outer).cloned().unwrap_or(Ty::Unknown);
                for flow in std::iter::once(flow).chain(around) {
                    self.unit.flows[flow.0 as usize].ty = ty.clone();
                }
            }
        }
    }
}

/// Seconds that go into a flow go into its readers.
fn spread_seconds(all: &mut BTreeMap<FlowId, Sources>) {
    let mut open = flows_with(all, |sources| sources.seconds);
    while let Some(flow) = open.pop() {
        for reader in neighbours(all, flow, |sources| &sources.readers) {
            if let Some(sources) = all.get_mut(&reader)
                && !std::mem::replace(&mut sources.seconds, true)
            {
                open.push(reader);
            }
        }
    }
}

/// So do times; and what is fixed is a time for a reader that is one.
fn spread_times(all: &mut BTreeMap<FlowId, Sources>) {
    let mut open = flows_with(all, |sources| sources.time && !sources.seconds);
    while let Some(flow) = open.pop() {
        let readers = neighbours(all, flow, |sources| &sources.readers);
        let read = neighbours(all, flow, |sources| &sources.reads);
        for other in readers.into_iter().chain(read) {
            if let Some(sources) = all.get_mut(&other)
                && !sources.seconds
                && !std::mem::replace(&mut sources.time, true)
            {
                open.push(other);
            }
        }
    }
}

fn flows_with(all: &BTreeMap<FlowId, Sources>, holds: fn(&Sources) -> bool) -> Vec<FlowId> {
    let found = all.iter().filter(|(_, sources)| holds(sources));
    found.map(|(flow, _)| *flow).collect()
}

fn neighbours(
    all: &BTreeMap<FlowId, Sources>,
    flow: FlowId,
    which: fn(&Sources) -> &Vec<FlowId>,
) -> Vec<FlowId> {
    all.get(&flow).map(which).cloned().unwrap_or_default()
}

/// Adds the operands that have the type of an expression; false if it has none.
fn goes_on(unit: &Unit, expr: &Expr, open: &mut Vec<ExprId>) -> bool {
    match &expr.kind {
        Kind::Part { base, .. } if is_either(&unit.expr(*base).ty) => open.push(*base),
        Kind::Each(Each::If, parts) => open.extend(parts.iter().skip(1)),
        Kind::Each(_, parts) => open.extend(parts),
        Kind::When { value, .. } | Kind::Current(value) => open.push(*value),
        Kind::Merge { cases, .. } => open.extend(cases.iter().map(|case| case.1)),
        Kind::Prim(call) if KEEPING.contains(&call.prim.desc().name) => {
            let inputs = call.inputs.iter().flatten();
            open.extend(inputs.filter(|id| is_either(&unit.expr(**id).ty)));
        }
        _ => return false,
    }
    true
}

/// Operators of which result and operands are of one kind, in ticks and in seconds.
const KEEPING: &[&str] = &[
    "Core::IntAdd",
    "Rpi::IntSubtract",
    "Rpi::IntModulo",
    "Rpi::IntNegate",
    "Core::IntMultiply",
    "Core::IntDivide",
    "Core::DoubleAdd",
    "Rpi::DoubleSubtract",
    "Core::DoubleModulo",
    "Rpi::DoubleNegate",
    "Rpi::SecondsFromTicks",
];

/// Whether seconds are a time of the core, converted.
fn is_time(kind: &Kind) -> bool {
    let name = |call: &PrimCall| call.prim.desc().name;
    matches!(kind, Kind::Prim(call) if matches!(name(call), "Core::CycleTime" | "Rpi::Time"))
}

/// Whether seconds may as well be ticks: they are fixed, or nothing is known of them.
fn may_be_either(unit: &Unit, expr: &Expr) -> bool {
    match &expr.kind {
        Kind::Literal(_) | Kind::Const(_) | Kind::Fault | Kind::None => true,
        Kind::Flow(flow) => unit.flow(*flow).role == FlowRole::Param || expr.ty.is_unknown(),
        Kind::Prim(call) => {
            call.prim.desc().name == "Rpi::WholeTicks" || is_fixed(unit, &expr.kind)
        }
        _ => expr.ty.is_unknown(),
    }
}

fn is_either(ty: &Ty) -> bool {
    *ty == Ty::Duration || *ty == SECONDS
}
