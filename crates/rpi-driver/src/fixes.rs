//! Adaptation of fixes to the program: initial values get units and enum values, which the passes over nets do not
//! know, and fixes of the standard library are removed.

use crate::modules::is_library_path;
use rpi_diag::{Diagnostic, Edit, Fix, SourceMap, Span};
use rpi_sema::CheckedProgram;
use rpi_sema::ty::Ty;
use rpi_sema::typed::{Expr, TypedKind};
use std::cell::OnceCell;

/// Untyped initial values with which the fixes of the passes begin, by machine type.
const UNTYPED_INITIAL_VALUES: &[&str] = &["0.0 -> ", "0 -> ", "false -> "];

/// Gives the initial values in fixes the type of the expression that they precede. Fixes for types without literals are
/// removed.
pub(crate) fn type_initial_values(diagnostics: &mut [Diagnostic], checked: &CheckedProgram) {
    let places = ExprIndex::of(checked);
    for diagnostic in diagnostics {
        diagnostic.keep_fixes(|fix| type_fix(fix, &places));
    }
}

/// Expressions of a program by location. They are sorted on first use.
struct ExprIndex<'c> {
    checked: &'c CheckedProgram,
    /// Sorted expressions, with copies of their locations so that sorting does not access the expressions.
    sorted: OnceCell<Vec<(Span, &'c Expr)>>,
}

impl<'c> ExprIndex<'c> {
    fn of(checked: &'c CheckedProgram) -> ExprIndex<'c> {
        let sorted = OnceCell::new();
        ExprIndex { checked, sorted }
    }

    fn sorted(&self) -> &[(Span, &'c Expr)] {
        self.sorted.get_or_init(|| {
            let units = self.checked.units.iter();
            let exprs = units.flat_map(|unit| &unit.exprs);
            let mut places: Vec<(Span, &Expr)> = exprs.map(|expr| (expr.span, expr)).collect();
            places.sort_by_key(|(place, _)| *place);
            places
        })
    }

    /// Returns the expressions that begin at the start of `place`, the shortest first.
    fn starting(&self, place: Span) -> impl Iterator<Item = &'c Expr> {
        let start = |span: Span| (span.file, span.start);
        let sorted = self.sorted();
        let first = sorted.partition_point(|(at, _)| start(*at) < start(place));
        let here = sorted[first..].iter();
        let here = here.take_while(move |(at, _)| start(*at) == start(place));
        here.map(|(_, expr)| *expr)
    }
}

/// Removes the fixes that would change the standard library, which is embedded in the compiler.
pub(crate) fn remove_library_fixes(diagnostics: &mut [Diagnostic], sources: &SourceMap) {
    let is_library = |span: Span| is_library_path(sources.name(span.file));
    for diagnostic in diagnostics {
        diagnostic.keep_fixes(|fix| fix.edits.iter().all(|edit| !is_library(edit.span)));
    }
}

/// Extends deletions that would leave a blank line to the whole line.
pub(crate) fn delete_whole_lines(diagnostics: &mut [Diagnostic], sources: &SourceMap) {
    let fixes = diagnostics
        .iter_mut()
        .flat_map(|diagnostic| &mut diagnostic.fixes);
    for edit in fixes.flat_map(|fix| &mut fix.edits) {
        edit.extend_to_whole_lines(sources.text(edit.span.file));
    }
}

/// Gives the initial value in a fix the type of the expression that it precedes. Returns false if the value cannot be
/// written as a literal of that type.
fn type_fix(fix: &mut Fix, places: &ExprIndex<'_>) -> bool {
    for pair in fix.edits.chunks_mut(2) {
        if let [before, after] = pair {
            remove_parentheses(before, after, places);
        }
    }
    let mut insertions = fix.edits.iter_mut().filter(|edit| edit.span.is_empty());
    insertions.all(|edit| type_edit(edit, places).is_some())
}

/// Changes the edits of a fix so that it inserts `pre x` instead of `pre (x)`, if the delayed expression is a single
/// name.
fn remove_parentheses(before: &mut Edit, after: &mut Edit, places: &ExprIndex<'_>) {
    let (Some(head), Some(tail)) = (before.text.strip_suffix('('), after.text.strip_prefix(')'))
    else {
        return;
    };
    // The parentheses of a call must stay: `time(x)`.
    if head.ends_with(char::is_alphanumeric) {
        return;
    }
    let whole = before.span.merge(after.span);
    let mut here = places.starting(whole).filter(|expr| expr.span == whole);
    if here.any(|expr| matches!(expr.kind, TypedKind::Flow(_))) {
        (before.text, after.text) = (head.to_owned(), tail.to_owned());
    }
}

/// Gives the initial value in an edit the type of the expression that it precedes. Returns `None` if the value cannot
/// be written as a literal of that type.
fn type_edit(edit: &mut Edit, places: &ExprIndex<'_>) -> Option<()> {
    let (open, rest) = match edit.text.strip_prefix('(') {
        Some(rest) => ("(", rest),
        None => ("", edit.text.as_str()),
    };
    let begins = |plain: &&str| rest.strip_prefix(*plain);
    if let Some(behind) = UNTYPED_INITIAL_VALUES.iter().find_map(begins)
        && let Some(ty) = type_at(edit.span, places)
    {
        edit.text = format!("{open}{} -> {behind}", zero_literal(ty)?);
    }
    Some(())
}

/// Returns the type of the shortest expression of known type that begins at a location.
fn type_at<'c>(place: Span, places: &ExprIndex<'c>) -> Option<&'c Ty> {
    let mut here = places.starting(place);
    let known = here.find(|expr| !expr.ty.has_unknown());
    known.map(|expr| &expr.ty)
}

/// Returns a literal of the type for an initial value: zero for numbers, `false` for Booleans; `None` for types without
/// literals.
fn zero_literal(ty: &Ty) -> Option<String> {
    match ty {
        Ty::Bool => Some("false".to_owned()),
        Ty::Int => Some("0".to_owned()),
        Ty::Subrange(range) => Some(range.clamp(0).to_string()),
        Ty::Real(dim) if *ty == Ty::REAL || dim.is_dimensionless() => Some("0.0".to_owned()),
        Ty::Real(dim) => Some(format!("0[{dim}]")),
        Ty::Duration => Some("0[s]".to_owned()),
        Ty::Enum(values) => values.values.first().map(ToString::to_string),
        Ty::Array(element, n) => Some(format!("{}^{n}", zero_literal(element)?)),
        // The name of a generic instance contains its arguments and cannot be written in a program.
        Ty::Struct(of) if !of.name.contains('<') => {
            let fields = of.fields.iter();
            let fields = fields.map(|field| {
                Some(format!(
                    "{} = {}",
                    field.name.as_ref()?,
                    zero_literal(&field.ty)?
                ))
            });
            let fields: Option<Vec<String>> = fields.collect();
            Some(format!("{}{{{}}}", of.name, fields?.join("; ")))
        }
        _ => None,
    }
}
