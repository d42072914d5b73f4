//! Steps of tasks and results of commands in the syntax of other languages.

use super::{ForeignSyntax, Repair, foreign_syntax};
use crate::foreign::statement_kinds::BRANCH_HELP;
use crate::foreign::statements;
use crate::syntax_errors::ErrorContext;
use crate::token::Token;

/// Recognises an `if` among the steps of a task: `if Look() then Move(); end`.
pub(super) fn step_by_condition(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = found.error.index;
    if found.token_at(at) != Some(Token::If) || !found.in_task() || !found.expects(Token::Repeat) {
        return None;
    }
    let end = statements::nested_block_end(found, at);
    found
        .cx
        .suppress_foreign_operators(found.range_span(at..end));
    let diagnostic = foreign_syntax("a task branches on the results of its steps")
        .primary(found.token_span(at), "expected a step")
        .help(BRANCH_HELP);
    Some(ForeignSyntax {
        diagnostic,
        repair: Repair::RemovePhrase(at..end, Vec::new()),
    })
}

/// Recognises a step without its argument list: `Rest;`.
pub(super) fn step_without_arguments(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = found.error.index;
    let ends = matches!(
        found.token_at(at),
        Some(Token::Semi | Token::On | Token::Tel)
    );
    let is_step = found.token_before() == Some(Token::Ident) && found.expects(Token::LParen);
    if !ends || !is_step || !found.in_task() || !found.expects(Token::Colon) {
        return None;
    }
    let name = found.token_span(at - 1);
    let diagnostic = foreign_syntax("a step needs parentheses after the command name")
        .primary(name, "expected `()` after this")
        .fix(rpi_diag::Fix::sure("insert `()`").insert_after(name, "()"));
    let open = found.insertion(at, Token::LParen);
    let close = found.insertion(at, Token::RParen);
    let repair = Repair::ReplaceTokens(vec![(open.0, [open.1, close.1].concat())]);
    Some(ForeignSyntax { diagnostic, repair })
}

/// Recognises a repetition without `times`: `repeat 3 let Rest(); tel`.
pub(super) fn repeat_without_times(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = found.error.index;
    if found.token_at(at) != Some(Token::Let) || !found.expects(Token::Times) || at == 0 {
        return None;
    }
    let diagnostic = foreign_syntax("the number of repetitions is followed by `times`")
        .primary(found.token_span(at), "expected `times` before this")
        .fix(
            rpi_diag::Fix::sure("insert `times`").insert_after(found.token_span(at - 1), " times"),
        );
    let repair = Repair::ReplaceTokens(vec![found.insertion(at, Token::Times)]);
    Some(ForeignSyntax { diagnostic, repair })
}

/// Recognises a repetition without `repeat`: `3 times let Rest(); tel`.
pub(super) fn times_without_repeat(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = found.error.index;
    let is_count = matches!(found.token_at(at), Some(Token::Int | Token::Ident));
    let is_round = found.source_text(at + 1) == "times" && found.in_task();
    if !is_count || !is_round || !found.expects(Token::Repeat) {
        return None;
    }
    let diagnostic = foreign_syntax("a repetition begins with `repeat`")
        .primary(
            found.range_span(at..at + 2),
            "expected `repeat` before this",
        )
        .fix(rpi_diag::Fix::sure("insert `repeat`").insert_before(found.token_span(at), "repeat "));
    let word = found.insertion(at, Token::Repeat);
    let times = found.replacement(at + 1, &[Token::Times]);
    Some(ForeignSyntax {
        diagnostic,
        repair: Repair::ReplaceTokens(vec![word, times]),
    })
}

/// Recognises steps that are separated by another token than `;`: `Rest(), Rest();`, `Rest() then Rest();`.
pub(super) fn steps_without_semi(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = found.error.index;
    let is_sign = matches!(
        found.token_at(at),
        Some(Token::Comma | Token::Then | Token::Arrow)
    ) || matches!(found.source_text(at), "then" | "and");
    let is_step = found.token_before() == Some(Token::RParen) && found.expects(Token::On);
    if !is_sign || !is_step || !found.in_task() {
        return None;
    }
    let gap = found
        .cx
        .span(found.lexemes[at - 1].end, found.lexemes[at].end);
    let diagnostic = foreign_syntax("steps are separated by `;`")
        .primary(found.token_span(at), "expected `;`")
        .fix(rpi_diag::Fix::sure("write `;`").replace(gap, ";"));
    Some(ForeignSyntax {
        diagnostic,
        repair: Repair::ReplaceTokens(vec![found.replacement(at, &[Token::Semi])]),
    })
}

/// Recognises an assignment of a step's result, which RPI does not have: `r = Rest();`.
pub(super) fn step_with_value(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = found.error.index;
    let is_step = found.in_task() && found.expects(Token::LParen) && found.expects(Token::Colon);
    if found.token_at(at) != Some(Token::Eq) || !is_step {
        return None;
    }
    let diagnostic = foreign_syntax("a step has results, not a value")
        .primary(found.token_span(at), "a task has no equations")
        .help(BRANCH_HELP);
    Some(ForeignSyntax {
        diagnostic,
        repair: Repair::RemoveErrorPhrase,
    })
}

/// Recognises a result of a command without `finish`, `yield` or `fail`: `done when c;`.
pub(super) fn result_without_keyword(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = found.error.index;
    let name = at
        .checked_sub(1)
        .filter(|at| found.token_at(*at) == Some(Token::Ident))?;
    let before = name.checked_sub(1).and_then(|at| found.token_at(at));
    let is_first = matches!(
        before,
        Some(Token::Let | Token::Semi | Token::Tel | Token::End)
    );
    let in_command = found.token_at(0) == Some(Token::Command);
    if found.token_at(at) != Some(Token::When)
        || !is_first
        || !in_command
        || !found.expects(Token::Eq)
    {
        return None;
    }
    let span = found.token_span(name);
    let diagnostic = foreign_syntax("a result begins with `finish`, `yield` or `fail`")
        .primary(span, "expected `finish` before this")
        .fix(rpi_diag::Fix::maybe("insert `finish`").insert_before(span, "finish "));
    Some(ForeignSyntax {
        diagnostic,
        repair: Repair::ReplaceTokens(vec![found.insertion(name, Token::Finish)]),
    })
}
