//! Sampled flows: an expression on clock c is computed in a fragment that is active when c (M4).

use super::families::Family;
use super::scope::Scope;
use super::signal::{Signal, Wire, alias_of};
use super::{At, Elab, Mode, Sampled};
use crate::typed::{ClockOn, ExprId, FlowId};
use rpi_diag::Span;
use rpi_image::{Scalar, Type, Value};
use rpi_net::prim;
use rpi_net::{Activation, FragmentId, PortRef, Restart};

/// What a clock's fragments are known by: the fragment around them, the flow that decides, and for which value.
pub(super) type ClockKey = (FragmentId, Deciding, u32);

/// What decides whether a clock ticks.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub(super) enum Deciding {
    Flow(PortRef),
    /// The same in all cycles: a Boolean as 0 or 1, or the number of an enum's value.
    Constant(i64),
}

impl<'u> Elab<'u> {
    /// Where an expression is evaluated: in the fragment of its clock.
    pub(super) fn placed(&mut self, scope: &mut Scope<'u>, id: ExprId, at: At) -> At {
        let Some(facts) = self.facts_of(scope).filter(|facts| facts.clocks.any()) else {
            return at;
        };
        let span = scope.unit.expr(id).span;
        self.on_clock(scope, facts.clocks.of_expr(id), at, span)
    }

    /// A place in the fragment of a clock. A guard that lies around it counts there, too.
    pub(super) fn on_clock(
        &mut self,
        scope: &mut Scope<'u>,
        clock: &'u [ClockOn],
        at: At,
        span: Span,
    ) -> At {
        let fragment = self.clocked(scope, clock, at, span);
        let inside = fragment == at.fragment
            || self
                .net
                .enclosing(fragment)
                .any(|outer| outer == at.fragment);
        At {
            fragment,
            guard: at.guard.filter(|_| inside),
            side: at.side.filter(|_| inside),
        }
    }

    pub(super) fn facts_of(&self, scope: &Scope<'u>) -> Option<&'u crate::facts::Facts> {
        let facts = self.facts;
        scope.id.and_then(|unit| facts.get(unit.0 as usize))
    }

    /// The fragment of a clock, for an expression that stands at a place.
    fn clocked(
        &mut self,
        scope: &mut Scope<'u>,
        clock: &'u [ClockOn],
        place: At,
        span: Span,
    ) -> FragmentId {
        let mut fragment = scope.base;
        if self.mode != Mode::Constant {
            for on in clock {
                fragment = self.sampled(scope, *on, fragment, place, span);
            }
        }
        fragment
    }

    fn sampled(
        &mut self,
        scope: &mut Scope<'u>,
        on: ClockOn,
        parent: FragmentId,
        place: At,
        span: Span,
    ) -> FragmentId {
        let wire = self.flow(scope, on.flow, span);
        let deciding = match wire.first() {
            Some(Signal::Port(port)) => Some(Deciding::Flow(self.first_name(*port))),
            Some(Signal::Const(value)) => {
                let value = value.as_bool().map(i64::from).or(value.as_int());
                value.map(Deciding::Constant)
            }
            _ => None,
        };
        let key = deciding.map(|deciding| (parent, deciding, on.value));
        if let Some(fragment) = key.and_then(|key| self.known_clock(key, place)) {
            return fragment;
        }
        let at = At::fragment(parent);
        let condition = self.ticks(scope, on, at, span);
        let activation = self.when(&condition, at, span);
        let name = format!("{}@{}", scope.prefix, scope.unit.flow(on.flow).name);
        let fragment = self.ticking_by(&name, parent, activation, span);
        if let Some(key) = key {
            self.clocks.entry(key).or_default().push(fragment);
        }
        fragment
    }

    /// A fragment of a clock that there is already: any; or, if all in one would make a ring, only one around the place,
    /// so that each sampled expression has its own.
    fn known_clock(&self, key: ClockKey, place: At) -> Option<FragmentId> {
        let known = self.clocks.get(&key)?;
        let mut around = self.net.enclosing(place.fragment);
        match self.sampled {
            Sampled::Together => known.first().copied(),
            _ => around.find(|fragment| known.contains(fragment)),
        }
    }

    /// Where an equation of a node is evaluated that is called on a clock: in a fragment of its own, if all in one would
    /// make a ring.
    pub(super) fn apart(&mut self, at: At, span: Span) -> At {
        match self.sampled == Sampled::DelaysBeside && self.ticking.contains(&at.fragment) {
            true => At {
                fragment: self.like(at.fragment, span),
                ..at
            },
            false => at,
        }
    }

    /// One more fragment of the same clock.
    fn like(&mut self, fragment: FragmentId, span: Span) -> FragmentId {
        let known = &self.net.fragments[fragment.0 as usize];
        let parent = known.parent.unwrap_or(FragmentId::ROOT);
        let name = known.name.split('#').next().unwrap_or_default().to_owned();
        self.ticking_by(&name, parent, known.activation.clone(), span)
    }

    /// A fragment that is active while a clock ticks.
    fn ticking_by(
        &mut self,
        name: &str,
        parent: FragmentId,
        activation: Activation,
        span: Span,
    ) -> FragmentId {
        let path = format!("{name}#{}", self.net.fragments.len());
        let fragment = self.fragment(&path, parent, activation, Restart::Never, span);
        // Its author knows the flows in it, but not that there is a fragment around them.
        self.net.fragments[fragment.0 as usize].origin.flow = None;
        self.ticking.insert(fragment);
        fragment
    }

    /// `pre x` on a clock beside the fragment of that clock, so that it breaks rings through the fragment: what x was at
    /// the latest tick. None where there is nothing to be gained.
    pub(super) fn pre_beside(
        &mut self,
        scope: &mut Scope<'u>,
        operand: ExprId,
        id: ExprId,
        at: At,
    ) -> Option<Wire> {
        if self.sampled != Sampled::DelaysBeside || at.fragment == scope.base {
            return None;
        }
        let clock = self.facts_of(scope)?.clocks.of_expr(id);
        let span = scope.unit.expr(id).span;
        // The operand is not evaluated where it is read: there it would be part of the ring.
        let (wire, ticks, beside) = match clock.split_last() {
            Some((on, outer)) => {
                let beside = At::fragment(self.clocked(scope, outer, at, span));
                let wire = self.expr(scope, operand, beside);
                (wire, self.ticks(scope, *on, beside, span), beside)
            }
            None => {
                if !self.ticking.contains(&scope.base) {
                    return None;
                }
                let base = &self.net.fragments[scope.base.0 as usize];
                let parent = base.parent?;
                let Activation::When { condition, .. } = base.activation else {
                    return None;
                };
                let own = At::fragment(self.like(scope.base, span));
                let wire = self.expr(scope, operand, own);
                (wire, Signal::Port(condition), At::fragment(parent))
            }
        };
        let scalars = super::expr::leaf_scalars(&scope.unit.expr(id).ty);
        let absence = self.absence(scope, operand);
        let mut leaves = Vec::with_capacity(scalars.len());
        for (k, (signal, scalar)) in wire.iter().zip(scalars).enumerate() {
            let latch = (signal, scalar, &ticks);
            leaves.push(match absence.leaf(k) {
                true => self.latch(latch, None, beside, span),
                false => {
                    let none = Signal::Const(Value::neutral(Type::One(scalar)));
                    let latest = self.latch(latch, Some(&none), beside, span);
                    self.behind_first_tick(&latest, (&none, scalar), at.unguarded(), span)
                }
            });
        }
        Some(leaves.into())
    }

    /// By what a flow was known when something was sampled by it first: maybe before its equation was reached.
    fn first_name(&self, port: PortRef) -> PortRef {
        let mut name = port;
        while let Some(before) = self.names_before.get(&name)
            && alias_of(name).is_none_or(|alias| alias_of(*before) < Some(alias))
        {
            name = *before;
        }
        name
    }

    /// What a signal was when its clock ticked last before this cycle; until then `before`, or absent.
    fn latch(
        &mut self,
        (signal, scalar, ticks): (&Signal, Scalar, &Signal),
        before: Option<&Signal>,
        at: At,
        span: Span,
    ) -> Signal {
        let held = self.new_alias(scalar);
        let family = match before {
            Some(_) => Family::Pre,
            None => Family::OptionalPre,
        };
        let mut latest = self.delay(family, scalar, &Signal::Port(held), at, span);
        if let Some(before) = before {
            let first = self.first(at.fragment, span);
            let inputs = [first, before.clone(), latest];
            latest = self.family(Family::Conditional, scalar, &inputs, at, span);
        }
        let inputs = [ticks.clone(), signal.clone(), latest.clone()];
        let next = self.family(Family::Conditional, scalar, &inputs, at, span);
        self.bind_alias(held, &next);
        latest
    }

    /// A value that is there from the second tick of a fragment on: at the first it is that of a delay, which has none.
    fn behind_first_tick(
        &mut self,
        latest: &Signal,
        (any, scalar): (&Signal, Scalar),
        at: At,
        span: Span,
    ) -> Signal {
        let undefined = self.delay(Family::Pre, scalar, any, at, span);
        let inputs = [self.first(at.fragment, span), undefined, latest.clone()];
        self.family(Family::Conditional, scalar, &inputs, at, span)
    }

    /// Whether the flow that decides has the value.
    fn ticks(&mut self, scope: &mut Scope<'u>, on: ClockOn, at: At, span: Span) -> Signal {
        let wire = self.flow(scope, on.flow, span);
        let deciding = wire.first().cloned().unwrap_or(Signal::Absent);
        match (scope.unit.flow(on.flow).ty.scalar(), on.value) {
            (Some(Scalar::Bool), 0) => {
                self.simple(prim!("Core::BooleanNot"), &[deciding], at, span)
            }
            (Some(Scalar::Bool), _) => deciding,
            _ => {
                let value = Signal::Const(Value::int(on.value.into()));
                self.simple(prim!("Core::IntEquals"), &[deciding, value], at, span)
            }
        }
    }

    /// `merge c (...)`: a choice by the flow that decides. The other cases are not there.
    pub(super) fn merge(
        &mut self,
        scope: &mut Scope<'u>,
        on: ExprId,
        cases: &'u [(u32, ExprId)],
        id: ExprId,
        at: At,
    ) -> Wire {
        let span = scope.unit.expr(id).span;
        let scalars = super::expr::leaf_scalars(&scope.unit.expr(id).ty);
        let is_truth = scope.unit.expr(on).ty.scalar() == Some(Scalar::Bool);
        let deciding = self.one(scope, on, at);
        let Some(((_, last), others)) = cases.split_last() else {
            return super::signal::nothing();
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

    /// `current x`: x where its clock ticks, else what it was at the last tick.
    pub(super) fn current(
        &mut self,
        scope: &mut Scope<'u>,
        operand: ExprId,
        at: At,
        span: Span,
    ) -> Wire {
        let wire = self.expr(scope, operand, at.unguarded());
        let clock = self
            .facts_of(scope)
            .map(|facts| facts.clocks.of_value(operand));
        let Some(on) = clock.and_then(|clock| clock.last()).copied() else {
            return wire;
        };
        let scalars = super::expr::leaf_scalars(&scope.unit.expr(operand).ty);
        let before = match scope.unit.is_lustre {
            true => Family::Pre,
            false => Family::OptionalPre,
        };
        let ticks = self.ticks(scope, on, at, span);
        let mut leaves = Vec::with_capacity(scalars.len());
        for (signal, scalar) in wire.iter().zip(scalars) {
            let result = self.new_alias(scalar);
            let before = self.delay(before, scalar, &Signal::Port(result), at, span);
            let inputs = [ticks.clone(), signal.clone(), before];
            let held = self.family(Family::Conditional, scalar, &inputs, at, span);
            self.bind_alias(result, &held);
            leaves.push(held);
        }
        leaves.into()
    }

    /// An out-port of what is run, absent where its clock does not tick.
    pub(super) fn off_clock_absent(
        &mut self,
        scope: &mut Scope<'u>,
        flow: FlowId,
        wire: &Wire,
        span: Span,
    ) -> Wire {
        let clock = self
            .facts_of(scope)
            .map_or(&[][..], |f| f.clocks.of_flow(flow));
        let scalars = super::expr::leaf_scalars(&scope.unit.flow(flow).ty);
        self.absent_beside(scope, clock, (wire, &scalars), At::ROOT, span)
    }

    /// An operand for an operator that looks at its presence: absent where its clock does not tick and the operator's
    /// does.
    pub(super) fn read_by(
        &mut self,
        scope: &mut Scope<'u>,
        [reader, operand]: [ExprId; 2],
        scalars: &[Scalar],
        at: At,
    ) -> Wire {
        let wire = self.wide(scope, operand, scalars.len(), at);
        let clock = self
            .facts_of(scope)
            .map_or(&[][..], |f| f.clocks.beyond(operand, reader));
        let span = scope.unit.expr(operand).span;
        self.absent_beside(scope, clock, (&wire, scalars), at, span)
    }

    /// A value whose reader has a faster clock, or parts of it: absent where its own does not tick.
    pub(super) fn lifted(&mut self, scope: &mut Scope<'u>, id: ExprId, wire: Wire, at: At) -> Wire {
        let facts = self.facts_of(scope);
        let lifts = facts.map_or(&[][..], |facts| facts.clocks.lifted(id));
        if lifts.is_empty() {
            return wire;
        }
        let expr = scope.unit.expr(id);
        let scalars = super::expr::leaf_scalars(&expr.ty);
        let mut signals = wire.to_vec();
        for lift in lifts {
            let at = At::fragment(self.clocked(scope, lift.outer(), at, expr.span));
            let [start, end] = [lift.leaves.start, lift.leaves.end].map(|at| at.min(signals.len()));
            let leaves = start..end;
            let part: Wire = signals[leaves.clone()].iter().cloned().collect();
            let scalars = scalars.get(leaves.clone()).unwrap_or_default();
            let part = self.absent_beside(scope, lift.beyond(), (&part, scalars), at, expr.span);
            for (signal, lifted) in signals[leaves].iter_mut().zip(part.iter()) {
                *signal = lifted.clone();
            }
        }
        signals.into()
    }

    /// A value, absent where one of these clocks, each within the one before, does not tick.
    fn absent_beside(
        &mut self,
        scope: &mut Scope<'u>,
        clock: &[ClockOn],
        (wire, scalars): (&Wire, &[Scalar]),
        at: At,
        span: Span,
    ) -> Wire {
        if clock.is_empty() {
            return wire.clone();
        }
        let mut active = Signal::Const(Value::bool(true));
        for on in clock.iter().rev() {
            let ticks = self.ticks(scope, *on, at, span);
            let no = Signal::Const(Value::bool(false));
            let inputs = [ticks, active, no];
            active = self.family(Family::Conditional, Scalar::Bool, &inputs, at, span);
        }
        let off = self.simple(prim!("Core::BooleanNot"), &[active], at, span);
        let leaves = wire.iter().zip(scalars).map(|(signal, scalar)| {
            let inputs = [signal.clone(), off.clone()];
            self.family(Family::SetNull, *scalar, &inputs, at, span)
        });
        leaves.collect()
    }
}
