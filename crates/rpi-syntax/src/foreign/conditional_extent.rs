//! Conditional expressions of other languages beside operators that only RPI has.
//!
//! The precedence of such an operator relative to the foreign expression is undefined. The fix takes the shortest
//! expression and puts it in parentheses, so that its extent is visible.

use crate::syntax_errors::ErrorContext;
use crate::token::Token;
use rpi_diag::{Diagnostic, Fix, Span};
use std::ops::Range;

/// Help for a conditional expression whose extent among other operators is not clear.
const EXTENT_HELP: &str =
    "the parentheses show its extent: move them if more operators belong to it";

/// Returns whether an operator that only RPI has is among tokens.
pub(super) fn has_own_operator(found: &ErrorContext<'_, '_>, mut range: Range<usize>) -> bool {
    range.any(|at| is_own_operator(found, at))
}

/// Returns whether a token is an operator that only RPI has.
fn is_own_operator(found: &ErrorContext<'_, '_>, at: usize) -> bool {
    use Token::{Arrow, Bar, Coalesce, Fby, Implies, When, With};
    matches!(
        found.token_at(at),
        Some(Arrow | Bar | Coalesce | Fby | Implies | When | With)
    )
}

/// Adds the fix for the shortest conditional expression. `sign` is a token inside it; `first` are the tokens up to it,
/// and `last` the tokens of its last value. `meant` builds the text from both, without the other operators.
pub(super) fn with_extent_fix(
    found: &ErrorContext<'_, '_>,
    diagnostic: Diagnostic,
    [first, last]: [Range<usize>; 2],
    meant: impl Fn(&str, &str) -> String,
) -> Diagnostic {
    let level = found.structure.parent(first.start);
    let is_own = |at: &usize| is_own_operator(found, *at) && found.structure.parent(*at) == level;
    let own = first.clone().rev().find(is_own);
    let start = own.map_or(first.start, |at| at + 1);
    let end = last.clone().find(is_own).unwrap_or(last.end);
    if start >= first.end || last.start >= end {
        return diagnostic.help(EXTENT_HELP);
    }
    let meant = meant(
        found.range_text(start..first.end),
        found.range_text(last.start..end),
    );
    let place = found.range_span(start..end);
    diagnostic
        .help(EXTENT_HELP)
        .fix(Fix::maybe(format!("write `({meant})`")).replace(place, format!("({meant})")))
}

/// Adds a fix that makes a conditional expression at `place`, extended by parentheses around it.
pub(super) fn with_parentheses(diagnostic: Diagnostic, mut fix: Fix, place: Span) -> Diagnostic {
    fix.title = "write `(if ... then ... else ...)`".to_owned();
    let fix = fix.into_maybe();
    diagnostic
        .help(EXTENT_HELP)
        .fix(fix.insert_before(place, "(").insert_after(place, ")"))
}
