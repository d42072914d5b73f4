//! Composite values: arrays and structs.

use super::access::{leaves, no_part};
use super::body::Body;
use super::report::{Wanted, not_a};
use super::types::{MAX_LEAVES, too_large};
use crate::program::{DeclKind, Lookup, Space};
use crate::ty::{StructTy, Subst, Ty, fit};
use crate::typed::{ExprId, Kind};
use rpi_diag::{Code, Finding, Span};
use rpi_syntax::ast::{self, Binary, FieldValue, Ident, StaticArg, StructExpr};
use std::rc::Rc;

/// Maximum length of an array.
const MAX_LENGTH: i64 = MAX_LEAVES as i64;

impl<'a> Body<'_, 'a> {
    /// Checks an array literal `[x, y]`.
    pub(super) fn array(&mut self, elements: &'a [ast::Expr], span: Span) -> ExprId {
        let ids: Vec<ExprId> = elements.iter().map(|e| self.expr(e)).collect();
        let Some((first, rest)) = ids.split_first() else {
            let finding = Finding::new(Code::RPI2007, "cannot infer the type of an empty array")
                .at(span, "no elements");
            return self.fault_with(finding, span);
        };
        let mut element = self.ty_of(*first).clone();
        for id in rest {
            let common = self.common_type(
                *first,
                *id,
                "the elements of an array must have the same type",
            );
            if element.is_unknown() {
                element = common;
            }
        }
        let n = u32::try_from(ids.len()).unwrap_or(u32::MAX);
        self.add_array(Kind::Build(ids.into()), Rc::new(element), n, span)
    }

    /// Adds an expression of an array type; reports an array with too many leaves.
    pub(super) fn add_array(&mut self, kind: Kind, element: Rc<Ty>, n: u32, span: Span) -> ExprId {
        let ty = Ty::Array(element, n);
        match ty.leaf_count() > MAX_LEAVES {
            true => self.fault_with(too_large(span), span),
            false => self.add(kind, ty, span),
        }
    }

    /// Checks the array of `n` equal elements, `x ^ n`.
    pub(super) fn repeat(&mut self, binary: &'a Binary, span: Span) -> ExprId {
        let element = self.expr(&binary.lhs);
        let Some(n) = self.size(&binary.rhs) else {
            return self.fault(span);
        };
        let ty = Rc::new(self.ty_of(element).clone());
        self.add_array(Kind::Repeat(element), ty, n, span)
    }

    /// Checks the concatenation of arrays, `x | y`.
    pub(super) fn concat(&mut self, binary: &'a Binary, span: Span) -> ExprId {
        let (left, right) = (self.expr(&binary.lhs), self.expr(&binary.rhs));
        let (a, b) = (self.ty_of(left).clone(), self.ty_of(right).clone());
        let (Ty::Array(a, n), Ty::Array(b, m)) = (&a, &b) else {
            if a.is_unknown() || b.is_unknown() {
                return self.fault(span);
            }
            let finding = Finding::new(Code::RPI2006, format!("`|` cannot take `{a}` and `{b}`"))
                .at(self.span_of(right), format!("this is `{b}`"))
                .also(self.span_of(left), format!("this is `{a}`"))
                .help("`|` concatenates arrays; for Booleans write `or`");
            return self.fault_with(finding, span);
        };
        if let Err(misfit) = fit(a, b, &mut Subst::default()) {
            let wanted = Wanted::By(self.span_of(left), format!("this is `{a}^{n}`"));
            let expected = (**a).clone();
            self.misfit(right, &expected, &misfit, &wanted);
        }
        let n = n.saturating_add(*m);
        self.add_array(Kind::Build([left, right].into()), a.clone(), n, span)
    }

    /// Returns the value of a size, a constant non-negative integer; reports any other expression.
    pub(super) fn size(&mut self, size: &'a ast::Expr) -> Option<u32> {
        let told = self.findings.len();
        let Some(value) = self.integer(size) else {
            // A conversion cannot be applied to a size, so that the fixes are replaced by a hint.
            for finding in self.findings.iter_mut().skip(told) {
                if finding.code == Code::RPI2001 && finding.span() == size.span {
                    finding.fixes.clear();
                    // Depends on the wording "expected X, found Y" of type mismatches.
                    finding.help = vec![match finding.message.ends_with("found `bool`") {
                        true => {
                            "exclusive or is `a xor b`; `x^3` is an array of 3 times `x`".to_owned()
                        }
                        false => {
                            "the size of an array must be a constant integer; a power is `x ** 2.0`"
                                .to_owned()
                        }
                    }];
                }
            }
            return None;
        };
        if (0..=MAX_LENGTH).contains(&value) {
            return u32::try_from(value).ok();
        }
        let finding = Finding::new(Code::RPI2009, format!("invalid array size {value}"))
            .at(size.span, format!("expected a size from 0 to {MAX_LENGTH}"));
        self.report(finding);
        None
    }

    /// Checks a struct literal: `T{x = 1; y = 2}` or `T{s with x = 1}`.
    pub(super) fn structure(&mut self, value: &'a StructExpr, span: Span) -> ExprId {
        if let Some(spatial) = self.spatial_named(value) {
            return self.spatial_value(spatial, value, span);
        }
        if let Some(generic) = self.generic_struct(value) {
            return self.inferred_struct(generic, value, span);
        }
        let Some(ty) = self.struct_ty(&value.ty, &value.statics) else {
            for field in &value.fields {
                self.expr(&field.value);
            }
            return self.fault(span);
        };
        let base = value.base.as_ref().map(|base| self.expr(base));
        if let Some(base) = base {
            self.expect(base, &Ty::Struct(ty.clone()), &Wanted::Here);
        }
        let given = self.given_fields(&ty, &value.fields);
        let parts = given.and_then(|given| self.fill_fields(&ty, &given, base, span));
        match parts {
            Some(parts) => self.add(Kind::Build(parts.into()), Ty::Struct(ty), span),
            None => self.add(Kind::Fault, Ty::Struct(ty), span),
        }
    }

    /// Resolves the struct type of a literal; reports a name that is not a struct.
    fn struct_ty(&mut self, name: &Ident, statics: &'a [StaticArg]) -> Option<Rc<StructTy>> {
        let Lookup::Found(id) = self
            .c
            .program
            .lookup_in(Space::Type, self.module, &name.name)
        else {
            let near = {
                let is_type = |id| matches!(self.c.program.decl(id).kind, DeclKind::Type(_));
                let names = self.c.program.visible(self.module, is_type);
                self.c.suggest(&name.name, names)
            };
            self.unknown_name("type", &name.name, name.span, near);
            return None;
        };
        let decl = self.c.program.decl(id).clone();
        if let DeclKind::Type(_) = decl.kind {
            match self.type_of(id, statics, name.span) {
                Ty::Struct(ty) => return Some(ty),
                Ty::Unknown => return None,
                _ => {}
            }
        }
        let finding = not_a(
            "a struct",
            &name.name,
            decl.kind.what(),
            name.span,
            decl.span,
        );
        self.report(finding);
        None
    }

    /// Checks the values of a struct literal and assigns them to the fields.
    fn given_fields(
        &mut self,
        ty: &Rc<StructTy>,
        fields: &'a [FieldValue],
    ) -> Option<Vec<Option<ExprId>>> {
        let values = fields.iter().map(|field| (field, self.expr(&field.value)));
        let values: Vec<(&FieldValue, ExprId)> = values.collect();
        self.matched_fields(ty, &values)
    }

    /// Returns the value of each field, `None` for a field without a value. Returns `None` after the error about an
    /// unknown field, as that may be a missing one, misspelt.
    pub(super) fn matched_fields(
        &mut self,
        ty: &Rc<StructTy>,
        fields: &[(&'a FieldValue, ExprId)],
    ) -> Option<Vec<Option<ExprId>>> {
        let mut given = vec![None; ty.fields.len()];
        let mut sound = true;
        for (value, id) in fields.iter().copied() {
            let name = &value.field.name;
            let Some(k) = ty.fields.iter().position(|f| f.name.as_ref() == Some(name)) else {
                let of = format!("the struct `{}`", ty.name);
                self.report(no_part(&Ty::Struct(ty.clone()), &of, &value.field));
                sound = false;
                continue;
            };
            self.expect(id, &ty.fields[k].ty, &Wanted::Here);
            if let Some(first) = given[k].replace(id) {
                let finding = crate::program::twice(name, value.field.span, self.span_of(first));
                self.report(finding);
            }
        }
        sound.then_some(given)
    }

    /// Returns the values of all fields. Fields without a value are taken from `base` or from their defaults; reports
    /// missing ones.
    pub(super) fn fill_fields(
        &mut self,
        ty: &Rc<StructTy>,
        given: &[Option<ExprId>],
        base: Option<ExprId>,
        span: Span,
    ) -> Option<Vec<ExprId>> {
        let mut parts = Vec::new();
        let mut at = 0;
        let mut left_out = Vec::new();
        for (k, field) in ty.fields.iter().enumerate() {
            let part = match (given[k], base, ty.defaults.get(k)) {
                (Some(id), ..) => Some(id),
                (None, Some(base), _) => {
                    Some(self.add(Kind::Part { base, at }, field.ty.clone(), span))
                }
                (None, None, Some(Some(default))) if default.is_empty() => {
                    Some(self.add(Kind::Fault, field.ty.clone(), span))
                }
                (None, None, Some(Some(default))) => {
                    Some(self.add(Kind::Const(default.clone()), field.ty.clone(), span))
                }
                _ => None,
            };
            match part {
                Some(part) => parts.push(part),
                None => left_out.extend(field.name.as_deref()),
            }
            at += leaves(&field.ty);
        }
        if left_out.is_empty() {
            return Some(parts);
        }
        let finding = Finding::new(
            Code::RPI1010,
            format!(
                "missing {} of `{}`",
                super::report::listed(left_out),
                ty.name
            ),
        )
        .at(span, "all fields without a default are required");
        self.report(finding);
        None
    }
}
