//! Calls: resolution of the callee, static arguments, activation, and instantiation of the called unit.

use crate::check::Constant;
use crate::check::bodies::body::Body;
use crate::check::bodies::locals;
use crate::check::bodies::locals::Local;
use crate::check::bodies::statement;
use crate::check::calls::applied;
use crate::check::calls::args;
use crate::check::calls::args::Given;
use crate::check::calls::callable::Callable;
use crate::check::calls::callable::Fixed;
use crate::check::calls::condact;
use crate::check::calls::intrinsics;
use crate::check::calls::intrinsics::SPECIALS;
use crate::check::calls::intrinsics::Special;
use crate::check::calls::iterate;
use crate::check::calls::prim;
use crate::check::diagnostics::elsewhere;
use crate::check::diagnostics::report;
use crate::check::diagnostics::report::not_a;
use crate::check::diagnostics::suggest_callee;
use crate::check::diagnostics::undefined_names;
use crate::check::exprs::names;
use crate::check::exprs::proof_only;
use crate::check::limits::nesting;
use crate::check::signatures::alias;
use crate::check::signatures::constraint;
use crate::check::signatures::header;
use crate::check::signatures::header::Header;
use crate::check::signatures::instance;
use crate::check::signatures::size_inference;
use crate::check::signatures::static_args;
use crate::check::signatures::static_args::Param;
use crate::check::signatures::static_args::Static;
use crate::check::signatures::static_args::Statics;
use crate::check::signatures::unit;
use crate::check::signatures::unit::is_callable;
use crate::check::types::consts;
use crate::check::types::data;
use crate::elab::NotConstant;
use crate::program::{DeclId, DeclKind, Lookup, Space};
use crate::ty::{Subst, Ty};
use crate::typed::{
    self, Activation, Equation, ExprId, FlowRole, Kind, Optional, Place, Target, UnitKind,
};
use rpi_diag::{Code, Finding, Span};
use rpi_prims::{PrimId, registry};
use rpi_syntax::Name;
use rpi_syntax::ast::{self, NodeDef, StaticArg};
use std::rc::Rc;

/// Call whose arguments match the ports of the callee.
pub(crate) struct Fitted {
    /// Header of the called instance.
    pub(crate) header: Rc<Header>,
    /// Argument of each in-port; `None` for a port that uses its default.
    pub(crate) args: Vec<Option<ExprId>>,
    /// Types and frames inferred for the free names of the signature.
    subst: Subst,
}

/// Meaning of the name of a callee.
enum Callee<'a> {
    /// Callable with all its static arguments: a node parameter or an operator.
    Known(Callable),
    /// Declaration.
    Decl(DeclId),
    /// Predeclared operator with its own checks.
    Special(Special),
    /// Registered primitive.
    Prim(PrimId),
    /// Iterator over arrays, by name.
    Iterator(&'static str),
    /// Alternative of a `datatype`: its type and index.
    Constructor(DeclId, u32),
    /// Not callable, which has been reported.
    Nothing(std::marker::PhantomData<&'a ()>),
}

/// Checks a call.
pub(crate) fn check_call<'a>(cx: &mut Body<'_, 'a>, call: &'a ast::Call, span: Span) -> ExprId {
    let activation = resolve_activation(cx, &call.activation);
    call_with_activation(cx, call, activation, span)
}

/// Checks a call with a given activation.
pub(crate) fn call_with_activation<'a>(
    cx: &mut Body<'_, 'a>,
    call: &'a ast::Call,
    activation: Activation,
    span: Span,
) -> ExprId {
    let name = &call.callee.name;
    match resolve_callee(cx, &name.name, name.span) {
        Callee::Nothing(_) => {
            let given = args::check_args(cx, &call.args);
            elsewhere::suggest_for_foreign_call(cx, call, &given, span);
            suggest_callee::suggest_struct_literal(cx, call, span)
        }
        Callee::Special(special) => intrinsics::check_intrinsic(cx, special, call, span),
        Callee::Iterator("condact") if call.callee.statics.is_empty() => {
            intrinsics::check_intrinsic(cx, Special::Condact, call, span)
        }
        Callee::Iterator("condact") => condact::condact_call(cx, call, span),
        Callee::Iterator(name) if call.callee.statics.is_empty() => {
            suggest_callee::iterator_without_statics(cx, name, call, span)
        }
        Callee::Iterator(name) => {
            match iterate::resolve_iterator(cx, name, &call.callee.statics, call.callee.span) {
                Some(iteration) => {
                    let given = args::check_args(cx, &call.args);
                    call_callable(
                        cx,
                        &Callable::Iteration(Rc::new(iteration)),
                        given,
                        activation,
                        span,
                    )
                }
                None => {
                    args::check_args(cx, &call.args);
                    cx.fault(span)
                }
            }
        }
        Callee::Known(callable) => {
            let given = args::check_args(cx, &call.args);
            call_callable(cx, &callable, given, activation, span)
        }
        Callee::Prim(prim) => prim::check_prim_call(cx, prim, call, span),
        Callee::Constructor(ty, index) => {
            let given = args::check_args(cx, &call.args);
            let values: Vec<ExprId> = given.iter().map(|arg| arg.value).collect();
            data::constructor_value(cx, (ty, index), &call.callee.statics, &values, span)
        }
        Callee::Decl(id) => call_decl(cx, id, call, activation, span),
    }
}

/// Checks a call of a declaration. A call of an alias (`node f = g<<3>>;`) is a call of its target.
fn call_decl<'a>(
    cx: &mut Body<'_, 'a>,
    id: DeclId,
    call: &'a ast::Call,
    activation: Activation,
    span: Span,
) -> ExprId {
    proof_only::check_call_in_quantifier(cx, call, id, span);
    if let DeclKind::Node(node) = cx.c.program.decl(id).kind
        && let NodeDef::Alias(callee) = &node.definition
    {
        let given = args::check_args(cx, &call.args);
        return match resolve_alias(cx, id, callee, &call.callee.statics) {
            Some(callable) => call_callable(cx, &callable, given, activation, span),
            None => cx.fault(span),
        };
    }
    let mut bound = static_args::bind_statics(cx, id, &call.callee.statics);
    let args = static_args::bind_sizes(cx, id, &call.args, &mut bound);
    let (mut given, all_named) = args::check_args_for(cx, id, &args);
    given.extend(bound.ports);
    if bound.faulty || !all_named {
        return cx.fault(span);
    }
    call_declared(cx, id, bound.statics, given, activation, span)
}

/// Returns the callable that an alias stands for. The alias may have static parameters.
fn resolve_alias<'a>(
    cx: &mut Body<'_, 'a>,
    id: DeclId,
    callee: &'a ast::Callee,
    statics: &'a [StaticArg],
) -> Option<Callable> {
    let bound = static_args::bind_statics(cx, id, statics);
    if bound.faulty {
        return None;
    }
    if alias::is_cyclic_alias(cx.c, id) || !nesting::may_alias(cx.c, callee.span) {
        return None;
    }
    check_alias_ports(cx, id, &bound.statics);
    cx.c.aliases.push(id);
    let mut body = Body::around(cx.c, id);
    body.statics = Rc::new(bound.statics);
    let callable = resolve_callable(&mut body, &callee.name.name, &callee.statics, callee.span);
    let callable = callable.and_then(|callable| require_portable(&mut body, callable));
    body.leave();
    cx.c.aliases.pop();
    callable
}

/// Checks the unit of an alias with static parameters and declared ports, so that ports that differ from those of
/// its target are reported.
fn check_alias_ports(cx: &mut Body<'_, '_>, id: DeclId, statics: &Statics) {
    let DeclKind::Node(node) = cx.c.program.decl(id).kind else {
        return;
    };
    let params = static_args::static_params_of(cx.c, id);
    let is_given = |param: &crate::check::signatures::static_args::Param<'_>| {
        statics.contains_key(&param.name().name)
    };
    if node.signature.outputs.is_none() || params.is_empty() || !params.iter().all(is_given) {
        return;
    }
    if let Some(header) = header::check_header(cx.c, id, Rc::new(statics.clone())) {
        unit::instantiate(cx.c, &header, header.span);
    }
}

/// Checks the conditions of an activation.
fn resolve_activation<'a>(cx: &mut Body<'_, 'a>, activation: &'a ast::Activation) -> Activation {
    match activation {
        ast::Activation::Always => Activation::Always,
        ast::Activation::Restart { every } => Activation::Restart {
            every: statement::check_condition(cx, every, "a restart"),
        },
        ast::Activation::Activate {
            every,
            restart,
            default,
        } => Activation::Condact {
            every: statement::check_condition(cx, every, "an activation"),
            default: default
                .as_ref()
                .map(|default| condact::check_condact_default(cx, default)),
            restart: restart
                .as_ref()
                .map(|restart| statement::check_condition(cx, restart, "a restart")),
        },
    }
}

/// Resolves the name of a callee.
fn resolve_callee<'a>(cx: &mut Body<'_, 'a>, name: &Name, span: Span) -> Callee<'a> {
    let importing = std::mem::take(&mut cx.importing);
    if let Some(Static::Callee(callable, misfit)) = cx.statics.get(name).cloned() {
        if let Some(misfit) = misfit {
            report::report_diagnostic(cx, (*misfit).clone());
            return Callee::Nothing(std::marker::PhantomData);
        }
        return Callee::Known(callable);
    }
    if let Lookup::Found(id) = cx.c.program.lookup_in(Space::Value, cx.module, name)
        && let DeclKind::Constructor { ty, index } = cx.c.program.decl(id).kind
    {
        return Callee::Constructor(ty, index);
    }
    if let Lookup::Found(id) = cx.c.program.lookup_in(Space::Value, cx.module, name)
        && let DeclKind::EnumValue { ty, index } = cx.c.program.decl(id).kind
        && data::is_datatype(cx, ty)
    {
        return Callee::Constructor(ty, index);
    }
    let space = match importing {
        true => Space::Contract,
        false => Space::Callable,
    };
    match cx.c.program.lookup_in(space, cx.module, name) {
        Lookup::Found(id) => resolve_callee_decl(cx, id, name, span),
        Lookup::Missing => resolve_builtin_callee(cx, name, span),
    }
}

/// Resolves a declaration as a callee; reports one that is not callable.
fn resolve_callee_decl<'a>(
    cx: &mut Body<'_, 'a>,
    id: DeclId,
    name: &Name,
    span: Span,
) -> Callee<'a> {
    let decl = cx.c.program.decl(id).clone();
    if is_callable(decl.kind) {
        return Callee::Decl(id);
    }
    if !matches!(decl.kind, DeclKind::Broken(_)) {
        let finding = not_a("a callable", name, decl.kind.what(), span, decl.span);
        let finding = match decl.kind {
            DeclKind::Command(_) => finding.help("run a command by a task, or by `rpi run`"),
            _ => finding,
        };
        report::report_diagnostic(cx, finding);
    }
    Callee::Nothing(std::marker::PhantomData)
}

/// Resolves an iterator, a predeclared operator or a primitive; reports an undefined name.
fn resolve_builtin_callee<'a>(cx: &mut Body<'_, 'a>, name: &Name, span: Span) -> Callee<'a> {
    let plain = name.strip_prefix("Lustre::").unwrap_or(name);
    if let Some(iterator) = crate::check::calls::iterate::NAMES
        .iter()
        .find(|iterator| **iterator == plain)
    {
        return Callee::Iterator(iterator);
    }
    let specials = SPECIALS.iter();
    let is_kind2 = |s: &&Special| matches!(s, Special::Any | Special::Choose | Special::Machine(_));
    let is_ours = |s: &&Special| matches!(s, Special::Spatial(_) | Special::Time);
    let is_rpi = unit::reads_rpi_syntax(cx);
    let mut specials = specials.filter(|s| match is_rpi {
        true => !is_kind2(s),
        false => !is_ours(s),
    });
    if let Some(special) = specials.find(|special| special.name() == plain) {
        return Callee::Special(*special);
    }
    if let Some(operator) = crate::check::calls::predefined_ops::operator(name) {
        return Callee::Known(operator);
    }
    if let Some(prim) = PrimId::of(name) {
        return Callee::Prim(prim);
    }
    report_undefined_callee(cx, name, span);
    Callee::Nothing(std::marker::PhantomData)
}

/// Reports an undefined callee, with a suggestion.
fn report_undefined_callee(cx: &mut Body<'_, '_>, name: &Name, span: Span) {
    if let Some(Local::Flow(flow)) = locals::find_local(cx, name) {
        let declared = cx.unit.flow(flow).span;
        let finding = not_a("a callable", name, "a flow", span, declared).help(format!(
            "read an array element by `{name}[0]`; write a product as `{name} * x`"
        ));
        return report::report_diagnostic(cx, finding);
    }
    let callable = |id: DeclId| is_callable(cx.c.program.decl(id).kind);
    let near =
        cx.c.suggest(name, cx.c.program.visible(cx.module, callable));
    // `time` is not suggested: it is also the name of a predeclared flow, which is more likely to be meant.
    let specials = SPECIALS.iter().map(|special| special.name());
    let specials = specials.filter(|special| *special != "time");
    let near = near.or_else(|| rpi_diag::suggest(name, specials));
    let near = near.or_else(|| match name.is_qualified() {
        true => {
            cx.c.suggest(name, registry().iter().map(|prim| prim.desc.name))
        }
        false => None,
    });
    let what = if name.is_qualified() {
        "primitive"
    } else {
        "node, function or fragment"
    };
    let last = name.rsplit("::").next().unwrap_or_default();
    let is_there = |other: &str| {
        let mut visible = cx.c.program.visible(cx.module, callable);
        visible.any(|known| known == other) || SPECIALS.iter().any(|s| s.name() == other)
    };
    let here = match name.is_qualified() && is_there(last) {
        true => Some(last),
        false => crate::check::diagnostics::foreign::call_here(name),
    };
    match here {
        Some(here) => undefined_names::report_foreign_name(cx, what, name, span, here),
        None => undefined_names::report_undefined(cx, what, name, span, near),
    }
}

/// Resolves a callable with its static arguments, for an iterator or as a static argument.
pub(crate) fn resolve_callable<'a>(
    cx: &mut Body<'_, 'a>,
    name: &Name,
    statics: &'a [StaticArg],
    span: Span,
) -> Option<Callable> {
    match resolve_callee(cx, name, span) {
        Callee::Nothing(_) => None,
        Callee::Constructor(..) => {
            let finding = not_a(
                "a callable",
                name,
                "an alternative of a datatype",
                span,
                span,
            );
            report::report_diagnostic(cx, finding);
            None
        }
        Callee::Known(callable) => Some(callable),
        Callee::Special(special) => Some(Callable::Special(special)),
        Callee::Prim(prim) => Some(Callable::Prim(prim)),
        Callee::Iterator(iterator) => {
            let iteration = iterate::resolve_iterator(cx, iterator, statics, span)?;
            Some(Callable::Iteration(Rc::new(iteration)))
        }
        Callee::Decl(id) => {
            if let DeclKind::Node(node) = cx.c.program.decl(id).kind
                && let NodeDef::Alias(callee) = &node.definition
            {
                return resolve_alias(cx, id, callee, statics);
            }
            let bound = static_args::bind_statics(cx, id, statics);
            let fixed = fold_fixed_ports(cx, &bound.ports)?;
            (!bound.faulty).then(|| Callable::Unit(id, Rc::new(bound.statics), fixed))
        }
    }
}

/// Returns the values of the ports that static arguments fix.
fn fold_fixed_ports<'a>(cx: &mut Body<'_, 'a>, ports: &[Given<'a>]) -> Option<Rc<[(Name, Fixed)]>> {
    let mut fixed = Vec::new();
    for port in ports {
        let value = match consts::try_fold(cx, port.value) {
            Err(NotConstant::Flow(_)) if args::is_load_time_constant(cx, port.value) => {
                Fixed::Loaded(port.value)
            }
            _ => Fixed::Constant(Constant {
                leaves: consts::fold(cx, port.value)?,
                ty: cx.ty_of(port.value).clone(),
            }),
        };
        fixed.push((port.name?.name.clone(), value));
    }
    Some(fixed.into())
}

/// Rejects a callable with values that are only known in this body; returns `None` after the error.
pub(crate) fn require_portable(cx: &mut Body<'_, '_>, callable: Callable) -> Option<Callable> {
    match callable.loaded() {
        None => Some(callable),
        Some(value) => {
            consts::fold(cx, value);
            None
        }
    }
}

/// Calls a callable with checked arguments.
pub(crate) fn call_callable<'a>(
    cx: &mut Body<'_, 'a>,
    callable: &Callable,
    given: Vec<Given<'a>>,
    activation: Activation,
    span: Span,
) -> ExprId {
    match callable {
        Callable::Unit(id, statics, fixed) => {
            call_with_fixed_ports(cx, *id, statics, fixed, given, activation, span)
        }
        Callable::Prim(prim) => prim::prim_call_with(cx, *prim, &given, span),
        Callable::Op(op) => applied::call_operator(cx, *op, &given, span),
        Callable::Predef(predef) => applied::call_predefined_op(cx, predef, given, span),
        Callable::Special(special) => intrinsics::apply_intrinsic(cx, *special, &given, span),
        Callable::Iteration(iteration) => iterate::apply_iterator(cx, iteration, &given, span),
        Callable::Open(header) => applied::call_node_param(cx, header, given, span),
    }
}

/// Calls a declaration with the values of its fixed ports added to the arguments.
fn call_with_fixed_ports<'a>(
    cx: &mut Body<'_, 'a>,
    id: DeclId,
    statics: &Rc<Statics>,
    fixed: &Rc<[(Name, Fixed)]>,
    mut given: Vec<Given<'a>>,
    activation: Activation,
    span: Span,
) -> ExprId {
    let params = static_args::static_params_of(cx.c, id);
    for (name, fixed) in &**fixed {
        let value = match fixed {
            Fixed::Constant(constant) => names::constant_expr(cx, constant, span),
            Fixed::Loaded(value) => *value,
        };
        let param = params.iter().map(Param::name).find(|p| p.name == *name);
        let port = || static_args::in_port_idents(cx.c, id).find(|port| port.name == *name);
        given.push(Given {
            name: param.or_else(port),
            value,
            is_static: true,
        });
    }
    call_declared(cx, id, (**statics).clone(), given, activation, span)
}

/// Calls a declaration with checked arguments.
fn call_declared<'a>(
    cx: &mut Body<'_, 'a>,
    id: DeclId,
    statics: Statics,
    given: Vec<Given<'a>>,
    activation: Activation,
    span: Span,
) -> ExprId {
    match match_call(cx, id, statics, given, span) {
        Ok(fitted) => add_call(cx, fitted, activation, span),
        // The type is kept, so that the uses of the outputs are still checked.
        Err(ty) => cx.add(Kind::Fault, ty, span),
    }
}

/// Matches arguments with the ports of a declaration and infers its open static parameters.
///
/// Returns the type of the result, as far as it is known, after an error.
pub(crate) fn match_call<'a>(
    cx: &mut Body<'_, 'a>,
    id: DeclId,
    mut statics: Statics,
    mut given: Vec<Given<'a>>,
    span: Span,
) -> Result<Fitted, Ty> {
    if unit::reads_rpi_syntax(cx) {
        given = args::flatten_tuple_args(cx, given);
    }
    if !size_inference::infer_size_params(cx, id, &given, &mut statics) {
        return Err(Ty::Unknown);
    }
    let open = static_args::add_default_statics(cx.c, id, &mut statics);
    if unit::lacks_sizes(cx.c, id, &open, &statics, span) {
        // Not reported beside a misspelt argument: that may be the one the size depends on.
        if !args::report_unknown_args(cx, id, &given) {
            instance::report_missing(cx, id, &open, span);
        }
        return Err(Ty::Unknown);
    }
    if !constraint::check_constraints(cx, id, &statics, span) {
        return Err(Ty::Unknown);
    }
    let header = header::check_header(cx.c, id, Rc::new(statics.clone()));
    let header = header.ok_or(Ty::Unknown)?;
    let free = header.free_frames.iter();
    let mut subst = Subst {
        frames: free.map(|frame| (frame.clone(), None)).collect(),
        ..Subst::default()
    };
    let Some(mut args) = args::match_args_to_ports(cx, &header, &given, span) else {
        return Err(match open.is_empty() {
            true => header.result_type().substituted(&subst),
            false => Ty::Unknown,
        });
    };
    let mut sound = args::check_arg_types(cx, &header, &mut args, &mut subst);
    let of_units = header.inputs.iter().any(|port| port.ty.has_unknown());
    let told = args.iter().flatten();
    let all_told = told.copied().all(|arg| !cx.ty_of(arg).has_unknown());
    let told_at = all_told.then_some(span);
    let header = instance::resolve_instance(cx, &header, statics, &open, &subst, (span, told_at));
    let header = header.ok_or(Ty::Unknown)?;
    // Units that depend on static parameters are known only in the instance, so that the types are checked again.
    sound = sound && (!of_units || args::check_arg_types(cx, &header, &mut args, &mut subst));
    match sound {
        true => Ok(Fitted {
            header,
            args,
            subst,
        }),
        false => Err(header.result_type().substituted(&subst)),
    }
}

/// Adds the call of an instance.
fn add_call(cx: &mut Body<'_, '_>, fitted: Fitted, activation: Activation, span: Span) -> ExprId {
    let Fitted {
        ref header,
        args,
        ref subst,
    } = fitted;
    if header.kind != UnitKind::Function {
        cx.has_state(span);
    }
    report_extern_call(cx, header, span);
    let Some(unit) = unit::instantiate(cx.c, header, span) else {
        return cx.fault(span);
    };
    let args = name_clock_args(cx, header, args);
    let ty = header.result_type().substituted(subst);
    if let Activation::Condact {
        default: Some(default),
        ..
    } = activation
    {
        statement::expect_type(
            cx,
            default,
            &ty,
            &crate::check::diagnostics::report::Wanted::Here,
        );
    }
    let args = args.into();
    let call = typed::Call {
        unit,
        args,
        activation,
    };
    cx.add(Kind::Call(Box::new(call)), ty, span)
}

/// Gives each argument that decides the clock of another port a flow of its own, as clocks refer to flows by name.
fn name_clock_args(
    cx: &mut Body<'_, '_>,
    header: &Header,
    mut args: Vec<Option<ExprId>>,
) -> Vec<Option<ExprId>> {
    if cx.inferring {
        return args;
    }
    let deciding = header.inputs.iter().zip(&mut args);
    for (port, arg) in deciding.filter(|(port, _)| port.decides) {
        let unnamed = |id: &ExprId| !matches!(cx.unit.expr(*id).kind, Kind::Flow(_));
        if let Some(value) = arg.filter(unnamed) {
            *arg = Some(bind_to_flow(cx, port, value));
        }
    }
    args
}

/// Adds a flow with the value of an expression, named after the port with a unique suffix.
fn bind_to_flow(
    cx: &mut Body<'_, '_>,
    port: &crate::check::signatures::header::Port,
    value: ExprId,
) -> ExprId {
    let (span, ty) = (cx.span_of(value), cx.ty_of(value).clone());
    let name = ast::Ident {
        name: format!("{}#{}", port.name, cx.unit.flows.len()).into(),
        span,
    };
    let flow = locals::add_flow(cx, &name, ty.clone(), Optional::Inferred, FlowRole::Local);
    let place = Place::Flow { flow, at: 0 };
    let equation = Equation {
        targets: vec![Target { place, ty, span }],
        value,
        span,
    };
    cx.current().equations.push(equation);
    names::flow_expr(cx, flow, span)
}

/// Reports a call of a node without a body.
fn report_extern_call(cx: &mut Body<'_, '_>, header: &Header, span: Span) {
    if let DeclKind::Node(node) = cx.c.program.decl(header.decl).kind
        && matches!(node.definition, NodeDef::Extern)
    {
        let finding = Finding::new(Code::RPI1012, format!("`{}` has no body", header.name))
            .at(span, "an external node cannot be executed")
            .also(header.span, "declared without a body");
        report::report_diagnostic(cx, finding);
    }
}
