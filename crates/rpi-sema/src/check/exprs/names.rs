//! Names in expressions.

use crate::check::Constant;
use crate::check::bodies::body::Body;
use crate::check::bodies::contract;
use crate::check::bodies::locals;
use crate::check::bodies::locals::Local;
use crate::check::bodies::type_inference;
use crate::check::calls::prim;
use crate::check::diagnostics::foreign;
use crate::check::diagnostics::report;
use crate::check::diagnostics::report::undefined_name;
use crate::check::diagnostics::report::wrong_kind_of_name;
use crate::check::diagnostics::undefined_names;
use crate::check::exprs::access;
use crate::check::exprs::bindings;
use crate::check::signatures::static_args::StaticBinding;
use crate::check::signatures::unit;
use crate::check::types::consts;
use crate::check::types::data;
use crate::check::types::type_decls;
use crate::program::{Decl, DeclId, DeclKind, Lookup, NameSpace};
use crate::ty::Ty;
use crate::typed::TypedKind;
use crate::typed::predeclared::PREDECLARED_FLOWS;
use crate::typed::{BlockId, ExprId, FlowId, Leaf, UnitKind};
use rpi_diag::{Code, Diagnostic, Fix, Span};
use rpi_syntax::Name;
use rpi_syntax::ast::{self, CommandDecl, ExprKind};

/// Returns a typed expression that reads a plain or qualified name: a flow, constant, static parameter or predeclared
/// name. Reports an undefined name.
pub(crate) fn resolve_name(cx: &mut Body<'_, '_>, name: &Name, span: Span) -> ExprId {
    if let Some(bound) = bindings::read_binding(cx, name, span) {
        return bound;
    }
    if let Some(mode) = name.strip_prefix("::") {
        return contract::mode_condition(cx, mode, span);
    }
    if let Some(local) = locals::find_local(cx, name) {
        return resolve_local(cx, name, &local, span);
    }
    match cx.statics.get(name) {
        Some(StaticBinding::Value(constant)) => {
            cx.static_read_count += 1;
            let constant = constant.clone();
            return constant_expr(cx, &constant, span);
        }
        Some(_) => return not_a_flow(cx, name, "a static parameter", span, span),
        None => {}
    }
    match cx
        .checker
        .program
        .lookup_in(NameSpace::Value, cx.module, name)
    {
        Lookup::Found(id) => resolve_declared(cx, id, span),
        Lookup::Missing => resolve_predeclared(cx, name, span),
    }
}

fn resolve_local(cx: &mut Body<'_, '_>, name: &Name, local: &Local, span: Span) -> ExprId {
    match local {
        Local::Flow(flow) => flow_expr(cx, *flow, span),
        Local::Constant(constant) => constant_expr(cx, constant, span),
        // Fragments and states are not flows. A state may share its name with the constant or enum value that holds
        // in it.
        _ if let Some(value) = value_named(cx, name) => resolve_declared(cx, value, span),
        Local::Block(block) => not_a_value(cx, name, "a fragment", *block, span),
        Local::State(block) => not_a_value(cx, name, "a state", *block, span),
        Local::AmbiguousState(places, _) => ambiguous_state(cx, name, *places, span),
    }
}

fn not_a_value(
    cx: &mut Body<'_, '_>,
    name: &Name,
    what: &str,
    block: BlockId,
    span: Span,
) -> ExprId {
    let declared = cx.unit.block(block).span;
    let diagnostic = wrong_kind_of_name("a flow", name, what, span, declared)
        .help(format!("read one of its flows: `{name}.x`"));
    cx.report_error_expr(diagnostic, span)
}

/// Reports a name that is a state of several automata and is read outside of them. `first` and `second` are the
/// locations of two of the states. Returns an expression without a value.
pub(crate) fn ambiguous_state(
    cx: &mut Body<'_, '_>,
    name: &Name,
    [first, second]: [Span; 2],
    span: Span,
) -> ExprId {
    let message = format!("`{name}` is a state of more than one automaton");
    let diagnostic = Diagnostic::new(Code::RPI1002, message)
        .primary(span, "ambiguous name")
        .secondary(first, "one candidate")
        .secondary(second, "another candidate")
        .help("give one of them another name");
    cx.report_error_expr(diagnostic, span)
}

/// Returns the declaration of the constant or enum value with this name; `None` if there is none.
fn value_named(cx: &Body<'_, '_>, name: &Name) -> Option<DeclId> {
    let Lookup::Found(id) = cx
        .checker
        .program
        .lookup_in(NameSpace::Value, cx.module, name)
    else {
        return None;
    };
    let kind = &cx.checker.program.decl(id).kind;
    matches!(kind, DeclKind::Const(_) | DeclKind::EnumValue { .. }).then_some(id)
}

/// Adds an expression that reads a flow and returns it.
pub(crate) fn flow_expr(cx: &mut Body<'_, '_>, flow: FlowId, span: Span) -> ExprId {
    if cx.inference.is_running {
        type_inference::record_unknown_read(cx, flow, span);
    }
    let ty = cx.unit.flow(flow).ty.clone();
    cx.add(TypedKind::Flow(flow), ty, span)
}

/// Adds an expression with the value of a constant and returns it.
pub(crate) fn constant_expr(cx: &mut Body<'_, '_>, constant: &Constant, span: Span) -> ExprId {
    let kind = match &constant.leaves[..] {
        [one] => TypedKind::Literal(one.clone()),
        _ => TypedKind::Const(constant.leaves.clone()),
    };
    // Constants are evaluated without a known tick length, so times are in seconds there.
    let ty = match &constant.ty {
        Ty::Duration if cx.unit.kind == UnitKind::Constant => crate::ty::machine_types::SECONDS,
        ty => ty.clone(),
    };
    cx.add(kind, ty, span)
}

fn resolve_declared(cx: &mut Body<'_, '_>, id: DeclId, span: Span) -> ExprId {
    let decl = cx.checker.program.decl(id).clone();
    match decl.kind {
        DeclKind::Const(_) => match consts::check_constant(cx.checker, id) {
            Some(constant) => constant_expr(cx, &constant, span),
            None => cx.error_expr(span),
        },
        DeclKind::EnumValue { ty, index } => {
            let ty = type_decls::type_decl(cx.checker, ty);
            cx.add(TypedKind::Literal(Leaf::int(index.into())), ty, span)
        }
        DeclKind::Constructor { ty, index } => {
            data::constructor_value(cx, (ty, index), &[], &[], span)
        }
        DeclKind::Broken(_) => cx.error_expr(span),
        DeclKind::Frame(frame) => match consts::check_constant(cx.checker, id) {
            Some(constant) => constant_expr(cx, &constant, span),
            None if frame.pose.is_some() => cx.error_expr(span),
            None => {
                let diagnostic =
                    wrong_kind_of_name("a flow", &decl.name, "a frame", span, decl.span);
                cx.report_error_expr(
                    diagnostic.help(format!(
                        "a frame has a pose if its declaration gives one: `frame {} in ... = pose(...);`",
                        decl.name
                    )),
                    span,
                )
            }
        },
        kind => not_a_flow(cx, &decl.name, kind.description(), span, decl.span),
    }
}

fn not_a_flow(cx: &mut Body<'_, '_>, name: &str, is: &str, span: Span, declared: Span) -> ExprId {
    let diagnostic = wrong_kind_of_name("a flow", name, is, span, declared);
    let help = "write a value here: a number, a flow or a constant";
    cx.report_error_expr(diagnostic.help(help), span)
}

fn resolve_predeclared(cx: &mut Body<'_, '_>, name: &Name, span: Span) -> ExprId {
    if name == "none" {
        return cx.add(TypedKind::None, Ty::Unknown, span);
    }
    let found = PREDECLARED_FLOWS.iter().find(|flow| name == flow.name);
    match found.filter(|_| unit::reads_rpi_syntax(cx)) {
        Some(flow) if flow.only_in_commands && cx.unit.kind == UnitKind::Function => {
            command_flow_in_function(cx, flow.name, span)
        }
        Some(flow) => {
            if !flow.only_in_commands {
                cx.record_state(span);
            }
            prim::add_nullary_prim(cx, flow.prim, flow.ty.clone(), span)
        }
        None => undefined_flow(cx, name, span),
    }
}

fn command_flow_in_function(cx: &mut Body<'_, '_>, name: &str, span: Span) -> ExprId {
    let diagnostic = Diagnostic::new(Code::RPI3005, format!("a function cannot read `{name}`"))
        .primary(span, "it belongs to the running command")
        .help("pass it to the function as an argument, or declare the function as a node");
    cx.report_error_expr(diagnostic, span)
}

/// Returns the name of the constant or enum value that is most similar to `name`; `None` if none is similar enough.
fn similar_value(cx: &Body<'_, '_>, name: &Name) -> Option<String> {
    let is_value = |id: DeclId| {
        let kind = cx.checker.program.decl(id).kind;
        matches!(kind, DeclKind::Const(_) | DeclKind::EnumValue { .. })
    };
    let values = cx.checker.program.visible_names(cx.module, is_value);
    cx.checker.suggest(name, values)
}

fn undefined_flow(cx: &mut Body<'_, '_>, name: &Name, span: Span) -> ExprId {
    if let Some(value) = access::enum_value_by_path(cx, name, span) {
        return value;
    }
    if !cx.record_undefined(name) {
        return cx.error_expr(span);
    }
    if let Some(diagnostic) = contract::hidden_local_error(cx, name, span) {
        return cx.report_error_expr(diagnostic, span);
    }
    let near = cx.checker.suggest(name, locals::local_names(cx));
    let near = near.or_else(|| similar_value(cx, name));
    if cx.unit.kind == UnitKind::Task {
        let diagnostic = undefined_name("device or parameter", name, span, near);
        report::report_diagnostic(
            cx,
            diagnostic.help(format!(
                "declare the devices of a task as its parameters: `task {} ({name}: ...)`",
                cx.unit.name
            )),
        );
        return cx.error_expr(span);
    }
    let predeclared = PREDECLARED_FLOWS.iter().map(|flow| flow.name);
    let values = ["true", "false", "none"].into_iter();
    let is_near = near.is_some();
    let near = near.or_else(|| rpi_diag::suggest(name, predeclared.chain(values)));
    if let Some(help) = foreign::foreign_value_help(name).filter(|_| !is_near) {
        let diagnostic = undefined_name(
            crate::check::diagnostics::undefined_names::FLOW_KIND,
            name,
            span,
            None,
        );
        report::report_diagnostic(cx, diagnostic.help(help));
        return cx.error_expr(span);
    }
    if let Some(diagnostic) = flow_of_fragment(cx, name, span) {
        undefined_names::report_undefined_flow(cx, name, diagnostic);
        return cx.error_expr(span);
    }
    let is_meant = |_: &&str| !is_near || !foreign::is_common_word(name);
    match foreign::value_equivalent(name).filter(is_meant) {
        Some(here) => undefined_names::report_foreign_name(cx, "value", name, span, here),
        None => undefined_names::report_undefined(
            cx,
            crate::check::diagnostics::undefined_names::FLOW_KIND,
            name,
            span,
            near,
        ),
    }
    cx.error_expr(span)
}

/// Returns the diagnostic for reading a flow that only an inline fragment or a state in the current block declares.
/// From outside, the flow must be read through the name of the fragment: `Filter.smooth`. `None` if no fragment or
/// state declares the name.
fn flow_of_fragment(cx: &Body<'_, '_>, name: &Name, span: Span) -> Option<Diagnostic> {
    let block = &cx.unit.block(locals::inner_block_of_flow(cx, name)?).name;
    let path = format!("{block}.{name}");
    let message = format!("undefined flow `{name}`");
    let diagnostic = Diagnostic::new(Code::RPI1001, message)
        .primary(span, format!("declared in `{block}`, not here"))
        .help(format!(
            "read it through its fragment or state as `{path}`, and give a value by `?? ...` for the cycles in which `{block}` is inactive"
        ));
    Some(diagnostic.fix(Fix::maybe(format!("write `{path}`")).replace(span, path)))
}

/// Returns an expression for `MoveToC.at_b`: the identity (a number) of the result `at_b` of the command `MoveToC`.
/// `None` if `name` is not a command.
pub(crate) fn command_result(
    cx: &mut Body<'_, '_>,
    name: &Name,
    field: &ast::Ident,
    span: Span,
) -> Option<ExprId> {
    if locals::find_local(cx, name).is_some() {
        return None;
    }
    let Lookup::Found(id) = cx.checker.program.lookup(cx.module, name) else {
        return None;
    };
    let Decl { kind, .. } = cx.checker.program.decl(id);
    let DeclKind::Command(command) = *kind else {
        return None;
    };
    let results = result_names(command);
    if !results.contains(&&field.name) {
        let near = rpi_diag::suggest(&field.name, results.iter().map(|name| name.as_str()));
        let of = format!("the command `{name}`");
        let diagnostic =
            crate::check::diagnostics::report::no_member(&of, &field.name, field.span, near).help(
                report::members_help("result", results.iter().map(|n| n.as_str())),
            );
        return Some(cx.report_error_expr(diagnostic, span));
    }
    let identity = result_identity(&format!("{name}.{}", field.name));
    Some(cx.add(TypedKind::Literal(Leaf::int(identity)), Ty::Result, span))
}

/// Returns a typed expression for a dotted name, as in `export a.b`. Reports an undefined part.
pub(crate) fn resolve_dotted<'a>(cx: &mut Body<'_, 'a>, dotted: &'a ast::Dotted) -> ExprId {
    let [first, rest @ ..] = &dotted.parts[..] else {
        return cx.error_expr(dotted.span);
    };
    if let (Some(Local::Block(block) | Local::State(block)), [field, after @ ..]) =
        (locals::find_local(cx, &first.name), rest)
    {
        let of_block = access::block_member(cx, block, field, first.span.merge(field.span));
        return after.iter().fold(of_block, |base, field| {
            access::member_access(cx, base, field)
        });
    }
    let base = resolve_name(cx, &first.name, first.span);
    rest.iter()
        .fold(base, |base, field| access::member_access(cx, base, field))
}

/// Returns the names of the results with which a command can end, in text order.
pub(crate) fn result_names(command: &CommandDecl) -> Vec<&Name> {
    let ends = end_statements(command).into_iter();
    ends.map(|end| &end.result.name).collect()
}

/// Returns the statements of a command that can end it, in text order.
pub(crate) fn end_statements(command: &CommandDecl) -> Vec<&ast::CommandEnd> {
    let statements = command.body.statements.iter();
    let ends = statements.filter_map(|statement| match &statement.kind {
        ast::StatementKind::CommandEnd(end) => Some(end.as_ref()),
        _ => None,
    });
    ends.collect()
}

/// Returns the run-time identity of a command's result: the 64-bit FNV-1a hash (Fowler, Noll, Vo) of `Command.result`,
/// given as `path`.
#[must_use]
pub fn result_identity(path: &str) -> i64 {
    let step = |hash: u64, byte: u8| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
    path.bytes().fold(0xcbf2_9ce4_8422_2325, step).cast_signed()
}

/// Returns the name if an expression is only a name, with or without parentheses; `None` otherwise.
pub(crate) fn plain_name(expr: &ast::Expr) -> Option<&Name> {
    match &expr.unparen().kind {
        ExprKind::Name(name) => Some(name),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn identities_are_those_of_fnv_1a() {
        assert_eq!(result_identity("").cast_unsigned(), 0xcbf2_9ce4_8422_2325);
        assert_eq!(result_identity("a").cast_unsigned(), 0xaf63_dc4c_8601_ec8c);
    }
}
