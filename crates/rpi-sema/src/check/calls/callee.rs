//! Callees: resolution of the name and static arguments of a call.

use crate::check::Constant;
use crate::check::bodies::body::Body;
use crate::check::bodies::locals;
use crate::check::bodies::locals::Local;
use crate::check::calls::args;
use crate::check::calls::args::CallArgument;
use crate::check::calls::callable::Callable;
use crate::check::calls::callable::FixedPortValue;
use crate::check::calls::intrinsics::INTRINSICS;
use crate::check::calls::intrinsics::Intrinsic;
use crate::check::calls::iterate;
use crate::check::diagnostics::report;
use crate::check::diagnostics::report::wrong_kind_of_name;
use crate::check::diagnostics::undefined_names;
use crate::check::limits::nesting;
use crate::check::signatures::alias;
use crate::check::signatures::header;
use crate::check::signatures::static_args;
use crate::check::signatures::static_args::StaticBinding;
use crate::check::signatures::static_args::StaticBindings;
use crate::check::signatures::static_params;
use crate::check::signatures::unit;
use crate::check::signatures::unit::is_callable;
use crate::check::types::consts;
use crate::check::types::data;
use crate::elab::NotConstantError;
use crate::program::{DeclId, DeclKind, Lookup, NameSpace};
use crate::ty::Ty;
use rpi_diag::Span;
use rpi_prims::{PrimId, registry};
use rpi_syntax::Name;
use rpi_syntax::ast::{self, NodeDef, NodeKind, StaticArg};
use std::rc::Rc;

/// What the name in a call refers to.
pub(crate) enum Callee<'a> {
    /// Callable that needs no further static arguments: an operator, or the value of a static parameter that stands for
    /// a node.
    Known(Callable),
    /// Declaration that can be called, such as that of a node or a function.
    Decl(DeclId),
    /// Predeclared operator whose arguments have rules of their own, such as `hold`.
    Special(Intrinsic),
    /// Primitive (basic operation) of the registry.
    Prim(PrimId),
    /// Iterator over arrays with this name: `map`, `fold`, `red` and the like.
    Iterator(&'static str),
    /// Alternative of a `datatype`, which is called to construct a value: the declaration of the type, and the index of
    /// the alternative.
    Constructor(DeclId, u32),
    /// The name cannot be called, and the error has been reported.
    Nothing(std::marker::PhantomData<&'a ()>),
}

/// Returns the callable for which the alias `id` (`node f = g<<3>>;`) stands. `callee` is the target of the alias and
/// `statics` are the static arguments of the call. `None` after an error.
pub(crate) fn resolve_alias<'a>(
    cx: &mut Body<'_, 'a>,
    id: DeclId,
    callee: &'a ast::Callee,
    statics: &'a [StaticArg],
) -> Option<Callable> {
    let bound = static_args::bind_statics(cx, id, statics);
    if bound.has_error {
        return None;
    }
    if alias::is_cyclic_alias(cx.checker, id) || !nesting::may_alias(cx.checker, callee.span) {
        return None;
    }
    check_alias_ports(cx, id, &bound.statics);
    cx.checker.aliases.push(id);
    let mut body = Body::for_top_level(cx.checker, id);
    body.statics = Rc::new(bound.statics);
    let callable = resolve_callable(&mut body, &callee.name.name, &callee.statics, callee.span);
    let callable = callable.and_then(|callable| require_portable(&mut body, callable));
    body.finish();
    cx.checker.aliases.pop();
    callable
}

/// Checks an alias with static parameters and declared ports, so that ports that differ from those of its target are
/// reported.
fn check_alias_ports(cx: &mut Body<'_, '_>, id: DeclId, statics: &StaticBindings) {
    let DeclKind::Node(node) = cx.checker.program.decl(id).kind else {
        return;
    };
    let params = static_params::static_params_of_decl(cx.checker, id);
    let is_given = |param: &crate::check::signatures::static_params::StaticParamDecl<'_>| {
        statics.contains_key(&param.name().name)
    };
    if node.signature.outputs.is_none() || params.is_empty() || !params.iter().all(is_given) {
        return;
    }
    if let Some(header) = header::check_header(cx.checker, id, Rc::new(statics.clone())) {
        unit::instantiate(cx.checker, &header, header.span);
    }
}

/// Returns the meaning of the name in a call: a static parameter, a declaration, an operator or a primitive. Reports an
/// undefined name.
pub(crate) fn resolve_callee<'a>(cx: &mut Body<'_, 'a>, name: &Name, span: Span) -> Callee<'a> {
    let importing = std::mem::take(&mut cx.contract.resolving_contract);
    if let Some(StaticBinding::Callable(callable, misfit)) = cx.statics.get(name).cloned() {
        if let Some(misfit) = misfit {
            report::report_diagnostic(cx, (*misfit).clone());
            return Callee::Nothing(std::marker::PhantomData);
        }
        return Callee::Known(callable);
    }
    if let Lookup::Found(id) = cx
        .checker
        .program
        .lookup_in(NameSpace::Value, cx.module, name)
        && let DeclKind::Constructor { ty, index } = cx.checker.program.decl(id).kind
    {
        return Callee::Constructor(ty, index);
    }
    if let Lookup::Found(id) = cx
        .checker
        .program
        .lookup_in(NameSpace::Value, cx.module, name)
        && let DeclKind::EnumValue { ty, index } = cx.checker.program.decl(id).kind
        && data::is_datatype(cx, ty)
    {
        return Callee::Constructor(ty, index);
    }
    let space = match importing {
        true => NameSpace::Contract,
        false => NameSpace::Callable,
    };
    match cx.checker.program.lookup_in(space, cx.module, name) {
        Lookup::Found(id) => resolve_callee_decl(cx, id, name, span),
        Lookup::Missing if importing => {
            report_undefined_contract(cx, name, span);
            Callee::Nothing(std::marker::PhantomData)
        }
        Lookup::Missing => resolve_builtin_callee(cx, name, span),
    }
}

/// Reports the import of an undefined contract and suggests the most similar contract. Nodes are not suggested.
fn report_undefined_contract(cx: &mut Body<'_, '_>, name: &Name, span: Span) {
    let is_contract = |id: DeclId| matches!(cx.checker.program.decl(id).kind, DeclKind::Node(node) if node.kind == NodeKind::Contract);
    let visible = cx.checker.program.visible_names(cx.module, is_contract);
    let near = cx.checker.suggest(name, visible);
    let diagnostic = match near.is_none() {
        true => report::undefined_name("contract", name, span, None).help(format!(
            "declare `contract {name} (...) returns (...)`, with the ports of this node"
        )),
        false => report::undefined_name("contract", name, span, near),
    };
    report::report_diagnostic(cx, diagnostic);
}

/// Returns a declaration as the meaning of the name in a call. Reports a declaration that cannot be called, such as a
/// type.
fn resolve_callee_decl<'a>(
    cx: &mut Body<'_, 'a>,
    id: DeclId,
    name: &Name,
    span: Span,
) -> Callee<'a> {
    let decl = cx.checker.program.decl(id).clone();
    if is_callable(decl.kind) {
        return Callee::Decl(id);
    }
    if !matches!(decl.kind, DeclKind::Broken(_)) {
        let diagnostic =
            wrong_kind_of_name("a callable", name, decl.kind.description(), span, decl.span);
        let diagnostic = match decl.kind {
            DeclKind::Command(_) => diagnostic.help("run a command by a task, or by `rpi run`"),
            _ => diagnostic,
        };
        report::report_diagnostic(cx, diagnostic);
    }
    Callee::Nothing(std::marker::PhantomData)
}

/// Returns the iterator, predeclared operator or primitive with this name. Reports an undefined name.
fn resolve_builtin_callee<'a>(cx: &mut Body<'_, 'a>, name: &Name, span: Span) -> Callee<'a> {
    let plain = name.strip_prefix("Lustre::").unwrap_or(name);
    if let Some(iterator) = crate::check::calls::iterate::ITERATORS
        .iter()
        .find(|iterator| **iterator == plain)
    {
        return Callee::Iterator(iterator);
    }
    let specials = INTRINSICS.iter();
    let is_kind2 = |s: &&Intrinsic| {
        matches!(
            s,
            Intrinsic::Any | Intrinsic::Choose | Intrinsic::Machine(_)
        )
    };
    let is_ours = |s: &&Intrinsic| matches!(s, Intrinsic::Spatial(_) | Intrinsic::Time);
    let is_rpi = unit::reads_rpi_syntax(cx);
    let mut specials = specials.filter(|s| match is_rpi {
        true => !is_kind2(s),
        false => !is_ours(s),
    });
    if let Some(special) = specials.find(|special| special.name() == plain) {
        return Callee::Special(*special);
    }
    if let Some(operator) = crate::check::calls::predefined_ops::predefined_op(name) {
        return Callee::Known(operator);
    }
    if let Some(prim) = PrimId::from_name(name) {
        return Callee::Prim(prim);
    }
    report_undefined_callee(cx, name, span);
    Callee::Nothing(std::marker::PhantomData)
}

/// Reports the undefined name of a callee and suggests a similar name or the equivalent of a name from another
/// language.
fn report_undefined_callee(cx: &mut Body<'_, '_>, name: &Name, span: Span) {
    if let Some(Local::Flow(flow)) = locals::find_local(cx, name) {
        let declared = cx.unit.flow(flow).span;
        let help = match &cx.unit.flow(flow).ty {
            Ty::Array(..) => format!("an element is read by brackets: `{name}[...]`"),
            Ty::Int | Ty::Real(_) => format!("a product is written with `*`: `{name} * ...`"),
            _ => format!("write `{name}` without arguments, or the name of a node"),
        };
        let diagnostic = wrong_kind_of_name("a callable", name, "a flow", span, declared);
        return report::report_diagnostic(cx, diagnostic.help(help));
    }
    let callable = |id: DeclId| is_callable(cx.checker.program.decl(id).kind);
    let near = cx
        .checker
        .suggest(name, cx.checker.program.visible_names(cx.module, callable));
    // `time` is not suggested: it is also the name of a predeclared flow, which is more likely to be meant.
    let specials = INTRINSICS.iter().map(|special| special.name());
    let specials = specials.filter(|special| *special != "time");
    let near = near.or_else(|| rpi_diag::suggest(name, specials));
    let near = near.or_else(|| match name.is_qualified() {
        true => cx
            .checker
            .suggest(name, registry().iter().map(|prim| prim.desc.name)),
        false => None,
    });
    let what = if name.is_qualified() {
        "primitive"
    } else {
        "node, function or fragment"
    };
    let last = name.rsplit("::").next().unwrap_or_default();
    let is_there = |other: &str| {
        let mut visible = cx.checker.program.visible_names(cx.module, callable);
        visible.any(|known| known == other) || INTRINSICS.iter().any(|s| s.name() == other)
    };
    let here = match name.is_qualified() && is_there(last) {
        true => Some(last),
        false => crate::check::diagnostics::foreign::function_equivalent(name),
    };
    match here {
        Some(here) => undefined_names::report_foreign_name(cx, what, name, span, here),
        None => undefined_names::report_undefined(cx, what, name, span, near),
    }
}

/// Returns the callable that a name with static arguments refers to, when it is passed to an iterator or as a static
/// argument. `None` after an error.
pub(crate) fn resolve_callable<'a>(
    cx: &mut Body<'_, 'a>,
    name: &Name,
    statics: &'a [StaticArg],
    span: Span,
) -> Option<Callable> {
    match resolve_callee(cx, name, span) {
        Callee::Nothing(_) => None,
        Callee::Constructor(..) => {
            let diagnostic = wrong_kind_of_name(
                "a callable",
                name,
                "an alternative of a datatype",
                span,
                span,
            );
            report::report_diagnostic(cx, diagnostic);
            None
        }
        Callee::Known(callable) => Some(callable),
        Callee::Special(special) => Some(Callable::Intrinsic(special)),
        Callee::Prim(prim) => Some(Callable::Prim(prim)),
        Callee::Iterator(iterator) => {
            let iteration = iterate::resolve_iterator(cx, iterator, statics, span)?;
            Some(Callable::Iteration(Rc::new(iteration)))
        }
        Callee::Decl(id) => {
            if let DeclKind::Node(node) = cx.checker.program.decl(id).kind
                && let NodeDef::Alias(callee) = &node.definition
            {
                return resolve_alias(cx, id, callee, statics);
            }
            let bound = static_args::bind_statics(cx, id, statics);
            let fixed = fold_fixed_ports(cx, &bound.ports)?;
            (!bound.has_error).then(|| Callable::Unit(id, Rc::new(bound.statics), fixed))
        }
    }
}

/// Returns the values of the ports that static arguments fix, each computed now or, if it depends on parameters of the
/// command, when the command is loaded. `None` after an error.
fn fold_fixed_ports<'a>(
    cx: &mut Body<'_, 'a>,
    ports: &[CallArgument<'a>],
) -> Option<Rc<[(Name, FixedPortValue)]>> {
    let mut fixed = Vec::new();
    for port in ports {
        let value = match consts::try_fold(cx, port.value) {
            Err(NotConstantError::RunTime(_)) if args::is_load_time_constant(cx, port.value) => {
                FixedPortValue::LoadTime(port.value)
            }
            _ => FixedPortValue::Constant(Constant {
                leaves: consts::fold(cx, port.value)?,
                ty: cx.ty_of(port.value).clone(),
            }),
        };
        fixed.push((port.name?.name.clone(), value));
    }
    Some(fixed.into())
}

/// Returns the callable, or `None` after an error if the value of one of its ports is an expression of the current
/// body, so that the callable cannot be used outside of the body.
pub(crate) fn require_portable(cx: &mut Body<'_, '_>, callable: Callable) -> Option<Callable> {
    match callable.load_time_value() {
        None => Some(callable),
        Some(value) => {
            consts::fold(cx, value);
            None
        }
    }
}
