//! Elaborates elementwise operators: `if`, `pre`, `->`, `??`, `hold`.

use crate::clocks::ClockId;
use crate::elab::clocks::LeafPlaces;
use crate::elab::expr::leaf_scalars;
use crate::elab::families::{Family, member};
use crate::elab::scope::Scope;
use crate::elab::signal::{Signal, Wire};
use crate::elab::{At, Elab, Mode, NotConstant};
use crate::typed::{Each, ExprId, Kind, Unit};
use rpi_diag::Span;
use rpi_image::{Scalar, Type, Value};
use rpi_net::prim;
use rpi_net::{FragmentId, Input, PortRef, Types};
use smallvec::smallvec;

impl<'u> Elab<'u> {
    pub(in crate::elab) fn each(
        &mut self,
        scope: &mut Scope<'u>,
        each: Each,
        operands: &'u [ExprId],
        id: ExprId,
        at: At,
    ) -> Wire {
        let unit = scope.unit;
        let (ty, span) = (&unit.expr(id).ty, unit.expr(id).span);
        match (each, operands) {
            (Each::If, [condition, yes, no]) => self.choice(scope, *condition, [*yes, *no], id, at),
            (Each::Pre, [x]) => self.pre(scope, *x, id, at),
            (Each::Last, [x]) => match self.level(scope, *x, at.fragment) {
                None => self.pre(scope, *x, id, at),
                Some(level) => {
                    if level != at.fragment {
                        // The usual fix for an uninitialised delay would be wrong here: `->` restarts with the state.
                        self.net.outer_delays.insert(span);
                    }
                    let around = std::mem::replace(&mut scope.base, level);
                    let wire = self.pre(scope, *x, id, At::fragment(level));
                    scope.base = around;
                    wire
                }
            },
            (Each::Arrow, [a, b]) => self.arrow(scope, *a, *b, id, at),
            (Each::Coalesce, [a, b]) => self.choice_by_presence(scope, [id, *a, *b], at),
            (Each::Hold, [x, init]) => {
                let (at, scalars) = (at.unguarded(), leaf_scalars(ty));
                let x = self.read_each(scope, [id, *x], scalars.len(), at);
                let init = self.read_each(scope, [id, *init], scalars.len(), at);
                let places = self.leaf_places(scope, id, at);
                let leaves = x.iter().zip(init.iter()).zip(scalars).enumerate();
                leaves
                    .map(|(k, ((x, init), scalar))| {
                        let inputs = [x.clone(), init.clone()];
                        self.family(Family::Hold, scalar, &inputs, places.at(k), span)
                    })
                    .collect()
            }
            _ => crate::elab::signal::nothing(),
        }
    }

    /// Elaborates `if c then x else y`. Operations in a branch that can fault are guarded by the condition.
    fn choice(
        &mut self,
        scope: &mut Scope<'u>,
        condition: ExprId,
        [yes, no]: [ExprId; 2],
        id: ExprId,
        at: At,
    ) -> Wire {
        let span = scope.unit.expr(id).span;
        let scalars = leaf_scalars(&scope.unit.expr(id).ty);
        let count = scalars.len();
        let places = self.leaf_places(scope, id, at);
        if let LeafPlaces::Each(_) = places {
            return self.choice_of_each(scope, condition, [yes, no], id, &places);
        }
        let condition = self.operand(scope, [id, condition], at);
        let sides = self.choice_here(&condition, at, span);
        if let Signal::Const(value) = &condition
            && self.chooses(scope, id, value)
        {
            let [in_yes, in_no] = sides.map(|side| At { side, ..at });
            return match value.as_bool() == Some(true) {
                true => self.read_each(scope, [id, yes], count, in_yes),
                false => self.read_each(scope, [id, no], count, in_no),
            };
        }
        let guards = self.guards(scope, &condition, [yes, no], at, span);
        let [in_yes, in_no] = [0, 1].map(|k| At {
            guard: guards[k],
            side: sides[k],
            ..at
        });
        let [yes, no] = [(yes, in_yes), (no, in_no)].map(|(branch, there)| {
            self.lazily(scope, branch, |elab, scope| {
                elab.read_each(scope, [id, branch], count, there)
            })
        });
        let mut leaves = Vec::with_capacity(count);
        for (k, scalar) in scalars.into_iter().enumerate() {
            let (Some(yes), Some(no)) = (yes.get(k), no.get(k)) else {
                break;
            };
            let inputs = [condition.clone(), yes.clone(), no.clone()];
            leaves.push(self.family(Family::Conditional, scalar, &inputs, at, span));
        }
        leaves.into()
    }

    /// Elaborates `if c then x else y` on a value whose leaves have different clocks: each leaf is selected on its own
    /// clock.
    fn choice_of_each(
        &mut self,
        scope: &mut Scope<'u>,
        condition: ExprId,
        branches: [ExprId; 2],
        id: ExprId,
        places: &LeafPlaces,
    ) -> Wire {
        let span = scope.unit.expr(id).span;
        let scalars = leaf_scalars(&scope.unit.expr(id).ty);
        let base = At::fragment(scope.base);
        let decided = self.placed(scope, condition, base);
        let plain = self.expr(scope, condition, decided);
        let guards = match plain.first() {
            Some(signal) => self.guards(scope, &signal.clone(), branches, decided, span),
            None => [None; 2],
        };
        let [yes, no] = [0, 1].map(|k| {
            let guard = guards[k];
            let at = At { guard, ..decided };
            self.read_each(scope, [id, branches[k]], scalars.len(), at)
        });
        let clocks = self.facts_of(scope).map(|facts| facts.clocks.row(id));
        let mut leaves = Vec::with_capacity(scalars.len());
        for (k, scalar) in scalars.into_iter().enumerate() {
            let (Some(yes), Some(no)) = (yes.get(k), no.get(k)) else {
                break;
            };
            let clock = clocks.as_ref().map_or(ClockId::BASE, |row| row.leaf(k));
            let here = self.read_at(scope, condition, clock, decided);
            let here = here.first().cloned().unwrap_or(Signal::Absent);
            let inputs = [here, yes.clone(), no.clone()];
            leaves.push(self.family(Family::Conditional, scalar, &inputs, places.at(k), span));
        }
        leaves.into()
    }

    /// Returns whether a constant condition drops a branch. Dependencies follow the source, with one version for each
    /// choice of static arguments. Under a condition without static parameters both branches count (M5.4), and state in
    /// them keeps running, which may fault (M6.6).
    fn chooses(&mut self, scope: &Scope<'u>, id: ExprId, value: &Value) -> bool {
        let unit = scope.unit;
        let Kind::Each(_, operands) = &unit.expr(id).kind else {
            return true;
        };
        let is_of_instance = unit.chosen.binary_search(&operands[0]).is_ok();
        let left_out = operands[if value.as_bool() == Some(true) { 2 } else { 1 }];
        let is_left_out = |elab: &mut Self| {
            !elab.goes_on(scope, left_out) && elab.drops(reads_flows(unit, left_out))
        };
        is_of_instance || self.mode == Mode::Constant || is_left_out(self)
    }

    /// Returns the guard of each branch that can fault; for other branches the guard of `at`.
    fn guards(
        &mut self,
        scope: &Scope<'u>,
        condition: &Signal,
        branches: [ExprId; 2],
        at: At,
        span: Span,
    ) -> [Option<PortRef>; 2] {
        let mut guards = [at.guard; 2];
        for (k, branch) in branches.into_iter().enumerate() {
            if !self.can_fault(scope, branch) {
                continue;
            }
            let here = match k {
                0 => condition.clone(),
                _ => self.simple(
                    prim!("Core::BooleanNot"),
                    std::slice::from_ref(condition),
                    at,
                    span,
                ),
            };
            guards[k] = self.guarded_by(here, at, span).guard;
        }
        guards
    }

    /// Returns the position `at` with the additional guard `condition`.
    pub(in crate::elab) fn guarded_by(&mut self, condition: Signal, at: At, span: Span) -> At {
        let here = match at.guard {
            Some(outer) => self.simple(
                prim!("Core::BooleanAnd"),
                &[Signal::Port(outer), condition],
                at,
                span,
            ),
            None => condition,
        };
        At {
            guard: self.port_of(&here, Scalar::Bool, at, span),
            ..at
        }
    }

    /// Elaborates `pre x`. The optional delay is used for leaves of x that can be absent.
    fn pre(&mut self, scope: &mut Scope<'u>, x: ExprId, id: ExprId, at: At) -> Wire {
        let absence = self.absence(scope, x);
        self.delayed(scope, x, id, at, |leaf| absence.leaf(leaf))
    }

    /// Returns the fragment in which the flow read by `x` is defined, if it encloses the reader.
    fn level(&self, scope: &Scope<'u>, x: ExprId, reader: FragmentId) -> Option<FragmentId> {
        let kind = &scope.unit.expr(x).kind;
        let &Kind::Flow(flow) = kind else {
            let mut inner = None;
            kind.operands(&mut |operand| inner = inner.or(Some(operand)));
            return self.level(scope, inner?, reader);
        };
        let block = scope.unit.flow(flow).block;
        let fragments = || scope.unit.blocks.iter().zip(&scope.fragments);
        let is_below = |id: &FragmentId| {
            fragments().any(|(of, own)| of.parent == Some(block) && *own == Some(*id))
        };
        let below = self.net.enclosing(reader).find(is_below)?;
        self.net.fragment(below).parent
    }

    fn delayed(
        &mut self,
        scope: &mut Scope<'u>,
        x: ExprId,
        id: ExprId,
        at: At,
        optional: impl Fn(usize) -> bool,
    ) -> Wire {
        let span = scope.unit.expr(id).span;
        if self.mode == Mode::Constant {
            return self.fail(NotConstant::Flow(span));
        }
        let scalars = leaf_scalars(&scope.unit.expr(id).ty);
        let wire = self.expr(scope, x, at.unguarded());
        let places = self.leaf_places(scope, id, at);
        let mut leaves = Vec::with_capacity(scalars.len());
        for (k, (scalar, signal)) in scalars.into_iter().zip(wire.iter()).enumerate() {
            let family = if optional(k) {
                Family::OptionalPre
            } else {
                Family::Pre
            };
            leaves.push(self.delay(family, scalar, signal, places.at(k), span));
        }
        leaves.into()
    }

    /// Adds one delay node.
    pub(in crate::elab) fn delay(
        &mut self,
        family: Family,
        scalar: Scalar,
        signal: &Signal,
        at: At,
        span: Span,
    ) -> Signal {
        let Some(prim) = member(family, scalar) else {
            return Signal::Absent;
        };
        let input = match self.port_of(signal, scalar, at, span) {
            Some(port) => Input::Port(port),
            None => Input::Open,
        };
        let node = self.node(
            prim,
            smallvec![input],
            Vec::new(),
            Types::from([Type::One(scalar)]),
            at.fragment,
            span,
        );
        Signal::Port(PortRef { node, port: 0 })
    }

    /// Elaborates `a -> b`. Operations that can fault are guarded by the first cycle or its negation. `none -> pre x`
    /// becomes a delay that starts absent.
    fn arrow(&mut self, scope: &mut Scope<'u>, a: ExprId, b: ExprId, id: ExprId, at: At) -> Wire {
        let unit = scope.unit;
        let span = unit.expr(id).span;
        if self.mode == Mode::Constant {
            return self.fail(NotConstant::Flow(span));
        }
        if let (Kind::None, Kind::Each(Each::Pre, operands)) =
            (&unit.expr(a).kind, &unit.expr(b).kind)
        {
            return self.delayed(scope, operands[0], b, at, |_| true);
        }
        let scalars = leaf_scalars(&unit.expr(id).ty);
        let first = self.first(at.fragment, span);
        let guards = self.guards(scope, &first, [a, b], at, span);
        let [in_a, in_b] = guards.map(|guard| At { guard, ..at });
        let a = self.read_each(scope, [id, a], scalars.len(), in_a);
        let b = self.read_each(scope, [id, b], scalars.len(), in_b);
        let places = self.leaf_places(scope, id, at);
        let mut leaves = Vec::with_capacity(scalars.len());
        for (k, scalar) in scalars.into_iter().enumerate() {
            let (Some(a), Some(b)) = (a.get(k), b.get(k)) else {
                break;
            };
            let at = places.at(k);
            let inputs = [self.first(at.fragment, span), a.clone(), b.clone()];
            leaves.push(match a == b {
                true => a.clone(),
                false => self.family(Family::Conditional, scalar, &inputs, at, span),
            });
        }
        leaves.into()
    }

    /// Returns which leaves of an expression can be absent.
    pub(in crate::elab) fn absence(&self, scope: &Scope<'u>, id: ExprId) -> crate::facts::Absence {
        let facts = scope.id.and_then(|unit| self.facts.get(unit.0 as usize));
        facts.map_or(crate::facts::Absence::NEVER, |facts| facts.absence(id))
    }

    /// Returns the constant value of a signal, following one alias.
    pub(in crate::elab) fn settled_constant(&self, signal: &Signal) -> Option<Value> {
        match signal {
            Signal::Const(value) => Some(value.clone()),
            Signal::Port(port) => {
                let alias = crate::elab::signal::alias_of(*port)?;
                match self.aliases.get(alias)?.as_ref()? {
                    Signal::Const(value) => Some(value.clone()),
                    _ => None,
                }
            }
            _ => None,
        }
    }

    /// Returns the wire of an expression expanded to `count` leaves. A bare `none` has a single leaf and is repeated.
    pub(in crate::elab) fn wide(
        &mut self,
        scope: &mut Scope<'u>,
        id: ExprId,
        count: usize,
        at: At,
    ) -> Wire {
        let wire = self.expr(scope, id, at);
        match (&wire[..], count) {
            ([Signal::Absent], n) if n != 1 => (0..n).map(|_| Signal::Absent).collect(),
            _ => wire,
        }
    }
}

/// Returns whether an expression reads flows in the current cycle, that is outside a delay.
pub(in crate::elab) fn reads_flows(unit: &Unit, id: ExprId) -> bool {
    let mut parts = unit.parts(id);
    while let Some((id, expr)) = parts.next() {
        match &expr.kind {
            Kind::Flow(_) => return true,
            Kind::Each(Each::Pre | Each::Last, _) => {}
            _ => parts.enter(id),
        }
    }
    false
}
