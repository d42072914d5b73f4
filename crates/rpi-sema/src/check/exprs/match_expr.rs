//! `match` expressions of Kind 2 with nested patterns: `match o with Wrap(A): 0 | Wrap(B(n)): n | Empty: 1 end`.
//!
//! The first matching case is taken. Missing and unreachable cases are found by the usefulness check of Maranget,
//! "Warnings for pattern matching" (2007): is there a value that matches a pattern and none of the patterns before it?

use crate::check::bodies::body::Body;
use crate::check::diagnostics::report;
use crate::check::diagnostics::report::join_names;
use crate::check::exprs::bindings;
use crate::check::exprs::bindings::BindingValue;
use crate::check::exprs::expr;
use crate::check::exprs::ops;
use crate::check::types::data;
use crate::program::{DeclKind, Lookup, NameSpace};
use crate::ty::{EnumTy, Ty};
use crate::typed::ExprId;
use crate::typed::{ElementwiseOp, TypedKind};
use rpi_diag::{Code, Diagnostic, Span};
use rpi_syntax::Name;
use rpi_syntax::ast::{Arm, Ident, Match, Pattern};
use rpi_syntax::ops::BinaryOp;
use std::rc::Rc;

/// Pattern of a `match`, reduced to what the search for missing cases needs: which alternatives it accepts.
#[derive(Clone)]
enum PatternShape {
    /// The pattern accepts any value: it is a name or `_`.
    Wildcard,
    /// The pattern accepts values of the alternative with this index; it has a pattern for each part of the
    /// alternative.
    Alternative(usize, Vec<PatternShape>),
}

/// Pattern that accepts any value.
const WILDCARD: &PatternShape = &PatternShape::Wildcard;

/// Maximum number of patterns compared in the search for missing cases of a `match`, and again in the search for
/// unreachable cases. The search takes exponential time in the worst case.
const MAX_STEPS: usize = 100_000;

/// A case of a `match`: its pattern, the conditions under which it is taken, and its value.
struct Case {
    shape: PatternShape,
    tests: Vec<ExprId>,
    value: ExprId,
}

/// Checks `match x with A: 1 | B(n): n end` and returns its typed expression, a chain of `if` expressions.
pub(crate) fn match_expr<'a>(cx: &mut Body<'_, 'a>, of: &'a Match, span: Span) -> ExprId {
    let value = expr::check_expr(cx, &of.value);
    let known = data::alternatives(cx, value);
    let before = cx.diagnostics.len();
    let mut cases: Vec<Case> = Vec::new();
    for arm in &of.arms {
        let case = check_match_case(cx, value, known.is_some(), arm);
        if let Some(first) = cases.first() {
            expr::common_type(
                cx,
                first.value,
                case.value,
                "all cases must have the same type",
            );
        }
        cases.push(case);
    }
    let Some((all, _)) = known else {
        let ty = cases
            .first()
            .map_or(Ty::Unknown, |case| cx.ty_of(case.value).clone());
        return cx.add(TypedKind::Error, ty, span);
    };
    if !report::has_error_since(cx, before) {
        check_exhaustiveness(cx, &all, value, of, &cases, span);
    }
    if report::has_error_since(cx, before) {
        return cx.error_expr(span);
    }
    // Built from the end: the cases are exhaustive, so the last one is the final `else`.
    let mut cases = cases.into_iter().rev();
    let Some(last) = cases.next() else {
        return cx.error_expr(span);
    };
    cases.fold(last.value, |rest, case| {
        let Some(test) = conjunction(cx, &case.tests, span) else {
            return case.value;
        };
        let ty = cx.ty_of(case.value).clone();
        cx.add(
            TypedKind::Each(ElementwiseOp::If, [test, case.value, rest].into()),
            ty,
            span,
        )
    })
}

fn conjunction(cx: &mut Body<'_, '_>, tests: &[ExprId], span: Span) -> Option<ExprId> {
    let (first, rest) = tests.split_first()?;
    let and = |whole, test| ops::binary_prim(cx, BinaryOp::And, whole, test, span);
    Some(rest.iter().copied().fold(*first, and))
}

/// Checks a case of a `match`. The names in its pattern can be read in its value. `value` is the matched value, and
/// `is_known` is false if it has a reported error, so that the pattern is not checked.
fn check_match_case<'a>(
    cx: &mut Body<'_, 'a>,
    value: ExprId,
    is_known: bool,
    arm: &'a Arm,
) -> Case {
    let before = cx.bindings.bound_names.len();
    let mut tests = Vec::new();
    let shape = match is_known {
        true => check_pattern(cx, value, &arm.pattern, &mut tests),
        // The error in the value has been reported; the names in the pattern get error expressions.
        false => {
            for name in arm.pattern.names() {
                let nothing = cx.error_expr(name.span);
                bindings::bind_name(cx, name, BindingValue::Expr(nothing));
            }
            PatternShape::Wildcard
        }
    };
    let then = expr::check_expr(cx, &arm.then);
    cx.bindings.bound_names.truncate(before);
    Case {
        shape,
        tests,
        value: then,
    }
}

/// Checks a pattern against the expression `value` and returns its reduced form. Adds the conditions under which the
/// pattern matches to `tests`, and lets the names in the pattern stand for parts of the value.
fn check_pattern<'a>(
    cx: &mut Body<'_, 'a>,
    value: ExprId,
    pattern: &'a Pattern,
    tests: &mut Vec<ExprId>,
) -> PatternShape {
    let name = &pattern.name;
    let has_alternatives = alternatives_of(cx.ty_of(value)).is_some();
    let known = match has_alternatives || !pattern.parts.is_empty() {
        true => data::alternatives(cx, value),
        false => None,
    };
    let index = known
        .as_ref()
        .and_then(|(all, _)| all.values.iter().position(|value| *value == name.name));
    match (known, index) {
        (Some((all, tag)), Some(index)) => {
            let test = data::tag_test(cx, &all, tag, index, name.span);
            tests.push(test);
            PatternShape::Alternative(index, check_part_patterns(cx, value, pattern, index, tests))
        }
        (Some((all, _)), None) if is_declared_value(cx, name) || !pattern.parts.is_empty() => {
            data::report_unknown_alternative(cx, &all, name);
            PatternShape::Wildcard
        }
        _ => {
            if name.name != "_" {
                bindings::bind_name(cx, name, BindingValue::Expr(value));
            }
            PatternShape::Wildcard
        }
    }
}

fn is_declared_value(cx: &Body<'_, '_>, name: &Ident) -> bool {
    let found = cx
        .checker
        .program
        .lookup_in(NameSpace::Value, cx.module, &name.name);
    matches!(found, Lookup::Found(_))
}

fn check_part_patterns<'a>(
    cx: &mut Body<'_, 'a>,
    value: ExprId,
    pattern: &'a Pattern,
    index: usize,
    tests: &mut Vec<ExprId>,
) -> Vec<PatternShape> {
    let (from, count) = parts_of_alternative(cx, &pattern.name.name, index);
    if count != pattern.parts.len() {
        let span = pattern.name.span;
        let parts = vec!["_"; count];
        data::report_part_count(cx, &pattern.name, &parts, pattern.parts.len(), span);
        return vec![PatternShape::Wildcard; count];
    }
    let fields = cx.ty_of(value).members().to_vec();
    let mut shapes = Vec::with_capacity(count);
    let mut at = 0;
    for (k, field) in fields.iter().enumerate() {
        if let Some(pattern) = k.checked_sub(from).and_then(|k| pattern.parts.get(k)) {
            let span = pattern.name.span;
            let part = TypedKind::Part { base: value, at };
            let part = cx.add(part, field.ty.clone(), span);
            shapes.push(check_pattern(cx, part, pattern, tests));
        }
        at += crate::check::exprs::access::leaf_count(&field.ty);
    }
    shapes
}

/// Returns where the struct of a `datatype` stores the parts of the alternative `name`: the index of the first field,
/// and the number of fields; (0, 0) if the alternative has no parts. `index` is the index of the alternative.
fn parts_of_alternative(cx: &Body<'_, '_>, name: &Name, index: usize) -> (usize, usize) {
    let found = cx
        .checker
        .program
        .lookup_in(NameSpace::Value, cx.module, name);
    let Lookup::Found(id) = found else {
        return (0, 0);
    };
    match cx.checker.program.decl(id).kind {
        DeclKind::Constructor { ty, .. } => data::constructor_field_range(cx, ty, index as u32),
        _ => (0, 0),
    }
}

/// Reports missing cases and unreachable cases of a `match`. `all` has the alternatives of the type, and `value` is the
/// matched value.
fn check_exhaustiveness(
    cx: &mut Body<'_, '_>,
    all: &EnumTy,
    value: ExprId,
    of: &Match,
    cases: &[Case],
    span: Span,
) {
    let mut search = UsefulnessSearch { body: cx, steps: 0 };
    let types = [search.body.ty_of(value).clone()];
    let rows: Vec<Vec<&PatternShape>> = cases.iter().map(|case| vec![&case.shape]).collect();
    let without = |k: &usize| {
        let is_it =
            |case: &Case| matches!(&case.shape, PatternShape::Alternative(index, _) if index == k);
        !cases.iter().any(is_it)
    };
    let has_any = cases
        .iter()
        .any(|case| matches!(case.shape, PatternShape::Wildcard));
    let mut missing: Vec<String> = match has_any {
        true => Vec::new(),
        false => (0..all.values.len())
            .filter(without)
            .map(|k| all.values[k].to_string())
            .collect(),
    };
    if missing.is_empty() && !has_any {
        missing.extend(
            search
                .find_unmatched(&types, &rows, &[WILDCARD])
                .into_iter()
                .flatten(),
        );
    }
    let unknown = missing.is_empty() && search.steps > MAX_STEPS;
    search.steps = 0;
    let mut unreachable = Vec::new();
    for k in 1..rows.len() {
        if search
            .find_unmatched(&types, &rows[..k], &rows[k])
            .is_none()
        {
            unreachable.push(k);
        }
    }
    if search.steps > MAX_STEPS {
        unreachable.clear();
    }
    if !missing.is_empty() {
        report::report_diagnostic(cx, not_covered(&missing, span));
    }
    if unknown {
        report::report_diagnostic(cx, too_many_cases(span));
    }
    for k in unreachable {
        report::report_diagnostic(cx, unreachable_case(&of.arms[..k], &of.arms[k].pattern));
    }
}

fn not_covered(missing: &[String], span: Span) -> Diagnostic {
    let missing = join_names(missing.iter().map(String::as_str));
    let message = format!("non-exhaustive match: {missing} not covered");
    Diagnostic::new(Code::RPI2011, message)
        .primary(span, "a `match` needs a case for every alternative")
        .help("add a case for it, or a last case `_` for all others")
}

/// Returns the diagnostic for a case of a `match` that no value reaches. `before` are the cases before it, and
/// `pattern` is its pattern.
fn unreachable_case(before: &[Arm], pattern: &Pattern) -> Diagnostic {
    let text = pattern_text(pattern);
    let mut before = before.iter().map(|arm| &arm.pattern);
    let same = before.find(|first| pattern_text(first) == text);
    if let Some(first) = same {
        let again = Ident {
            name: text.as_str().into(),
            span: pattern.name.span,
        };
        return crate::check::exprs::clocked::duplicate_case(&again, first.name.span);
    }
    Diagnostic::new(Code::RPI2011, format!("unreachable case `{text}`"))
        .primary(
            pattern.name.span,
            "the cases before it cover all its values",
        )
        .help("delete it, or move it before the more general cases")
}

/// Returns the diagnostic for a `match` with so many cases that the search for missing ones was stopped.
fn too_many_cases(span: Span) -> Diagnostic {
    let message = "too many combinations of cases to check for exhaustiveness";
    Diagnostic::new(Code::RPI1011, message)
        .primary(span, "a case may be missing")
        .help("nest a `match` on one part in a case of another, or add a last case `_`")
}

/// Returns a pattern as source text.
fn pattern_text(pattern: &Pattern) -> String {
    let parts: Vec<String> = pattern.parts.iter().map(pattern_text).collect();
    match &parts[..] {
        [] => pattern.name.name.to_string(),
        parts => format!("{}({})", pattern.name.name, parts.join(", ")),
    }
}

/// Returns the enumeration of the alternatives of an enum or `datatype`; `None` for other types.
fn alternatives_of(ty: &Ty) -> Option<&Rc<EnumTy>> {
    match ty {
        Ty::Enum(all) => Some(all),
        Ty::Struct(of) => match of.fields.first() {
            Some(tag) if tag.name.as_deref() == Some(crate::check::types::data::TAG) => {
                alternatives_of(&tag.ty)
            }
            _ => None,
        },
        _ => None,
    }
}

/// Search for values that no case of a `match` matches, with the number of steps taken so far.
struct UsefulnessSearch<'s, 'c, 'a> {
    body: &'s Body<'c, 'a>,
    steps: usize,
}

impl UsefulnessSearch<'_, '_, '_> {
    /// Searches for values of the types `types` that match the patterns `wanted` and none of the rows, which each have
    /// a pattern for each value. Returns one such list of values as source text; `None` if there is none or the step
    /// limit is reached.
    fn find_unmatched(
        &mut self,
        types: &[Ty],
        rows: &[Vec<&PatternShape>],
        wanted: &[&PatternShape],
    ) -> Option<Vec<String>> {
        if rows.iter().any(|row| {
            row.iter()
                .all(|shape| matches!(shape, PatternShape::Wildcard))
        }) {
            return None;
        }
        self.steps += rows.len().max(1);
        if self.steps > MAX_STEPS {
            return None;
        }
        let (Some((ty, types)), Some((first, rest))) = (types.split_first(), wanted.split_first())
        else {
            return Some(Vec::new());
        };
        let is_of =
            |row: &Vec<&PatternShape>| matches!(row.first(), Some(PatternShape::Alternative(..)));
        match (first, alternatives_of(ty)) {
            (PatternShape::Alternative(index, parts), Some(all)) => {
                let parts: Vec<&PatternShape> = parts.iter().collect();
                self.find_unmatched_alternative((ty, all, *index), types, rows, (&parts, rest))
            }
            (_, Some(all)) if rows.iter().any(is_of) => (0..all.values.len()).find_map(|index| {
                let (_, count) = parts_of_alternative(self.body, &all.values[index], index);
                let parts = vec![WILDCARD; count];
                self.find_unmatched_alternative((ty, all, index), types, rows, (&parts, rest))
            }),
            _ => {
                let rows = rows.iter().filter(|row| !is_of(row));
                let rows: Vec<Vec<&PatternShape>> = rows.map(|row| row[1..].to_vec()).collect();
                let mut found = self.find_unmatched(types, &rows, rest)?;
                found.insert(0, "_".to_owned());
                Some(found)
            }
        }
    }

    /// Searches as [`Self::find_unmatched`] does, but only for a first value that is the alternative `index` of the
    /// type `ty`. `types` and `rest` are for the other values, and `parts` are the patterns wanted for the parts of the
    /// alternative.
    fn find_unmatched_alternative(
        &mut self,
        (ty, all, index): (&Ty, &Rc<EnumTy>, usize),
        types: &[Ty],
        rows: &[Vec<&PatternShape>],
        (parts, rest): (&[&PatternShape], &[&PatternShape]),
    ) -> Option<Vec<String>> {
        let name = &all.values[index];
        let (from, count) = parts_of_alternative(self.body, name, index);
        let fields = ty.members().iter().skip(from).take(count);
        let inner: Vec<Ty> = fields.map(|field| field.ty.clone()).collect();
        let opened = rows.iter().filter_map(|row| match row.split_first()? {
            (PatternShape::Wildcard, rest) => Some([&vec![WILDCARD; count], rest].concat()),
            (PatternShape::Alternative(k, parts), rest) if *k == index => {
                let parts: Vec<&PatternShape> = parts.iter().collect();
                Some([&parts, rest].concat())
            }
            _ => None,
        });
        let opened: Vec<Vec<&PatternShape>> = opened.collect();
        let types = [&inner, types].concat();
        let mut found = self.find_unmatched(&types, &opened, &[parts, rest].concat())?;
        let after = found.split_off(count.min(found.len()));
        let written = match &found[..] {
            [] => name.to_string(),
            parts => format!("{name}({})", parts.join(", ")),
        };
        Some([vec![written], after].concat())
    }
}
