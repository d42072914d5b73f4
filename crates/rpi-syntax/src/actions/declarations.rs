//! Grammar actions for declarations, parameters and ports.
//!
//! In the functions, `l` and `r` are the byte offsets of the beginning and end of the node.

use crate::Dialect;
use crate::ast::*;
use crate::context::ParseContext;
use crate::validation;
use rpi_diag::Span;

/// Builds a section of a device: the ports after `actuator`, `sensor` or `status`.
///
/// A doc comment before the keyword belongs to the first port.
pub(crate) fn device_section(
    cx: &ParseContext<'_>,
    kind: PortKind,
    mut ports: Vec<DevicePort>,
    start: u32,
    end: u32,
) -> DeviceSection {
    let first = ports.first_mut();
    if let Some(first) = first.and_then(|port| port.alternatives.first_mut()) {
        first.doc = first.doc.take().or_else(|| cx.doc(start));
    }
    DeviceSection {
        kind,
        ports,
        span: cx.span(start, end),
    }
}

pub(crate) fn signature(
    name: Ident,
    statics: Vec<StaticParam>,
    inputs: Option<Vec<VarDecl>>,
    outputs: Option<Vec<VarDecl>>,
) -> Signature {
    Signature {
        name,
        statics,
        inputs,
        outputs,
    }
}

pub(crate) fn node(
    modifier: Modifier,
    kind: NodeKind,
    signature: Signature,
    contract: Option<Box<Contract>>,
    definition: NodeDef,
    outside: ExternalForm,
) -> Box<NodeDecl> {
    let sizes = crate::size_ports::size_params(&signature, &definition);
    Box::new(NodeDecl {
        kind,
        size_params: sizes,
        modifier,
        signature,
        contract: contract.map(|c| *c),
        definition,
        external_form: outside,
        c_name: None,
    })
}

/// Builds an external function with its name in C: `extern function f (x: real) returns (y: real) = "c_name";`.
pub(crate) fn external(
    (modifier, kind): (Modifier, NodeKind),
    signature: Signature,
    c_name: Ident,
    contract: Option<Box<Contract>>,
) -> Box<NodeDecl> {
    let form = ExternalForm::Extern;
    let mut declared = node(modifier, kind, signature, contract, NodeDef::Extern, form);
    declared.c_name = Some(c_name);
    declared
}

/// Sets `clock` as the clock of all variables that have none, as in `(x: int; y: int) when c`.
pub(crate) fn with_clock(mut vars: Vec<VarDecl>, clock: Clock) -> Vec<VarDecl> {
    for var in &mut vars {
        var.clock.get_or_insert_with(|| clock.clone());
    }
    vars
}

pub(crate) fn item(cx: &ParseContext<'_>, l: u32, kind: ItemKind, r: u32) -> Item {
    Item {
        doc: cx.doc(l),
        kind,
        span: cx.span(l, r),
    }
}

pub(crate) fn const_def(
    cx: &ParseContext<'_>,
    l: u32,
    names: Vec<Ident>,
    ty: Option<Type>,
    value: Option<Expr>,
    r: u32,
) -> Box<ConstDef> {
    Box::new(ConstDef {
        doc: cx.doc(l),
        names,
        ty,
        value,
        span: cx.span(l, r),
    })
}

pub(crate) fn generic_type(
    cx: &ParseContext<'_>,
    l: u32,
    name: Ident,
    statics: Vec<StaticParam>,
    ty: Type,
    r: u32,
) -> Box<TypeDef> {
    let mut def = type_def(cx, l, name, Some(ty), r);
    def.statics = statics;
    def
}

pub(crate) fn type_def(
    cx: &ParseContext<'_>,
    l: u32,
    name: Ident,
    ty: Option<Type>,
    r: u32,
) -> Box<TypeDef> {
    Box::new(TypeDef {
        doc: cx.doc(l),
        name,
        statics: Vec::new(),
        ty,
        span: cx.span(l, r),
    })
}

pub(crate) fn broken_type_def(cx: &ParseContext<'_>, l: u32, r: u32) -> Box<TypeDef> {
    let span = cx.span(l, r);
    let name = cx.error_names(l).into_iter().next();
    let name = name.unwrap_or_else(|| placeholder_name(cx, span));
    type_def(cx, l, name, Some(broken_type(span)), r)
}

pub(crate) fn static_param(
    cx: &ParseContext<'_>,
    l: u32,
    kind: StaticParamKind,
    r: u32,
) -> Box<StaticParam> {
    Box::new(StaticParam {
        doc: cx.doc(l),
        kind,
        span: cx.span(l, r),
    })
}

pub(crate) fn var_decl(
    cx: &ParseContext<'_>,
    l: u32,
    names: Vec<Ident>,
    ty: Type,
    clock: Option<Box<Clock>>,
    default: Option<Expr>,
    r: u32,
) -> Box<VarDecl> {
    Box::new(VarDecl {
        doc: cx.doc(l),
        is_const: false,
        names,
        ty,
        clock: clock.map(|clock| *clock),
        default,
        span: cx.span(l, r),
    })
}

/// Builds a variable declaration with a condition (Kind 2): `x: int | x > 0`, short for
/// `x: subtype { x: int | x > 0 }`.
pub(crate) fn refined_decl(
    cx: &ParseContext<'_>,
    l: u32,
    names: Vec<Ident>,
    base: Type,
    condition: Expr,
    r: u32,
) -> Box<VarDecl> {
    let Some(name) = names.first().cloned() else {
        return var_decl(cx, l, names, base, None, None, r);
    };
    if cx.dialect != Dialect::Lustre {
        cx.report(validation::unsupported_condition(condition.span));
        return var_decl(cx, l, names, base, None, None, r);
    }
    let span = base.span.merge(condition.span);
    let refined = RefinementType {
        name,
        base,
        condition,
    };
    let kind = TypeKind::Refinement(Box::new(refined));
    var_decl(cx, l, names, Type { kind, span }, None, None, r)
}

pub(crate) fn const_port(
    cx: &ParseContext<'_>,
    l: u32,
    names: Vec<Ident>,
    ty: Type,
    r: u32,
) -> Box<VarDecl> {
    let mut port = var_decl(cx, l, names, ty, None, None, r);
    port.is_const = true;
    port
}

/// Builds a constant definition for the byte range `l..r`, which has a syntax error. Its type is an error type, and it
/// has no value.
pub(crate) fn broken_const_def(cx: &ParseContext<'_>, l: u32, r: u32) -> Box<ConstDef> {
    let ty = broken_type(cx.span(l, r));
    const_def(cx, l, cx.error_names(l), Some(ty), None, r)
}

pub(crate) fn broken_var_decl(cx: &ParseContext<'_>, l: u32, r: u32) -> Box<VarDecl> {
    let ty = broken_type(cx.span(l, r));
    var_decl(cx, l, cx.error_names(l), ty, None, None, r)
}

pub(crate) fn clock(
    cx: &ParseContext<'_>,
    l: u32,
    tick: ClockValue,
    flow: Ident,
    r: u32,
) -> Box<Clock> {
    let span = cx.span(l, r);
    Box::new(Clock {
        value: tick,
        flow,
        span,
    })
}

/// Returns the placeholder name `_` for a declaration whose name is missing. The error has been reported.
fn placeholder_name(cx: &ParseContext<'_>, span: Span) -> Ident {
    Ident {
        name: cx.intern("_"),
        span,
    }
}

fn broken_type(span: Span) -> Type {
    Type {
        kind: TypeKind::Error,
        span,
    }
}
