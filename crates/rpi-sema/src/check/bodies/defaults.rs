//! Defaults of flows that automata define (M14.5). An equation beside an automaton for a flow that its states also
//! define gives the value in the states that do not define it, as in SCADE and Heptagon.
//!
//! The equation defines a separate unnamed flow; the automaton chooses between this flow and those of its states. The
//! checks that every flow is defined exactly once therefore need no special case.

use crate::check::bodies::automaton;
use crate::check::bodies::automaton::shared_names;
use crate::check::bodies::body::Body;
use crate::check::bodies::locals;
use crate::check::bodies::locals::Local;
use crate::check::bodies::statement;
use crate::hash::FastSet;
use crate::typed::FlowId;
use rpi_syntax::Name;
use rpi_syntax::ast::{Ident, Statement, StatementKind};

/// Declares the default flows of the current block. A default flow has the value of an equation beside an automaton
/// whose states define the same name. It applies in states without an equation for that name.
pub(crate) fn declare_defaults(cx: &mut Body<'_, '_>, statements: &[Statement]) {
    let shared = defined_by_states(statements);
    if shared.is_empty() {
        return;
    }
    for name in defined_by_equations(statements) {
        if shared.contains(&name.name) {
            declare_default(cx, name);
        }
    }
}

/// Declares the default flow for the flow `name` of the current block, which states of an automaton define and which
/// also has an equation beside the automaton.
fn declare_default(cx: &mut Body<'_, '_>, name: &Ident) {
    let shared = match locals::find_in_block(cx, cx.block, &name.name) {
        Some(Local::Flow(flow)) if cx.unit.flow(flow).role.has_equation() => flow,
        // A name that no equation may define, such as an in-port, has no default either.
        Some(_) => return,
        None => {
            statement::report_constant_redefinition(cx, name);
            locals::introduce_flow(cx, name)
        }
    };
    if !cx.shared.defaults.contains_key(&shared) {
        let default = automaton::add_contribution(cx, name, shared);
        cx.shared.defaults.insert(shared, default);
    }
}

/// Returns the flow that an equation for `flow` in the current block defines: the default flow of `flow` if it has one
/// in this block, else `flow` itself.
pub(crate) fn defined_flow(cx: &Body<'_, '_>, flow: FlowId) -> FlowId {
    match cx.shared.defaults.get(&flow) {
        Some(default) if cx.unit.flow(*default).block == cx.block => *default,
        _ => flow,
    }
}

/// Returns the flow that gives the value of `flow` in states without an equation for it: the default of `flow`, or that
/// of a flow outside of the automaton that `flow` defines. `None` if there is no default.
pub(crate) fn shared_flow_default(cx: &Body<'_, '_>, flow: FlowId) -> Option<FlowId> {
    let mut around = std::iter::once(flow).chain(automaton::enclosing_shared_flows(cx, flow));
    around.find_map(|flow| cx.shared.defaults.get(&flow).copied())
}

/// Returns the names that the states of the automata among these statements define and do not declare.
fn defined_by_states(statements: &[Statement]) -> FastSet<&Name> {
    let automata = statements.iter().filter_map(|s| match &s.kind {
        StatementKind::Automaton(automaton) => Some(&**automaton),
        _ => None,
    });
    let names = automata.flat_map(shared_names);
    names.map(|name| &name.name).collect()
}

/// Returns the names on the left sides of the equations among these statements, including names of which a part is
/// defined.
fn defined_by_equations(statements: &[Statement]) -> impl Iterator<Item = &Ident> {
    let equations = statements.iter().filter_map(|s| match &s.kind {
        StatementKind::Equation(equation) => Some(&**equation),
        _ => None,
    });
    let targets = equations.flat_map(|equation| &equation.targets);
    targets.map(|target| &target.name)
}
