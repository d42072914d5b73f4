//! Definitions and references in bodies: locals, equations, fragments in place and automata.

use super::items;
use crate::hash::FastMap;
use crate::query::build::{
    Body, Builder, DefId, DefKind, DefPosition, Dialect, Ident, PendingRef, ScopeId, ShapeOrigin,
};
use rpi_syntax::Name;
use rpi_syntax::ast::{
    Automaton, Desugared, Equation, FragmentDecl, Locals, State, Statement, StatementKind, Target,
    Transition,
};

pub(super) fn index_body<'a>(builder: &mut Builder<'a>, scope: ScopeId, body: &'a Body) {
    let whole = builder.index.scope(scope).span;
    items::locals(builder, scope, whole, &body.locals);
    for statement in &body.statements {
        index_statement(builder, scope, statement);
    }
}

fn index_statement<'a>(builder: &mut Builder<'a>, scope: ScopeId, statement: &'a Statement) {
    let at = DefPosition {
        scope,
        whole: statement.span,
        doc: statement.doc.as_ref(),
    };
    match &statement.kind {
        StatementKind::Equation(equation) => index_equation(builder, at, equation),
        StatementKind::Call(call) => builder.exprs(scope, [&**call]),
        StatementKind::Claim(claim) => {
            builder.exprs(scope, [&claim.condition].into_iter().chain(&claim.provided))
        }
        StatementKind::CommandEnd(end) => builder.exprs(scope, [&end.condition]),
        StatementKind::Export(flows) => flows
            .iter()
            .for_each(|flow| builder.defer(scope, PendingRef::Dotted(flow))),
        StatementKind::Fragment(fragment) => block(builder, at, fragment),
        StatementKind::Automaton(automaton) => index_automaton(builder, at, automaton),
        StatementKind::Conditional(choice) => desugared(builder, at, &choice.desugared),
        StatementKind::FrameBlock(keep) => desugared(builder, at, &keep.desugared),
        StatementKind::Error(names) => names.iter().for_each(|name| {
            resolve_target(builder, at, name);
        }),
    }
}

/// Indexes the equations of a block of equations (`if`, `when`, `cond` or `frame`) that the parser has translated to
/// plain equations.
fn desugared<'a>(builder: &mut Builder<'a>, at: DefPosition<'a>, means: &'a Desugared) {
    for (equation, _) in &means.equations {
        index_equation(builder, at, equation);
    }
}

fn index_equation<'a>(builder: &mut Builder<'a>, at: DefPosition<'a>, equation: &'a Equation) {
    for target in &equation.targets {
        match target.path.is_empty() {
            true => index_target(builder, at, &target.name, equation),
            false => builder.defer(at.scope, PendingRef::Target(target)),
        }
    }
    builder.exprs(at.scope, [&equation.value]);
}

fn index_target<'a>(
    builder: &mut Builder<'a>,
    at: DefPosition<'a>,
    name: &'a Ident,
    equation: &'a Equation,
) {
    let def = resolve_target(builder, at, name);
    if let (Some(def), [_]) = (def, &equation.targets[..]) {
        let value = ShapeOrigin::Value(&equation.value);
        builder.shapes.set_if_unset(def, at.scope, value);
    }
}

/// Returns the definition to which a plain name on the left of an equation refers: a flow declared in this scope, a
/// flow of an enclosing scope that the equation defines, or a new local flow. `None` for `_` and for an undeclared name
/// in Lustre.
fn resolve_target<'a>(
    builder: &mut Builder<'a>,
    at: DefPosition<'a>,
    name: &'a Ident,
) -> Option<DefId> {
    if name.name == "_" {
        return None;
    }
    let here = builder.index.scope(at.scope).names.get(&name.name).copied();
    let around = || builder.index.lookup(at.scope, &name.name);
    let known = here.or_else(|| around().filter(|id| defines_outer_flow(builder, at.scope, *id)));
    match known {
        Some(def) => {
            builder.refer(name.span, def);
            Some(def)
        }
        None if builder.mode == Dialect::Lustre => None,
        None => Some(builder.define(at, name, DefKind::Local)),
    }
}

/// Returns whether an equation in a scope defines the flow `id` of an enclosing scope: a parameter or in-port, or a
/// flow that several states of an automaton define. A fragment has flows of its own.
fn defines_outer_flow(builder: &Builder<'_>, scope: ScopeId, id: DefId) -> bool {
    let def = builder.index.def(id);
    use DefKind::{Input, Local, Output, Param, TakenOver};
    match def.kind {
        TakenOver | Input | Param => true,
        Local | Output => is_state_in(builder, scope, def.parent),
        _ => false,
    }
}

/// Returns whether a scope belongs to a state of an automaton in the definition `parent`, directly or through nested
/// automata.
fn is_state_in(builder: &Builder<'_>, scope: ScopeId, parent: Option<DefId>) -> bool {
    let owner = |id: DefId| Some(builder.index.def(id)).filter(|def| def.kind == DefKind::State);
    let innermost = builder.index.scope(scope).owner.and_then(owner);
    let mut states = std::iter::successors(innermost, |state| owner(state.parent?));
    states.any(|state| state.parent == parent)
}

fn block<'a>(builder: &mut Builder<'a>, at: DefPosition<'a>, fragment: &'a FragmentDecl) {
    let signature = &fragment.signature;
    let scope = define_block(builder, at, &signature.name, DefKind::Block);
    // The activation is evaluated in the enclosing scope.
    let when = fragment.when.iter().map(|when| &when.condition);
    builder.exprs(at.scope, when.chain(&fragment.budget));
    let outputs = signature.outputs.as_deref().unwrap_or_default();
    items::index_vars(builder, scope, outputs, DefKind::Output);
    items::index_contract(builder, scope, fragment.contract.as_ref());
    index_body(builder, scope, &fragment.body);
}

/// Adds a definition for a fragment or state inside of a body, and returns its inner scope.
fn define_block<'a>(
    builder: &mut Builder<'a>,
    at: DefPosition<'a>,
    name: &'a Ident,
    kind: DefKind,
) -> ScopeId {
    let def = builder.define(at, name, kind);
    let scope = builder.inner(at, def);
    builder.index.inner_scopes[def.0 as usize].members = Some(scope);
    scope
}

fn index_automaton<'a>(builder: &mut Builder<'a>, at: DefPosition<'a>, automaton: &'a Automaton) {
    let states: Vec<ScopeId> = automaton
        .states
        .iter()
        .map(|state| {
            let at = DefPosition {
                whole: state.span,
                doc: state.doc.as_ref(),
                ..at
            };
            define_block(builder, at, &state.name, DefKind::State)
        })
        .collect();
    for state in &automaton.states {
        define_shared(builder, at, state);
    }
    // Another automaton in the same body may have states with the same names.
    let names = automaton.states.iter().map(|state| &state.name.name);
    let owners = states.iter().map(|scope| builder.index.scope(*scope).owner);
    let named = names.zip(owners).filter_map(|(name, id)| Some((name, id?)));
    let named: FastMap<&Name, DefId> = named.collect();
    for (state, scope) in automaton.states.iter().zip(states) {
        for transition in state.unless.iter().chain(&state.until) {
            if let Some(target) = named.get(&transition.target.name) {
                builder.refer(transition.target.span, *target);
            }
        }
        index_transitions(builder, at.scope, scope, state);
        index_body(builder, scope, &state.body);
    }
}

/// Adds definitions, in the enclosing scope, for the flows that a state of an automaton defines but does not declare.
fn define_shared<'a>(builder: &mut Builder<'a>, at: DefPosition<'a>, state: &'a State) {
    let is_declared = |name: &Ident| declared_names(state).any(|known| known.name == name.name);
    let equations = state.body.statements.iter();
    let targets = equations.filter_map(|statement| match &statement.kind {
        StatementKind::Equation(equation) => Some((statement, equation)),
        _ => None,
    });
    for (statement, equation) in targets {
        let at = DefPosition {
            whole: statement.span,
            doc: statement.doc.as_ref(),
            ..at
        };
        let plain = |target: &&'a Target| target.path.is_empty();
        let names = equation.targets.iter().filter(plain).map(|t| &t.name);
        for name in names.filter(|name| !is_declared(name)) {
            index_target(builder, at, name, equation);
        }
    }
}

/// Records the names in the conditions of a state's transitions, to be resolved later. Strong transitions (`unless`)
/// are evaluated in the enclosing scope `around`, weak ones (`until`) in the scope `inside` of the state.
fn index_transitions<'a>(
    builder: &mut Builder<'a>,
    around: ScopeId,
    inside: ScopeId,
    state: &'a State,
) {
    let mut all = |scope: ScopeId, transitions: &'a [Transition]| {
        let conditions = transitions.iter().flat_map(|one| &one.condition);
        builder.exprs(scope, conditions);
    };
    all(around, &state.unless);
    all(inside, &state.until);
}

fn declared_names<'a>(state: &'a State) -> impl Iterator<Item = &'a Ident> {
    state.body.locals.iter().flat_map(|section| {
        let names: Vec<&'a Ident> = match section {
            Locals::Var(vars) => vars.iter().flat_map(|var| &var.names).collect(),
            Locals::Const(defs) => defs.iter().flat_map(|def| &def.names).collect(),
        };
        names
    })
}
