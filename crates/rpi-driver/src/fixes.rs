//! Adaptation of fixes to the program: initial values get units and enum values, which the passes over nets do not
//! know, and fixes of the standard library are removed.

use crate::library::is_library_path;
use rpi_diag::{Diagnostic, Edit, Fix, SourceMap, Span};
use rpi_sema::CheckedProgram;
use rpi_sema::ty::Ty;
use rpi_sema::typed::{Expr, TypedKind};
use std::cell::OnceCell;

/// Initial values of delays in the fixes of the compiler passes, which know only the machine type (real, integer or
/// Boolean) of a flow.
const UNTYPED_INITIAL_VALUES: &[&str] = &["0.0 -> ", "0 -> ", "false -> "];

/// Gives the initial values of delays in fixes the type of the expression that they precede, such as a physical unit or
/// an enumeration value. Fixes for types without literals are removed.
pub(crate) fn type_initial_values(diagnostics: &mut [Diagnostic], checked: &CheckedProgram) {
    let places = ExprIndex::of(checked);
    for diagnostic in diagnostics {
        diagnostic.keep_fixes(|fix| type_fix(fix, &places));
    }
}

/// Expressions of a program by source location. They are sorted on first use.
struct ExprIndex<'c> {
    checked: &'c CheckedProgram,
    /// Expressions with their locations, sorted by location. The copies of the locations let the sorting work without
    /// access to the expressions.
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

    /// Returns the expressions that begin where the location `place` begins, the shortest first.
    fn starting(&self, place: Span) -> impl Iterator<Item = &'c Expr> {
        let start = |span: Span| (span.file, span.start);
        let sorted = self.sorted();
        let first = sorted.partition_point(|(at, _)| start(*at) < start(place));
        let here = sorted[first..].iter();
        let here = here.take_while(move |(at, _)| start(*at) == start(place));
        here.map(|(_, expr)| *expr)
    }
}

/// Removes the fixes that would change the text of the standard library, which is embedded in the compiler.
pub(crate) fn remove_library_fixes(diagnostics: &mut [Diagnostic], sources: &SourceMap) {
    let is_library = |span: Span| is_library_path(sources.name(span.file));
    for diagnostic in diagnostics {
        diagnostic.keep_fixes(|fix| fix.edits.iter().all(|edit| !is_library(edit.span)));
    }
}

/// Extends each deletion in a fix that would leave a blank line to the whole line.
pub(crate) fn delete_whole_lines(diagnostics: &mut [Diagnostic], sources: &SourceMap) {
    let fixes = diagnostics
        .iter_mut()
        .flat_map(|diagnostic| &mut diagnostic.fixes);
    for edit in fixes.flat_map(|fix| &mut fix.edits) {
        edit.extend_to_whole_lines(sources.text(edit.span.file));
    }
}

/// Gives the initial values in a fix the type of the expressions that they precede. Returns false if a value cannot be
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

/// Changes the edits before and after an expression in a fix so that the fix inserts `pre x` instead of `pre (x)`, if
/// the expression is a single name.
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

/// Gives the initial value in an edit of a fix the type of the expression that it precedes. Returns `None` if the value
/// cannot be written as a literal of that type.
fn type_edit(edit: &mut Edit, places: &ExprIndex<'_>) -> Option<()> {
    let (open, rest) = match edit.text.strip_prefix('(') {
        Some(rest) => ("(", rest),
        None => ("", edit.text.as_str()),
    };
    let begins = |plain: &&str| rest.strip_prefix(*plain);
    if let Some(behind) = UNTYPED_INITIAL_VALUES.iter().find_map(begins)
        && let Some(ty) = type_at(edit.span, places)
    {
        edit.text = format!("{open}{} -> {behind}", ty.zero_literal()?);
    }
    Some(())
}

/// Returns the type of the shortest expression of known type that begins where `place` begins; `None` if there is none.
fn type_at<'c>(place: Span, places: &ExprIndex<'c>) -> Option<&'c Ty> {
    let mut here = places.starting(place);
    let known = here.find(|expr| !expr.ty.has_unknown());
    known.map(|expr| &expr.ty)
}
