//! Resolution of type expressions.

use super::body::Body;
use super::locals::Local;
use super::nesting::is_workable;
use super::quantifier::{SETS, foreign_ty};
use super::quantity::unit_fault;
use super::report::not_a;
use super::statics::{Static, Statics};
use super::{Checker, Lazy};
use crate::program::{DeclId, DeclKind, Lookup, Space};
use crate::ty::{EnumTy, Geometry, Member, StructTy, Ty};
use crate::typed::Leaf;
use crate::units::{Dim, Measure, resolve};
use rpi_diag::{Code, Finding, Span};
use rpi_image::Scalar;
use rpi_syntax::Name;
use rpi_syntax::ast::{
    ArrayType, Dotted, Frames, Ident, NamedType, Type, TypeDef, TypeKind, Unit, VarDecl,
};
use std::rc::Rc;

/// Maximum number of leaves of an array, over all levels. A larger array is probably a mistake, and would only use up
/// memory.
pub(super) const MAX_LEAVES: usize = 1 << 16;

/// A type, and whether a value may be absent.
#[derive(Clone, Debug)]
pub(super) struct PortTy {
    pub(super) ty: Ty,
    pub(super) optional: bool,
}

impl<'a> Body<'_, 'a> {
    /// Resolves the type of a port or variable, which may be optional as a whole.
    pub(super) fn port_ty(&mut self, ty: &'a Type) -> PortTy {
        match &ty.kind {
            TypeKind::Optional(inner) => PortTy {
                ty: self.ty(inner),
                optional: true,
            },
            _ => PortTy {
                ty: self.ty(ty),
                optional: false,
            },
        }
    }

    /// Resolves a type that is not optional.
    pub(super) fn ty(&mut self, ty: &'a Type) -> Ty {
        match &ty.kind {
            TypeKind::Bool => Ty::Bool,
            TypeKind::Int => Ty::Int,
            TypeKind::Subrange(range) => self.subrange(range, ty.span),
            TypeKind::Real(None) => Ty::REAL,
            TypeKind::Real(Some(unit)) => self.real_in(unit),
            TypeKind::Named(named) => self.named_ty(named),
            TypeKind::Array(array) => self.array_ty(array, ty.span),
            TypeKind::Optional(inner) => self.inner_optional(inner, ty.span),
            TypeKind::Tuple(types) => {
                let types: Vec<Ty> = types.iter().map(|ty| self.value_ty(ty)).collect();
                match &types[..] {
                    [one] => one.clone(),
                    _ => Ty::tuple(types),
                }
            }
            TypeKind::Refined(refined) => self.refined(refined),
            TypeKind::Enum(_) | TypeKind::Struct(_) | TypeKind::Data(_) => {
                self.nameless_ty(ty.span)
            }
            TypeKind::Broken => Ty::Unknown,
        }
    }

    /// Resolves the type of reals in a unit; unknown while a type parameter in the unit is unknown, and after an error.
    fn real_in(&mut self, unit: &Unit) -> Ty {
        match self.measure(unit) {
            Ok(Some(measure)) => Ty::Real(measure.dim),
            Ok(None) => Ty::Unknown,
            Err(finding) => {
                self.report(*finding);
                Ty::Unknown
            }
        }
    }

    /// Resolves a unit; `None` while a type parameter in it is unknown.
    ///
    /// # Errors
    /// Returns the diagnostic for an invalid unit.
    pub(super) fn measure(&self, unit: &Unit) -> Result<Option<Measure>, Box<Finding>> {
        for factor in &unit.factors {
            match self.statics.get(&factor.unit.name) {
                Some(Static::Ty(Ty::Generic(_) | Ty::Unknown)) => return Ok(None),
                Some(Static::Ty(ty)) if !matches!(ty, Ty::Real(_) | Ty::Duration) => {
                    return Err(Box::new(no_quantity(&factor.unit, ty)));
                }
                _ => {}
            }
        }
        let parameter = |name: &str| match self.statics.get(name) {
            Some(Static::Ty(Ty::Real(dim))) => Some(*dim),
            Some(Static::Ty(Ty::Duration)) => Some(Dim::TIME),
            _ => None,
        };
        let found = resolve(unit, &parameter).map_err(|fault| Box::new(unit_fault(&fault)));
        found.map(Some)
    }

    fn inner_optional(&mut self, inner: &'a Type, span: Span) -> Ty {
        self.report(
            Finding::new(Code::RPI3004, "a part of a value cannot be optional")
                .at(span, "optional part")
                .help("only a whole flow or port can be optional: write `?` after the whole type"),
        );
        self.ty(inner)
    }

    fn nameless_ty(&mut self, span: Span) -> Ty {
        self.report(
            Finding::new(Code::RPI1003, "an enum or struct needs a name")
                .at(span, "declared in place")
                .help("declare it by `type Name = ...;` and write the name here"),
        );
        Ty::Unknown
    }

    fn array_ty(&mut self, array: &'a ArrayType, span: Span) -> Ty {
        let element = self.value_ty(&array.element);
        let Some(size) = self.size(&array.size) else {
            return Ty::Unknown;
        };
        let ty = Ty::Array(Rc::new(element), size);
        if ty.leaf_count() > MAX_LEAVES {
            self.report(too_large(span));
            return Ty::Unknown;
        }
        ty
    }

    fn named_ty(&mut self, named: &'a NamedType) -> Ty {
        let name = &named.name.name;
        if let Some(Static::Ty(ty)) = self.statics.get(name) {
            return ty.clone();
        }
        match self.c.program.lookup_in(Space::Type, self.module, name) {
            Lookup::Found(id) => self.declared_ty(id, named),
            Lookup::Missing => self.builtin_ty(named),
        }
    }

    /// Resolves a type by its name alone.
    pub(super) fn ty_named(&mut self, name: &Name, span: Span) -> Option<Ty> {
        if let Some(Static::Ty(ty)) = self.statics.get(name) {
            return Some(ty.clone());
        }
        if let Lookup::Found(id) = self.c.program.lookup_in(Space::Type, self.module, name)
            && let DeclKind::Type(_) = self.c.program.decl(id).kind
        {
            return Some(self.type_of(id, &[], span));
        }
        let spatial = Scalar::ALL
            .iter()
            .copied()
            .find(|s| s.name() == name.as_str());
        let found = match name.as_str() {
            "time" if self.is_rpi() => Some(Ty::Duration),
            _ => spatial.map(super::prim::scalar_ty),
        };
        if found.is_none() {
            self.unknown_type(name, span);
        }
        found
    }

    /// Whether no declaration and no static parameter has this name, so that it can only be a predeclared type.
    pub(super) fn is_undeclared_type(&self, name: &Name) -> bool {
        let found = self.c.program.lookup_in(Space::Type, self.module, name);
        !self.statics.contains_key(name) && matches!(found, Lookup::Missing)
    }

    fn declared_ty(&mut self, id: DeclId, named: &'a NamedType) -> Ty {
        let decl = self.c.program.decl(id);
        match decl.kind {
            DeclKind::Type(_) => self.type_of(id, &named.statics, named.name.span),
            DeclKind::Device(device) => self.device_ty(id, device, named),
            DeclKind::Broken(_) => Ty::Unknown,
            kind => {
                let finding = not_a(
                    "a type",
                    &decl.name,
                    kind.what(),
                    named.name.span,
                    decl.span,
                );
                self.report(finding);
                Ty::Unknown
            }
        }
    }

    fn builtin_ty(&mut self, named: &'a NamedType) -> Ty {
        let name = named.name.name.as_str();
        let scalar = Scalar::ALL.iter().copied().find(|s| s.name() == name);
        match scalar {
            Some(Scalar::Time) => Ty::Time,
            Some(scalar) => {
                let dim = self.components(scalar, &named.statics);
                let geometry = self.geometry(named.frames.as_ref());
                Ty::Spatial(scalar, Rc::new(Geometry { dim, ..geometry }))
            }
            None if name == "result" => Ty::Result,
            None if name == "text" => Ty::Text,
            None if name == "time" && self.is_rpi() => Ty::Duration,
            None if !self.is_rpi() && is_foreign_name(name) => self.foreign_type(named),
            None => {
                self.unknown_type(&named.name.name, named.name.span);
                Ty::Unknown
            }
        }
    }

    /// Resolves a built-in type of Kind 2: a machine integer, or a type of which only the name is known.
    fn foreign_type(&mut self, named: &'a NamedType) -> Ty {
        let (name, span) = (named.name.name.as_str(), named.name.span);
        if !matches!(name, "set" | "map" | "history") {
            let machine = self.machine_named(name, &named.statics, span);
            return machine.map_or(Ty::Unknown, Ty::Machine);
        }
        let args: Vec<String> = named
            .statics
            .iter()
            .map(|arg| self.type_argument(arg))
            .collect();
        match name {
            "set" | "map" => self.foreign(&format!("a {name}"), SETS, span),
            _ => self.history(named),
        }
        match &args[..] {
            _ if args.iter().any(String::is_empty) => Ty::Unknown,
            _ if name == "history" => Ty::Unknown,
            [] => foreign_ty(name.to_owned()),
            args => foreign_ty(format!("{name}<{}>", args.join(", "))),
        }
    }

    /// Returns a static argument of such a type as text; empty after an error.
    fn type_argument(&mut self, arg: &'a rpi_syntax::ast::StaticArg) -> String {
        match &arg.value {
            rpi_syntax::ast::StaticValue::Expr(value) => self
                .integer(value)
                .map_or_else(String::new, |n| n.to_string()),
            _ => match self.static_type(arg) {
                None | Some(Ty::Unknown) => String::new(),
                Some(ty) => ty.to_string(),
            },
        }
    }

    /// Checks `history(x)`, the past values of a flow.
    fn history(&mut self, named: &NamedType) {
        let of = named
            .frames
            .as_ref()
            .and_then(|frames| frames.in_frame.parts.first());
        let Some(of) = of else {
            return self.unknown_type(&named.name.name, named.name.span);
        };
        let is_bound = self.bound.iter().any(|bound| bound.name == of.name);
        if is_bound || self.local_flow(&of.name).is_none() {
            let message = format!("`{}` has no history", of.name);
            let finding = Finding::new(Code::RPI2014, message)
                .at(of.span, "not a flow of the node")
                .help("`history(x)` is the sequence of past values of a flow `x`");
            return self.report(finding);
        }
        self.foreign(
            "a history",
            "a control core stores no values of earlier cycles except those of `pre`",
            named.name.span,
        );
    }

    pub(super) fn near_type(&self, name: &str) -> Option<String> {
        let builtin = [
            "Vector", "Rotation", "Pose", "Twist", "Wrench", "Time", "time", "bool", "int", "real",
        ];
        let is_type = |id: DeclId| {
            let kind = self.c.program.decl(id).kind;
            matches!(kind, DeclKind::Type(_) | DeclKind::Device(_))
        };
        let declared = self
            .c
            .suggest(name, self.c.program.visible(self.module, is_type));
        declared.or_else(|| rpi_diag::suggest(name, builtin.into_iter()))
    }

    fn geometry(&mut self, frames: Option<&Frames>) -> Geometry {
        Geometry {
            dim: None,
            of: frames
                .and_then(|f| f.of.as_ref())
                .and_then(|f| self.frame(f)),
            in_frame: frames.and_then(|f| self.frame(&f.in_frame)),
        }
    }

    /// Resolves a frame: declared, of a device, or (in a signature) free.
    fn frame(&mut self, frame: &Dotted) -> Option<Name> {
        match &frame.parts[..] {
            [one] => {
                let known = self.is_frame(&one.name) || self.free_frame(&one.name);
                self.known_frame(known, one.name.clone(), one.span)
            }
            [device, local] => {
                let known = self.device_frames(&device.name).contains(&local.name);
                let name = format!("{}.{}", device.name, local.name);
                self.known_frame(known, name.into(), frame.span)
            }
            _ => self.known_frame(false, "".into(), frame.span),
        }
    }

    /// Resolves the frame in which another frame is placed.
    pub(super) fn parent_frame(&mut self, frame: &Dotted) -> Option<Name> {
        self.frame(frame)
    }

    fn is_frame(&self, name: &Name) -> bool {
        match self.c.program.lookup(self.module, name) {
            Lookup::Found(id) => matches!(self.c.program.decl(id).kind, DeclKind::Frame(_)),
            _ => false,
        }
    }

    /// Whether a name may be a free frame of the signature. In the signature itself every name may be one.
    fn free_frame(&mut self, name: &Name) -> bool {
        let known = self.unit.free_frames.contains(name);
        if !known && self.in_signature {
            self.unit.free_frames.push(name.clone());
        }
        known || self.in_signature
    }

    fn device_frames(&self, device: &Name) -> Vec<Name> {
        let Some(Local::Flow(flow)) = self.find_local(device) else {
            return Vec::new();
        };
        self.unit
            .device(flow)
            .map_or_else(Vec::new, |d| d.frames.clone())
    }

    fn known_frame(&mut self, known: bool, name: Name, span: Span) -> Option<Name> {
        if !known {
            let program = self.c.program;
            let is_frame = |id| matches!(program.decl(id).kind, DeclKind::Frame(_));
            let declared = program.visible(self.module, is_frame);
            let free = self.unit.free_frames.iter().map(Name::as_str);
            let near = self.c.suggest(&name, free.chain(declared));
            let finding = Finding::new(Code::RPI1001, format!("undefined frame `{name}`"))
                .at(span, "not declared")
                .help(
                    "declare it by `frame`, name it in the signature, or use a frame of a device",
                );
            self.report(finding.did_you_mean(span, near));
        }
        known.then_some(name)
    }
}

impl<'a> Checker<'a> {
    /// Checks a type declaration or device type on its own.
    pub(super) fn type_alone(&mut self, id: DeclId) {
        match self.program.decl(id).kind {
            DeclKind::Type(def) => {
                let params = super::statics::params(&def.statics).into_iter();
                let open = params.map(|param| {
                    let name = param.name().name.clone();
                    (name.clone(), Static::Ty(Ty::Generic(name)))
                });
                self.type_instance(id, Rc::new(open.collect()));
            }
            DeclKind::Device(device) => self.device_alone(id, device),
            _ => {}
        }
    }

    /// Returns the type of a declaration without static arguments.
    pub(super) fn type_decl(&mut self, id: DeclId) -> Ty {
        self.type_instance(id, Rc::default())
    }

    /// Returns the type of a declaration with static arguments.
    pub(super) fn type_instance(&mut self, id: DeclId, statics: Rc<Statics>) -> Ty {
        let key = super::instance::key(id, &statics);
        match self.types.get(&key) {
            Some(Lazy::Done(ty)) => return ty.clone().unwrap_or(Ty::Unknown),
            Some(Lazy::Busy) => {
                self.in_circles("type", id);
                return Ty::Unknown;
            }
            None => {}
        }
        if !self.may_nest("type", self.program.decl(id).span) {
            return Ty::Unknown;
        }
        // In progress before it is resolved, so that a type that depends on itself is detected.
        self.types.insert(key.clone(), Lazy::Busy);
        self.open.push(id);
        let ty = self.nested(|checker| checker.type_def(id, statics));
        self.open.pop();
        self.types.insert(key, Lazy::Done(Some(ty.clone())));
        ty
    }

    fn type_def(&mut self, id: DeclId, statics: Rc<Statics>) -> Ty {
        let DeclKind::Type(def) = self.program.decl(id).kind else {
            return Ty::Unknown;
        };
        let mut body = Body::around(self, id);
        body.statics = statics;
        let ty = body.type_meaning(def);
        let is_temporal = body.state_at.is_some();
        body.leave();
        if is_temporal {
            self.temporal.insert(id);
        }
        ty
    }

    /// Reports a dependency cycle of declarations.
    pub(super) fn in_circles(&mut self, what: &str, id: DeclId) {
        let from = self.open.iter().position(|open| *open == id).unwrap_or(0);
        let ring: Vec<_> = self.open[from..]
            .iter()
            .map(|id| self.program.decl(*id))
            .collect();
        let name = &self.program.decl(id).name;
        let way: Vec<String> = ring
            .iter()
            .map(|decl| format!("`{}` -> ", decl.name))
            .collect();
        let message = match ring.len() {
            0 | 1 => format!("the {what} `{name}` depends on itself"),
            _ => format!(
                "the {what} `{name}` depends on itself: {}`{name}`",
                way.concat()
            ),
        };
        let mut finding = Finding::new(Code::RPI1007, message);
        if ring.is_empty() {
            let decl = self.program.decl(id);
            let text = format!("`{name}` depends on `{name}`");
            finding = finding.at(decl.span, text);
        }
        for (k, decl) in ring.iter().enumerate() {
            let next = &ring[(k + 1) % ring.len()].name;
            let text = format!("`{}` depends on `{next}`", decl.name);
            finding = match k {
                0 => finding.at(decl.span, text),
                _ => finding.also(decl.span, text),
            };
        }
        self.findings.push(finding);
    }
}

impl<'a> Body<'_, 'a> {
    fn type_meaning(&mut self, def: &'a TypeDef) -> Ty {
        let name = self.type_name(def);
        match def.ty.as_ref().map(|ty| (&ty.kind, ty)) {
            None => Ty::Struct(Rc::new(StructTy {
                name,
                fields: Vec::new(),
                defaults: Vec::new(),
            })),
            Some((TypeKind::Enum(values), _)) => {
                let values = values.iter().map(|v| v.name.name.clone()).collect();
                Ty::Enum(Rc::new(EnumTy::new(name, values)))
            }
            Some((TypeKind::Data(all), _)) => self.data_meaning(def, name, all),
            Some((TypeKind::Struct(fields), _)) => self.struct_meaning(def, name, fields),
            Some((_, ty)) => self.ty(ty),
        }
    }

    /// Returns the name of a type with its static arguments.
    fn type_name(&self, def: &TypeDef) -> Name {
        let params = super::statics::params(&def.statics);
        super::instance::display(self.c.program, &def.name.name, &params, &self.statics)
    }

    fn struct_meaning(&mut self, def: &'a TypeDef, name: Name, fields: &'a [VarDecl]) -> Ty {
        let known = self.fields(fields);
        if !is_workable(&known) {
            let finding = Finding::new(Code::RPI2009, "the struct is too large").at(
                def.name.span,
                "too many parts, or structs nested too deeply",
            );
            self.report(finding);
            return Ty::Unknown;
        }
        Ty::Struct(Rc::new(StructTy {
            name,
            fields: known,
            defaults: self.field_defaults(fields),
        }))
    }

    pub(super) fn fields(&mut self, decls: &'a [VarDecl]) -> Vec<Member> {
        let mut fields: Vec<Member> = Vec::new();
        let names = || decls.iter().flat_map(|decl| &decl.names);
        for decl in decls {
            let ty = self.value_ty(&decl.ty);
            for name in &decl.names {
                let first = names().take(fields.len()).find(|n| n.name == name.name);
                if let Some(first) = first {
                    let finding = crate::program::twice(&name.name, name.span, first.span);
                    self.report(finding);
                }
                fields.push(Member {
                    name: Some(name.name.clone()),
                    ty: ty.clone(),
                });
            }
        }
        fields
    }

    fn field_defaults(&mut self, decls: &'a [VarDecl]) -> Vec<Option<Rc<[Leaf]>>> {
        let mut defaults = Vec::new();
        for decl in decls {
            let default = decl.default.as_ref().map(|value| {
                let ty = self.ty(&decl.ty);
                // An invalid default, which has been reported, is empty.
                self.constant_of(value, &ty).unwrap_or_default()
            });
            defaults.extend(decl.names.iter().map(|_| default.clone()));
        }
        defaults
    }
}

/// Returns the diagnostic for a type parameter in a unit that is not a type of reals.
fn no_quantity(name: &Ident, ty: &Ty) -> Finding {
    let message = match ty.to_string() == name.name.as_str() {
        // The body is checked for all types of this parameter.
        true => format!("`{ty}` may be a type without unit"),
        false => format!("`{}` is `{ty}` here, which has no unit", name.name),
    };
    Finding::new(Code::RPI2003, message).at(name.span, "expected a type of reals")
}

/// Names of the built-in types of Kind 2.
const FOREIGN_TYPES: &[&str] = &[
    "set", "map", "history", "int8", "int16", "int32", "int64", "uint8", "uint16", "uint32",
    "uint64", "uint", "sint",
];

/// Prefixes of the names of types on whose values operators are not checked.
pub(super) const FOREIGN: &[&str] = &["set<", "map<"];

fn is_foreign_name(name: &str) -> bool {
    FOREIGN_TYPES.contains(&name)
}

/// Whether a type is a built-in type of Kind 2 whose name starts with one of these prefixes.
pub(super) fn is_foreign(ty: &Ty, beginnings: &[&str]) -> bool {
    let Ty::Struct(of) = ty else {
        return false;
    };
    let base = of.name.split('<').next().unwrap_or_default();
    is_foreign_name(base)
        && beginnings
            .iter()
            .any(|beginning| of.name.starts_with(beginning))
}

/// Returns the diagnostic for an array with too many leaves.
pub(super) fn too_large(span: Span) -> Finding {
    Finding::new(Code::RPI2009, "the array is too large")
        .at(span, format!("more than {MAX_LEAVES} values"))
}
