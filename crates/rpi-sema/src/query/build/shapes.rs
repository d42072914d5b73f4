//! Shapes: the definition whose members a value has, a device type, a struct or a callable with several outputs.
//!
//! Shapes are found in the syntax alone, from a flow to its equation to the callee, so they are available in programs
//! with errors and lead to the declaration of a member.

use crate::hash::Map;
use crate::query::build::{Builder, DefId, Expr, Origin, ScopeId, Type};
use crate::query::def::DefKind;
use rpi_syntax::ast::{Call, ExprKind, TypeKind};

/// Greatest length of a chain of equations that is followed.
const MAX_DEPTH: u32 = 100;

/// Origins of shapes, and the shapes found so far.
#[derive(Default)]
pub(super) struct Shapes<'a> {
    origins: Map<DefId, (ScopeId, Origin<'a>)>,
    known: Map<DefId, Option<DefId>>,
    depth: u32,
}

impl<'a> Shapes<'a> {
    pub(super) fn set(&mut self, def: DefId, scope: ScopeId, origin: Origin<'a>) {
        self.origins.insert(def, (scope, origin));
    }

    /// Sets the origin of a flow unless it has one. A flow with several definitions has the shape of the first.
    pub(super) fn set_if_open(&mut self, def: DefId, scope: ScopeId, origin: Origin<'a>) {
        self.origins.entry(def).or_insert((scope, origin));
    }
}

impl<'a> Builder<'a> {
    /// Returns the definition whose members a definition has, if it is another one.
    pub(super) fn shape(&mut self, def: DefId) -> Option<DefId> {
        if let Some(known) = self.shapes.known.get(&def) {
            return *known;
        }
        let (scope, origin) = self.shapes.origins.get(&def).copied()?;
        if self.shapes.depth >= MAX_DEPTH {
            return None;
        }
        // A recursive query is part of a cycle and finds no shape.
        self.shapes.known.insert(def, None);
        self.shapes.depth += 1;
        let shape = match origin {
            Origin::Type(ty) => self.shape_of_type(scope, ty),
            Origin::Value(expr) => self.owner_of(scope, expr),
            Origin::Alias(callee) => {
                let found = self.index.lookup(scope, &callee.name.name);
                found.map(|callee| self.callable_behind(callee))
            }
        };
        self.shapes.depth -= 1;
        self.shapes.known.insert(def, shape);
        shape
    }

    /// Returns the definition whose members are read as `definition.name`.
    pub(super) fn owner_behind(&mut self, def: DefId) -> Option<DefId> {
        match Self::has_own_members(self.index.def(def).kind) {
            true => Some(def),
            false => self.shape(def),
        }
    }

    /// Returns the definition whose members are read as `expression.name`.
    pub(super) fn owner_of(&mut self, scope: ScopeId, expr: &'a Expr) -> Option<DefId> {
        match &expr.kind {
            ExprKind::Name(name) => {
                let def = self.index.lookup(scope, name)?;
                self.owner_behind(def)
            }
            ExprKind::Field(field) => {
                let owner = self.owner_of(scope, &field.base)?;
                let member = self.member_named(owner, &field.field.name)?;
                self.owner_behind(member)
            }
            ExprKind::Call(call) => self.owner_of_call(scope, call),
            ExprKind::Paren(inner) | ExprKind::Unary(_, inner) => self.owner_of(scope, inner),
            ExprKind::Index(index) => self.owner_of(scope, &index.base),
            ExprKind::When(when) => self.owner_of(scope, &when.value),
            ExprKind::Update(update) => self.owner_of(scope, &update.base),
            ExprKind::Binary(binary) => {
                let left = self.owner_of(scope, &binary.lhs);
                left.or_else(|| self.owner_of(scope, &binary.rhs))
            }
            ExprKind::If(choice) => {
                let yes = self.owner_of(scope, &choice.yes);
                yes.or_else(|| self.owner_of(scope, &choice.no))
            }
            ExprKind::Merge(merge) => self.owner_of(scope, &merge.cases.first()?.then),
            ExprKind::Struct(of) => {
                let ty = self.index.lookup(scope, &of.ty.name)?;
                Some(self.type_behind(ty))
            }
            _ => None,
        }
    }

    /// Returns the shape of a call's result: that of its only output, or the callee if it has several. `hold(x, init)`
    /// has the shape of x.
    fn owner_of_call(&mut self, scope: ScopeId, call: &'a Call) -> Option<DefId> {
        let Some(callee) = self.index.lookup(scope, &call.callee.name.name) else {
            return self.owner_of(scope, &call.args.first()?.value);
        };
        let callee = self.callable_behind(callee);
        if !self.index.def(callee).kind.is_callable() {
            return None;
        }
        let outputs = self.index.inside(callee).members;
        let order = outputs.map_or(&[][..], |scope| &self.index.scope(scope).order);
        let is_output = |id: &&DefId| self.index.def(**id).kind == DefKind::Output;
        let mut outputs = order.iter().filter(is_output).copied();
        match (outputs.next(), outputs.next()) {
            (Some(only), None) => self.shape(only),
            _ => Some(callee),
        }
    }

    fn shape_of_type(&mut self, scope: ScopeId, ty: &'a Type) -> Option<DefId> {
        match &ty.kind {
            TypeKind::Named(named) => {
                let def = self.index.lookup(scope, &named.name.name)?;
                Some(self.type_behind(def))
            }
            TypeKind::Array(array) => self.shape_of_type(scope, &array.element),
            TypeKind::Optional(inner) => self.shape_of_type(scope, inner),
            _ => None,
        }
    }

    /// Returns the struct or device type behind type aliases.
    pub(super) fn type_behind(&mut self, ty: DefId) -> DefId {
        self.shape(ty).unwrap_or(ty)
    }

    /// Resolves an alias: for `node f = g<<3>>;` returns g.
    pub(super) fn callable_behind(&mut self, def: DefId) -> DefId {
        match self.index.def(def).kind.is_callable() {
            true => self.shape(def).unwrap_or(def),
            false => def,
        }
    }

    pub(super) fn member_named(&self, owner: DefId, name: &str) -> Option<DefId> {
        let scope = self.index.inside(owner).members?;
        let found = *self.index.scope(scope).names.get(name)?;
        let kind = self.index.def(owner).kind;
        let is_member = self.index.def(found).kind.is_member_of(kind);
        is_member.then_some(found)
    }
}
