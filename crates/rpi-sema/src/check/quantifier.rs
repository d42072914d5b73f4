//! What Kind 2 proves and nobody runs: quantifiers, conditions of types, sets; and types said where a value stands.

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
    /// `forall (x: int) c`: its value is left open.
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
                "it speaks of more values than can be looked at",
                span,
            ),
        }
        self.add(Kind::Outside, Ty::Bool, span)
    }

    /// A quantifier does not speak of arrays, sets and maps.
    fn countable(&mut self, ty: &Ty, written: &ast::Type) {
        let has_elements = matches!(ty, Ty::Array(..)) || is_foreign(ty, &["set<", "map<"]);
        if has_elements {
            let message = format!("a quantifier can not speak of all `{ty}`");
            let finding = Finding::new(Code::RPI2014, message)
                .at(written.span, "a type of many values")
                .help("quantify over an index: `forall (i: int) a[i] > 0`");
            self.report(finding);
        }
    }

    /// A construct of Kind 2 that is read and not run.
    pub(super) fn foreign(&mut self, what: &str, why: &str, span: Span) {
        let message = format!("{what} can not be run here");
        self.report(Finding::new(Code::RPI0017, message).at(span, why));
    }

    /// `subtype { x: T | c }`: a value of `T`; the condition is for provers.
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

    /// Whether the variables of a quantifier are being declared or looked at.
    pub(super) fn quantifies(&self) -> bool {
        self.bound.iter().any(super::bound::Bound::is_quantified)
    }

    /// `(x: T)`
    pub(super) fn ascribed(&mut self, of: &'a Ascribed) -> ExprId {
        let value = self.expr(&of.value);
        let ty = self.ty(&of.ty);
        self.expect(
            value,
            &ty,
            &Wanted::By(of.ty.span, "its type is said here".into()),
        );
        if self.is_temporal(&of.ty) && self.reads_bound(&of.value) {
            let finding = Finding::new(Code::RPI2014, "this has no earlier cycle")
                .at(
                    of.value.span,
                    "it depends on a variable that stands for many values",
                )
                .also(
                    of.ty.span,
                    "the condition of the type is about earlier cycles",
                );
            self.report(finding);
        }
        value
    }

    /// Whether the condition of a type is about earlier cycles.
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

    /// A call inside a quantifier of what can not be looked into.
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
                "`{}` is called for many values at once",
                call.callee.name.name
            );
            let finding = Finding::new(Code::RPI2014, message)
                .at(
                    span,
                    "whether and with what depends on a variable of a quantifier",
                )
                .help("only functions whose body is known can be called so");
            self.report(finding);
        }
    }

    /// `{}@<T>`
    pub(super) fn empty_set(&mut self, types: &'a [StaticArg], span: Span) -> ExprId {
        let known: Vec<Ty> = types.iter().filter_map(|ty| self.static_type(ty)).collect();
        let ty = match &known[..] {
            [one] => set_of(one),
            _ => Ty::Unknown,
        };
        self.foreign("a set", SETS, span);
        self.add(Kind::Outside, ty, span)
    }

    /// `x in s`
    pub(super) fn is_in(&mut self, lhs: &'a Expr, rhs: &'a Expr, span: Span) -> ExprId {
        let (value, set) = (self.expr(lhs), self.expr(rhs));
        let (found, of) = (self.ty_of(value).clone(), self.ty_of(set).clone());
        if !of.is_unknown() && !is_foreign(&of, &["set<", "map<"]) {
            let finding = Finding::new(
                Code::RPI2006,
                format!("`in` can not take `{found}` and `{of}`"),
            )
            .at(rhs.span, format!("this is `{of}`"))
            .help(
                "compare with each: `x = 1 or x = 2`; a range has two bounds: `x >= 1 and x <= 5`",
            );
            self.report(finding);
        }
        self.add(Kind::Outside, Ty::Bool, span)
    }

    /// A value that the program leaves open belongs to no constant.
    pub(super) fn open_in_constant(&mut self, span: Span) {
        if self.unit.kind == UnitKind::Constant {
            let finding = Finding::new(Code::RPI2008, "a constant is needed here")
                .at(span, "this may have another value in each cycle");
            self.report(finding);
        }
    }
}

/// Why sets and maps are not run.
pub(super) const SETS: &str =
    "its size has no bound, and a control core takes no memory while it runs";

/// The type of sets.
pub(super) fn set_of(element: &Ty) -> Ty {
    foreign_ty(format!("set<{element}>"))
}

/// A type of Kind 2 of which only the name is known.
pub(super) fn foreign_ty(name: String) -> Ty {
    Ty::Struct(Rc::new(StructTy {
        name: name.into(),
        fields: Vec::new(),
        defaults: Vec::new(),
    }))
}
