//! Arguments of a call and their assignment to ports.

use crate::check::bodies::body::Body;
use crate::check::bodies::locals;
use crate::check::calls::arg_tuples;
use crate::check::calls::frame_binding;
use crate::check::diagnostics::argument_order;
use crate::check::diagnostics::report;
use crate::check::diagnostics::report::ExpectationReason;
use crate::check::diagnostics::report::join_names;
use crate::check::exprs::expr;
use crate::check::exprs::names::plain_name;
use crate::check::signatures::header::Header;
use crate::check::signatures::header::Port;
use crate::check::signatures::static_params;
use crate::check::signatures::unit;
use crate::check::types::exact_time;
use crate::program::DeclId;
use crate::ty::Substitution;
use crate::ty::Ty;
use crate::ty::check_assignable;
use crate::typed::TypedKind;
use crate::typed::{ExprId, FlowRole, UnitKind};
use rpi_diag::{Code, Diagnostic, Fix, Quote, Span};
use rpi_syntax::Name;
use rpi_syntax::ast::{Arg, Expr, ExprKind, Ident};
use rpi_syntax::ops::BinaryOp;
use std::rc::Rc;

/// Argument of a call whose value has been checked.
#[derive(Clone, Copy)]
pub(crate) struct CallArgument<'a> {
    /// Name of the port or parameter; `None` if the argument is assigned by its position.
    pub(crate) name: Option<&'a Ident>,
    /// Typed expression of the argument.
    pub(crate) value: ExprId,
    /// Whether the argument is written in `<<...>>`. Its value must then be fixed when the command is loaded.
    pub(crate) is_static: bool,
}

impl<'a> CallArgument<'a> {
    /// Creates an argument without a name, which is assigned to a port by its position.
    pub(crate) fn positional(value: ExprId) -> CallArgument<'a> {
        CallArgument {
            name: None,
            value,
            is_static: false,
        }
    }
}

/// Checks the values of the arguments of a call, without comparing them with the ports of the callee.
pub(crate) fn check_args<'a>(cx: &mut Body<'_, 'a>, args: &'a [Arg]) -> Vec<CallArgument<'a>> {
    args.iter().map(|arg| check_arg(cx, arg)).collect()
}

fn check_arg<'a>(cx: &mut Body<'_, 'a>, arg: &'a Arg) -> CallArgument<'a> {
    let value = expr::check_expr(cx, &arg.value);
    CallArgument {
        name: arg.name.as_ref(),
        value,
        is_static: false,
    }
}

/// Checks the values of the arguments of a call of a declaration. Also returns whether the call can be checked further:
/// `false`, without arguments, if an argument is named by `=` instead of `:`, which is reported.
pub(crate) fn check_args_for<'a>(
    cx: &mut Body<'_, 'a>,
    id: DeclId,
    args: &[&'a Arg],
) -> (Vec<CallArgument<'a>>, bool) {
    let before = cx.diagnostics.len();
    let named = args.iter().filter(|arg| arg.name.is_none());
    let wrong = named
        .filter(|arg| report_arg_named_by_eq(cx, id, &arg.value))
        .count();
    if wrong > 0 {
        merge_named_by_eq(cx, before);
        return (Vec::new(), false);
    }
    (args.iter().map(|arg| check_arg(cx, arg)).collect(), true)
}

/// Merges the diagnostics about arguments named by `=` instead of `:` into one, without the first `before` diagnostics.
fn merge_named_by_eq(cx: &mut Body<'_, '_>, before: usize) {
    let by_eq = |diagnostic: &Diagnostic| diagnostic.code == Code::RPI1010;
    let mut others = cx.diagnostics.split_off(before).into_iter();
    let Some(mut first) = others.find(by_eq) else {
        return;
    };
    let mut rest = Vec::new();
    for diagnostic in others {
        if !by_eq(&diagnostic) {
            rest.push(diagnostic);
            continue;
        }
        first = first.secondary(diagnostic.span(), "and here");
        let edits = diagnostic.fixes.into_iter().flat_map(|fix| fix.edits);
        if let Some(fix) = first.fixes.first_mut() {
            fix.edits.extend(edits);
        }
    }
    cx.diagnostics.push(first);
    cx.diagnostics.extend(rest);
}

/// Whether the argument `value` is written `x = e` where `x` is the name of a parameter of declaration `id`, so that
/// `x: e` was meant. The error is reported.
pub(crate) fn report_arg_named_by_eq<'a>(
    cx: &mut Body<'_, 'a>,
    id: DeclId,
    value: &'a Expr,
) -> bool {
    let ExprKind::Binary(binary) = &value.kind else {
        return false;
    };
    let is_sign = matches!(binary.op, BinaryOp::Eq | BinaryOp::Implies);
    let Some(name) = plain_name(&binary.lhs).filter(|_| is_sign) else {
        return false;
    };
    if locals::find_local(cx, name).is_some() || !static_params::has_param(cx.checker, id, name) {
        return false;
    }
    let between = Span {
        start: binary.lhs.span.end,
        end: binary.rhs.span.start,
        ..value.span
    };
    let diagnostic = Diagnostic::new(
        Code::RPI1010,
        format!("expected `:` after the argument name `{name}`"),
    )
    .primary(
        between,
        format!("`{}` is a comparison", binary.op.spelling()),
    )
    // Not applied automatically: another argument of the call may really be a comparison of flows.
    .fix(Fix::maybe(format!("write `{name}: ...`")).replace(between, ": "));
    report::report_diagnostic(cx, diagnostic);
    expr::check_expr(cx, &binary.rhs);
    true
}

/// Returns for each in-port of a callable its argument, or `None` for a port that uses its default. Reports unknown,
/// missing and excess arguments and returns `None` if there are any.
pub(crate) fn match_args_to_ports<'a>(
    cx: &mut Body<'_, 'a>,
    header: &Rc<Header>,
    given: &[CallArgument<'a>],
    span: Span,
) -> Option<Vec<Option<ExprId>>> {
    let given = &arg_tuples::flatten_tuple_args_for(cx, header, given)[..];
    let mut args = vec![None; header.inputs.len()];
    let mut places = positional_ports(header).into_iter();
    let mut sound = true;
    for arg in given {
        let port = match arg.name {
            Some(name) => header.inputs.iter().position(|p| p.name == name.name),
            None => places.find(|k| args[*k].is_none()),
        };
        sound &= match port {
            Some(k) => assign_arg(cx, header, &mut args, k, arg),
            None => report_unexpected_arg(cx, header, arg, given),
        };
    }
    // An argument with a misspelt name is not reported as missing as well.
    (sound && check_missing_args(cx, header, &args, span)).then_some(args)
}

/// Stores `arg` as the argument of the port with index `k`. Reports a second argument for the port, and an argument
/// that must be fixed when the command is loaded but changes. Returns `false` after an error.
fn assign_arg<'a>(
    cx: &mut Body<'_, 'a>,
    header: &Header,
    args: &mut [Option<ExprId>],
    k: usize,
    arg: &CallArgument<'a>,
) -> bool {
    let port = &header.inputs[k];
    if let Some(first) = args[k].replace(arg.value) {
        let diagnostic = Diagnostic::new(Code::RPI1010, format!("`{}` is given twice", port.name))
            .primary(cx.span_of(arg.value), "given again here")
            .secondary(cx.span_of(first), "first given here");
        report::report_diagnostic(cx, diagnostic);
        return false;
    }
    if is_load_time_constant(cx, arg.value) {
        return true;
    }
    let diagnostic = match (arg.is_static, port.role) {
        (true, _) => varying_static(cx, header, port, arg.value),
        (false, FlowRole::Param) => varying_parameter(cx, header, port, arg.value),
        (false, _) => return true,
    };
    report::report_diagnostic(cx, diagnostic);
    false
}

/// Returns the diagnostic for an argument in `<<...>>` that changes while the command runs.
fn varying_static(cx: &Body<'_, '_>, header: &Header, port: &Port, value: ExprId) -> Diagnostic {
    let help = match port.role {
        FlowRole::Param => format!(
            "arguments in `<<...>>` are fixed at load time; in `{}`, declare `{}` as an in-port to let it change",
            without_statics(&header.name),
            port.name
        ),
        _ => format!(
            "arguments in `<<...>>` are fixed at load time; pass this one in `(...)`: `{}: {}`",
            port.name,
            Quote::text(cx.span_of(value))
        ),
    };
    let message = format!("`{}` must be fixed when the command is loaded", port.name);
    Diagnostic::new(Code::RPI2008, message)
        .primary(cx.span_of(value), "this changes while the command runs")
        .help(help)
}

/// Returns the diagnostic for an argument of a parameter if its value changes while the command runs.
fn varying_parameter(cx: &Body<'_, '_>, header: &Header, port: &Port, value: ExprId) -> Diagnostic {
    let help = match cx.unit.kind {
        // A command has no in-ports; it reads what changes itself.
        UnitKind::Task => format!(
            "pass a constant, or let `{}` read the value itself while it runs",
            header.name
        ),
        _ => format!(
            "pass a constant, or declare `{}` as an in-port, whose value may change",
            port.name
        ),
    };
    let message = format!(
        "the parameter `{}` of `{}` must be fixed when the command is loaded",
        port.name, header.name
    );
    Diagnostic::new(Code::RPI2008, message)
        .primary(cx.span_of(value), "this changes while the command runs")
        .secondary(port.span, "declared as a parameter here")
        .help(help)
}

/// Reports named arguments that match no port or parameter of a declaration; returns whether there are any.
pub(crate) fn report_unknown_args<'a>(
    cx: &mut Body<'_, 'a>,
    id: DeclId,
    given: &[CallArgument<'a>],
) -> bool {
    let ports = static_params::in_port_names(cx.checker, id);
    let params = static_params::static_params_of_decl(cx.checker, id);
    let names = ports.chain(params.iter().map(|param| &param.name().name));
    let names: Vec<&Name> = names.collect();
    let decl = cx.checker.program.decl(id);
    let named = given.iter().filter_map(|arg| arg.name);
    let clients = named.filter(|name| !names.contains(&&name.name));
    let clients: Vec<Diagnostic> = clients
        .map(|name| argument_order::unknown_arg(&decl.name, decl.span, &names, name, given))
        .collect();
    let any = !clients.is_empty();
    clients
        .into_iter()
        .for_each(|diagnostic| report::report_diagnostic(cx, diagnostic));
    any
}

/// Reports an argument without a port of the callee: an unknown name or one argument too many. Returns `false`.
fn report_unexpected_arg<'a>(
    cx: &mut Body<'_, 'a>,
    header: &Header,
    arg: &CallArgument<'a>,
    given: &[CallArgument<'a>],
) -> bool {
    let (ports, count) = (positional_ports(header).len(), given.len());
    let diagnostic = match arg.name {
        Some(name) => {
            let names: Vec<&Name> = header.inputs.iter().map(|p| &p.name).collect();
            argument_order::unknown_arg(&header.name, header.span, &names, name, given)
        }
        None => Diagnostic::new(
            Code::RPI1010,
            format!(
                "`{}` takes {}, found {count}",
                header.name,
                rpi_diag::with_noun(ports, "argument")
            ),
        )
        .primary(cx.span_of(arg.value), "unexpected argument")
        .secondary(header.span, "declared here")
        .help(format!("it is declared as `{}`", signature_text(header))),
    };
    report::report_diagnostic(cx, diagnostic);
    false
}

/// Whether every port without a default value has an argument. Reports the missing arguments.
fn check_missing_args(
    cx: &mut Body<'_, '_>,
    header: &Rc<Header>,
    args: &[Option<ExprId>],
    span: Span,
) -> bool {
    let ports = header.inputs.iter().enumerate().zip(args);
    // Values that a command takes over from its predecessor are not arguments.
    let open = ports.filter(|((_, port), arg)| {
        arg.is_none() && !port.has_default && port.role != FlowRole::TakenOver
    });
    let open: Vec<(usize, &Port)> = open.map(|(port, _)| port).collect();
    let may_lack = open.iter().all(|(_, port)| port.is_static) && !cx.inference.is_running;
    if open.is_empty() || may_lack && unit::reads_no_ports(cx.checker, header, &open, span) {
        return true;
    }
    let open: Vec<Name> = open.iter().map(|(_, port)| port.name.clone()).collect();
    let names = join_names(open.iter().map(Name::as_str));
    let noun = ["arguments", "argument"][usize::from(open.len() == 1)];
    let signature = signature_text(header);
    let help = match (&open[..], unit::reads_rpi_syntax(cx)) {
        ([only], true) => {
            format!("add `{only}: ...` to the arguments; it is declared as `{signature}`")
        }
        _ => format!("it is declared as `{signature}`"),
    };
    let diagnostic = Diagnostic::new(
        Code::RPI1010,
        format!("missing {noun} {names} of `{}`", header.name),
    )
    .primary(span, format!("no value for {names}"))
    .secondary(header.span, "declared here")
    .help(help);
    report::report_diagnostic(cx, diagnostic);
    false
}

/// Checks the types of the arguments against the ports of the callee. Infers the types and frames that the signature
/// leaves open, and stores them in `subst`. Returns whether all types match.
pub(crate) fn check_arg_types(
    cx: &mut Body<'_, '_>,
    header: &Header,
    args: &mut [Option<ExprId>],
    subst: &mut Substitution,
) -> bool {
    let mut sound = true;
    if argument_order::report_wrong_order(cx, header, args, subst) {
        return false;
    }
    exact_time::convert_time_args(cx, header, args);
    for (port, arg) in header.inputs.iter().zip(&*args) {
        match arg {
            Some(arg) => frame_binding::bind_device_frames(cx, port, *arg, subst),
            None => frame_binding::bind_omitted_frame(header, port, subst),
        }
    }
    for (port, arg) in header.inputs.iter().zip(&*args) {
        let Some(arg) = *arg else {
            continue;
        };
        let found = cx.ty_of(arg).clone();
        match check_assignable(&port.ty, &found, subst) {
            Ok(()) => sound &= expr::check_angle_unit(cx, arg, &port.ty),
            Err(misfit) => {
                let expected = port.ty.substituted(subst);
                let text = format!("`{}` is `{expected}`", port.name);
                let reason = ExpectationReason::Because(port.span, text);
                report::type_mismatch(cx, arg, &expected, &misfit, &reason);
                sound = false;
            }
        }
    }
    sound
}

/// Whether the value of an expression is the same in all cycles, because it depends on constants and parameters only.
pub(crate) fn is_load_time_constant(cx: &Body<'_, '_>, id: ExprId) -> bool {
    let mut parts = cx.unit.traverse(id);
    while let Some((id, expr)) = parts.next() {
        let fixed = match &expr.kind {
            // Devices are the same in all cycles, those given to a fragment, too.
            TypedKind::Flow(flow) => {
                cx.unit.flow(*flow).role == FlowRole::Param || matches!(expr.ty, Ty::Device(_))
            }
            TypedKind::Sensor { .. }
            | TypedKind::When { .. }
            | TypedKind::Merge { .. }
            | TypedKind::Current(_) => false,
            TypedKind::Each(each, _) => {
                matches!(
                    each,
                    crate::typed::ElementwiseOp::If | crate::typed::ElementwiseOp::Coalesce
                )
            }
            TypedKind::Prim(call) => {
                let desc = call.prim.desc();
                desc.role == rpi_image::Role::Compute
                    && matches!(desc.state, rpi_image::StateSize::None)
            }
            TypedKind::Call(call) => {
                cx.checker.units[call.unit.0 as usize].kind == UnitKind::Function
            }
            _ => true,
        };
        if !fixed {
            return false;
        }
        parts.enter(id);
    }
    true
}

/// Returns the name of a callable without its static arguments: `f` for `f<<3>>`.
pub(crate) fn without_statics(name: &Name) -> &str {
    name.split("<<").next().unwrap_or(name)
}

/// Returns the name of a callable and its in-ports with their types, for messages. A long list of ports is cut off.
pub(crate) fn signature_text(header: &Header) -> String {
    const LONGEST: usize = 6;
    let wanted = |port: &&Port| port.role != FlowRole::TakenOver;
    let mut ports: Vec<String> = Vec::new();
    for port in header.inputs.iter().filter(wanted).take(LONGEST) {
        ports.push(match port.ty.is_unknown() {
            true => port.name.to_string(),
            false => format!("{}: {}", port.name, port.ty),
        });
    }
    if header.inputs.iter().filter(wanted).count() > LONGEST {
        ports.push("...".to_owned());
    }
    format!("{}({})", header.name, ports.join("; "))
}

/// Returns the indices, among the in-ports of a callable, of the ports that take positional arguments.
pub(crate) fn positional_ports(header: &Header) -> Vec<usize> {
    let wanted = |port: &Port| match (header.kind, port.role) {
        (kind, role) if kind.is_root() => role == FlowRole::Param,
        (_, FlowRole::Param) => !port.is_static,
        (_, role) => role == FlowRole::Input,
    };
    let ports = header.inputs.iter().enumerate();
    ports
        .filter(|(_, port)| wanted(port))
        .map(|(k, _)| k)
        .collect()
}
