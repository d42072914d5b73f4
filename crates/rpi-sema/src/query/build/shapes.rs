//! Shapes: the definition whose members a value has, a device type, a struct or a callable with several outputs.
//!
//! Shapes are found in the syntax alone, from a flow to its equation to the callee, so they are available in programs
//! with errors and lead to the declaration of a member.

use super::refs;
use crate::hash::FastMap;
use crate::query::build::{Builder, DefId, Expr, ScopeId, ShapeOrigin, Type};
use crate::query::def::DefKind;
use rpi_syntax::ast::{Call, ExprKind, TypeKind};

/// Maximum length of a chain of definitions that is followed to find the members of a flow.
const MAX_DEPTH: u32 = 100;

/// For each definition, the syntax that determines its members, and the definition that has these members once it is
/// known.
#[derive(Default)]
pub(super) struct Shapes<'a> {
    origins: FastMap<DefId, (ScopeId, ShapeOrigin<'a>)>,
    known: FastMap<DefId, Option<DefId>>,
    depth: u32,
}

impl<'a> Shapes<'a> {
    pub(super) fn set(&mut self, def: DefId, scope: ScopeId, origin: ShapeOrigin<'a>) {
        self.origins.insert(def, (scope, origin));
    }

    /// Sets the syntax that determines the members of a flow, unless it is set already. A flow with several equations
    /// has the members of the first one.
    pub(super) fn set_if_unset(&mut self, def: DefId, scope: ScopeId, origin: ShapeOrigin<'a>) {
        self.origins.entry(def).or_insert((scope, origin));
    }
}

/// Returns the definition whose members another definition has, such as the struct type of a flow; `None` if there is
/// none.
pub(super) fn index_shape(builder: &mut Builder<'_>, def: DefId) -> Option<DefId> {
    if let Some(known) = builder.shapes.known.get(&def) {
        return *known;
    }
    let (scope, origin) = builder.shapes.origins.get(&def).copied()?;
    if builder.shapes.depth >= MAX_DEPTH {
        return None;
    }
    // A recursive query is part of a cycle and finds no shape.
    builder.shapes.known.insert(def, None);
    builder.shapes.depth += 1;
    let shape = match origin {
        ShapeOrigin::Type(ty) => shape_of_type(builder, scope, ty),
        ShapeOrigin::Value(expr) => owner_of(builder, scope, expr),
        ShapeOrigin::Alias(callee) => {
            let found = builder.index.lookup(scope, &callee.name.name);
            found.map(|callee| resolve_callable_alias(builder, callee))
        }
    };
    builder.shapes.depth -= 1;
    builder.shapes.known.insert(def, shape);
    shape
}

/// Returns the definition whose members are read by `definition.name`; `None` if there are none.
pub(super) fn owner_of_def(builder: &mut Builder<'_>, def: DefId) -> Option<DefId> {
    let kind = builder.index.def(def).kind;
    // A sensor with several parts has them as members; that of any other port has the members of its type.
    let has_parts =
        kind == DefKind::Port && builder.index.inner_scopes[def.0 as usize].members.is_some();
    match has_parts || refs::has_own_members(kind) {
        true => Some(def),
        false => index_shape(builder, def),
    }
}

/// Returns the definition whose members are read by `expression.name`; `None` if there are none.
pub(super) fn owner_of<'a>(
    builder: &mut Builder<'a>,
    scope: ScopeId,
    expr: &'a Expr,
) -> Option<DefId> {
    match &expr.kind {
        ExprKind::Name(name) => {
            let def = builder.index.lookup(scope, name)?;
            owner_of_def(builder, def)
        }
        ExprKind::Field(field) => {
            let owner = owner_of(builder, scope, &field.base)?;
            let member = member_named(builder, owner, &field.field.name)?;
            owner_of_def(builder, member)
        }
        ExprKind::Call(call) => owner_of_call(builder, scope, call),
        ExprKind::Paren(inner) | ExprKind::Unary(_, inner) => owner_of(builder, scope, inner),
        ExprKind::Index(index) => owner_of(builder, scope, &index.base),
        ExprKind::When(when) => owner_of(builder, scope, &when.value),
        ExprKind::Update(update) => owner_of(builder, scope, &update.base),
        ExprKind::Binary(binary) => {
            let left = owner_of(builder, scope, &binary.lhs);
            left.or_else(|| owner_of(builder, scope, &binary.rhs))
        }
        ExprKind::If(choice) => {
            let yes = owner_of(builder, scope, &choice.then_value);
            yes.or_else(|| owner_of(builder, scope, &choice.else_value))
        }
        ExprKind::Merge(merge) => owner_of(builder, scope, &merge.cases.first()?.then),
        ExprKind::Struct(of) => {
            let ty = builder.index.lookup(scope, &of.ty.name)?;
            Some(resolve_type_alias(builder, ty))
        }
        _ => None,
    }
}

/// Returns the definition with the members of a call's result. It is that of the only output, or the callee if there
/// are several outputs. `hold(x, init)` has the members of `x`.
fn owner_of_call<'a>(builder: &mut Builder<'a>, scope: ScopeId, call: &'a Call) -> Option<DefId> {
    let Some(callee) = builder.index.lookup(scope, &call.callee.name.name) else {
        return owner_of(builder, scope, &call.args.first()?.value);
    };
    let callee = resolve_callable_alias(builder, callee);
    if !builder.index.def(callee).kind.is_callable() {
        return None;
    }
    let outputs = builder.index.inner_scopes(callee).members;
    let order = outputs.map_or(&[][..], |scope| &builder.index.scope(scope).order);
    let is_output = |id: &&DefId| builder.index.def(**id).kind == DefKind::Output;
    let mut outputs = order.iter().filter(is_output).copied();
    match (outputs.next(), outputs.next()) {
        (Some(only), None) => index_shape(builder, only),
        _ => Some(callee),
    }
}

fn shape_of_type<'a>(builder: &mut Builder<'a>, scope: ScopeId, ty: &'a Type) -> Option<DefId> {
    match &ty.kind {
        TypeKind::Named(named) => {
            let def = builder.index.lookup(scope, &named.name.name)?;
            Some(resolve_type_alias(builder, def))
        }
        TypeKind::Array(array) => shape_of_type(builder, scope, &array.element),
        TypeKind::Optional(inner) => shape_of_type(builder, scope, inner),
        _ => None,
    }
}

/// Returns the struct or device type for which a type name stands, through aliases of types.
pub(super) fn resolve_type_alias(builder: &mut Builder<'_>, ty: DefId) -> DefId {
    index_shape(builder, ty).unwrap_or(ty)
}

/// Returns the callable for which a definition stands: `g` for the alias `node f = g<<3>>;`, else the definition
/// itself.
pub(super) fn resolve_callable_alias(builder: &mut Builder<'_>, def: DefId) -> DefId {
    match builder.index.def(def).kind.is_callable() {
        true => index_shape(builder, def).unwrap_or(def),
        false => def,
    }
}

pub(super) fn member_named(builder: &Builder<'_>, owner: DefId, name: &str) -> Option<DefId> {
    let scope = builder.index.inner_scopes(owner).members?;
    let found = *builder.index.scope(scope).names.get(name)?;
    let kind = builder.index.def(owner).kind;
    let is_member = builder.index.def(found).kind.is_member_of(kind);
    is_member.then_some(found)
}
