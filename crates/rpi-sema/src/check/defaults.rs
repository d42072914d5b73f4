//! Defaults of flows that automata define (M14.5). An equation beside an automaton for a flow that its states also
//! define gives the value in the states that do not define it, as in SCADE and Heptagon.
//!
//! The equation defines a separate unnamed flow; the automaton chooses between this flow and those of its states. The
//! checks that every flow is defined exactly once therefore need no special case.

use super::automaton::candidates;
use super::body::Body;
use super::locals::Local;
use crate::hash::Set;
use crate::typed::FlowId;
use rpi_syntax::Name;
use rpi_syntax::ast::{Ident, Statement, StatementKind};

impl Body<'_, '_> {
    /// Declares the flows of those equations in the current block that are defaults.
    pub(super) fn declare_defaults(&mut self, statements: &[Statement]) {
        let shared = defined_by_states(statements);
        if shared.is_empty() {
            return;
        }
        for name in defined_by_equations(statements) {
            if shared.contains(&name.name) {
                self.declare_default(name);
            }
        }
    }

    /// Declares the default flow for a flow that states share.
    fn declare_default(&mut self, name: &Ident) {
        let shared = match self.find_in(self.block, &name.name) {
            Some(Local::Flow(flow)) if self.unit.flow(flow).role.has_equation() => flow,
            // A name that no equation may define, such as an in-port, has no default either.
            Some(_) => return,
            None => {
                self.hides_no_constant(name);
                self.introduce_flow(name)
            }
        };
        if !self.defaults.contains_key(&shared) {
            let default = self.version_of(name, shared);
            self.defaults.insert(shared, default);
        }
    }

    /// Returns the flow that an equation for `flow` in the current block defines: the default flow, if there is one.
    pub(super) fn defined_here(&self, flow: FlowId) -> FlowId {
        match self.defaults.get(&flow) {
            Some(default) if self.unit.flow(*default).block == self.block => *default,
            _ => flow,
        }
    }

    /// Returns the default of a shared flow: its own, or that of an outer shared flow to which it contributes.
    pub(super) fn default_beside(&self, flow: FlowId) -> Option<FlowId> {
        let mut around = std::iter::once(flow).chain(self.shared_around(flow));
        around.find_map(|flow| self.defaults.get(&flow).copied())
    }
}

/// Returns the names that the states of a body's automata define and do not declare.
fn defined_by_states(statements: &[Statement]) -> Set<&Name> {
    let automata = statements.iter().filter_map(|s| match &s.kind {
        StatementKind::Automaton(automaton) => Some(&**automaton),
        _ => None,
    });
    let names = automata.flat_map(candidates);
    names.map(|name| &name.name).collect()
}

/// Returns the names on the left sides of a body's equations, including those defined part by part.
fn defined_by_equations(statements: &[Statement]) -> impl Iterator<Item = &Ident> {
    let equations = statements.iter().filter_map(|s| match &s.kind {
        StatementKind::Equation(equation) => Some(&**equation),
        _ => None,
    });
    let targets = equations.flat_map(|equation| &equation.targets);
    targets.map(|target| &target.name)
}
