//! Static arguments: the arguments in `<<...>>`, bound to static parameters.

use crate::check::bodies::body::Body;
use crate::check::bodies::statement;
use crate::check::calls::args;
use crate::check::calls::args::Given;
use crate::check::calls::call;
use crate::check::calls::callable::Callable;
use crate::check::diagnostics::report;
use crate::check::diagnostics::report::listed;
use crate::check::diagnostics::report::unknown;
use crate::check::exprs::expr;
use crate::check::limits::nesting;
use crate::check::signatures::alias;
use crate::check::signatures::unit;
use crate::check::types;
use crate::check::types::consts;
use crate::check::types::subrange;
use crate::check::{Checker, Constant};
use crate::program::{DeclId, DeclKind};
use crate::ty::{Subst, Ty, fit};
use crate::typed::ExprId;
use rpi_diag::{Code, Finding, Fix, Span};
use rpi_syntax::Name;
use rpi_syntax::ast::{
    Arg, ConstDef, Expr, ExprKind, Ident, NodeDecl, Signature, StaticArg, StaticParam,
    StaticParamKind, StaticValue, VarDecl,
};
use std::collections::BTreeMap;
use std::rc::Rc;

/// Value of a static parameter.
#[derive(Clone, Debug)]
pub(crate) enum Static {
    /// A type.
    Ty(Ty),
    /// A value that is known at compile time.
    Value(Constant),
    /// A value that is known at load time: a flow in the body.
    Opaque,
    /// A callable, and the diagnostic for calling it although its ports differ from those of the parameter.
    Callee(Callable, Option<Rc<Finding>>),
}

/// Values of the static parameters of a callable, by name.
pub(crate) type Statics = BTreeMap<Name, Static>;

/// Declaration of a static parameter.
#[derive(Clone, Copy)]
pub(crate) enum Param<'a> {
    /// Type parameter: `type t`, `type T: number`.
    Type(&'a Ident, Option<&'a Ident>),
    /// Value parameter: `n: int = 3`.
    Value(&'a Ident, &'a ConstDef),
    /// Node parameter: `node f (...) returns (...)`.
    Node(&'a Signature),
}

impl<'a> Param<'a> {
    pub(crate) fn name(&self) -> &'a Ident {
        match self {
            Param::Type(name, _) | Param::Value(name, _) => name,
            Param::Node(signature) => &signature.name,
        }
    }
}

/// Returns the static parameters of a declaration, one for each name.
pub(crate) fn params<'a>(statics: &'a [StaticParam]) -> Vec<Param<'a>> {
    let mut all = Vec::new();
    for param in statics {
        match &param.kind {
            StaticParamKind::Type(name, constraint) => {
                all.push(Param::Type(name, constraint.as_ref()));
            }
            StaticParamKind::Value(def) => {
                all.extend(def.names.iter().map(|name| Param::Value(name, def)));
            }
            StaticParamKind::Node(_, signature) => all.push(Param::Node(signature)),
        }
    }
    all
}

/// Returns the `const` in-ports of a node, which may determine sizes.
pub(crate) fn size_params(node: &NodeDecl) -> Vec<Param<'_>> {
    let sizes = node.sizes.iter();
    sizes
        .flat_map(|def| def.names.iter().map(move |name| Param::Value(name, def)))
        .collect()
}

/// Whether a callable declaration has a static parameter or an in-port of this name.
pub(crate) fn has_param(checker: &Checker<'_>, id: DeclId, name: &Name) -> bool {
    in_port_names(checker, id).any(|port| port == name)
        || static_params_of(checker, id)
            .iter()
            .any(|param| param.name().name == *name)
}

/// Returns the names of the in-ports of a callable declaration.
pub(crate) fn in_port_names<'a>(
    checker: &Checker<'a>,
    id: DeclId,
) -> impl Iterator<Item = &'a Name> + use<'a> {
    in_port_idents(checker, id).map(|name| &name.name)
}

/// Returns the names of the in-ports of a callable declaration, with their locations.
pub(crate) fn in_port_idents<'a>(
    checker: &Checker<'a>,
    id: DeclId,
) -> impl Iterator<Item = &'a Ident> + use<'a> {
    let inputs: &'a [VarDecl] = match checker.program.decl(id).kind {
        DeclKind::Node(d) => d.signature.inputs.as_deref().unwrap_or(&[]),
        DeclKind::Fragment(d) => d.signature.inputs.as_deref().unwrap_or(&[]),
        DeclKind::Primitive(d) => d.signature.inputs.as_deref().unwrap_or(&[]),
        _ => &[],
    };
    inputs.iter().flat_map(|port| &port.names)
}

/// Returns the static parameters of a callable declaration.
pub(crate) fn static_params_of<'a>(checker: &Checker<'a>, id: DeclId) -> Vec<Param<'a>> {
    params_of(checker.program.decl(id).kind)
}

/// Returns the static parameters of a callable declaration.
pub(crate) fn params_of(kind: DeclKind<'_>) -> Vec<Param<'_>> {
    match kind {
        DeclKind::Node(d) => [params(&d.signature.statics), size_params(d)].concat(),
        DeclKind::Fragment(d) => params(&d.signature.statics),
        DeclKind::Primitive(d) => params(&d.signature.statics),
        DeclKind::Command(d) => params(&d.statics),
        DeclKind::Device(d) => params(&d.statics),
        _ => Vec::new(),
    }
}

/// Static arguments of a call, sorted by the parameters that they are for.
pub(crate) struct Bound<'a> {
    /// Values of the static parameters that have an argument.
    pub(crate) statics: Statics,
    /// Arguments for ports and for values known at load time, by name.
    pub(crate) ports: Vec<Given<'a>>,
    /// Whether an error has been reported.
    pub(crate) faulty: bool,
}

/// Binds static arguments to the parameters of a declaration. Arguments without a static parameter are left for its
/// ports.
pub(crate) fn bind_statics<'a>(
    cx: &mut Body<'_, 'a>,
    id: DeclId,
    args: &'a [StaticArg],
) -> Bound<'a> {
    let params = static_params_of(cx.c, id);
    let mut bound = Bound {
        statics: Statics::new(),
        ports: Vec::new(),
        faulty: false,
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
            bound.faulty = true;
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
                bound.faulty = true;
            }
        }
    }
    bound
}

/// Binds the arguments for `const` in-ports that determine sizes; returns the other arguments.
pub(crate) fn bind_sizes<'a>(
    cx: &mut Body<'_, 'a>,
    id: DeclId,
    args: &'a [Arg],
    bound: &mut Bound<'a>,
) -> Vec<&'a Arg> {
    let DeclKind::Node(node) = cx.c.program.decl(id).kind else {
        return args.iter().collect();
    };
    let ports = node
        .signature
        .inputs
        .iter()
        .flatten()
        .flat_map(|port| &port.names);
    let ports: Vec<&'a Ident> = ports.collect();
    let sizes = size_params(node);
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
            Some(Param::Value(name, def)) => bind_size(cx, id, name, def, arg, bound),
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
    bound: &mut Bound<'a>,
) {
    let ty = static_param_type(cx.c, id, def, &bound.statics);
    match consts::const_value(cx, &arg.value, &ty) {
        Some(leaves) => {
            bound
                .statics
                .insert(name.name.clone(), Static::Value(Constant { ty, leaves }));
        }
        None => bound.faulty = true,
    }
}

/// Whether a positional argument after those of the static parameters may be for an in-port:
/// `on_delay<<500[ms]>>(x)`.
fn may_be_for_port(cx: &Body<'_, '_>, id: DeclId, params: &[Param<'_>], arg: &StaticArg) -> bool {
    let has_values = params.iter().any(|param| !matches!(param, Param::Type(..)));
    let has_ports = in_port_names(cx.c, id).next().is_some();
    unit::reads_rpi_syntax(cx)
        && !has_values
        && has_ports
        && matches!(arg.value, StaticValue::Expr(_))
}

/// Binds an argument to an in-port; without a name to the first in-port that has no argument in `(...)`.
fn bind_port<'a>(
    cx: &mut Body<'_, 'a>,
    name: Option<&'a Ident>,
    arg: &'a StaticArg,
    bound: &mut Bound<'a>,
) {
    let Some(value) = static_expr(cx, arg) else {
        bound.faulty = true;
        return;
    };
    bound.ports.push(Given {
        name,
        value,
        is_static: true,
    });
}

fn static_expr<'a>(cx: &mut Body<'_, 'a>, arg: &'a StaticArg) -> Option<ExprId> {
    match &arg.value {
        StaticValue::Expr(expr) => Some(expr::check_expr(cx, expr)),
        _ => {
            let finding =
                Finding::new(Code::RPI1010, "a value is expected here").at(arg.span, "not a value");
            report::report_diagnostic(cx, finding);
            None
        }
    }
}

/// Adds to the reported error of `f<<bool>>` the parameter that expects a value.
fn expected_value_hint(cx: &mut Body<'_, '_>, id: DeclId, name: &Ident, arg: &StaticArg) {
    let of = &cx.c.program.decl(id).name;
    let what = match &arg.value {
        StaticValue::Type(_) => "this is a type",
        StaticValue::Op(_) => "this is an operator",
        _ => "this is a callable",
    };
    let text = format!("`{}` of `{of}` is declared here", name.name);
    if let Some(finding) = cx.findings.last_mut() {
        if let Some(label) = finding.labels.first_mut() {
            label.text = what.to_owned();
        }
        *finding = finding.clone().also(name.span, text);
    }
}

fn too_many_static_args(cx: &mut Body<'_, '_>, id: DeclId, count: usize, span: Span) {
    let decl = cx.c.program.decl(id);
    let finding = Finding::new(
        Code::RPI1010,
        format!(
            "too many static arguments for `{}`: expected {count}",
            decl.name
        ),
    )
    .at(span, "unexpected argument")
    .also(decl.span, "declared here");
    report::report_diagnostic(cx, finding);
}

fn bind_param<'a>(
    cx: &mut Body<'_, 'a>,
    id: DeclId,
    param: Param<'a>,
    arg: &'a StaticArg,
    bound: &mut Bound<'a>,
) {
    let name = param.name();
    let value = match param {
        Param::Type(..) => static_type(cx, arg).map(Static::Ty),
        Param::Node(signature) => {
            let known = bound.statics.clone();
            let callable = static_callable(cx, arg);
            let callable = callable.and_then(|callable| call::require_portable(cx, callable));
            callable.map(|callable| {
                let misfit = port_mismatch(cx, id, &known, signature, &callable, arg.span);
                Static::Callee(callable, misfit.map(Rc::new))
            })
        }
        Param::Value(_, def) => {
            let Some(value) = static_expr(cx, arg) else {
                expected_value_hint(cx, id, name, arg);
                bound.faulty = true;
                return;
            };
            Some(bind_value(cx, id, def, name, value, bound))
        }
    };
    match value {
        Some(value) => {
            bound.statics.insert(name.name.clone(), value);
        }
        None => bound.faulty = true,
    }
}

/// Binds a value. A value that distinguishes instances becomes part of the instance; others remain flows.
fn bind_value<'a>(
    cx: &mut Body<'_, 'a>,
    id: DeclId,
    def: &'a ConstDef,
    name: &'a Ident,
    value: ExprId,
    bound: &mut Bound<'a>,
) -> Static {
    let ty = static_param_type(cx.c, id, def, &bound.statics);
    let wanted = crate::check::diagnostics::report::Wanted::By(
        name.span,
        format!("`{}` is `{ty}`", name.name),
    );
    statement::expect_type(cx, value, &ty, &wanted);
    if tells_apart(&ty)
        && let Some(leaves) = consts::fold_silently(cx, value)
    {
        bound.faulty |= !subrange::is_in_subranges(cx, &leaves, &ty, cx.span_of(value));
        return Static::Value(Constant { ty, leaves });
    }
    bound.ports.push(Given {
        name: Some(name),
        value,
        is_static: true,
    });
    Static::Opaque
}

pub(crate) fn static_type<'a>(cx: &mut Body<'_, 'a>, arg: &'a StaticArg) -> Option<Ty> {
    match &arg.value {
        StaticValue::Type(ty) => Some(types::resolve_type(cx, ty)),
        StaticValue::Expr(expr) => type_by_name(cx, expr),
        _ => {
            let finding =
                Finding::new(Code::RPI1010, "a type is expected here").at(arg.span, "not a type");
            report::report_diagnostic(cx, finding);
            None
        }
    }
}

/// Resolves a type whose name was parsed as an expression.
fn type_by_name<'a>(cx: &mut Body<'_, 'a>, expr: &'a Expr) -> Option<Ty> {
    let ExprKind::Name(name) = &expr.kind else {
        let finding = Finding::new(Code::RPI1010, "a type is expected here")
            .at(expr.span, "this is a value")
            .fix(Fix::maybe("mark it as a type").insert_before(expr.span, "type "));
        report::report_diagnostic(cx, finding);
        return None;
    };
    types::type_by_plain_name(cx, name, expr.span)
}

fn static_callable<'a>(cx: &mut Body<'_, 'a>, arg: &'a StaticArg) -> Option<Callable> {
    match &arg.value {
        StaticValue::Op(op) => Some(Callable::Op(*op)),
        StaticValue::Callee(callee) => {
            call::resolve_callable(cx, &callee.name.name, &callee.statics, callee.span)
        }
        StaticValue::Expr(Expr {
            kind: ExprKind::Name(name),
            span,
        }) => call::resolve_callable(cx, name, &[], *span),
        _ => {
            let finding =
                Finding::new(Code::RPI1010, "a node is expected here").at(arg.span, "not a node");
            report::report_diagnostic(cx, finding);
            None
        }
    }
}

/// Returns the diagnostic for a callable whose ports differ from those of a node parameter, as far as both are
/// known.
fn port_mismatch<'a>(
    cx: &mut Body<'_, 'a>,
    id: DeclId,
    statics: &Statics,
    signature: &'a Signature,
    callable: &Callable,
    span: Span,
) -> Option<Finding> {
    let ports = alias::callable_ports(cx, callable, span)?;
    let wanted = [&signature.inputs, &signature.outputs];
    for (wanted, given) in wanted.into_iter().zip([&ports.inputs, &ports.outputs]) {
        let wanted = signature_port_types(cx.c, id, statics, wanted.as_deref().unwrap_or_default());
        if wanted.len() != given.len() {
            let counts = (wanted.len(), given.len());
            return Some(wrong_node(signature, span, "number of ports", counts));
        }
        for (wanted, given) in wanted.iter().zip(given) {
            if fit(wanted, &given.ty, &mut Subst::default()).is_err() {
                return Some(wrong_node(
                    signature,
                    span,
                    &given.name,
                    (wanted, &given.ty),
                ));
            }
        }
    }
    None
}

/// Resolves a callable that is passed as a static argument.
pub(crate) fn static_callee<'a>(cx: &mut Body<'_, 'a>, arg: &'a StaticArg) -> Option<Callable> {
    static_callable(cx, arg)
}

/// Returns the declared type of a static value parameter, or the type of its default. The type is unknown if it
/// depends on unbound type parameters.
pub(crate) fn static_param_type<'a>(
    checker: &mut Checker<'a>,
    id: DeclId,
    def: &'a ConstDef,
    statics: &Statics,
) -> Ty {
    let mut known = statics.clone();
    for param in static_params_of(checker, id) {
        if let Param::Type(name, _) = param {
            let open = || Static::Ty(Ty::Unknown);
            known.entry(name.name.clone()).or_insert_with(open);
        }
    }
    static_param_type_with(checker, id, def, &Rc::new(known))
}

/// Returns the types of ports in the signature of a declaration, one for each name.
pub(crate) fn signature_port_types<'a>(
    checker: &mut Checker<'a>,
    id: DeclId,
    statics: &Statics,
    ports: &'a [VarDecl],
) -> Vec<Ty> {
    let mut body = signature_body(checker, id, &Rc::new(statics.clone()));
    body.in_signature = true;
    let mut types = Vec::new();
    for port in ports {
        let ty = types::resolve_type(&mut body, &port.ty);
        types.extend(port.names.iter().map(|_| ty.clone()));
    }
    types
}

/// Reports errors in the port types of the node parameters of a declaration.
pub(crate) fn check_node_params(checker: &mut Checker<'_>, id: DeclId, statics: &Rc<Statics>) {
    for param in static_params_of(checker, id) {
        let Param::Node(signature) = param else {
            continue;
        };
        let mut body = signature_body(checker, id, statics);
        body.in_signature = true;
        let ports = signature.inputs.iter().chain(&signature.outputs).flatten();
        for port in ports {
            types::resolve_type(&mut body, &port.ty);
        }
        body.leave();
    }
}

fn static_param_type_with<'a>(
    checker: &mut Checker<'a>,
    id: DeclId,
    def: &'a ConstDef,
    statics: &Rc<Statics>,
) -> Ty {
    let mut body = signature_body(checker, id, statics);
    body.in_signature = true;
    match (&def.ty, &def.value) {
        (Some(ty), _) => types::resolve_type(&mut body, ty),
        (None, Some(value)) => {
            let value = expr::check_expr(&mut body, value);
            body.ty_of(value).clone()
        }
        (None, None) => Ty::Unknown,
    }
}

/// Returns a body for checking the signature of a declaration, with the static parameters known so far.
fn signature_body<'s, 'a>(
    checker: &'s mut Checker<'a>,
    id: DeclId,
    statics: &Rc<Statics>,
) -> Body<'s, 'a> {
    let unit = crate::typed::Unit::new("".into(), crate::typed::UnitKind::Constant, Span::NONE);
    Body::new(checker, id, statics.clone(), unit)
}

/// Adds defaults for parameters without an argument; returns the names that remain open.
pub(crate) fn add_default_statics(
    checker: &mut Checker<'_>,
    id: DeclId,
    statics: &mut Statics,
) -> Vec<Name> {
    let mut open = Vec::new();
    for param in static_params_of(checker, id) {
        let name = &param.name().name;
        if statics.contains_key(name) {
            continue;
        }
        match param {
            Param::Value(_, def) => {
                // Moved out and back instead of cloned: each default may need all parameters before it.
                let known = Rc::new(std::mem::take(statics));
                let value = default_static(checker, id, def, &known);
                *statics = Rc::unwrap_or_clone(known);
                if value.is_none() && def.value.is_none() {
                    open.push(name.clone());
                }
                statics.insert(name.clone(), value.unwrap_or(Static::Opaque));
            }
            Param::Type(..) => {
                open.push(name.clone());
                statics.insert(name.clone(), Static::Ty(Ty::Generic(name.clone())));
            }
            Param::Node(_) => open.push(name.clone()),
        }
    }
    open
}

fn default_static<'a>(
    checker: &mut Checker<'a>,
    id: DeclId,
    def: &'a ConstDef,
    statics: &Rc<Statics>,
) -> Option<Static> {
    let decl = checker.program.decl(id);
    let ty = static_param_type_with(checker, id, def, statics);
    let value = def.value.as_ref().filter(|_| tells_apart(&ty))?;
    if !nesting::may_nest(checker, "static parameter", decl.span) {
        return None;
    }
    let leaves = nesting::check_nested(checker, |checker| {
        let mut body = signature_body(checker, id, statics);
        consts::const_value(&mut body, value, &ty)
    })?;
    Some(Static::Value(Constant { ty, leaves }))
}

/// Whether values of a type may determine sizes and branches, so that each value needs its own instance.
pub(crate) fn tells_apart(ty: &Ty) -> bool {
    match ty {
        Ty::Bool | Ty::Int | Ty::Subrange(_) | Ty::Enum(_) => true,
        Ty::Array(element, _) => tells_apart(element),
        _ => false,
    }
}

/// Returns the diagnostic for missing static arguments.
pub(crate) fn missing(name: &Name, open: &[Name], span: Span, declared: Span) -> Finding {
    let names = listed(open.iter().map(Name::as_str));
    Finding::new(
        Code::RPI1010,
        format!("missing static arguments of `{name}`: {names}"),
    )
    .at(span, "required in `<<...>>`")
    .also(declared, "declared here")
    .help(format!(
        "write them before the arguments: `{name}<<{}: ...>>(...)`",
        open.first().map_or("n", Name::as_str)
    ))
}

/// Returns the diagnostic for a static argument without a parameter.
pub(crate) fn no_param(of: &Name, name: &Ident, near: Option<String>) -> Finding {
    // Without the static arguments in the name of an instance, which are not part of the error.
    let of = of.split("<<").next().unwrap_or(of);
    let finding = unknown(
        &format!("static parameter of `{of}`:"),
        &name.name,
        name.span,
        near,
    );
    finding.note(format!(
        "`<<...>>` takes the static parameters of `{of}`, and in-ports that are fixed at load time"
    ))
}

/// Returns the diagnostic for a node whose ports do not match a node parameter.
fn wrong_node<T: std::fmt::Display>(
    signature: &Signature,
    span: Span,
    what: &str,
    (wanted, given): (T, T),
) -> Finding {
    let message = format!(
        "port mismatch: the node for `{}` has other ports",
        signature.name.name
    );
    Finding::new(Code::RPI2001, message)
        .at(
            span,
            format!("{what}: expected `{wanted}`, found `{given}`"),
        )
        .also(signature.name.span, "the expected ports are declared here")
}
