//! Operators of other languages, such as `==` and `:=`.

use super::foreign_syntax;
use crate::token::Token;
use rpi_diag::{Diagnostic, Fix, Span};

/// Operator of another language, with the operator of this one to write in its place.
pub(crate) struct ForeignOperator {
    /// Spelling of the operator in the other language.
    spelling: &'static str,
    /// Name of the operation, as used in messages.
    name: &'static str,
    /// Equivalent RPI token.
    pub(crate) token: Token,
    /// Whether the operator has this meaning in every language that has it.
    is_sure: bool,
}

/// Creates the table row of an operator with the same meaning in all languages that have it.
const fn row(written: &'static str, name: &'static str, token: Token) -> ForeignOperator {
    ForeignOperator {
        spelling: written,
        name,
        token,
        is_sure: true,
    }
}

/// Creates the table row of an operator whose meaning differs between languages.
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

/// Construct that a foreign `:=` belongs to.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum AssignContext {
    /// Definition of a flow: `y := x`.
    Definition,
    /// Named argument of a call: `f(x := 1)`.
    Argument,
    /// Any other construct, or one that is not recognised.
    Other,
}

/// Reports a foreign `:=`. Returns the diagnostic and the RPI token that replaces it.
pub(crate) fn assign_diagnostic(span: Span, text: &str, of: AssignContext) -> (Diagnostic, Token) {
    let seen = "`:=` is from another language";
    let (message, sign, token) = match of {
        AssignContext::Argument => ("an argument name is followed by `:`", ":", Token::Colon),
        _ if is_in_brackets(&text[..span.start as usize]) => {
            let diagnostic = foreign_syntax("a modified copy of a value is written with `with`")
                .primary(span, seen);
            let diagnostic = diagnostic.help("write `(a with [0] = x)`, `(r with .n = x)`");
            return (diagnostic, Token::Eq);
        }
        _ => ("a definition is written `=`", "=", Token::Eq),
    };
    let title = format!("write `{sign}`");
    let fix = match of {
        AssignContext::Other => Fix::maybe(title),
        _ => Fix::sure(title),
    };
    (
        foreign_syntax(message)
            .primary(span, seen)
            .fix(fix.replace(span, sign)),
        token,
    )
}

/// Returns the row of a foreign operator, if `written` is one.
pub(crate) fn find_operator(written: &str) -> Option<&'static ForeignOperator> {
    FOREIGN_OPERATORS
        .iter()
        .find(|sign| sign.spelling == written)
}

/// Returns the diagnostic for an operator of another language, with the operator to write instead.
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

/// Returns whether the text ends within an open `[` of its last statement. Looks back 400 characters at most.
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

/// Returns `word` with the spaces that separate it from the text on both sides of `span`.
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
