//! Signs of other languages.

use super::habit;
use crate::token::Token;
use rpi_diag::{Finding, Fix, Span};

/// A sign of another language.
pub(crate) struct Sign {
    written: &'static str,
    /// What it is there.
    name: &'static str,
    /// What it is here.
    pub(crate) token: Token,
    /// Whether it is that in every language that has it.
    is_sure: bool,
}

const fn row(written: &'static str, name: &'static str, token: Token) -> Sign {
    Sign {
        written,
        name,
        token,
        is_sure: true,
    }
}

const fn unsure(written: &'static str, name: &'static str, token: Token) -> Sign {
    Sign {
        is_sure: false,
        ..row(written, name, token)
    }
}

/// The signs that the lexer knows; none of them means anything here.
pub(crate) const SIGNS: &[Sign] = &[
    row("==", "equality", Token::Eq),
    row("===", "equality", Token::Eq),
    row("!=", "inequality", Token::Ne),
    row("!==", "inequality", Token::Ne),
    row("~=", "inequality", Token::Ne),
    row("&", "conjunction", Token::And),
    row("&&", "conjunction", Token::And),
    row("||", "disjunction", Token::Or),
    row("!", "negation", Token::Not),
    // Elsewhere it turns over bits.
    unsure("~", "negation", Token::Not),
    row(":=", "a definition", Token::Eq),
    row("==>", "implication", Token::Implies),
];

/// What `:=` of another language belongs to.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Becomes {
    /// `y := x`
    Definition,
    /// `f(x := 1)`
    Argument,
    /// Anything else.
    Unclear,
}

/// A `:=` stands in the text.
pub(crate) fn becomes(span: Span, text: &str, of: Becomes) -> (Finding, Token) {
    let seen = "`:=` is of another language";
    let (message, sign, token) = match of {
        Becomes::Argument => (NAMED, ":", Token::Colon),
        _ if is_in_brackets(&text[..span.start as usize]) => {
            let finding = habit("a changed part of a value is written with `with`").at(span, seen);
            let finding = finding.help("write `(a with [0] = x)`, `(r with .n = x)`");
            return (finding, Token::Eq);
        }
        _ => ("a definition is written `=`", "=", Token::Eq),
    };
    let title = format!("write `{sign}`");
    let fix = match of {
        Becomes::Unclear => Fix::maybe(title),
        _ => Fix::sure(title),
    };
    (
        habit(message).at(span, seen).fix(fix.replace(span, sign)),
        token,
    )
}

/// The row of a sign.
pub(crate) fn sign(written: &str) -> Option<&'static Sign> {
    SIGNS.iter().find(|sign| sign.written == written)
}

/// Such a sign stands in the text.
pub(crate) fn foreign_sign(span: Span, text: &str, sign: &Sign) -> Finding {
    let meant = sign.token.spelling().unwrap_or_default();
    let title = format!("write `{meant}`");
    let fix = match sign.is_sure {
        true => Fix::sure(title),
        false => Fix::maybe(title),
    };
    habit(format!("{} is written `{meant}`", sign.name))
        .at(span, format!("`{}` is of another language", sign.written))
        .fix(fix.replace(span, apart(span, text, meant)))
}

/// What is said of `f(a := x)`.
pub(crate) const NAMED: &str = "arguments are named by `:`";

/// Whether a `[` of the statement at hand is open at the end of the text.
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

/// A word with the spaces that keep it apart from what stands beside it.
pub(crate) fn apart(span: Span, text: &str, word: &str) -> String {
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
            let sign = sign(&text[at as usize..(at + len) as usize]).expect("a row");
            let meant = sign.token.spelling().unwrap_or_default();
            assert_eq!(apart(span, text, meant), becomes, "{text}");
        }
    }
}
