//! Elaborates sampled flows: an expression on clock c is computed in a fragment that is active when c (M4). This
//! fragment is not in the source, so dependencies are those of the single operations in it (M5).

use crate::clocks::{ClockId, Decider, Row, Tick};
use crate::elab::families::Family;
use crate::elab::scope::Scope;
use crate::elab::signal::{Signal, Wire};
use crate::elab::{At, Elab, Mode};
use crate::facts::Facts;
use crate::typed::{Equation, ExprId, FlowId, Kind, Place, UnitId};
use rpi_diag::Span;
use rpi_image::{Scalar, Value};
use rpi_net::prim;
use rpi_net::{FragmentId, PortRef, Restart};

/// Key of a clock's fragment: the parent fragment, the decider and its value.
pub(in crate::elab) type ClockKey = (FragmentId, Deciding, u32);

/// Signal that decides whether a clock ticks.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub(in crate::elab) enum Deciding {
    Flow(PortRef),
    /// Constant decider: a Boolean as 0 or 1, or the index of an enum's value.
    Constant(i64),
}

/// Positions where the leaves of an expression are computed.
pub(in crate::elab) enum LeafPlaces {
    All(At),
    Each(Vec<At>),
}

impl LeafPlaces {
    pub(in crate::elab) fn at(&self, k: usize) -> At {
        match self {
            LeafPlaces::All(at) => *at,
            LeafPlaces::Each(places) => places[k.min(places.len() - 1)],
        }
    }
}

impl<'u> Elab<'u> {
    /// Returns the position where an expression is evaluated: in the fragment of its clock.
    pub(in crate::elab) fn placed(&mut self, scope: &mut Scope<'u>, id: ExprId, at: At) -> At {
        match self.clocked_facts(scope) {
            Some(facts) => self.place(scope, facts.clocks.place(id), at),
            None => at,
        }
    }

    /// Returns the positions of the leaves of an elementwise expression. `at` is the position of its first leaf.
    pub(in crate::elab) fn leaf_places(
        &mut self,
        scope: &mut Scope<'u>,
        id: ExprId,
        at: At,
    ) -> LeafPlaces {
        let row = self.clocked_facts(scope).map(|facts| facts.clocks.row(id));
        match row {
            None | Some(Row::All(_)) => LeafPlaces::All(at),
            Some(Row::Each(leaves)) => {
                let place = |clock: &ClockId| self.place(scope, *clock, at);
                LeafPlaces::Each(leaves.iter().map(place).collect())
            }
        }
    }

    /// Returns the position in the fragment of a clock. The guard of `at` is kept if the fragment lies inside that of
    /// `at`.
    pub(in crate::elab) fn place(&mut self, scope: &mut Scope<'u>, clock: ClockId, at: At) -> At {
        let fragment = self.clock_fragment(scope, clock);
        let mut around = self.net.enclosing(fragment);
        let inside = fragment == at.fragment || around.any(|outer| outer == at.fragment);
        At {
            fragment,
            guard: at.guard.filter(|_| inside),
            side: at.side.filter(|_| inside),
        }
    }

    pub(in crate::elab) fn facts_of(&self, scope: &Scope<'u>) -> Option<&'u Facts> {
        let facts = self.facts;
        scope.id.and_then(|unit| facts.get(unit.0 as usize))
    }

    /// Returns the facts of a unit that has sampled flows; none for other units and for constants.
    pub(in crate::elab) fn clocked_facts(&self, scope: &Scope<'u>) -> Option<&'u Facts> {
        let facts = self.facts_of(scope).filter(|facts| facts.clocks.any());
        facts.filter(|_| self.mode != Mode::Constant)
    }

    /// Returns the fragment of a clock in the block that is being elaborated, creating it if necessary.
    fn clock_fragment(&mut self, scope: &mut Scope<'u>, clock: ClockId) -> FragmentId {
        let Some(facts) = self.clocked_facts(scope).filter(|_| clock != ClockId::BASE) else {
            return scope.base;
        };
        let key = (scope.base, clock);
        if let Some(known) = scope.clocks.get(&key) {
            return *known;
        }
        let mut fragment = scope.base;
        for tick in facts.clocks.path(clock) {
            fragment = self.sampled(scope, *tick, fragment);
        }
        scope.clocks.insert(key, fragment);
        fragment
    }

    fn sampled(&mut self, scope: &mut Scope<'u>, tick: Tick, parent: FragmentId) -> FragmentId {
        let (span, name) = self.written(scope, tick.by);
        let deciding = match self.deciding(scope, tick.by, span) {
            Signal::Port(port) => Some(Deciding::Flow(self.first_name(port))),
            Signal::Const(value) => {
                let value = value.as_bool().map(i64::from).or(value.as_int());
                value.map(Deciding::Constant)
            }
            _ => None,
        };
        let key = deciding.map(|deciding| (parent, deciding, tick.value));
        if let Some(known) = key.and_then(|key| self.clocks.get(&key)) {
            return *known;
        }
        let at = At::fragment(parent);
        let condition = self.ticks(scope, tick, at, span);
        let activation = self.when(&condition, at, span);
        let path = format!("{}@{name}#{}", scope.prefix, self.net.fragments.len());
        let fragment = self.fragment(&path, parent, activation, Restart::Never, span);
        let made = &mut self.net.fragments[fragment.0 as usize];
        made.is_clock = true;
        // The user knows the flows in this fragment but not the fragment, so it has no flow of its own.
        made.origin.flow = None;
        if let Some(key) = key {
            self.clocks.insert(key, fragment);
        }
        fragment
    }

    /// Returns the first port under which a flow was used as a decider, which may be an alias from before its equation
    /// was reached. Otherwise one clock would get two fragments.
    fn first_name(&self, port: PortRef) -> PortRef {
        use crate::elab::signal::alias_of;
        let mut name = port;
        while let Some(before) = self.names_before.get(&name)
            && alias_of(name).is_none_or(|alias| alias_of(*before) < Some(alias))
        {
            name = *before;
        }
        name
    }

    /// Returns the span and name of a decider in the source.
    fn written(&self, scope: &Scope<'u>, by: Decider) -> (Span, String) {
        match by {
            Decider::Flow(flow) => {
                let flow = scope.unit.flow(flow);
                (flow.span, flow.name.to_string())
            }
            Decider::Inside(call, number) => {
                (scope.unit.expr(call).span, format!("inside{number}"))
            }
        }
    }

    /// Returns the signal of a decider; an alias for a decider inside a call.
    fn deciding(&mut self, scope: &mut Scope<'u>, by: Decider, span: Span) -> Signal {
        match by {
            Decider::Flow(flow) => {
                let wire = self.flow(scope, flow, span);
                wire.first().cloned().unwrap_or(Signal::Absent)
            }
            Decider::Inside(call, number) => {
                let port = match scope.inside.get(&(call, number)) {
                    Some(port) => *port,
                    None => {
                        let scalar = self.scalar_inside(scope, by);
                        let port = self.new_alias(scalar);
                        scope.inside.insert((call, number), port);
                        port
                    }
                };
                Signal::Port(port)
            }
        }
    }

    /// Returns the machine type of a decider.
    fn scalar_inside(&self, scope: &Scope<'u>, by: Decider) -> Scalar {
        let (mut unit, mut by) = (scope.unit, by);
        loop {
            let (call, number) = match by {
                Decider::Flow(flow) => {
                    return unit.flow(flow).ty.scalar().unwrap_or(Scalar::Bool);
                }
                Decider::Inside(call, number) => (call, number),
            };
            let Kind::Call(call) = &unit.expr(call).kind else {
                return Scalar::Bool;
            };
            let exposed = self.facts[call.unit.0 as usize].clocks.exposed();
            let Some((inner, _)) = exposed.get(number as usize) else {
                return Scalar::Bool;
            };
            (unit, by) = (&self.units[call.unit.0 as usize], *inner);
        }
    }

    /// Returns the deciders that a unit exposes to its caller.
    pub(in crate::elab) fn expose(
        &mut self,
        scope: &mut Scope<'u>,
        id: UnitId,
        span: Span,
    ) -> Vec<Signal> {
        let facts = self.facts.get(id.0 as usize);
        let exposed = facts.map_or(&[][..], |facts| facts.clocks.exposed());
        let exposed = exposed.iter();
        exposed
            .map(|(by, _)| self.deciding(scope, *by, span))
            .collect()
    }

    /// Binds the aliases of the deciders inside a call.
    pub(in crate::elab) fn bind_inside(
        &mut self,
        scope: &mut Scope<'u>,
        call: ExprId,
        exposed: Vec<Signal>,
    ) {
        for (number, signal) in (0..).zip(exposed) {
            let by = Decider::Inside(call, number);
            if let Signal::Port(alias) = self.deciding(scope, by, Span::NONE) {
                self.bind_alias(alias, &signal);
            }
        }
    }

    /// Returns the condition under which a sampling ticks: the decider has its value.
    fn ticks(&mut self, scope: &mut Scope<'u>, tick: Tick, at: At, span: Span) -> Signal {
        let deciding = self.deciding(scope, tick.by, span);
        match (self.scalar_inside(scope, tick.by), tick.value) {
            (Scalar::Bool, 0) => self.simple(prim!("Core::BooleanNot"), &[deciding], at, span),
            (Scalar::Bool, _) => deciding,
            _ => {
                let value = Signal::Const(Value::int(tick.value.into()));
                self.simple(prim!("Core::IntEquals"), &[deciding, value], at, span)
            }
        }
    }

    /// Elaborates `merge c (...)` as a selection by the decider. Cases that are not selected are absent.
    pub(in crate::elab) fn merge(
        &mut self,
        scope: &mut Scope<'u>,
        on: ExprId,
        cases: &'u [(u32, ExprId)],
        id: ExprId,
        at: At,
    ) -> Wire {
        let span = scope.unit.expr(id).span;
        let scalars = crate::elab::expr::leaf_scalars(&scope.unit.expr(id).ty);
        let is_truth = scope.unit.expr(on).ty.scalar() == Some(Scalar::Bool);
        let deciding = self.operand_wire(scope, [id, on], at);
        let deciding = deciding.first().cloned().unwrap_or(Signal::Absent);
        let Some(((_, last), others)) = cases.split_last() else {
            return crate::elab::signal::nothing();
        };
        let mut chosen = self.wide(scope, *last, scalars.len(), at).to_vec();
        for (value, case) in others.iter().rev() {
            let wire = self.wide(scope, *case, scalars.len(), at);
            let here = match (is_truth, value) {
                (true, 0) => self.simple(
                    prim!("Core::BooleanNot"),
                    std::slice::from_ref(&deciding),
                    at,
                    span,
                ),
                (true, _) => deciding.clone(),
                _ => {
                    let value = Signal::Const(Value::int((*value).into()));
                    self.simple(
                        prim!("Core::IntEquals"),
                        &[deciding.clone(), value],
                        at,
                        span,
                    )
                }
            };
            for ((slot, signal), scalar) in chosen.iter_mut().zip(wire.iter()).zip(&scalars) {
                let inputs = [here.clone(), signal.clone(), slot.clone()];
                *slot = self.family(Family::Conditional, *scalar, &inputs, at, span);
            }
        }
        chosen.into()
    }

    /// Elaborates `current x`: x where its clock ticks, else its value at the last tick.
    pub(in crate::elab) fn current(
        &mut self,
        scope: &mut Scope<'u>,
        [id, operand]: [ExprId; 2],
        at: At,
    ) -> Wire {
        let wire = self.expr(scope, operand, at.unguarded());
        let Some(facts) = self.clocked_facts(scope) else {
            return wire;
        };
        let span = scope.unit.expr(id).span;
        let places = self.leaf_places(scope, id, at);
        let scalars = crate::elab::expr::leaf_scalars(&scope.unit.expr(operand).ty);
        let before = match scope.unit.is_lustre {
            true => Family::Pre,
            false => Family::OptionalPre,
        };
        let mut leaves = Vec::with_capacity(scalars.len());
        for (k, (signal, scalar)) in wire.iter().zip(scalars).enumerate() {
            let clock = facts.clocks.leaf(operand, k);
            let Some(tick) = facts.clocks.path(clock).last() else {
                leaves.push(signal.clone());
                continue;
            };
            let at = places.at(k);
            let ticks = self.ticks(scope, *tick, at, span);
            let result = self.new_alias(scalar);
            let before = self.delay(before, scalar, &Signal::Port(result), at, span);
            let inputs = [ticks, signal.clone(), before];
            let held = self.family(Family::Conditional, scalar, &inputs, at, span);
            self.bind_alias(result, &held);
            leaves.push(held);
        }
        leaves.into()
    }

    /// Returns a flow for a reader in all cycles of its block: absent where the flow's clock does not tick.
    pub(in crate::elab) fn off_clock_absent(
        &mut self,
        scope: &mut Scope<'u>,
        flow: FlowId,
        wire: &Wire,
        span: Span,
    ) -> Wire {
        let Some(facts) = self.clocked_facts(scope) else {
            return wire.clone();
        };
        let scalars = crate::elab::expr::leaf_scalars(&scope.unit.flow(flow).ty);
        let row = facts.clocks.flow(flow);
        let clocks = |k: usize| (row.leaf(k), ClockId::BASE);
        self.seen(scope, (wire, &scalars), clocks, span)
    }

    /// Returns an operand of a strict operator or call: absent where the operator's clock ticks and its own does not.
    pub(in crate::elab) fn operand_wire(
        &mut self,
        scope: &mut Scope<'u>,
        [reader, operand]: [ExprId; 2],
        at: At,
    ) -> Wire {
        let clock = match self.clocked_facts(scope) {
            Some(facts) => facts.clocks.place(reader),
            None => ClockId::BASE,
        };
        self.read_at(scope, operand, clock, at)
    }

    /// Returns an operand of an elementwise operator, leaf by leaf on the clock of the result.
    pub(in crate::elab) fn read_each(
        &mut self,
        scope: &mut Scope<'u>,
        [reader, operand]: [ExprId; 2],
        count: usize,
        at: At,
    ) -> Wire {
        let wire = self.wide(scope, operand, count, at);
        let Some(facts) = self.clocked_facts(scope) else {
            return wire;
        };
        let clocks = &facts.clocks;
        let pair = |k: usize| (clocks.leaf(operand, k), clocks.leaf(reader, k));
        let expr = scope.unit.expr(operand);
        let scalars = crate::elab::expr::leaf_scalars(&expr.ty);
        self.seen(scope, (&wire, &scalars), pair, expr.span)
    }

    /// Returns a value for a reader on one clock.
    pub(in crate::elab) fn read_at(
        &mut self,
        scope: &mut Scope<'u>,
        id: ExprId,
        clock: ClockId,
        at: At,
    ) -> Wire {
        let wire = self.expr(scope, id, at);
        let Some(facts) = self.clocked_facts(scope) else {
            return wire;
        };
        let expr = scope.unit.expr(id);
        let scalars = crate::elab::expr::leaf_scalars(&expr.ty);
        let pair = |k: usize| (facts.clocks.leaf(id, k), clock);
        self.seen(scope, (&wire, &scalars), pair, expr.span)
    }

    /// Returns the value of an equation on the clocks of its targets.
    pub(in crate::elab) fn taken(
        &mut self,
        scope: &mut Scope<'u>,
        equation: &'u Equation,
        wire: Wire,
    ) -> Wire {
        let Some(facts) = self.clocked_facts(scope) else {
            return wire;
        };
        let clocks = &facts.clocks;
        let mut wanted = Vec::with_capacity(wire.len());
        for target in &equation.targets {
            let row = match target.place {
                Place::Flow { flow, at } => (clocks.flow(flow), at as usize),
                _ => (Row::All(ClockId::BASE), 0),
            };
            let leaves = 0..target.ty.leaf_count();
            wanted.extend(leaves.map(|k| row.0.leaf(row.1 + k)));
        }
        let own = |k: usize| clocks.leaf(equation.value, k);
        let pair = |k: usize| (own(k), wanted.get(k).copied().unwrap_or(own(k)));
        let expr = scope.unit.expr(equation.value);
        let scalars = crate::elab::expr::leaf_scalars(&expr.ty);
        self.seen(scope, (&wire, &scalars), pair, expr.span)
    }

    /// Returns leaves of a value, each with its clock and its reader's clock as given by `clocks`. A leaf on a slower
    /// clock becomes absent where that clock does not tick.
    fn seen(
        &mut self,
        scope: &mut Scope<'u>,
        (wire, scalars): (&Wire, &[Scalar]),
        clocks: impl Fn(usize) -> (ClockId, ClockId),
        span: Span,
    ) -> Wire {
        let Some(facts) = self.clocked_facts(scope) else {
            return wire.clone();
        };
        let is_slower = |k: usize| {
            let (own, reader) = clocks(k);
            facts.clocks.is_slower(own, reader)
        };
        if !(0..wire.len()).any(is_slower) {
            return wire.clone();
        }
        let mut leaves = Vec::with_capacity(wire.len());
        let mut off: Option<((ClockId, ClockId), Signal)> = None;
        for (k, signal) in wire.iter().enumerate() {
            if !is_slower(k) {
                leaves.push(signal.clone());
                continue;
            }
            let pair = clocks(k);
            let at = At::fragment(self.clock_fragment(scope, pair.1));
            let known = off.take().filter(|(known, _)| *known == pair);
            let known = match known {
                Some((_, known)) => known,
                None => self.off(scope, facts.clocks.beyond(pair.0, pair.1), at, span),
            };
            let scalar = scalars.get(k).copied().unwrap_or(Scalar::Bool);
            let inputs = [signal.clone(), known.clone()];
            leaves.push(self.family(Family::SetNull, scalar, &inputs, at, span));
            off = Some((pair, known));
        }
        leaves.into()
    }

    /// Returns the operand of `when` where its clock meets that of the decider. Leaves on other clocks are optional
    /// there.
    pub(in crate::elab) fn sampled_value(
        &mut self,
        scope: &mut Scope<'u>,
        [id, value]: [ExprId; 2],
        at: At,
    ) -> Wire {
        let wire = self.expr(scope, value, at);
        let Some(facts) = self.clocked_facts(scope) else {
            return wire;
        };
        let expr = scope.unit.expr(value);
        let scalars = crate::elab::expr::leaf_scalars(&expr.ty);
        let mut leaves = Vec::with_capacity(wire.len());
        for (k, (signal, scalar)) in wire.iter().zip(scalars).enumerate() {
            let (common, beyond) = facts.clocks.beyond_sampled(value, k, id);
            if beyond.is_empty() {
                leaves.push(signal.clone());
                continue;
            }
            let mut fragment = scope.base;
            for tick in common {
                fragment = self.sampled(scope, *tick, fragment);
            }
            let at = At::fragment(fragment);
            let off = self.off(scope, beyond, at, expr.span);
            let inputs = [signal.clone(), off];
            leaves.push(self.family(Family::SetNull, scalar, &inputs, at, expr.span));
        }
        leaves.into()
    }

    /// Returns the condition that at least one of these nested samplings does not tick.
    fn off(&mut self, scope: &mut Scope<'u>, path: &[Tick], at: At, span: Span) -> Signal {
        let mut active = Signal::Const(Value::bool(true));
        for tick in path.iter().rev() {
            let ticks = self.ticks(scope, *tick, at, span);
            let no = Signal::Const(Value::bool(false));
            let inputs = [ticks, active, no];
            active = self.family(Family::Conditional, Scalar::Bool, &inputs, at, span);
        }
        self.simple(prim!("Core::BooleanNot"), &[active], at, span)
    }

    /// Returns a flow for readers outside its block: defined in all cycles of the block, absent where its clock does
    /// not tick. The aliases are bound at the end, when the fragment of the block exists.
    pub(in crate::elab) fn flow_outside(
        &mut self,
        scope: &mut Scope<'u>,
        flow: FlowId,
        span: Span,
    ) -> Wire {
        let facts = self.clocked_facts(scope);
        let is_base = |facts: &Facts| facts.clocks.flow(flow) == Row::All(ClockId::BASE);
        if facts.is_none_or(is_base) {
            return self.flow(scope, flow, span);
        }
        if let Some((_, known)) = scope.outside.iter().find(|(known, _)| *known == flow) {
            return known.clone();
        }
        let wire = self.alias_wire(&scope.unit.flow(flow).ty, span);
        scope.outside.push((flow, wire.clone()));
        wire
    }

    /// Binds the aliases of flows that are read outside their blocks.
    pub(in crate::elab) fn bind_outside(&mut self, scope: &mut Scope<'u>) {
        let around = scope.base;
        for (flow, aliases) in std::mem::take(&mut scope.outside) {
            let declared = scope.unit.flow(flow);
            let Some(fragment) = scope.fragment(declared.block) else {
                continue;
            };
            scope.base = fragment;
            self.begin(&format!("{}{}", scope.prefix, declared.name));
            let wire = self.flow(scope, flow, declared.span);
            let wire = self.off_clock_absent(scope, flow, &wire, declared.span);
            for (alias, signal) in aliases.iter().zip(wire.iter()) {
                if let Signal::Port(alias) = alias {
                    self.bind_alias(*alias, signal);
                }
            }
        }
        scope.base = around;
    }
}
