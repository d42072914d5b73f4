//! Targets: the left sides of equations.

use crate::check::bodies::automaton;
use crate::check::bodies::body::Body;
use crate::check::bodies::defaults;
use crate::check::bodies::locals;
use crate::check::bodies::locals::Local;
use crate::check::bodies::tuple_pieces;
use crate::check::bodies::type_inference;
use crate::check::bodies::type_inference::EquationLhs;
use crate::check::diagnostics::number_fixes;
use crate::check::diagnostics::report;
use crate::check::diagnostics::report::ExpectationReason;
use crate::check::diagnostics::report::undefined_name;
use crate::check::diagnostics::undefined_names;
use crate::check::exprs::access;
use crate::check::exprs::expr;
use crate::check::types::exact_time;
use crate::program::Lookup;
use crate::ty::Substitution;
use crate::ty::Ty;
use crate::ty::check_assignable;
use crate::ty::join;
use crate::typed::{Equation, ExprId, FlowId, FlowRole, Target, TargetPlace, UnitKind};
use rpi_diag::with_noun;
use rpi_diag::{Code, Diagnostic, Span};
use rpi_syntax::Name;
use rpi_syntax::ast::{self, Ident};
use smallvec::SmallVec;

/// Checks the value and the left side of the equation with this index in `pending`, and adds the typed equation to the
/// current block.
pub(crate) fn check_equation(cx: &mut Body<'_, '_>, index: usize) {
    let value = type_inference::checked_value(cx, index);
    let (goal, span) = (cx.pending[index].lhs, cx.pending[index].span);
    let count = match goal {
        EquationLhs::Targets(targets) => targets.len(),
        EquationLhs::Var(_) => 1,
    };
    let mut parts: SmallVec<[Ty; 1]> = match goal {
        EquationLhs::Targets(targets) if count > 1 => {
            let wanted = targets.iter().map(|target| declared_type(cx, target));
            let wanted: Vec<Option<&Ty>> = wanted.collect();
            let pieces = tuple_pieces::decompose(std::slice::from_ref(cx.ty_of(value)), &wanted);
            pieces.into_iter().map(|piece| piece.ty).collect()
        }
        _ => SmallVec::from([cx.ty_of(value).clone()]),
    };
    if parts.len() != count && !cx.ty_of(value).is_unknown() {
        return count_mismatch(cx, index, value, count, parts.len());
    }
    parts.resize(count, Ty::Unknown);
    let targets = match goal {
        EquationLhs::Targets(targets) => {
            let targets = targets.iter().zip(&parts);
            targets
                .map(|(target, ty)| check_target(cx, target, ty, value))
                .collect()
        }
        EquationLhs::Var(flow) => vec![check_var_target(cx, flow, &parts[0], value)],
    };
    cx.current_block().equations.push(Equation {
        targets,
        value,
        span,
    });
}

/// Returns the type of the flow that a target defines as a whole; `None` if the type is not known or if the target is a
/// part of a flow.
fn declared_type<'s>(cx: &'s Body<'_, '_>, target: &ast::Target) -> Option<&'s Ty> {
    let flow = cx.find_flow(&target.name.name)?;
    let ty = &cx.unit.flow(flow).ty;
    (target.path.is_empty() && !ty.has_unknown()).then_some(ty)
}

fn count_mismatch(
    cx: &mut Body<'_, '_>,
    index: usize,
    value: ExprId,
    targets: usize,
    parts: usize,
) {
    let span = cx.pending[index].span;
    let at = cx.span_of(value);
    let diagnostic = Diagnostic::new(
        Code::RPI1010,
        format!(
            "{} {} defined by {}",
            with_noun(targets, "flow"),
            if targets == 1 { "is" } else { "are" },
            with_noun(parts, "value")
        ),
    )
    .primary(at, format!("this gives {}", with_noun(parts, "value")))
    .secondary(span, format!("{} on the left", with_noun(targets, "flow")))
    .help(match targets > parts {
        true => "delete the flows that get no value, or give as many values as flows",
        false => "add a flow for each value on the left",
    });
    // It is not known which target lacks its value, so no further errors are reported for any of them.
    let introduced = cx.pending[index].inferred_flows.iter().flatten();
    cx.reported.erroneous_flows.extend(introduced.copied());
    if let EquationLhs::Targets(targets) = cx.pending[index].lhs {
        let declared = targets.iter().filter_map(|t| cx.find_flow(&t.name.name));
        let declared: Vec<FlowId> = declared.collect();
        cx.reported.erroneous_flows.extend(declared);
    }
    report::report_diagnostic(cx, diagnostic);
}

/// Checks a target of an equation and returns its typed form. `found` is the type of the part of `value` that the
/// target gets; a mismatch is reported.
fn check_target<'a>(
    cx: &mut Body<'_, 'a>,
    target: &'a ast::Target,
    found: &Ty,
    value: ExprId,
) -> Target {
    let (place, expected) = target_place(cx, target);
    typed_target(cx, place, expected, target.span, found, value)
}

fn check_var_target(cx: &mut Body<'_, '_>, flow: FlowId, found: &Ty, value: ExprId) -> Target {
    let expected = cx.unit.flow(flow).ty.clone();
    let span = cx.unit.flow(flow).span;
    typed_target(
        cx,
        TargetPlace::Flow { flow, at: 0 },
        expected,
        span,
        found,
        value,
    )
}

fn typed_target(
    cx: &mut Body<'_, '_>,
    place: TargetPlace,
    expected: Ty,
    span: Span,
    found: &Ty,
    value: ExprId,
) -> Target {
    let mut ty = expected.clone();
    let is_all = cx.ty_of(value) == found;
    if is_all {
        exact_time::convert_time_for(cx, value, &expected);
    }
    let now = cx.ty_of(value).clone();
    let found = if is_all { &now } else { found };
    match check_assignable(&expected, found, &mut Substitution::default()) {
        Ok(()) => {
            expr::check_angle_unit(cx, value, &expected);
            ty = join(&expected, found).unwrap_or(ty);
            number_fixes::prefer_integers(cx, value, &expected);
        }
        Err(misfit) => {
            let text = format!("the target has the type `{expected}`");
            report::type_mismatch(
                cx,
                value,
                &expected,
                &misfit,
                &ExpectationReason::Because(span, text),
            );
            label_shared_type(cx, &place, value, &expected);
        }
    }
    Target { place, ty, span }
}

/// Adds to the reported type mismatch in a state where the flow gets its type: its declaration, or the first state that
/// defines it.
fn label_shared_type(cx: &mut Body<'_, '_>, place: &TargetPlace, value: ExprId, ty: &Ty) {
    let TargetPlace::Flow { flow, .. } = *place else {
        return;
    };
    let Some(shared) = automaton::enclosing_shared_flows(cx, flow).next() else {
        return;
    };
    let (name, place) = (cx.unit.flow(shared).name.clone(), cx.unit.flow(shared).span);
    let (value, target) = (cx.span_of(value), cx.unit.flow(flow).span);
    let reported = cx.diagnostics.last_mut();
    if let Some(diagnostic) = reported.filter(|it| it.span() == value && place != target) {
        let text = format!("`{name}` is `{ty}` here");
        diagnostic.add_secondary(place, text);
    }
}

fn target_place<'a>(cx: &mut Body<'_, 'a>, target: &'a ast::Target) -> (TargetPlace, Ty) {
    let name = &target.name;
    match locals::find_local(cx, &name.name) {
        Some(Local::Flow(flow)) => {
            target_place_in_flow(cx, defaults::defined_flow(cx, flow), target)
        }
        Some(Local::Constant(_)) => not_definable(cx, name, "a constant"),
        Some(Local::Block(_)) => not_definable(cx, name, "a fragment"),
        Some(Local::State(_) | Local::AmbiguousState(..)) => not_definable(cx, name, "a state"),
        None if name.name == "_" => (TargetPlace::Nowhere, Ty::Unknown),
        None => undefined_target(cx, name, !target.path.is_empty()),
    }
}

/// Reports a target whose name is not declared in the body. Returns a target and a type that cause no further errors.
/// `in_part` is whether the target is a part of the name, as in `arm.tcp`.
fn undefined_target(cx: &mut Body<'_, '_>, name: &Ident, in_part: bool) -> (TargetPlace, Ty) {
    if let Lookup::Found(id) = cx.checker.program.lookup(cx.module, &name.name) {
        return not_definable(cx, name, cx.checker.program.decl(id).kind.description());
    }
    let help = match in_part && cx.unit.kind == UnitKind::Command {
        true => format!(
            "declare the device as a parameter of the command, with its device type: `command {} ({}: ...)`",
            cx.unit.name, name.name
        ),
        false => format!(
            "declare it as an out-port, or before `let`: `var {}: ...;`",
            name.name
        ),
    };
    let help = help.as_str();
    if cx.record_undefined(&name.name) {
        let near = cx.checker.suggest(&name.name, locals::local_names(cx));
        // That the intended flow has no equation is the same error.
        let meant = near.as_ref().and_then(|near| cx.find_flow(near));
        cx.reported.erroneous_flows.extend(meant);
        let diagnostic = undefined_name("flow", &name.name, name.span, near);
        report::report_diagnostic(cx, diagnostic.help(help));
    } else {
        add_target_help(cx, name, help);
    }
    (TargetPlace::Nowhere, Ty::Unknown)
}

/// Adds a help text to the earlier diagnostic about a read of the undefined flow `name`, if the diagnostic has only the
/// general advice to declare the flow.
fn add_target_help(cx: &mut Body<'_, '_>, name: &Ident, help: &str) {
    let index = cx.reported.undefined_flows.index(&name.name);
    let general = undefined_names::declaration_help(cx, &name.name);
    let diagnostic = index.and_then(|index| cx.diagnostics.get_mut(index));
    let is_general = |diagnostic: &&mut Diagnostic| {
        diagnostic.fixes.is_empty() && diagnostic.help.iter().all(|help| *help == general)
    };
    if let Some(diagnostic) = diagnostic.filter(is_general) {
        diagnostic.help = vec![help.to_owned()];
    }
}

/// Returns the type of a flow. A flow that several states of an automaton define has one type in all of them, so that
/// its type may be known from another state.
fn shared_type<'s>(cx: &'s Body<'_, '_>, flow: FlowId) -> &'s Ty {
    let all = automaton::enclosing_shared_flows(cx, flow).chain([flow]);
    let mut types = all.map(|flow| &cx.unit.flow(flow).ty);
    let known = types.find(|ty| !ty.has_unknown());
    known.unwrap_or(&cx.unit.flow(flow).ty)
}

fn target_place_in_flow<'a>(
    cx: &mut Body<'_, 'a>,
    flow: FlowId,
    target: &'a ast::Target,
) -> (TargetPlace, Ty) {
    if let Some(device) = cx.unit.device_type_instance(flow).cloned() {
        return access::actuator_target(cx, flow, &device, target);
    }
    let what = match cx.unit.flow(flow).role {
        FlowRole::Input | FlowRole::TakenOver => Some("an in-port"),
        FlowRole::Param => Some("a parameter"),
        FlowRole::Output | FlowRole::Local => None,
    };
    let ty = shared_type(cx, flow).clone();
    if what.is_some() && cx.reported.erroneous_flows.contains(&flow) {
        return (TargetPlace::Nowhere, Ty::Unknown);
    }
    if let Some(what) = what {
        // A parameter of an unknown type may be a device.
        return match ty.is_unknown() && !target.path.is_empty() {
            true => (TargetPlace::Nowhere, Ty::Unknown),
            false => not_definable(cx, &target.name, what),
        };
    }
    if is_part_of_outer_flow(cx, flow, target) {
        return (TargetPlace::Nowhere, Ty::Unknown);
    }
    match access::resolve_path(cx, &ty, 0, &target.path) {
        Some((at, ty)) => (TargetPlace::Flow { flow, at }, ty),
        None => (TargetPlace::Nowhere, Ty::Unknown),
    }
}

/// Whether a target is a part of a flow of a surrounding block, as in `a[0] = 1` inside of a fragment, which is an
/// error because the equation has an effect only while the current block is active. The error is reported once for each
/// flow.
fn is_part_of_outer_flow(cx: &mut Body<'_, '_>, flow: FlowId, target: &ast::Target) -> bool {
    if cx.unit.flow(flow).block == cx.block {
        return false;
    }
    if !cx.reported.erroneous_flows.contains(&flow) {
        cx.reported.erroneous_flows.push(flow);
        let name = &target.name.name;
        let block = cx.unit.block(cx.block).name.clone();
        let declared = cx.unit.flow(flow).span;
        let message = format!("`{name}` is defined in parts inside of `{block}`");
        let diagnostic = Diagnostic::new(Code::RPI1008, message)
            .primary(
                target.span,
                format!("takes effect only while `{block}` is active"),
            )
            .secondary(
                declared,
                format!("`{name}` is declared outside of `{block}`"),
            )
            .help(whole_value_help(cx, flow, name, &block));
        report::report_diagnostic(cx, diagnostic);
    }
    true
}

/// Returns the advice to define a flow of a surrounding block as a whole: in each state of an automaton, or outside of
/// a fragment.
fn whole_value_help(cx: &Body<'_, '_>, flow: FlowId, name: &Name, block: &Name) -> String {
    let whole = match &cx.unit.flow(flow).ty {
        Ty::Array(_, n @ 1..=4) => format!("[{}]", vec!["..."; *n as usize].join(", ")),
        _ => "...".to_owned(),
    };
    match automaton::is_state(cx, cx.block) {
        true => format!("define it as a whole in each state: `{name} = {whole};`"),
        false => format!(
            "define a local flow as a whole in `{block}`, such as `inner = {whole};`, and outside of it `{name} = {block}.inner ?? ...;`"
        ),
    }
}

fn not_definable(cx: &mut Body<'_, '_>, name: &Ident, what: &str) -> (TargetPlace, Ty) {
    let diagnostic = Diagnostic::new(Code::RPI1003, format!("`{}` is {what}", name.name))
        .primary(name.span, format!("{what} cannot be defined here"))
        .help(format!(
            "use another name for the new flow: `{}_new = ...;`",
            name.name
        ));
    report::report_diagnostic(cx, diagnostic);
    (TargetPlace::Nowhere, Ty::Unknown)
}
