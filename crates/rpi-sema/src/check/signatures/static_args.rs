//! Static arguments: the arguments in `<<...>>`, bound to static parameters.

use crate::check::Constant;
use crate::check::bodies::body::Body;
use crate::check::bodies::statement;
use crate::check::calls::args;
use crate::check::calls::args::CallArgument;
use crate::check::calls::callable::Callable;
use crate::check::calls::callee;
use crate::check::diagnostics::report;
use crate::check::diagnostics::report::join_names;
use crate::check::diagnostics::report::undefined_name;
use crate::check::exprs::expr;
use crate::check::signatures::callable_args;
use crate::check::signatures::static_params;
use crate::check::signatures::static_params::StaticParamDecl;
use crate::check::signatures::unit;
use crate::check::types;
use crate::check::types::consts;
use crate::check::types::subrange;
use crate::program::{DeclId, DeclKind};
use crate::ty::Ty;
use crate::typed::ExprId;
use rpi_diag::{Code, Diagnostic, Fix, Span};
use rpi_syntax::Name;
use rpi_syntax::ast::{Arg, ConstDef, Expr, ExprKind, Ident, Signature, StaticArg, StaticValue};
use std::collections::BTreeMap;
use std::rc::Rc;

/// Value of a static parameter for one instance.
#[derive(Clone, Debug)]
pub(crate) enum StaticBinding {
    /// The parameter is a type parameter, and this is its type.
    Type(Ty),
    /// The parameter has this value, which is known at compile time.
    Value(Constant),
    /// The value is known only when the command is loaded. The parameter is a flow of the body.
    LoadTime,
    /// The parameter stands for this callable. If the ports of the callable differ from those of the parameter, the
    /// diagnostic is reported when the parameter is called.
    Callable(Callable, Option<Rc<Diagnostic>>),
}

/// Values of the static parameters of a callable, by name.
pub(crate) type StaticBindings = BTreeMap<Name, StaticBinding>;

impl<'a> StaticParamDecl<'a> {
    pub(crate) fn name(&self) -> &'a Ident {
        match self {
            StaticParamDecl::Type(name, _) | StaticParamDecl::Value(name, _) => name,
            StaticParamDecl::Node(signature) => &signature.name,
        }
    }
}

/// Static arguments of a call, assigned to the parameters of the callee.
pub(crate) struct BoundStatics<'a> {
    /// Values of the static parameters that have an argument.
    pub(crate) statics: StaticBindings,
    /// Arguments for in-ports, and for static parameters whose values are known only when the command is loaded.
    pub(crate) ports: Vec<CallArgument<'a>>,
    /// Whether an error has been reported.
    pub(crate) has_error: bool,
}

/// Assigns static arguments to the static parameters of declaration `id`. Arguments for which there is no static
/// parameter are assigned to in-ports. Reports excess arguments.
pub(crate) fn bind_statics<'a>(
    cx: &mut Body<'_, 'a>,
    id: DeclId,
    args: &'a [StaticArg],
) -> BoundStatics<'a> {
    let params = static_params::static_params_of_decl(cx.checker, id);
    let mut bound = BoundStatics {
        statics: StaticBindings::new(),
        ports: Vec::new(),
        has_error: false,
    };
    let mut places = params.iter();
    for arg in args {
        let param = match &arg.name {
            None => places.next().copied(),
            Some(name) => params.iter().copied().find(|p| p.name().name == name.name),
        };
        if let (None, StaticValue::Expr(value)) = (&arg.name, &arg.value)
            && args::report_arg_named_by_eq(cx, id, value)
        {
            bound.has_error = true;
            continue;
        }
        match (param, &arg.name) {
            (Some(param), _) => bind_param(cx, id, param, arg, &mut bound),
            (None, Some(name)) => bind_port(cx, Some(name), arg, &mut bound),
            (None, None) if may_be_for_port(cx, id, &params, arg) => {
                bind_port(cx, None, arg, &mut bound);
            }
            (None, None) => {
                too_many_static_args(cx, id, params.len(), arg.span);
                bound.has_error = true;
            }
        }
    }
    bound
}

/// Assigns the arguments for `const` in-ports of the node `id`, which determine array sizes, to `bound`. Returns the
/// other arguments.
pub(crate) fn bind_sizes<'a>(
    cx: &mut Body<'_, 'a>,
    id: DeclId,
    args: &'a [Arg],
    bound: &mut BoundStatics<'a>,
) -> Vec<&'a Arg> {
    let DeclKind::Node(node) = cx.checker.program.decl(id).kind else {
        return args.iter().collect();
    };
    let ports = node
        .signature
        .inputs
        .iter()
        .flatten()
        .flat_map(|port| &port.names);
    let ports: Vec<&'a Ident> = ports.collect();
    let sizes = static_params::size_params(node);
    let mut left = Vec::new();
    for (k, arg) in args.iter().enumerate() {
        let port = match &arg.name {
            Some(name) => Some(name),
            None => ports.get(k).copied(),
        };
        let size = sizes
            .iter()
            .find(|size| port.is_some_and(|port| port.name == size.name().name));
        match size {
            Some(StaticParamDecl::Value(name, def)) => bind_size(cx, id, name, def, arg, bound),
            _ => left.push(arg),
        }
    }
    left
}

fn bind_size<'a>(
    cx: &mut Body<'_, 'a>,
    id: DeclId,
    name: &Ident,
    def: &'a ConstDef,
    arg: &'a Arg,
    bound: &mut BoundStatics<'a>,
) {
    let ty = static_params::static_param_type(cx.checker, id, def, &bound.statics);
    match consts::const_value(cx, &arg.value, &ty) {
        Some(leaves) => {
            bound.statics.insert(
                name.name.clone(),
                StaticBinding::Value(Constant { ty, leaves }),
            );
        }
        None => {
            bound.has_error = true;
            label_size_parameter(cx, name, arg);
        }
    }
}

/// Adds to the diagnostic about an argument that is not constant that its parameter decides the size of an array.
fn label_size_parameter(cx: &mut Body<'_, '_>, name: &Ident, arg: &Arg) {
    let last = cx.diagnostics.last_mut();
    let is_about = |diagnostic: &&mut Diagnostic| {
        diagnostic.code == Code::RPI2008 && arg.value.span.contains(diagnostic.span())
    };
    if let Some(diagnostic) = last.filter(is_about) {
        let text = format!(
            "`{}` decides the size of an array: it must be a constant",
            name.name
        );
        diagnostic.add_secondary(name.span, text);
    }
}

/// Whether a positional static argument for which no static parameter is left may be for an in-port:
/// `on_delay<<500[ms]>>(x)`.
fn may_be_for_port(
    cx: &Body<'_, '_>,
    id: DeclId,
    params: &[StaticParamDecl<'_>],
    arg: &StaticArg,
) -> bool {
    let has_values = params
        .iter()
        .any(|param| !matches!(param, StaticParamDecl::Type(..)));
    let has_ports = static_params::in_port_names(cx.checker, id)
        .next()
        .is_some();
    unit::reads_rpi_syntax(cx)
        && !has_values
        && has_ports
        && matches!(arg.value, StaticValue::Expr(_))
}

/// Assigns a static argument to an in-port, by its name or to the first in-port that has no argument in `(...)`.
fn bind_port<'a>(
    cx: &mut Body<'_, 'a>,
    name: Option<&'a Ident>,
    arg: &'a StaticArg,
    bound: &mut BoundStatics<'a>,
) {
    let Some(value) = static_expr(cx, arg) else {
        bound.has_error = true;
        return;
    };
    bound.ports.push(CallArgument {
        name,
        value,
        is_static: true,
    });
}

fn static_expr<'a>(cx: &mut Body<'_, 'a>, arg: &'a StaticArg) -> Option<ExprId> {
    match &arg.value {
        StaticValue::Expr(expr) => Some(expr::check_expr(cx, expr)),
        _ => {
            let diagnostic = Diagnostic::new(Code::RPI1010, "a value is expected here")
                .primary(arg.span, "not a value")
                .help("write a constant expression here");
            report::report_diagnostic(cx, diagnostic);
            None
        }
    }
}

/// Extends the error that has just been reported about `f<<bool>>`, where a value is expected, by the declaration of
/// the parameter `name`.
fn expected_value_hint(cx: &mut Body<'_, '_>, id: DeclId, name: &Ident, arg: &StaticArg) {
    let of = &cx.checker.program.decl(id).name;
    let what = match &arg.value {
        StaticValue::Type(_) => "this is a type",
        StaticValue::Op(_) => "this is an operator",
        _ => "this is a callable",
    };
    let text = format!("`{}` of `{of}` is declared here", name.name);
    if let Some(diagnostic) = cx.diagnostics.last_mut() {
        if let Some(label) = diagnostic.labels.first_mut() {
            label.text = what.to_owned();
        }
        diagnostic.add_secondary(name.span, text);
    }
}

fn too_many_static_args(cx: &mut Body<'_, '_>, id: DeclId, count: usize, span: Span) {
    let decl = cx.checker.program.decl(id);
    let diagnostic = Diagnostic::new(
        Code::RPI1010,
        format!(
            "too many static arguments for `{}`: expected {count}",
            decl.name
        ),
    )
    .primary(span, "unexpected argument")
    .secondary(decl.span, "declared here")
    .help("delete it, or pass it in `(...)` if it is a value of an in-port");
    report::report_diagnostic(cx, diagnostic);
}

/// Returns the value of a static parameter that stands for a node: the callable in `arg`, compared with the ports in
/// `signature`. `known` are the values of the other parameters. `None` after an error.
fn static_node<'a>(
    cx: &mut Body<'_, 'a>,
    id: DeclId,
    signature: &'a Signature,
    arg: &'a StaticArg,
    known: &StaticBindings,
) -> Option<StaticBinding> {
    let callable = callable_args::static_callable(cx, arg)?;
    let callable = callee::require_portable(cx, callable)?;
    let misfit = callable_args::port_mismatch(cx, id, known, signature, &callable, arg.span);
    Some(StaticBinding::Callable(callable, misfit.map(Rc::new)))
}

fn bind_param<'a>(
    cx: &mut Body<'_, 'a>,
    id: DeclId,
    param: StaticParamDecl<'a>,
    arg: &'a StaticArg,
    bound: &mut BoundStatics<'a>,
) {
    let name = param.name();
    let value = match param {
        StaticParamDecl::Type(..) => static_type(cx, arg).map(StaticBinding::Type),
        StaticParamDecl::Node(signature) => static_node(cx, id, signature, arg, &bound.statics),
        StaticParamDecl::Value(_, def) => {
            let Some(value) = static_expr(cx, arg) else {
                expected_value_hint(cx, id, name, arg);
                bound.has_error = true;
                return;
            };
            Some(bind_value(cx, id, def, name, value, bound))
        }
    };
    match value {
        Some(value) => {
            bound.statics.insert(name.name.clone(), value);
        }
        None => bound.has_error = true,
    }
}

/// Returns the value of the static parameter `name`. A value that may determine sizes is evaluated and becomes part of
/// the instance; other values are passed as arguments when the command is loaded.
fn bind_value<'a>(
    cx: &mut Body<'_, 'a>,
    id: DeclId,
    def: &'a ConstDef,
    name: &'a Ident,
    value: ExprId,
    bound: &mut BoundStatics<'a>,
) -> StaticBinding {
    let ty = static_params::static_param_type(cx.checker, id, def, &bound.statics);
    let wanted = crate::check::diagnostics::report::ExpectationReason::Because(
        name.span,
        format!("`{}` is `{ty}`", name.name),
    );
    statement::expect_type(cx, value, &ty, &wanted);
    if static_params::distinguishes_instances(&ty)
        && let Some(leaves) = consts::fold_silently(cx, value)
    {
        bound.has_error |= !subrange::is_in_subranges(cx, &leaves, &ty, cx.span_of(value));
        return StaticBinding::Value(Constant { ty, leaves });
    }
    bound.ports.push(CallArgument {
        name: Some(name),
        value,
        is_static: true,
    });
    StaticBinding::LoadTime
}

pub(crate) fn static_type<'a>(cx: &mut Body<'_, 'a>, arg: &'a StaticArg) -> Option<Ty> {
    match &arg.value {
        StaticValue::Type(ty) => Some(types::resolve_type(cx, ty)),
        StaticValue::Expr(expr) => type_by_name(cx, expr),
        _ => {
            let diagnostic = Diagnostic::new(Code::RPI1010, "a type is expected here")
                .primary(arg.span, "not a type");
            report::report_diagnostic(cx, diagnostic);
            None
        }
    }
}

/// Returns the type whose name was parsed as the expression `expr`. Reports any other expression and returns `None`.
fn type_by_name<'a>(cx: &mut Body<'_, 'a>, expr: &'a Expr) -> Option<Ty> {
    let ExprKind::Name(name) = &expr.kind else {
        let diagnostic = Diagnostic::new(Code::RPI1010, "a type is expected here")
            .primary(expr.span, "this is a value")
            .fix(Fix::maybe("mark it as a type").insert_before(expr.span, "type "));
        report::report_diagnostic(cx, diagnostic);
        return None;
    };
    types::type_by_plain_name(cx, name, expr.span)
}

/// Returns the diagnostic for a call of `name` at `span` in which the static arguments `open` are missing.
pub(crate) fn missing_static_args(
    name: &Name,
    open: &[Name],
    span: Span,
    declared: Span,
) -> Diagnostic {
    let names = join_names(open.iter().map(Name::as_str));
    let form: Vec<String> = open.iter().map(|param| format!("{param}: ...")).collect();
    let form = form.join(", ");
    Diagnostic::new(
        Code::RPI1010,
        format!("missing static arguments of `{name}`: {names}"),
    )
    .primary(span, "required in `<<...>>`")
    .secondary(declared, "declared here")
    .help(format!("write them after the name: `{name}<<{form}>>`"))
}

/// Returns the diagnostic for a static argument `name` for which `of` has no parameter. `near` is a similar parameter
/// to suggest.
pub(crate) fn unknown_static_param(of: &Name, name: &Ident, near: Option<String>) -> Diagnostic {
    // Without the static arguments in the name of an instance, which are not part of the error.
    let of = of.split("<<").next().unwrap_or(of);
    let diagnostic = undefined_name(
        &format!("static parameter of `{of}`:"),
        &name.name,
        name.span,
        near,
    );
    diagnostic.note(format!(
        "`<<...>>` takes the static parameters of `{of}`, and in-ports that are fixed at load time"
    ))
}
