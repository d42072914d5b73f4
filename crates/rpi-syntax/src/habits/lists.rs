//! Brackets and ranges of other languages: `{1, 2}`, `[y, z] = f(x)`, `f<<x>>`, `0..3`; string literals as comments.

use super::words::stands_for_operand;
use super::{Habit, Mend, habit};
use crate::Mode;
use crate::explain::Found;
use crate::token::Token;
use rpi_diag::Fix;

/// Recognises an array literal in braces: `a = {1, 2, 3};`.
pub(super) fn braces(found: &Found<'_, '_>) -> Option<Habit> {
    use Token::{False, Ident, Int, LBrace, LBracket, Minus, RBracket, Real, True};
    let at = found.fault.at;
    let open = at.checked_sub(1)?;
    let is_element = matches!(
        found.token(at),
        Some(False | Ident | Int | Minus | Real | True)
    );
    let is_value = found.token(open) == Some(LBrace) && stands_for_operand(found, open);
    let close = found.structure.partner(open)?;
    if !is_element || !is_value || found.cx.mode == Mode::Lustre || !is_list(found, open, close) {
        return None;
    }
    let fix = Fix::sure("write `[ ]`")
        .replace(found.span_at(open), "[")
        .replace(found.span_at(close), "]");
    let finding = habit("the elements of an array are written in brackets")
        .at(found.span_at(open), "braces enclose the fields of a struct")
        .also(found.span_at(close), "the array ends here")
        .fix(fix);
    let mend = found.brackets(open, close, [LBracket, RBracket]);
    Some(Habit { finding, mend })
}

/// Returns whether the braces contain no field, only values.
fn is_list(found: &Found<'_, '_>, open: usize, close: usize) -> bool {
    let is_field = |at: usize| {
        matches!(
            found.token(at),
            Some(Token::Eq | Token::Semi | Token::Colon)
        ) && found.structure.parent(at) == Some(open)
    };
    !(open + 1..close).any(is_field)
}

/// Recognises left sides in brackets: `[y, z] = f(x);`.
pub(super) fn targets(found: &Found<'_, '_>) -> Option<Habit> {
    use Token::{Eq, LBracket, LParen, RParen};
    let at = found.fault.at;
    let close = found.structure.partner(at)?;
    let is_target = found.token(at) == Some(LBracket) && found.expects_equation();
    if !is_target || found.token(close + 1) != Some(Eq) {
        return None;
    }
    let finding = habit("several flows on the left of an equation are written in parentheses")
        .at(
            found.span_of(at..close + 1),
            "brackets enclose the elements of an array",
        )
        .fix(
            Fix::sure("write `( )`")
                .replace(found.span_at(at), "(")
                .replace(found.span_at(close), ")"),
        );
    let mend = found.brackets(at, close, [LParen, RParen]);
    Some(Habit { finding, mend })
}

/// Recognises a call with its arguments in `<< >>`: `f<<x, c>>;`.
pub(super) fn only_static(found: &Found<'_, '_>) -> Option<Habit> {
    let at = found.fault.at;
    let close = at
        .checked_sub(1)
        .filter(|at| found.token(*at) == Some(Token::RStatic))?;
    let open = found.structure.partner(close)?;
    let callee = open
        .checked_sub(1)
        .filter(|at| found.token(*at) == Some(Token::Ident))?;
    // With a gap before `<<`, or across two statements, `<<` and `>>` are shift operators.
    let is_apart = found.lexemes[callee].end != found.lexemes[open].start;
    let is_broken = (open..close).any(|at| found.token(at) == Some(Token::Semi));
    if !found.expects(Token::LParen)
        || found.expects(Token::Plus)
        || is_apart
        || is_broken
        || !stands_for_operand(found, callee)
    {
        return None;
    }
    let name = found.written(callee);
    let meant = format!("{name}({})", found.text(open + 1..close));
    let finding = habit("the arguments of a call are written in `( )`")
        .at(
            found.span_of(open..close + 1),
            "`<< >>` encloses static arguments, which are fixed at load time",
        )
        .help(format!(
            "`{name}(...)`, or `{name}<<...>>(...)` if it has static parameters"
        ))
        .fix(Fix::maybe(format!("write `{meant}`")).replace(found.span_of(callee..at), meant));
    let mend = found.brackets(open, close, [Token::LParen, Token::RParen]);
    Some(Habit { finding, mend })
}

/// Recognises a range test within an expression: `x in 0..3`.
pub(super) fn range(found: &Found<'_, '_>) -> Option<Habit> {
    let at = found.fault.at;
    if found.token(at) != Some(Token::DotDot) {
        return None;
    }
    let phrase = found.structure.phrase(at);
    let word = (phrase.start..at)
        .rev()
        .find(|at| found.written(*at) == "in")?;
    let value = word.checked_sub(1).map_or("x", |at| found.written(at));
    let finding = habit("a range is written as two comparisons")
        .at(found.span_of(word..at + 1), "keyword of another language")
        .help(format!("`0 <= {value} and {value} < 3`"));
    Some(Habit {
        finding,
        mend: Mend::Usual,
    })
}

/// Recognises a list comprehension: `[f(a) for a in xs]`.
pub(super) fn comprehension(found: &Found<'_, '_>) -> Option<Habit> {
    let at = found.fault.at;
    if found.written(at) != "for" || !found.expects(Token::Plus) {
        return None;
    }
    let finding = habit("an array is computed element by element with `map`")
        .at(found.span_at(at), "there are no loops")
        .help(
            "`map<<f, 3>>(a)` applies `f` to each of 3 elements; `red<<+, 3>>(0, a)` is their sum",
        );
    Some(Habit {
        finding,
        mend: Mend::Usual,
    })
}

/// Recognises string literals as comments among equations: `"""what this does"""`.
pub(super) fn text(found: &Found<'_, '_>) -> Option<Habit> {
    let at = found.fault.at;
    let is_text = |at: usize| found.token(at) == Some(Token::Str);
    if !is_text(at) || !found.expects_equation() {
        return None;
    }
    let end = (at..).find(|at| !is_text(*at)).unwrap_or(at + 1);
    let finding = habit("comments begin with `--`")
        .at(
            found.span_of(at..end),
            "a string literal is not an equation",
        )
        .help("write the documentation of a declaration before it, after `--|`");
    let semi = usize::from(found.token(end) == Some(Token::Semi));
    let mend = Mend::Tokens(vec![(at..end + semi, Vec::new())]);
    Some(Habit { finding, mend })
}
