//! Operators of other languages, such as `==` and `:=`.

use super::foreign_syntax;
use crate::token::Token;
use rpi_diag::{Diagnostic, Fix, Span};

/// Operator of another language, with the RPI operator that has the same meaning.
pub(crate) struct ForeignOperator {
    /// Spelling of the operator in the other language.
    spelling: &'static str,
    /// Name of the operation in messages, such as "equality".
    name: &'static str,
    /// RPI operator with the same meaning.
    pub(crate) token: Token,
    /// Whether the operator has this meaning in all languages that have it, so that the fix can be applied
    /// automatically.
    is_sure: bool,
}

/// Creates a table row for an operator that has the same meaning in all languages that have it.
const fn row(written: &'static str, name: &'static str, token: Token) -> ForeignOperator {
    ForeignOperator {
        spelling: written,
        name,
        token,
        is_sure: true,
    }
}

/// Creates a table row for an operator whose meaning differs between languages.
const fn ambiguous_row(written: &'static str, name: &'static str, token: Token) -> ForeignOperator {
    ForeignOperator {
        is_sure: false,
        ..row(written, name, token)
    }
}

/// Table of the foreign operators that the lexer recognises. None of them is an operator of RPI.
pub(crate) const FOREIGN_OPERATORS: &[ForeignOperator] = &[
    row("==", "equality", Token::Eq),
    row("===", "equality", Token::Eq),
    row("!=", "inequality", Token::Ne),
    row("!==", "inequality", Token::Ne),
    row("~=", "inequality", Token::Ne),
    row("&", "conjunction", Token::And),
    row("&&", "conjunction", Token::And),
    row("||", "disjunction", Token::Or),
    row("!", "negation", Token::Not),
    // In C, `~` is the bitwise complement.
    ambiguous_row("~", "negation", Token::Not),
    row(":=", "a definition", Token::Eq),
    row("==>", "implication", Token::Implies),
];

/// Construct in which a foreign `:=` occurs. It decides the replacement of the `:=`.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum AssignContext {
    /// Definition of a flow: `y := x`.
    Definition,
    /// Named argument of a call: `f(x := 1)`.
    Argument,
    /// Comparison in a condition: `if x := 1 then`.
    Comparison,
    /// The `:=` is neither in a definition nor after the name of an argument.
    Other,
}

/// Reports a `:=` of another language at `span`. Returns the diagnostic and the RPI token that replaces the `:=`.
pub(crate) fn assign_diagnostic(span: Span, text: &str, of: AssignContext) -> (Diagnostic, Token) {
    let seen = "`:=` is from another language";
    let (message, sign, token) = match of {
        AssignContext::Argument => ("an argument name is followed by `:`", ":", Token::Colon),
        _ if is_in_brackets(&text[..span.start as usize]) => {
            return (foreign_update(span, text).primary(span, seen), Token::Eq);
        }
        AssignContext::Definition => ("a definition is written with `=`", "=", Token::Eq),
        AssignContext::Comparison => ("a comparison is written with `=`", "=", Token::Eq),
        AssignContext::Other => (
            "a definition or a comparison is written with `=`",
            "=",
            Token::Eq,
        ),
    };
    let title = format!("write `{sign}`");
    let fix = match of {
        AssignContext::Comparison | AssignContext::Other => Fix::maybe(title),
        _ => Fix::sure(title),
    };
    (
        foreign_syntax(message)
            .primary(span, seen)
            .fix(fix.replace(span, sign)),
        token,
    )
}

/// Returns the diagnostic for an update in brackets, `a[0 := x]`, with its RPI form. `span` is the place of `:=`.
fn foreign_update(span: Span, text: &str) -> Diagnostic {
    let diagnostic = foreign_syntax("a modified copy of a value is written with `with`");
    let Some((place, [base, part, value])) = update_parts(span, text) else {
        return diagnostic.help("write `(... with [...] = ...)` for an element of an array, `(... with .name = ...)` for a field");
    };
    let element = format!("({base} with [{part}] = {value})");
    let field = format!("({base} with .{part} = {value})");
    match part.starts_with(|c: char| c.is_ascii_digit()) {
        true => {
            diagnostic.fix(Fix::maybe(format!("write `{element}`")).replace(place, element.clone()))
        }
        false => diagnostic.help(format!(
            "write `{field}` for a field, `{element}` for an element of an array"
        )),
    }
}

/// Returns the place and the parts of an update `a[0 := x]`: the value, the changed part and its new value.
fn update_parts(span: Span, text: &str) -> Option<(Span, [&str; 3])> {
    let (before, after) = (
        text.get(..span.start as usize)?,
        text.get(span.end as usize..)?,
    );
    let open = before.rfind('[')?;
    let close = after.find(']')?;
    let (part, value) = (before[open + 1..].trim(), after[..close].trim());
    let is_name = |c: char| c.is_alphanumeric() || matches!(c, '_' | '.');
    let start = before[..open].rfind(|c| !is_name(c)).map_or(0, |at| at + 1);
    let base = &before[start..open];
    let is_simple = |part: &str| !part.is_empty() && part.chars().all(is_name);
    let place = Span {
        start: start as u32,
        end: span.end + close as u32 + 1,
        ..span
    };
    let is_whole = is_simple(base) && is_simple(part) && !value.contains(['[', '\n', ';', ':']);
    is_whole.then_some((place, [base, part, value]))
}

/// Returns the table row of the foreign operator with the spelling `written`; `None` if there is none.
pub(crate) fn find_operator(written: &str) -> Option<&'static ForeignOperator> {
    FOREIGN_OPERATORS
        .iter()
        .find(|sign| sign.spelling == written)
}

/// Returns the diagnostic for the foreign operator `sign` at `span`, with a fix that writes the RPI operator.
pub(crate) fn operator_diagnostic(span: Span, text: &str, sign: &ForeignOperator) -> Diagnostic {
    let meant = sign.token.spelling().unwrap_or_default();
    let title = format!("write `{meant}`");
    let fix = match sign.is_sure {
        true => Fix::sure(title),
        false => Fix::maybe(title),
    };
    foreign_syntax(format!("{} is written `{meant}`", sign.name))
        .primary(
            span,
            format!("`{}` is from another language", sign.spelling),
        )
        .fix(fix.replace(span, with_spaces(span, text, meant)))
}

/// Returns whether a `[` of the last statement is still open at the end of the text. Looks at the last 400 characters
/// only.
fn is_in_brackets(before: &str) -> bool {
    let mut closed = 0u32;
    let near = before.chars().rev().take(400);
    for c in near.take_while(|c| *c != ';') {
        match c {
            ']' => closed += 1,
            '[' if closed == 0 => return true,
            '[' => closed -= 1,
            _ => {}
        }
    }
    false
}

/// Returns `word` with the spaces that separate it from the characters of `text` before and after `span`.
pub(crate) fn with_spaces(span: Span, text: &str, word: &str) -> String {
    let is_word = word.starts_with(|c: char| c.is_ascii_alphabetic());
    let joins = |c: char| is_word && !c.is_whitespace() && c != '(';
    let before = text[..span.start as usize].ends_with(joins);
    let after = text[span.end as usize..].starts_with(|c: char| is_word && !c.is_whitespace());
    let space = |needed: bool| if needed { " " } else { "" };
    format!("{}{word}{}", space(before), space(after))
}

#[cfg(test)]
mod tests {
    use super::*;
    use rpi_diag::FileId;

    #[test]
    fn words_are_kept_apart() {
        for (text, at, len, becomes) in [
            ("a&&b", 1, 2, " and "),
            ("a && b", 2, 2, "and"),
            ("!a", 0, 1, "not "),
            ("(!a)", 1, 1, "not "),
            ("a==b", 1, 2, "="),
        ] {
            let span = Span::new(FileId(0), at, at + len);
            let sign = find_operator(&text[at as usize..(at + len) as usize]).expect("a row");
            let meant = sign.token.spelling().unwrap_or_default();
            assert_eq!(with_spaces(span, text, meant), becomes, "{text}");
        }
    }
}
