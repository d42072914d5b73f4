//! Constructs of Kind 2 that are for provers only (quantifiers, conditions of types, sets), and type ascriptions.

use super::body::Body;
use super::bound::Means;
use super::report::Wanted;
use super::types::is_foreign;
use crate::program::{DeclKind, Lookup, Space};
use crate::ty::{StructTy, Ty};
use crate::typed::{ExprId, Kind, UnitKind};
use rpi_diag::{Code, Finding, Span};
use rpi_syntax::ast::{
    self, Ascribed, Call, Expr, NodeDef, NodeKind, Quantified, Refined, StaticArg, TypeKind,
};
use std::rc::Rc;

impl<'a> Body<'_, 'a> {
    /// Checks a quantifier `forall (x: int) c`. Its value is never computed.
    pub(super) fn quantified(&mut self, of: &'a Quantified, span: Span) -> ExprId {
        let before = self.bound.len();
        for var in &of.vars {
            let fixed = self.fixed_before.replace(self.bound.len());
            let ty = self.ty(&var.ty);
            self.fixed_before = fixed;
            self.countable(&ty, &var.ty);
            for name in &var.names {
                self.bind_name(name, Means::Any(ty.clone()));
            }
        }
        let condition = self.expr(&of.condition);
        self.expect(condition, &Ty::Bool, &Wanted::Here);
        self.bound.truncate(before);
        match &mut self.claim {
            Some(claim) => claim.0 = claim.0.or(Some(span)),
            None => self.foreign(
                "a quantifier",
                "it ranges over more values than can be tested",
                span,
            ),
        }
        self.add(Kind::Outside, Ty::Bool, span)
    }

    /// Reports a quantifier over arrays, sets or maps.
    fn countable(&mut self, ty: &Ty, written: &ast::Type) {
        let has_elements = matches!(ty, Ty::Array(..)) || is_foreign(ty, &["set<", "map<"]);
        if has_elements {
            let message = format!("cannot quantify over `{ty}`");
            let finding = Finding::new(Code::RPI2014, message)
                .at(written.span, "not a quantifiable type")
                .help("quantify over an index: `forall (i: int) a[i] > 0`");
            self.report(finding);
        }
    }

    /// Reports a construct of Kind 2 that is checked but not executed.
    pub(super) fn foreign(&mut self, what: &str, why: &str, span: Span) {
        let message = format!("{what} cannot be executed");
        self.report(Finding::new(Code::RPI0017, message).at(span, why));
    }

    /// Checks `subtype { x: T | c }` and returns `T`; the condition is for provers.
    pub(super) fn refined(&mut self, refined: &'a Refined) -> Ty {
        let base = self.ty(&refined.base);
        let in_quantifier = self.fixed_before.is_some() || self.quantifies();
        let means = match in_quantifier {
            true => Means::Any(base.clone()),
            false => Means::Value(base.clone()),
        };
        self.with_bound(&refined.name, means, |body| {
            let condition = body.expr(&refined.condition);
            body.expect(condition, &Ty::Bool, &Wanted::Here);
        });
        base
    }

    /// Whether a quantified variable is in scope.
    pub(super) fn quantifies(&self) -> bool {
        self.bound.iter().any(super::bound::Bound::is_quantified)
    }

    /// Checks a type ascription `(x: T)`.
    pub(super) fn ascribed(&mut self, of: &'a Ascribed) -> ExprId {
        let value = self.expr(&of.value);
        let ty = self.ty(&of.ty);
        self.expect(
            value,
            &ty,
            &Wanted::By(of.ty.span, "expected because of this type".into()),
        );
        if self.is_temporal(&of.ty) && self.reads_bound(&of.value) {
            let finding =
                Finding::new(Code::RPI2014, "a quantified variable has no earlier cycles")
                    .at(of.value.span, "this depends on a quantified variable")
                    .also(
                        of.ty.span,
                        "the condition of the type refers to earlier cycles",
                    );
            self.report(finding);
        }
        value
    }

    /// Whether the condition of a type refers to earlier cycles.
    fn is_temporal(&self, ty: &ast::Type) -> bool {
        match &ty.kind {
            TypeKind::Named(named) => {
                let found = self
                    .c
                    .program
                    .lookup_in(Space::Type, self.module, &named.name.name);
                matches!(found, Lookup::Found(id) if self.c.temporal.contains(&id))
            }
            TypeKind::Array(array) => self.is_temporal(&array.element),
            _ => false,
        }
    }

    /// Reports a call inside a quantifier if the callee has state or no known body.
    pub(super) fn is_looked_into(
        &mut self,
        call: &'a Call,
        id: crate::program::DeclId,
        span: Span,
    ) {
        if !self.quantifies() {
            return;
        }
        let DeclKind::Node(node) = self.c.program.decl(id).kind else {
            return;
        };
        let opaque = node.kind == NodeKind::Node || matches!(node.definition, NodeDef::Extern);
        let reads = call.args.iter().any(|arg| self.reads_bound(&arg.value));
        if opaque && (reads || self.guarded) {
            let message = format!(
                "cannot call `{}` for a quantified variable",
                call.callee.name.name
            );
            let finding = Finding::new(Code::RPI2014, message)
                .at(span, "the call depends on a quantified variable")
                .help("only functions with a known body can be called here");
            self.report(finding);
        }
    }

    /// Checks the empty set `{}@<T>`.
    pub(super) fn empty_set(&mut self, types: &'a [StaticArg], span: Span) -> ExprId {
        let known: Vec<Ty> = types.iter().filter_map(|ty| self.static_type(ty)).collect();
        let ty = match &known[..] {
            [one] => set_of(one),
            _ => Ty::Unknown,
        };
        self.foreign("a set", SETS, span);
        self.add(Kind::Outside, ty, span)
    }

    /// Checks the membership `x in s`.
    pub(super) fn is_in(&mut self, lhs: &'a Expr, rhs: &'a Expr, span: Span) -> ExprId {
        let (value, set) = (self.expr(lhs), self.expr(rhs));
        let (found, of) = (self.ty_of(value).clone(), self.ty_of(set).clone());
        if !of.is_unknown() && !is_foreign(&of, &["set<", "map<"]) {
            let finding = Finding::new(
                Code::RPI2006,
                format!("`in` cannot take `{found}` and `{of}`"),
            )
            .at(rhs.span, format!("this is `{of}`"))
            .help(
                "compare with each value: `x = 1 or x = 2`; a range has two bounds: `x >= 1 and x <= 5`",
            );
            self.report(finding);
        }
        self.add(Kind::Outside, Ty::Bool, span)
    }

    /// Reports a nondeterministic value in a constant.
    pub(super) fn open_in_constant(&mut self, span: Span) {
        if self.unit.kind == UnitKind::Constant {
            let finding = Finding::new(Code::RPI2008, "a constant is needed here")
                .at(span, "this may change from cycle to cycle");
            self.report(finding);
        }
    }
}

/// Reason why sets and maps are not executed.
pub(super) const SETS: &str =
    "its size is unbounded, and a control core does not allocate memory at run time";

/// Returns the type of the sets of an element type.
pub(super) fn set_of(element: &Ty) -> Ty {
    foreign_ty(format!("set<{element}>"))
}

/// Returns a type of Kind 2 of which only the name is known.
pub(super) fn foreign_ty(name: String) -> Ty {
    Ty::Struct(Rc::new(StructTy {
        name: name.into(),
        fields: Vec::new(),
        defaults: Vec::new(),
    }))
}
