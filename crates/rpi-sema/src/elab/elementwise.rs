//! Elaborates elementwise operators: `if`, `pre`, `->`, `??`, `hold`.

use crate::clocks::ClockId;
use crate::elab::arrays;
use crate::elab::coverage_points;
use crate::elab::expr;
use crate::elab::expr::leaf_scalars;
use crate::elab::guards;
use crate::elab::nodes;
use crate::elab::primitive_family::PrimitiveFamily;
use crate::elab::primitive_family::member;
use crate::elab::sampled_flows;
use crate::elab::sampled_flows::LeafPositions;
use crate::elab::scope::Scope;
use crate::elab::short_circuit;
use crate::elab::signal::{Signal, Wire};
use crate::elab::{ElabMode, Elaborator, NotConstantError, Position};
use crate::typed::{ElementwiseOp, TypedKind};
use crate::typed::{ExprId, Unit};
use rpi_diag::Span;
use rpi_image::{Scalar, Type, Value};
use rpi_net::prim;
use rpi_net::{FragmentId, Input, PortRef, Types};
use smallvec::smallvec;

pub(super) fn elementwise<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    each: ElementwiseOp,
    operands: &'u [ExprId],
    id: ExprId,
    at: Position,
) -> Wire {
    let unit = scope.unit;
    let (ty, span) = (&unit.expr(id).ty, unit.expr(id).span);
    match (each, operands) {
        (ElementwiseOp::If, [condition, yes, no]) => {
            conditional(elab, scope, *condition, [*yes, *no], id, at)
        }
        (ElementwiseOp::Pre, [x]) => elab_pre(elab, scope, *x, id, at),
        (ElementwiseOp::Last, [x]) => match defining_fragment(elab, scope, *x, at.fragment) {
            None => elab_pre(elab, scope, *x, id, at),
            Some(level) => {
                if level != at.fragment {
                    // The usual fix for an uninitialised delay would be wrong here: `->` restarts with the state.
                    elab.net.outer_delays.insert(span);
                }
                let around = std::mem::replace(&mut scope.base, level);
                let wire = elab_pre(elab, scope, *x, id, Position::in_fragment(level));
                scope.base = around;
                wire
            }
        },
        (ElementwiseOp::Arrow, [a, b]) => arrow(elab, scope, *a, *b, id, at),
        (ElementwiseOp::Coalesce, [a, b]) => {
            short_circuit::coalesce_operands(elab, scope, [id, *a, *b], at)
        }
        (ElementwiseOp::Hold, [x, init]) => {
            let (at, scalars) = (at.unguarded(), leaf_scalars(ty));
            let x = sampled_flows::read_leaves(elab, scope, [id, *x], scalars.len(), at);
            let init = sampled_flows::read_leaves(elab, scope, [id, *init], scalars.len(), at);
            let places = sampled_flows::leaf_places(elab, scope, id, at);
            let leaves = x.iter().zip(init.iter()).zip(scalars).enumerate();
            leaves
                .map(|(k, ((x, init), scalar))| {
                    let inputs = [x.clone(), init.clone()];
                    nodes::add_family_member(
                        elab,
                        PrimitiveFamily::Hold,
                        scalar,
                        &inputs,
                        places.at(k),
                        span,
                    )
                })
                .collect()
        }
        _ => crate::elab::signal::empty_wire(),
    }
}

/// Elaborates `if c then x else y`. Operations in a branch that can fault run only while the branch is taken.
fn conditional<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    condition: ExprId,
    [yes, no]: [ExprId; 2],
    id: ExprId,
    at: Position,
) -> Wire {
    let span = scope.unit.expr(id).span;
    let scalars = leaf_scalars(&scope.unit.expr(id).ty);
    let count = scalars.len();
    let places = sampled_flows::leaf_places(elab, scope, id, at);
    if let LeafPositions::PerLeaf(_) = places {
        return conditional_per_leaf(elab, scope, condition, [yes, no], id, &places);
    }
    let condition = expr::elab_operand(elab, scope, [id, condition], at);
    let sides = coverage_points::record_choice(elab, &condition, at, span);
    if let Signal::Const(value) = &condition
        && drops_branch(elab, scope, id, value)
    {
        let [in_yes, in_no] = sides.map(|side| Position { branch: side, ..at });
        return match value.as_bool() == Some(true) {
            true => sampled_flows::read_leaves(elab, scope, [id, yes], count, in_yes),
            false => sampled_flows::read_leaves(elab, scope, [id, no], count, in_no),
        };
    }
    let guards = elab_guards(elab, scope, &condition, [yes, no], at, span);
    let [in_yes, in_no] = [0, 1].map(|k| Position {
        guard: guards[k],
        branch: sides[k],
        ..at
    });
    let [yes, no] = [(yes, in_yes), (no, in_no)].map(|(branch, there)| {
        short_circuit::lazy_operand(elab, scope, branch, |elab, scope| {
            sampled_flows::read_leaves(elab, scope, [id, branch], count, there)
        })
    });
    let mut leaves = Vec::with_capacity(count);
    for (k, scalar) in scalars.into_iter().enumerate() {
        let (Some(yes), Some(no)) = (yes.get(k), no.get(k)) else {
            break;
        };
        let inputs = [condition.clone(), yes.clone(), no.clone()];
        leaves.push(nodes::add_family_member(
            elab,
            PrimitiveFamily::Conditional,
            scalar,
            &inputs,
            at,
            span,
        ));
    }
    leaves.into()
}

/// Elaborates `if c then x else y` on a value whose leaves (scalar parts) have different clocks.
fn conditional_per_leaf<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    condition: ExprId,
    branches: [ExprId; 2],
    id: ExprId,
    places: &LeafPositions,
) -> Wire {
    let span = scope.unit.expr(id).span;
    let scalars = leaf_scalars(&scope.unit.expr(id).ty);
    let base = Position::in_fragment(scope.base);
    let decided = sampled_flows::position_of(elab, scope, condition, base);
    let plain = expr::elab_expr(elab, scope, condition, decided);
    let guards = match plain.first() {
        Some(signal) => elab_guards(elab, scope, &signal.clone(), branches, decided, span),
        None => [None; 2],
    };
    let [yes, no] = [0, 1].map(|k| {
        let guard = guards[k];
        let at = Position { guard, ..decided };
        sampled_flows::read_leaves(elab, scope, [id, branches[k]], scalars.len(), at)
    });
    let clocks = sampled_flows::facts_of(elab, scope).map(|facts| facts.clocks.expr_clocks(id));
    let mut leaves = Vec::with_capacity(scalars.len());
    for (k, scalar) in scalars.into_iter().enumerate() {
        let (Some(yes), Some(no)) = (yes.get(k), no.get(k)) else {
            break;
        };
        let clock = clocks.as_ref().map_or(ClockId::BASE, |row| row.leaf(k));
        let here = sampled_flows::read_at(elab, scope, condition, clock, decided);
        let here = here.first().cloned().unwrap_or(Signal::Absent);
        let inputs = [here, yes.clone(), no.clone()];
        leaves.push(nodes::add_family_member(
            elab,
            PrimitiveFamily::Conditional,
            scalar,
            &inputs,
            places.at(k),
            span,
        ));
    }
    leaves.into()
}

/// Returns whether the branch of an `if` that its constant condition never takes is left out. Dependencies follow the
/// source, with one version per choice of static arguments. Under a condition without static parameters, both branches
/// count (M5.4), and state in them runs on, which may fault (M6.6).
fn drops_branch<'u>(
    elab: &mut Elaborator<'u>,
    scope: &Scope<'u>,
    id: ExprId,
    value: &Value,
) -> bool {
    let unit = scope.unit;
    let TypedKind::Each(_, operands) = &unit.expr(id).kind else {
        return true;
    };
    let is_of_instance = unit.static_conditions.binary_search(&operands[0]).is_ok();
    let left_out = operands[if value.as_bool() == Some(true) { 2 } else { 1 }];
    is_of_instance
        || elab.mode == ElabMode::Constant
        || !guards::contains_state(elab, scope, left_out)
            && expr::drops_dead_code(elab, reads_flows(unit, left_out))
}

/// Returns the guards of the branches of an `if`: the condition or its negation for a branch that can fault, else the
/// guard of `at`. A guarded operation runs only while its guard is true.
fn elab_guards<'u>(
    elab: &mut Elaborator<'u>,
    scope: &Scope<'u>,
    condition: &Signal,
    branches: [ExprId; 2],
    at: Position,
    span: Span,
) -> [Option<PortRef>; 2] {
    let mut guards = [at.guard; 2];
    for (k, branch) in branches.into_iter().enumerate() {
        if !guards::elab_can_fault(elab, scope, branch) {
            continue;
        }
        let here = match k {
            0 => condition.clone(),
            _ => nodes::add_simple(
                elab,
                prim!("Core::BooleanNot"),
                std::slice::from_ref(condition),
                at,
                span,
            ),
        };
        guards[k] = with_guard(elab, here, at, span).guard;
    }
    guards
}

/// Returns the position `at` with the additional guard `condition`, under which operations that can fault run.
pub(super) fn with_guard(
    elab: &mut Elaborator<'_>,
    condition: Signal,
    at: Position,
    span: Span,
) -> Position {
    let here = match at.guard {
        Some(outer) => nodes::add_simple(
            elab,
            prim!("Core::BooleanAnd"),
            &[Signal::Port(outer), condition],
            at,
            span,
        ),
        None => condition,
    };
    Position {
        guard: arrays::port_of(elab, &here, Scalar::Bool, at, span),
        ..at
    }
}

/// Elaborates `pre x`. Leaves (scalar parts) that can be absent use the optional form of the delay.
fn elab_pre<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    x: ExprId,
    id: ExprId,
    at: Position,
) -> Wire {
    let absence = elab_absence(elab, scope, x);
    delay_leaves(elab, scope, x, id, at, |leaf| absence.leaf(leaf))
}

/// Returns the fragment in which the flow read by `x` is defined; `None` if it does not enclose `reader`.
fn defining_fragment<'u>(
    elab: &Elaborator<'u>,
    scope: &Scope<'u>,
    x: ExprId,
    reader: FragmentId,
) -> Option<FragmentId> {
    let kind = &scope.unit.expr(x).kind;
    let &TypedKind::Flow(flow) = kind else {
        let mut inner = None;
        kind.operands(&mut |operand| inner = inner.or(Some(operand)));
        return defining_fragment(elab, scope, inner?, reader);
    };
    let block = scope.unit.flow(flow).block;
    let fragments = || scope.unit.blocks.iter().zip(&scope.fragments);
    let is_below = |id: &FragmentId| {
        fragments().any(|(of, own)| of.parent == Some(block) && *own == Some(*id))
    };
    let below = elab.net.ancestors(reader).find(is_below)?;
    elab.net.fragment(below).parent
}

fn delay_leaves<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    x: ExprId,
    id: ExprId,
    at: Position,
    optional: impl Fn(usize) -> bool,
) -> Wire {
    let span = scope.unit.expr(id).span;
    if elab.mode == ElabMode::Constant {
        return elab.fail(NotConstantError::RunTime(span));
    }
    let scalars = leaf_scalars(&scope.unit.expr(id).ty);
    let wire = expr::elab_expr(elab, scope, x, at.unguarded());
    let places = sampled_flows::leaf_places(elab, scope, id, at);
    let mut leaves = Vec::with_capacity(scalars.len());
    for (k, (scalar, signal)) in scalars.into_iter().zip(wire.iter()).enumerate() {
        let family = if optional(k) {
            PrimitiveFamily::OptionalPre
        } else {
            PrimitiveFamily::Pre
        };
        leaves.push(delay(elab, family, scalar, signal, places.at(k), span));
    }
    leaves.into()
}

/// Adds a delay of one cycle, a primitive of the given family for the type, and returns its output.
pub(super) fn delay(
    elab: &mut Elaborator<'_>,
    family: PrimitiveFamily,
    scalar: Scalar,
    signal: &Signal,
    at: Position,
    span: Span,
) -> Signal {
    let Some(prim) = member(family, scalar) else {
        return Signal::Absent;
    };
    let input = match arrays::port_of(elab, signal, scalar, at, span) {
        Some(port) => Input::Port(port),
        None => Input::Unconnected,
    };
    let node = nodes::add_node(
        elab,
        prim,
        smallvec![input],
        Vec::new(),
        Types::from([Type::Scalar(scalar)]),
        at.fragment,
        span,
    );
    Signal::Port(PortRef { node, port: 0 })
}

/// Elaborates `a -> b`. Operations that can fault run only in the first cycle (in `a`) or in later ones (in `b`).
/// `none -> pre x` becomes a delay that starts absent.
fn arrow<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    a: ExprId,
    b: ExprId,
    id: ExprId,
    at: Position,
) -> Wire {
    let unit = scope.unit;
    let span = unit.expr(id).span;
    if elab.mode == ElabMode::Constant {
        return elab.fail(NotConstantError::RunTime(span));
    }
    if let (TypedKind::None, TypedKind::Each(ElementwiseOp::Pre, operands)) =
        (&unit.expr(a).kind, &unit.expr(b).kind)
    {
        return delay_leaves(elab, scope, operands[0], b, at, |_| true);
    }
    let scalars = leaf_scalars(&unit.expr(id).ty);
    let first = nodes::first_port(elab, at.fragment, span);
    let guards = elab_guards(elab, scope, &first, [a, b], at, span);
    let [in_a, in_b] = guards.map(|guard| Position { guard, ..at });
    let a = sampled_flows::read_leaves(elab, scope, [id, a], scalars.len(), in_a);
    let b = sampled_flows::read_leaves(elab, scope, [id, b], scalars.len(), in_b);
    let places = sampled_flows::leaf_places(elab, scope, id, at);
    let mut leaves = Vec::with_capacity(scalars.len());
    for (k, scalar) in scalars.into_iter().enumerate() {
        let (Some(a), Some(b)) = (a.get(k), b.get(k)) else {
            break;
        };
        let at = places.at(k);
        let inputs = [
            nodes::first_port(elab, at.fragment, span),
            a.clone(),
            b.clone(),
        ];
        leaves.push(match a == b {
            true => a.clone(),
            false => nodes::add_family_member(
                elab,
                PrimitiveFamily::Conditional,
                scalar,
                &inputs,
                at,
                span,
            ),
        });
    }
    leaves.into()
}

/// Returns which leaves (scalar parts) of an expression can be absent.
pub(super) fn elab_absence<'u>(
    elab: &Elaborator<'u>,
    scope: &Scope<'u>,
    id: ExprId,
) -> crate::facts::Absence {
    let facts = scope.id.and_then(|unit| elab.facts.get(unit.0 as usize));
    facts.map_or(crate::facts::Absence::NEVER, |facts| facts.absence(id))
}

/// Returns the constant value of a signal, or of the signal that a placeholder stands for; `None` if it is no constant.
pub(super) fn constant_value(elab: &Elaborator<'_>, signal: &Signal) -> Option<Value> {
    match signal {
        Signal::Const(value) => Some(value.clone()),
        Signal::Port(port) => {
            let alias = crate::elab::signal::alias_of(*port)?;
            match elab.aliases.signals.get(alias)?.as_ref()? {
                Signal::Const(value) => Some(value.clone()),
                _ => None,
            }
        }
        _ => None,
    }
}

/// Returns the signals of an expression for `count` leaves (scalar parts). A bare `none` is repeated.
pub(super) fn expr_leaves<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    id: ExprId,
    count: usize,
    at: Position,
) -> Wire {
    let wire = expr::elab_expr(elab, scope, id, at);
    match (&wire[..], count) {
        ([Signal::Absent], n) if n != 1 => (0..n).map(|_| Signal::Absent).collect(),
        _ => wire,
    }
}

/// Returns whether an expression reads flows in the current cycle, outside of delays such as `pre`.
pub(super) fn reads_flows(unit: &Unit, id: ExprId) -> bool {
    let mut parts = unit.traverse(id);
    while let Some((id, expr)) = parts.next() {
        match &expr.kind {
            TypedKind::Flow(_) => return true,
            TypedKind::Each(ElementwiseOp::Pre | ElementwiseOp::Last, _) => {}
            _ => parts.enter(id),
        }
    }
    false
}
