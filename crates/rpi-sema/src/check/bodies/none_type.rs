//! Infers the type of each `none` from its context. A `none` without a type has no leaves and would be treated as a
//! present value, so a type that cannot be inferred is reported.

use crate::check::bodies::body::Body;
use crate::check::bodies::inference_errors::report_uninferred;
use crate::check::calls::prim_ports::resolve_port_type;
use crate::check::diagnostics::report;
use crate::check::reuse;
use crate::hash::FastSet;
use crate::ty::Ty;
use crate::typed::{BlockId, ExprId, FlowId, TargetPlace};
use crate::typed::{ElementwiseOp, TypedKind};
use rpi_diag::{Code, Diagnostic, Severity};

/// Infers the type of every `none` (absent value) of the unit from its context, and reports each `none` whose type
/// remains unknown.
pub(crate) fn infer_none_types(cx: &mut Body<'_, '_>) {
    let is_error = |diagnostic: &&Diagnostic| diagnostic.severity() == Severity::Error;
    let here = cx
        .diagnostics
        .iter()
        .any(|diagnostic| is_error(&diagnostic));
    if here || !has_untyped_none(cx) {
        return;
    }
    // An expression with an error has no type either, so nothing is reported after other errors.
    let follows_error = reuse::has_error(&cx.checker.diagnostics);
    reuse::record_error_dependence(cx.checker, follows_error);
    if follows_error {
        return;
    }
    for (id, ty) in context_types(cx) {
        set_none_type(cx, id, &ty);
    }
    for id in (0..cx.unit.exprs.len()).rev() {
        let id = ExprId(u32::try_from(id).unwrap_or(u32::MAX));
        for (operand, ty) in operand_types(cx, id) {
            set_none_type(cx, operand, &ty);
        }
    }
    report_untyped_none(cx);
}

fn is_untyped_none(cx: &Body<'_, '_>, id: ExprId) -> bool {
    let expr = cx.unit.expr(id);
    matches!(expr.kind, TypedKind::None) && expr.ty.has_unknown()
}

fn has_untyped_none(cx: &Body<'_, '_>) -> bool {
    let mut all = (0..).map(ExprId).take(cx.unit.exprs.len());
    all.any(|id| is_untyped_none(cx, id))
}

/// Returns the types that the context requires of expressions: the type of the flow for its equation and its default,
/// and `bool` for conditions.
fn context_types(cx: &Body<'_, '_>) -> Vec<(ExprId, Ty)> {
    let defaults = cx.unit.flows.iter();
    let defaults = defaults.filter_map(|flow| Some((flow.default?, flow.ty.clone())));
    let mut types: Vec<(ExprId, Ty)> = defaults.collect();
    for block in &cx.unit.blocks {
        for equation in &block.equations {
            if let [target] = &equation.targets[..] {
                types.push((equation.value, target.ty.clone()));
            } else if let TypedKind::Build(parts) = &cx.unit.expr(equation.value).kind {
                let parts = parts.iter().zip(&equation.targets);
                types.extend(parts.map(|(part, target)| (*part, target.ty.clone())));
            }
        }
        let ends = block.ends.iter().map(|end| end.condition);
        let claims = block.claims.iter().map(|claim| claim.condition);
        let states = block.automata.iter().flat_map(|a| &a.states);
        let transitions = states.flat_map(|state| state.unless.iter().chain(&state.until));
        let conditions = ends.chain(claims).chain(block.when);
        let conditions = conditions.chain(transitions.filter_map(|t| t.condition));
        types.extend(conditions.map(|condition| (condition, Ty::Bool)));
    }
    types
}

/// Returns the operands of an expression, each with the type that the operator or callee requires of it. Empty if there
/// is no requirement.
fn operand_types(cx: &Body<'_, '_>, id: ExprId) -> Vec<(ExprId, Ty)> {
    let expr = cx.unit.expr(id);
    let alike = |ids: &[ExprId]| ids.iter().map(|id| (*id, expr.ty.clone())).collect();
    match &expr.kind {
        TypedKind::Each(ElementwiseOp::If, operands) => {
            let mut types: Vec<(ExprId, Ty)> = alike(&operands[1..]);
            types.push((operands[0], Ty::Bool));
            types
        }
        TypedKind::Each(_, operands) => alike(operands),
        TypedKind::When { value, .. } => alike(&[*value]),
        TypedKind::Current(operand) => alike(&[*operand]),
        TypedKind::Merge { cases, .. } => {
            alike(&cases.iter().map(|(_, case)| *case).collect::<Vec<_>>())
        }
        TypedKind::Repeat(_) | TypedKind::Build(_) => part_types(cx, id),
        TypedKind::Equal {
            operands: [a, b], ..
        } => {
            vec![(*a, cx.ty_of(*b).clone()), (*b, cx.ty_of(*a).clone())]
        }
        TypedKind::Call(call) => {
            let header = &cx.checker.instances.entries[call.unit.0 as usize].header;
            let args = call.args.iter().zip(&header.inputs);
            let args = args.filter_map(|(arg, port)| Some(((*arg)?, port.ty.clone())));
            let default = call.activation.default().map(|id| (id, expr.ty.clone()));
            args.chain(default).collect()
        }
        TypedKind::Prim(call) => {
            let ports = call.inputs.iter().zip(call.prim.desc().inputs);
            ports
                .filter_map(|(input, port)| Some(((*input)?, resolve_port_type(port.ty))))
                .collect()
        }
        _ => Vec::new(),
    }
}

/// Returns the parts of an array, struct or tuple expression, each with its type according to the type of the whole
/// expression.
fn part_types(cx: &Body<'_, '_>, id: ExprId) -> Vec<(ExprId, Ty)> {
    let expr = cx.unit.expr(id);
    match (&expr.kind, &expr.ty) {
        (TypedKind::Repeat(element), Ty::Array(ty, _)) => vec![(*element, (**ty).clone())],
        (TypedKind::Build(parts), Ty::Array(ty, _)) => {
            parts.iter().map(|part| (*part, (**ty).clone())).collect()
        }
        (TypedKind::Build(parts), ty) if ty.members().len() == parts.len() => {
            let parts = parts.iter().zip(ty.members());
            parts
                .map(|(part, member)| (*part, member.ty.clone()))
                .collect()
        }
        _ => Vec::new(),
    }
}

/// Sets the type of an expression whose type is unknown because it is, or contains, a `none`. Expressions of known
/// type, and of other kinds, remain unchanged.
fn set_none_type(cx: &mut Body<'_, '_>, id: ExprId, ty: &Ty) {
    let expr = &mut cx.unit.exprs[id.0 as usize];
    let passes_on = matches!(
        expr.kind,
        TypedKind::None
            | TypedKind::Each(..)
            | TypedKind::When { .. }
            | TypedKind::Current(_)
            | TypedKind::Merge { .. }
            | TypedKind::Repeat(_)
            | TypedKind::Build(_)
    );
    if passes_on && expr.ty.has_unknown() && !ty.has_unknown() {
        expr.ty = ty.clone().widened();
    }
}

/// Reports each `none` (absent value) of unknown type: at the flow whose type was to be inferred from it, otherwise at
/// the `none` itself.
fn report_untyped_none(cx: &mut Body<'_, '_>) {
    let mut reported: FastSet<ExprId> = FastSet::default();
    for block in (0..cx.unit.blocks.len()).map(|k| BlockId(u32::try_from(k).unwrap_or(0))) {
        for k in 0..cx.unit.block(block).equations.len() {
            let equation = &cx.unit.block(block).equations[k];
            let (value, flow) = match equation.targets[..] {
                [ref target] => match target.place {
                    TargetPlace::Flow { flow, .. } => (equation.value, flow),
                    _ => continue,
                },
                _ => continue,
            };
            let nones = untyped_nones_in(cx, value);
            if !nones.is_empty() && cx.unit.flow(flow).ty.has_unknown() {
                reported.extend(nones);
                report_none_flow(cx, flow);
            }
        }
    }
    for id in (0..).map(ExprId).take(cx.unit.exprs.len()) {
        if is_untyped_none(cx, id) && !reported.contains(&id) {
            let diagnostic = Diagnostic::new(Code::RPI2007, "cannot infer the type of this `none`")
                .primary(cx.span_of(id), "absent value of unknown type")
                .help("declare a flow with the type that is meant, `var nothing: ...?;` before `let`, and write `nothing = none;`");
            report::report_diagnostic(cx, diagnostic);
        }
    }
}

/// Returns each `none` (absent value) of unknown type within an expression.
fn untyped_nones_in(cx: &Body<'_, '_>, root: ExprId) -> Vec<ExprId> {
    let (mut parts, mut found) = (cx.unit.traverse(root), Vec::new());
    while let Some((id, _)) = parts.next() {
        if is_untyped_none(cx, id) {
            found.push(id);
        }
        parts.enter(id);
    }
    found
}

fn report_none_flow(cx: &mut Body<'_, '_>, flow: FlowId) {
    let why = "its equation is only `none`";
    let diagnostic = report_uninferred(cx.unit.flow(flow), why, "...?");
    report::report_diagnostic(cx, diagnostic);
}
