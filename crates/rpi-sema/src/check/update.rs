//! Functional updates: `(a with [2] = x; .f[i] = y)`; for Kind 2 `a[2 := x]`, `r[f := y]`.
//!
//! An index that is known only at run time is looked up in the list of all indices, so that its bounds are checked like
//! those of every other index. Each element of the result is then the new or the old one.

use super::access::leaves;
use super::body::Body;
use super::quantifier::SETS;
use super::report::Wanted;
use super::types::{FOREIGN, is_foreign};
use crate::ty::Ty;
use crate::typed::{Each, ExprId, Kind, Leaf};
use rpi_diag::Span;
use rpi_syntax::Name;
use rpi_syntax::ast::{Access, Change, Expr, Ident, Update};
use std::rc::Rc;

/// A change of a value: path of the part, new value, and location.
struct Part<'a> {
    path: &'a [Access],
    value: ExprId,
    span: Span,
}

impl<'a> Body<'_, 'a> {
    /// Checks an update `(base with [2] = x; .f[1] = y)`.
    pub(super) fn update(&mut self, update: &'a Update, span: Span) -> ExprId {
        if update.is_keyed && self.is_map_literal(&update.base) {
            return self.map_literal(update, span);
        }
        let base = self.expr(&update.base);
        if update.is_keyed {
            let change = |base, change| self.keyed(base, change, span);
            return update.changes.iter().fold(base, change);
        }
        update
            .changes
            .iter()
            .fold(base, |base, change| self.change(base, change, span))
    }

    /// Whether `map[1 := x]` of Kind 2 is a map literal: `map` is not a flow or static parameter.
    fn is_map_literal(&self, base: &Expr) -> bool {
        let is_free =
            |name: &Name| self.find_local(name).is_none() && !self.statics.contains_key(name);
        base.as_name()
            .is_some_and(|name| name == "map" && is_free(name))
    }

    fn map_literal(&mut self, update: &'a Update, span: Span) -> ExprId {
        for change in &update.changes {
            if let [Access::Index(key)] = &change.path[..] {
                self.expr(key);
            }
            self.expr(&change.value);
        }
        self.foreign("a map", SETS, update.base.span);
        self.fault(span)
    }

    /// Checks an update `base[key := value]` of Kind 2; in a struct the key is the name of a field.
    fn keyed(&mut self, base: ExprId, change: &'a Change, span: Span) -> ExprId {
        let ty = self.ty_of(base).clone();
        let field = match (&change.path[..], &ty) {
            ([Access::Index(key)], Ty::Struct(_)) if !is_foreign(&ty, FOREIGN) => {
                key.as_name().map(|name| Ident {
                    name: name.clone(),
                    span: key.span,
                })
            }
            _ => None,
        };
        match (&change.path[..], field) {
            (_, Some(field)) => {
                let value = self.expr(&change.value);
                let inside = Part {
                    path: &[],
                    value,
                    span,
                };
                let place = self.field_in(&ty, &field);
                let new = place.and_then(|(at, inner)| self.replaced(base, at, inner, &inside));
                new.unwrap_or_else(|| self.fault(span))
            }
            ([Access::Index(key)], None) if is_foreign(&ty, &["map<"]) => {
                self.expr(key);
                self.expr(&change.value);
                self.add(Kind::Fault, ty, span)
            }
            _ => self.change(base, change, span),
        }
    }

    fn change(&mut self, base: ExprId, change: &'a Change, span: Span) -> ExprId {
        let part = Part {
            path: &change.path,
            value: self.expr(&change.value),
            span,
        };
        match self.ty_of(base).is_unknown() {
            true => self.fault(span),
            false => self
                .changed(base, &part)
                .unwrap_or_else(|| self.fault(span)),
        }
    }

    /// Returns a value with the part at a path replaced; `None` after a reported error.
    fn changed(&mut self, base: ExprId, part: &Part<'a>) -> Option<ExprId> {
        let ty = self.ty_of(base).clone();
        let Some((first, rest)) = part.path.split_first() else {
            self.expect(part.value, &ty, &Wanted::Here);
            return Some(part.value);
        };
        let inside = Part {
            path: rest,
            ..*part
        };
        if let (Access::Index(index), Ty::Array(element, n)) = (first, &ty) {
            let at = self.expr(index);
            let is_int = self.expect(at, &Ty::Int, &Wanted::Here);
            return match self.known_int(at) {
                _ if !is_int => None,
                Some(k) => {
                    let k = self.in_bounds(k, *n, index.span)?;
                    self.replaced(base, k * leaves(element), (**element).clone(), &inside)
                }
                None => self.changed_at(base, at, &inside),
            };
        }
        if let (Access::Index(index), Ty::Tuple(members)) = (first, &ty) {
            let count = u32::try_from(members.len()).unwrap_or(u32::MAX);
            let k = self.integer(index)?;
            let k = self.in_bounds(k, count, index.span)?;
            let (before, rest) = members.split_at(k as usize);
            let at = before.iter().map(|member| leaves(&member.ty)).sum();
            return self.replaced(base, at, rest.first()?.ty.clone(), &inside);
        }
        if let (Access::Field(field), Ty::Spatial(..)) = (first, &ty) {
            let old = self.member(base, field);
            let new = self.changed(old, &inside)?;
            return Some(self.with_part(base, field, new, part.span));
        }
        let (at, inner) = self.path_in(&ty, 0, std::slice::from_ref(first))?;
        self.replaced(base, at, inner, &inside)
    }

    /// Returns a value with the part at a known leaf index replaced.
    fn replaced(&mut self, base: ExprId, at: u32, inner: Ty, inside: &Part<'a>) -> Option<ExprId> {
        let ty = self.ty_of(base).clone();
        let value = match inside.path {
            [] => {
                self.expect(inside.value, &inner, &Wanted::Here);
                inside.value
            }
            _ => {
                let old = self.add(Kind::Part { base, at }, inner, inside.span);
                self.changed(old, inside)?
            }
        };
        Some(self.add(Kind::Replace { base, at, value }, ty, inside.span))
    }

    /// Returns an array with the element at a run-time index replaced.
    fn changed_at(&mut self, base: ExprId, at: ExprId, inside: &Part<'a>) -> Option<ExprId> {
        let span = inside.span;
        let Ty::Array(element, n) = self.ty_of(base).clone() else {
            return None;
        };
        // An empty array has no element to replace, whatever the index.
        self.in_bounds(0, n, span)?;
        let numbers: Vec<ExprId> = (0..n).map(|k| self.number_of(k, span)).collect();
        let all = self.add_array(
            Kind::Build(numbers.clone().into()),
            Rc::new(Ty::Int),
            n,
            span,
        );
        let index = self.add(
            Kind::Select {
                base: all,
                index: at,
            },
            Ty::Int,
            span,
        );
        let old = self.add(Kind::Select { base, index }, (*element).clone(), span);
        let new = self.changed(old, inside)?;
        let mut elements = Vec::with_capacity(numbers.len());
        for (k, number) in (0..n).zip(numbers) {
            if !self.may_go_on(span) {
                return None;
            }
            let at = k * leaves(&element);
            let old = self.add(Kind::Part { base, at }, (*element).clone(), span);
            elements.push(self.either([index, number], [old, new], span));
        }
        Some(self.add_array(Kind::Build(elements.into()), element, n, span))
    }

    /// Selects the second of two values if two integers are equal, else the first. An `if` would compute the new value
    /// only where it is chosen; here it is computed once for all elements.
    fn either(&mut self, operands: [ExprId; 2], values: [ExprId; 2], span: Span) -> ExprId {
        let negated = false;
        let is_it = self.add(Kind::Equal { operands, negated }, Ty::Bool, span);
        let [one, zero] = [1, 0].map(|k| self.number_of(k, span));
        let which = Kind::Each(Each::If, [is_it, one, zero].into());
        let index = self.add(which, Ty::Int, span);
        let ty = self.ty_of(values[0]).clone();
        let base = self.add_array(Kind::Build(values.into()), Rc::new(ty.clone()), 2, span);
        self.add(Kind::Select { base, index }, ty, span)
    }

    fn number_of(&mut self, k: u32, span: Span) -> ExprId {
        self.add(Kind::Literal(Leaf::int(i64::from(k))), Ty::Int, span)
    }
}
