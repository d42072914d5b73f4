//! Types: resolution of type expressions, constants, units, frames, subranges and exact time.

pub(crate) mod consts;
pub(crate) mod data;
pub(crate) mod device;
pub(crate) mod exact_time;
pub(crate) mod frame_placement;
pub(crate) mod frames;
pub(crate) mod infer_times;
pub(crate) mod machine_int;
pub(crate) mod quantity;
pub(crate) mod subrange;
pub(crate) mod time_sums;
pub(crate) mod type_args;
pub(crate) mod type_decls;
pub(crate) mod value_types;

use crate::check::bodies::body::Body;
use crate::check::bodies::locals;
use crate::check::bodies::locals::Local;
use crate::check::diagnostics::report;
use crate::check::diagnostics::report::wrong_kind_of_name;
use crate::check::diagnostics::undefined_names;
use crate::check::exprs::compose;
use crate::check::exprs::proof_only;
use crate::check::exprs::proof_only::WHY_NO_SETS;
use crate::check::exprs::proof_only::opaque_type;
use crate::check::exprs::spatial_ops;
use crate::check::signatures::static_args;
use crate::check::signatures::static_args::StaticBinding;
use crate::check::signatures::unit;
use crate::check::types::quantity::invalid_unit;
use crate::program::{DeclId, DeclKind, Lookup, NameSpace};
use crate::ty::{Geometry, Ty};
use crate::units::{Dimension, ResolvedUnit, resolve};
use rpi_diag::{Code, Diagnostic, Span};
use rpi_image::Scalar;
use rpi_syntax::Name;
use rpi_syntax::ast::{ArrayType, Dotted, FramePair, NamedType, Type, TypeKind, Unit};
use std::rc::Rc;

/// Maximum number of leaves (scalar parts) of an array. A larger one is probably a mistake and would use much memory.
pub(crate) const MAX_LEAVES: usize = 1 << 16;

/// Type of a declaration, and whether its value may be absent (`T?`).
#[derive(Clone, Debug)]
pub(crate) struct DeclaredType {
    pub(crate) ty: Ty,
    pub(crate) optional: bool,
}

/// Returns the type of a port or variable, which may be optional as a whole (`T?`).
pub(crate) fn resolve_port_type<'a>(cx: &mut Body<'_, 'a>, ty: &'a Type) -> DeclaredType {
    match &ty.kind {
        TypeKind::Optional(inner) => DeclaredType {
            ty: resolve_type(cx, inner),
            optional: true,
        },
        _ => DeclaredType {
            ty: resolve_type(cx, ty),
            optional: false,
        },
    }
}

/// Returns the type that a type expression means. An optional type is an error here; the type is unknown after an
/// error.
pub(crate) fn resolve_type<'a>(cx: &mut Body<'_, 'a>, ty: &'a Type) -> Ty {
    match &ty.kind {
        TypeKind::Bool => Ty::Bool,
        TypeKind::Int => Ty::Int,
        TypeKind::Subrange(range) => subrange::subrange_type(cx, range, ty.span),
        TypeKind::Real(None) => Ty::REAL,
        TypeKind::Real(Some(unit)) => real_type(cx, unit),
        TypeKind::Named(named) => resolve_named_type(cx, named),
        TypeKind::Array(array) => array_type(cx, array, ty.span),
        TypeKind::Optional(inner) => optional_part(cx, inner, ty.span),
        TypeKind::Tuple(types) => {
            let types: Vec<Ty> = types
                .iter()
                .map(|ty| value_types::resolve_value_type(cx, ty))
                .collect();
            match &types[..] {
                [one] => one.clone(),
                _ => Ty::tuple(types),
            }
        }
        TypeKind::Refinement(refined) => proof_only::refinement_type(cx, refined),
        TypeKind::Enum(_) | TypeKind::Struct(_) | TypeKind::Datatype(_) => {
            anonymous_type(cx, ty.span)
        }
        TypeKind::Error => Ty::Unknown,
    }
}

/// Returns the type of reals in a unit. The type is unknown if the unit has a type parameter that is not known yet.
fn real_type(cx: &mut Body<'_, '_>, unit: &Unit) -> Ty {
    match resolve_unit(cx, unit) {
        Ok(Some(measure)) => Ty::Real(measure.dim),
        Ok(None) => Ty::Unknown,
        Err(diagnostic) => {
            report::report_diagnostic(cx, *diagnostic);
            Ty::Unknown
        }
    }
}

/// Returns the resolved unit in a type; `None` if it has a type parameter that is not known yet.
///
/// # Errors
///
/// Returns the diagnostic for an invalid unit.
pub(crate) fn resolve_unit(
    cx: &Body<'_, '_>,
    unit: &Unit,
) -> Result<Option<ResolvedUnit>, Box<Diagnostic>> {
    for factor in &unit.factors {
        match cx.statics.get(&factor.unit.name) {
            Some(StaticBinding::Type(Ty::Generic(_) | Ty::Unknown)) => return Ok(None),
            Some(StaticBinding::Type(ty)) if !matches!(ty, Ty::Real(_) | Ty::Duration) => {
                return Err(Box::new(type_decls::not_a_quantity(&factor.unit, ty)));
            }
            _ => {}
        }
    }
    let parameter = |name: &str| match cx.statics.get(name) {
        Some(StaticBinding::Type(Ty::Real(dim))) => Some(*dim),
        Some(StaticBinding::Type(Ty::Duration)) => Some(Dimension::TIME),
        _ => None,
    };
    let found = resolve(unit, &parameter).map_err(|fault| Box::new(invalid_unit(&fault)));
    found.map(Some)
}

fn optional_part<'a>(cx: &mut Body<'_, 'a>, inner: &'a Type, span: Span) -> Ty {
    report::report_diagnostic(
        cx,
        Diagnostic::new(Code::RPI3004, "a part of a value cannot be optional")
            .primary(span, "optional part")
            .help("only a whole flow or port can be optional: write `?` after the whole type"),
    );
    resolve_type(cx, inner)
}

fn anonymous_type(cx: &mut Body<'_, '_>, span: Span) -> Ty {
    report::report_diagnostic(
        cx,
        Diagnostic::new(Code::RPI1003, "an enum or struct needs a name")
            .primary(span, "declared in place")
            .help("declare it by `type Name = ...;` and write the name here"),
    );
    Ty::Unknown
}

fn array_type<'a>(cx: &mut Body<'_, 'a>, array: &'a ArrayType, span: Span) -> Ty {
    let element = value_types::resolve_value_type(cx, &array.element);
    let Some(size) = compose::const_size(cx, &array.size) else {
        return Ty::Unknown;
    };
    let ty = Ty::Array(Rc::new(element), size);
    if ty.leaf_count() > MAX_LEAVES {
        report::report_diagnostic(cx, too_large(span));
        return Ty::Unknown;
    }
    ty
}

fn resolve_named_type<'a>(cx: &mut Body<'_, 'a>, named: &'a NamedType) -> Ty {
    let name = &named.name.name;
    if let Some(StaticBinding::Type(ty)) = cx.statics.get(name) {
        return ty.clone();
    }
    match cx
        .checker
        .program
        .lookup_in(NameSpace::Type, cx.module, name)
    {
        Lookup::Found(id) => resolve_declared_type(cx, id, named),
        Lookup::Missing => resolve_builtin_type(cx, named),
    }
}

/// Returns the type with this name, without static arguments. Reports an undefined type and returns `None`.
pub(crate) fn type_by_plain_name(cx: &mut Body<'_, '_>, name: &Name, span: Span) -> Option<Ty> {
    if let Some(StaticBinding::Type(ty)) = cx.statics.get(name) {
        return Some(ty.clone());
    }
    if let Lookup::Found(id) = cx
        .checker
        .program
        .lookup_in(NameSpace::Type, cx.module, name)
        && let DeclKind::Type(_) = cx.checker.program.decl(id).kind
    {
        return Some(data::type_instance_for(cx, id, &[], span));
    }
    let spatial = Scalar::ALL
        .iter()
        .copied()
        .find(|s| s.name() == name.as_str());
    let found = match name.as_str() {
        "time" if unit::reads_rpi_syntax(cx) => Some(Ty::Duration),
        _ => spatial.map(crate::ty::machine_types::scalar_ty),
    };
    if found.is_none() {
        undefined_names::report_undefined_type(cx, name, span);
    }
    found
}

/// Whether a name is neither a declared type nor a static parameter, so that it can only be a predeclared type.
pub(crate) fn is_undeclared_type(cx: &Body<'_, '_>, name: &Name) -> bool {
    let found = cx
        .checker
        .program
        .lookup_in(NameSpace::Type, cx.module, name);
    !cx.statics.contains_key(name) && matches!(found, Lookup::Missing)
}

fn resolve_declared_type<'a>(cx: &mut Body<'_, 'a>, id: DeclId, named: &'a NamedType) -> Ty {
    let decl = cx.checker.program.decl(id);
    match decl.kind {
        DeclKind::Type(_) => data::type_instance_for(cx, id, &named.statics, named.name.span),
        DeclKind::Device(device) => device::resolve_device_type(cx, id, device, named),
        DeclKind::Broken(_) => Ty::Unknown,
        kind => {
            let diagnostic = wrong_kind_of_name(
                "a type",
                &decl.name,
                kind.description(),
                named.name.span,
                decl.span,
            );
            report::report_diagnostic(cx, diagnostic);
            Ty::Unknown
        }
    }
}

fn resolve_builtin_type<'a>(cx: &mut Body<'_, 'a>, named: &'a NamedType) -> Ty {
    let name = named.name.name.as_str();
    let scalar = Scalar::ALL.iter().copied().find(|s| s.name() == name);
    match scalar {
        Some(Scalar::Time) => Ty::Time,
        Some(scalar) => {
            let dim = spatial_ops::component_dim(cx, scalar, &named.statics);
            let geometry = check_geometry(cx, named.frames.as_ref());
            Ty::Spatial(scalar, Rc::new(Geometry { dim, ..geometry }))
        }
        None if name == "result" => Ty::Result,
        None if name == "text" => Ty::Text,
        None if name == "time" && unit::reads_rpi_syntax(cx) => Ty::Duration,
        None if !unit::reads_rpi_syntax(cx) && is_kind2_type_name(name) => kind2_type(cx, named),
        None => {
            undefined_names::report_undefined_type(cx, &named.name.name, named.name.span);
            Ty::Unknown
        }
    }
}

/// Returns a built-in type of Kind 2: a machine integer type, or a type that cannot be executed, such as a set.
fn kind2_type<'a>(cx: &mut Body<'_, 'a>, named: &'a NamedType) -> Ty {
    let (name, span) = (named.name.name.as_str(), named.name.span);
    if !matches!(name, "set" | "map" | "history") {
        let machine = machine_int::machine_int_type(cx, name, &named.statics, span);
        return machine.map_or(Ty::Unknown, Ty::Machine);
    }
    let args: Vec<String> = named
        .statics
        .iter()
        .map(|arg| type_argument(cx, arg))
        .collect();
    match name {
        "set" | "map" => proof_only::not_executable(cx, &format!("a {name}"), WHY_NO_SETS, span),
        _ => history(cx, named),
    }
    match &args[..] {
        _ if args.iter().any(String::is_empty) => Ty::Unknown,
        _ if name == "history" => Ty::Unknown,
        [] => opaque_type(name.to_owned()),
        args => opaque_type(format!("{name}<{}>", args.join(", "))),
    }
}

/// Returns the text of a static argument of a Kind 2 type, such as the key type of a map; empty after an error.
fn type_argument<'a>(cx: &mut Body<'_, 'a>, arg: &'a rpi_syntax::ast::StaticArg) -> String {
    match &arg.value {
        rpi_syntax::ast::StaticValue::Expr(value) => {
            consts::const_integer(cx, value).map_or_else(String::new, |n| n.to_string())
        }
        _ => match static_args::static_type(cx, arg) {
            None | Some(Ty::Unknown) => String::new(),
            Some(ty) => ty.to_string(),
        },
    }
}

/// Reports the Kind 2 type `history(x)`, the sequence of past values of a flow, because it cannot be executed.
fn history(cx: &mut Body<'_, '_>, named: &NamedType) {
    let of = named
        .frames
        .as_ref()
        .and_then(|frames| frames.reference.parts.first());
    let Some(of) = of else {
        return undefined_names::report_undefined_type(cx, &named.name.name, named.name.span);
    };
    let is_bound = cx
        .bindings
        .bound_names
        .iter()
        .any(|bound| bound.name == of.name);
    if is_bound || cx.find_flow(&of.name).is_none() {
        let message = format!("`{}` has no history", of.name);
        let label = match is_bound {
            true => "a variable of the quantifier, not a flow of the node",
            false => "not a flow of the node",
        };
        let diagnostic = Diagnostic::new(Code::RPI2014, message)
            .primary(of.span, label)
            .help("write the name of a port or local flow: `history(x)` holds the past values of the flow `x`");
        return report::report_diagnostic(cx, diagnostic);
    }
    proof_only::not_executable(
        cx,
        "a history",
        "a control core stores no values of earlier cycles except those of `pre`",
        named.name.span,
    );
}

pub(crate) fn similar_type(cx: &Body<'_, '_>, name: &str) -> Option<String> {
    let builtin = [
        "Vector", "Rotation", "Pose", "Twist", "Wrench", "Time", "time", "bool", "int", "real",
    ];
    let is_type = |id: DeclId| {
        let kind = cx.checker.program.decl(id).kind;
        matches!(kind, DeclKind::Type(_) | DeclKind::Device(_))
    };
    let declared = cx
        .checker
        .suggest(name, cx.checker.program.visible_names(cx.module, is_type));
    declared.or_else(|| rpi_diag::suggest(name, builtin.into_iter()))
}

fn check_geometry(cx: &mut Body<'_, '_>, frames: Option<&FramePair>) -> Geometry {
    Geometry {
        dim: None,
        of: frames
            .and_then(|f| f.located.as_ref())
            .and_then(|f| check_frame(cx, f)),
        in_frame: frames.and_then(|f| check_frame(cx, &f.reference)),
    }
}

/// Returns the name of a frame that is declared or belongs to a device; in the ports of a callable it may be
/// undeclared.
fn check_frame(cx: &mut Body<'_, '_>, frame: &Dotted) -> Option<Name> {
    match &frame.parts[..] {
        [one] => {
            let known = is_frame_name(cx, &one.name) || free_frame(cx, &one.name);
            checked_frame(cx, known, one.name.clone(), one.span)
        }
        [device, local] => {
            let known = device_frames(cx, &device.name).contains(&local.name);
            let name = format!("{}.{}", device.name, local.name);
            checked_frame(cx, known, name.into(), frame.span)
        }
        _ => checked_frame(cx, false, "".into(), frame.span),
    }
}

/// Returns the name of the frame in which another frame is placed. Reports an undefined frame.
pub(crate) fn parent_frame(cx: &mut Body<'_, '_>, frame: &Dotted) -> Option<Name> {
    check_frame(cx, frame)
}

fn is_frame_name(cx: &Body<'_, '_>, name: &Name) -> bool {
    match cx.checker.program.lookup(cx.module, name) {
        Lookup::Found(id) => matches!(cx.checker.program.decl(id).kind, DeclKind::Frame(_)),
        _ => false,
    }
}

/// Whether a frame name is free: not declared, and bound by the arguments of a call. In ports every name may be free.
fn free_frame(cx: &mut Body<'_, '_>, name: &Name) -> bool {
    let known = cx.unit.free_frames.contains(name);
    if !known && cx.in_signature {
        cx.unit.free_frames.push(name.clone());
    }
    known || cx.in_signature
}

fn device_frames(cx: &Body<'_, '_>, device: &Name) -> Vec<Name> {
    let Some(Local::Flow(flow)) = locals::find_local(cx, device) else {
        return Vec::new();
    };
    cx.unit
        .device_type_instance(flow)
        .map_or_else(Vec::new, |d| d.frames.clone())
}

fn checked_frame(cx: &mut Body<'_, '_>, known: bool, name: Name, span: Span) -> Option<Name> {
    if !known {
        let program = cx.checker.program;
        let is_frame = |id| matches!(program.decl(id).kind, DeclKind::Frame(_));
        let declared = program.visible_names(cx.module, is_frame);
        let free = cx.unit.free_frames.iter().map(Name::as_str);
        let near = cx.checker.suggest(&name, free.chain(declared));
        let mut diagnostic = Diagnostic::new(Code::RPI1001, format!("undefined frame `{name}`"))
            .primary(span, "not declared");
        if near.is_none() {
            let help =
                "declare it by `frame`, name it in the signature, or use a frame of a device";
            diagnostic = diagnostic.help(help);
        }
        report::report_diagnostic(cx, diagnostic.did_you_mean(span, near));
    }
    known.then_some(name)
}

/// Names of the built-in types of Kind 2.
const KIND2_TYPES: &[&str] = &[
    "set", "map", "history", "int8", "int16", "int32", "int64", "uint8", "uint16", "uint32",
    "uint64", "uint", "sint",
];

/// Prefixes of the names of Kind 2 types whose operators are not checked.
pub(crate) const UNCHECKED_TYPE_PREFIXES: &[&str] = &["set<", "map<"];

fn is_kind2_type_name(name: &str) -> bool {
    KIND2_TYPES.contains(&name)
}

/// Returns whether a type is a built-in type of Kind 2 whose name starts with one of the prefixes `beginnings`.
pub(crate) fn is_kind2_type(ty: &Ty, beginnings: &[&str]) -> bool {
    let Ty::Struct(of) = ty else {
        return false;
    };
    let base = of.name.split('<').next().unwrap_or_default();
    is_kind2_type_name(base)
        && beginnings
            .iter()
            .any(|beginning| of.name.starts_with(beginning))
}

/// Returns the diagnostic for an array with too many leaves (scalar parts).
pub(crate) fn too_large(span: Span) -> Diagnostic {
    Diagnostic::new(Code::RPI2009, "the array is too large")
        .primary(span, format!("more than {MAX_LEAVES} values"))
        .help("use a smaller array, or several")
}
