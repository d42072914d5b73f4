//! Static parameters of declarations: their kinds, types and default values.

use crate::check::bodies::body::Body;
use crate::check::exprs::expr;
use crate::check::limits::nesting;
use crate::check::signatures::static_args::StaticBinding;
use crate::check::signatures::static_args::StaticBindings;
use crate::check::types;
use crate::check::types::consts;
use crate::check::{Checker, Constant};
use crate::program::{DeclId, DeclKind};
use crate::ty::Ty;
use rpi_diag::Span;
use rpi_syntax::Name;
use rpi_syntax::ast::{
    ConstDef, Ident, NodeDecl, Signature, StaticParam, StaticParamKind, VarDecl,
};
use std::rc::Rc;

/// Declaration of a static parameter: for a type, a value or a node.
#[derive(Clone, Copy)]
pub(crate) enum StaticParamDecl<'a> {
    /// Type parameter, and the keyword of its constraint if there is one: `type t`, `type T: number`.
    Type(&'a Ident, Option<&'a Ident>),
    /// Value parameter with its definition: `n: int = 3`.
    Value(&'a Ident, &'a ConstDef),
    /// Parameter that stands for a node with these ports: `node f (...) returns (...)`.
    Node(&'a Signature),
}

/// Returns the static parameters of a declaration, one for each declared name.
pub(crate) fn static_params<'a>(statics: &'a [StaticParam]) -> Vec<StaticParamDecl<'a>> {
    let mut all = Vec::new();
    for param in statics {
        match &param.kind {
            StaticParamKind::Type(name, constraint) => {
                all.push(StaticParamDecl::Type(name, constraint.as_ref()));
            }
            StaticParamKind::Value(def) => {
                all.extend(
                    def.names
                        .iter()
                        .map(|name| StaticParamDecl::Value(name, def)),
                );
            }
            StaticParamKind::Node(_, signature) => all.push(StaticParamDecl::Node(signature)),
        }
    }
    all
}

/// Returns the in-ports of a node that are declared `const`. They may determine array sizes and are treated like static
/// parameters.
pub(crate) fn size_params(node: &NodeDecl) -> Vec<StaticParamDecl<'_>> {
    let sizes = node.size_params.iter();
    sizes
        .flat_map(|def| {
            def.names
                .iter()
                .map(move |name| StaticParamDecl::Value(name, def))
        })
        .collect()
}

/// Returns whether a callable declaration has a static parameter or an in-port of this name.
pub(crate) fn has_param(checker: &Checker<'_>, id: DeclId, name: &Name) -> bool {
    in_port_names(checker, id).any(|port| port == name)
        || static_params_of_decl(checker, id)
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

/// Returns the names of the in-ports of a callable declaration, or of the parameters of a command, with their locations.
pub(crate) fn in_port_idents<'a>(
    checker: &Checker<'a>,
    id: DeclId,
) -> impl Iterator<Item = &'a Ident> + use<'a> {
    let inputs: &'a [VarDecl] = match checker.program.decl(id).kind {
        DeclKind::Node(d) => d.signature.inputs.as_deref().unwrap_or(&[]),
        DeclKind::Fragment(d) => d.signature.inputs.as_deref().unwrap_or(&[]),
        DeclKind::Primitive(d) => d.signature.inputs.as_deref().unwrap_or(&[]),
        DeclKind::Command(d) => &d.params,
        _ => &[],
    };
    inputs.iter().flat_map(|port| &port.names)
}

/// Returns the static parameters of the declaration `id`; empty if it is not callable.
pub(crate) fn static_params_of_decl<'a>(
    checker: &Checker<'a>,
    id: DeclId,
) -> Vec<StaticParamDecl<'a>> {
    static_params_of(checker.program.decl(id).kind)
}

/// Returns the static parameters of a declaration of this kind; empty if it is not callable.
pub(crate) fn static_params_of(kind: DeclKind<'_>) -> Vec<StaticParamDecl<'_>> {
    match kind {
        DeclKind::Node(d) => [static_params(&d.signature.statics), size_params(d)].concat(),
        DeclKind::Fragment(d) => static_params(&d.signature.statics),
        DeclKind::Primitive(d) => static_params(&d.signature.statics),
        DeclKind::Command(d) => static_params(&d.statics),
        DeclKind::Device(d) => static_params(&d.statics),
        _ => Vec::new(),
    }
}

/// Returns the declared type of a static value parameter, or the type of its default. The type is unknown if it depends
/// on type parameters without a value in `statics`.
pub(crate) fn static_param_type<'a>(
    checker: &mut Checker<'a>,
    id: DeclId,
    def: &'a ConstDef,
    statics: &StaticBindings,
) -> Ty {
    let mut known = statics.clone();
    for param in static_params_of_decl(checker, id) {
        if let StaticParamDecl::Type(name, _) = param {
            let open = || StaticBinding::Type(Ty::Unknown);
            known.entry(name.name.clone()).or_insert_with(open);
        }
    }
    static_param_type_with(checker, id, def, &Rc::new(known))
}

/// Returns the types of ports in the signature of declaration `id`, one for each port name. `statics` are the values of
/// its static parameters.
pub(crate) fn signature_port_types<'a>(
    checker: &mut Checker<'a>,
    id: DeclId,
    statics: &StaticBindings,
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

/// Reports errors in the port types of those static parameters of declaration `id` that stand for nodes.
pub(crate) fn check_node_params(
    checker: &mut Checker<'_>,
    id: DeclId,
    statics: &Rc<StaticBindings>,
) {
    for param in static_params_of_decl(checker, id) {
        let StaticParamDecl::Node(signature) = param else {
            continue;
        };
        let mut body = signature_body(checker, id, statics);
        body.in_signature = true;
        let ports = signature.inputs.iter().chain(&signature.outputs).flatten();
        for port in ports {
            types::resolve_type(&mut body, &port.ty);
        }
        body.finish();
    }
}

fn static_param_type_with<'a>(
    checker: &mut Checker<'a>,
    id: DeclId,
    def: &'a ConstDef,
    statics: &Rc<StaticBindings>,
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

/// Returns a body for checking types in the signature of declaration `id`. `statics` are the static parameters known so
/// far.
fn signature_body<'s, 'a>(
    checker: &'s mut Checker<'a>,
    id: DeclId,
    statics: &Rc<StaticBindings>,
) -> Body<'s, 'a> {
    let unit = crate::typed::Unit::new("".into(), crate::typed::UnitKind::Constant, Span::NONE);
    Body::new(checker, id, statics.clone(), unit)
}

/// Adds to `statics` the defaults of the static parameters of `id` that have no argument. Returns the names of the
/// parameters that have no default either.
pub(crate) fn add_default_statics(
    checker: &mut Checker<'_>,
    id: DeclId,
    statics: &mut StaticBindings,
) -> Vec<Name> {
    let mut open = Vec::new();
    for param in static_params_of_decl(checker, id) {
        let name = &param.name().name;
        if statics.contains_key(name) {
            continue;
        }
        match param {
            StaticParamDecl::Value(_, def) => {
                // Moved out and back instead of cloned: each default may need all parameters before it.
                let known = Rc::new(std::mem::take(statics));
                let value = default_static(checker, id, def, &known);
                *statics = Rc::unwrap_or_clone(known);
                if value.is_none() && def.value.is_none() {
                    open.push(name.clone());
                }
                statics.insert(name.clone(), value.unwrap_or(StaticBinding::LoadTime));
            }
            StaticParamDecl::Type(..) => {
                open.push(name.clone());
                statics.insert(name.clone(), StaticBinding::Type(Ty::Generic(name.clone())));
            }
            StaticParamDecl::Node(_) => open.push(name.clone()),
        }
    }
    open
}

fn default_static<'a>(
    checker: &mut Checker<'a>,
    id: DeclId,
    def: &'a ConstDef,
    statics: &Rc<StaticBindings>,
) -> Option<StaticBinding> {
    let decl = checker.program.decl(id);
    let ty = static_param_type_with(checker, id, def, statics);
    let value = def
        .value
        .as_ref()
        .filter(|_| distinguishes_instances(&ty))?;
    if !nesting::may_nest(checker, "static parameter", decl.span) {
        return None;
    }
    let leaves = nesting::check_nested(checker, |checker| {
        let mut body = signature_body(checker, id, statics);
        consts::const_value(&mut body, value, &ty)
    })?;
    Some(StaticBinding::Value(Constant { ty, leaves }))
}

/// Whether values of a type may determine array sizes and static branches, so that each value needs an instance of its
/// own.
pub(crate) fn distinguishes_instances(ty: &Ty) -> bool {
    match ty {
        Ty::Bool | Ty::Int | Ty::Subrange(_) | Ty::Enum(_) => true,
        Ty::Array(element, _) => distinguishes_instances(element),
        _ => false,
    }
}
