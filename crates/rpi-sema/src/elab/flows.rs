//! Reads and definitions of flows.

use crate::elab::expr::leaf_scalars;
use crate::elab::scope::{Scope, State};
use crate::elab::signal::{Signal, Wire, alias_of, nothing};
use crate::elab::{At, Elab, Mode, NotConstant};
use crate::ty::Ty;
use crate::typed::{Equation, FlowId, FlowRole, Place, Target};
use rpi_diag::Span;
use rpi_net::PortRef;

impl<'u> Elab<'u> {
    /// Returns the wire of a flow; aliases if its equation has not been elaborated yet.
    pub(in crate::elab) fn flow(
        &mut self,
        scope: &mut Scope<'u>,
        flow: FlowId,
        span: Span,
    ) -> Wire {
        match scope.state(flow) {
            State::Known(wire) => return wire.clone(),
            State::Busy => return self.fail(NotConstant::Flow(span)),
            State::Open => {}
        }
        match self.mode {
            Mode::Net | Mode::Whole | Mode::Steps => {
                let wire = self.alias_wire(&scope.unit.flow(flow).ty, span);
                *scope.state(flow) = State::Known(wire.clone());
                wire
            }
            Mode::Constant => self.constant_flow(scope, flow, span),
        }
    }

    pub(in crate::elab) fn alias_wire(&mut self, ty: &Ty, span: Span) -> Wire {
        if !self.may_hold(ty.leaf_count(), span) {
            return nothing();
        }
        let scalars = leaf_scalars(ty);
        scalars
            .into_iter()
            .map(|scalar| Signal::Port(self.new_alias(scalar)))
            .collect()
    }

    /// Evaluates a flow of a function on demand.
    fn constant_flow(&mut self, scope: &mut Scope<'u>, flow: FlowId, span: Span) -> Wire {
        let role = scope.unit.flow(flow).role;
        let unit = scope.unit;
        let equations = unit.blocks.iter().flat_map(|block| &block.equations);
        let defines = |equation: &&Equation| equation.targets.iter().any(|t| is_whole(t, flow));
        let found = equations.into_iter().find(|equation| defines(equation));
        let Some(equation) = found.filter(|_| !matches!(role, FlowRole::Input | FlowRole::Param))
        else {
            return self.fail(NotConstant::Flow(span));
        };
        *scope.state(flow) = State::Busy;
        let wire = self.expr(scope, equation.value, At::ROOT);
        let wire = self.targets_in_subranges(scope, equation, wire, At::ROOT);
        self.define_all(scope, equation, &wire);
        match scope.state(flow) {
            State::Known(wire) => wire.clone(),
            _ => self.fail(NotConstant::Flow(span)),
        }
    }

    /// Defines the targets of an equation by the leaves of its value.
    pub(in crate::elab) fn define_all(
        &mut self,
        scope: &mut Scope<'u>,
        equation: &Equation,
        wire: &Wire,
    ) {
        let mut at = 0;
        for target in &equation.targets {
            let count = target.ty.leaf_count();
            let end = (at + count).min(wire.len());
            let part: Wire = match (at, end) == (0, wire.len()) {
                true => wire.clone(),
                false => wire[at.min(end)..end].into(),
            };
            if let Place::Flow { flow, at: offset } = target.place {
                self.define(scope, flow, offset as usize, &part);
            }
            at += count;
        }
    }

    /// Defines leaves of a flow, from `at` on, by their signals.
    pub(in crate::elab) fn define(
        &mut self,
        scope: &mut Scope<'u>,
        flow: FlowId,
        at: usize,
        part: &Wire,
    ) {
        let whole = scope.unit.flow(flow).ty.leaf_count();
        if part.len() == whole
            && at == 0
            && let state @ (State::Open | State::Busy) = scope.state(flow)
        {
            *state = State::Known(part.clone());
            return;
        }
        let wire = self.flow(scope, flow, scope.unit.flow(flow).span);
        let has_clocks = self.facts_of(scope).is_some_and(|facts| facts.clocks.any());
        for (k, signal) in part.iter().enumerate() {
            if let Some(Signal::Port(port)) = wire.get(at + k) {
                self.bind(*port, signal);
                if let (Signal::Port(name), true) = (signal, has_clocks) {
                    self.names_before.entry(*name).or_insert(*port);
                }
            }
        }
        if part.len() == whole {
            *scope.state(flow) = State::Known(part.clone());
        }
    }

    fn bind(&mut self, port: PortRef, signal: &Signal) {
        if let Some(alias) = alias_of(port) {
            self.aliases[alias].get_or_insert_with(|| signal.clone());
        }
    }
}

fn is_whole(target: &Target, flow: FlowId) -> bool {
    matches!(target.place, Place::Flow { flow: f, at: 0 } if f == flow)
}
