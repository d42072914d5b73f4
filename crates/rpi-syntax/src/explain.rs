//! Says in words what the grammar did not accept.

use crate::context::Context;
use crate::expected;
use crate::lexer::Lexeme;
use crate::outside;
use crate::structure::{Structure, closing};
use crate::token::Token;
use rpi_diag::{Code, Finding, Fix, Span};

/// A token that the grammar did not accept.
pub(crate) struct Fault {
    /// Which token; the number of tokens for the end.
    pub(crate) at: usize,
    /// What would have been accepted.
    pub(crate) expected: Vec<Token>,
}

impl Fault {
    /// Of the names that the grammar gives its tokens.
    pub(crate) fn new(at: usize, expected: Vec<String>) -> Fault {
        let expected = expected.iter().filter_map(|name| expected::token(name));
        Fault {
            at,
            expected: expected.collect(),
        }
    }

    /// Whether all that is wrong is a missing `;`: one would fit, and a new phrase begins here.
    pub(crate) fn lacks_semi(&self, cx: &Context<'_>, lexemes: &[Lexeme]) -> bool {
        let before = self.at.checked_sub(1).map(|i| lexemes[i]);
        let new_phrase = match (before, lexemes.get(self.at)) {
            (None, _) => false,
            // Where one has been put in, another would not help.
            (Some(before), _) if before.start == before.end => false,
            (Some(_), None) => true,
            (Some(before), Some(here)) => {
                matches!(
                    here.token,
                    Token::Tel | Token::Let | Token::Noc | Token::End
                ) || cx.slice(before.end, here.start).contains('\n')
            }
        };
        new_phrase && self.expected.contains(&Token::Semi)
    }
}

/// A `;` is missing before the token.
pub(crate) fn missing_semi(cx: &Context<'_>, lexemes: &[Lexeme], fault: &Fault) -> Finding {
    let before = lexemes[fault.at - 1];
    let span = cx.span(before.start, before.end);
    Finding::new(
        Code::RPI0006,
        format!("expected `;` after {}", quoted(cx, before)),
    )
    .at(after(span), "this phrase has no end")
    .fix(Fix::sure("insert `;`").insert_after(span, ";"))
}

/// A body is open at the end of the declaration.
pub(crate) fn open_body(
    cx: &Context<'_>,
    lexemes: &[Lexeme],
    structure: &Structure<'_>,
) -> Finding {
    let finding = Finding::new(Code::RPI0004, "this body has no end");
    let open = structure.open_let().map_or(0, |open| open);
    let last = lexemes
        .last()
        .map_or(Span::NONE, |l| cx.span(l.start, l.end));
    finding
        .at(
            cx.span(lexemes[open].start, lexemes[open].end),
            "no `tel` for this `let`",
        )
        .also(after(last), "the declaration ends here")
        .fix(Fix::maybe("insert `tel`").insert_after(last, "\ntel"))
}

/// The token fits nowhere.
pub(crate) fn unexpected(
    cx: &Context<'_>,
    lexemes: &[Lexeme],
    structure: &Structure<'_>,
    fault: &Fault,
) -> Finding {
    let here = lexemes.get(fault.at).copied();
    if let Some(open) = structure.open_bracket(fault.at)
        && closing(lexemes[open].token).is_some_and(|close| fault.expected.contains(&close))
        && here.is_none_or(|lexeme| ends_bracket(lexeme.token))
    {
        return open_bracket(cx, lexemes, open, fault.at);
    }
    match here {
        Some(lexeme) if reserved_as_name(cx, lexeme, fault) => reserved(cx, lexeme),
        Some(_) if fault.expected.is_empty() => outside::stray(cx, &lexemes[fault.at..]),
        _ => expected_found(cx, lexemes, fault),
    }
}

fn ends_bracket(token: Token) -> bool {
    use Token::{Let, RBrace, RBracket, RParen, RStatic, Semi, Tel};
    matches!(
        token,
        Semi | Let | Tel | RParen | RBracket | RBrace | RStatic
    )
}

fn open_bracket(cx: &Context<'_>, lexemes: &[Lexeme], open: usize, at: usize) -> Finding {
    let bracket = lexemes[open];
    let close = closing(bracket.token)
        .and_then(Token::spelling)
        .unwrap_or_default();
    let span = cx.span(bracket.start, bracket.end);
    Finding::new(
        Code::RPI0004,
        format!("{} is not closed", quoted(cx, bracket)),
    )
    .at(span, "opened here")
    .also(
        place(cx, lexemes, at),
        format!("expected `{close}` before this"),
    )
}

/// Whether a reserved word stands where a name is wanted: neither an expression nor an equation.
fn reserved_as_name(cx: &Context<'_>, lexeme: Lexeme, fault: &Fault) -> bool {
    let wants = |token| fault.expected.contains(&token);
    let wants_name = wants(Token::Ident) && !wants(Token::Int) && !wants(Token::Tel);
    let is_reserved = lexeme
        .token
        .keyword()
        .is_some_and(|word| word.is_reserved_in(cx.mode));
    wants_name
        && is_reserved
        && !matches!(
            lexeme.token,
            Token::When | Token::Let | Token::Tel | Token::Then
        )
}

fn reserved(cx: &Context<'_>, lexeme: Lexeme) -> Finding {
    let span = cx.span(lexeme.start, lexeme.end);
    Finding::new(
        Code::RPI0012,
        format!(
            "{} is a word of the language, not a name",
            quoted(cx, lexeme)
        ),
    )
    .at(span, "reserved")
    .help("choose another name")
}

fn expected_found(cx: &Context<'_>, lexemes: &[Lexeme], fault: &Fault) -> Finding {
    let before = fault.at.checked_sub(1).map(|i| lexemes[i]);
    let here = lexemes.get(fault.at).copied();
    let what = expected::in_words(&fault.expected, before.map(|lexeme| lexeme.token));
    let message = match before {
        Some(before) if before.token != Token::Broken => {
            format!("expected {what} after {}", quoted(cx, before))
        }
        _ => format!("expected {what}"),
    };
    let found = match here {
        Some(here) => format!("found {}", quoted(cx, here)),
        None => "the declaration ends here".to_owned(),
    };
    let finding = Finding::new(Code::RPI0001, message).at(place(cx, lexemes, fault.at), found);
    match expected::hint(
        before.map(|lexeme| lexeme.token),
        here.map(|lexeme| lexeme.token),
    ) {
        Some(hint) => finding.help(hint),
        None => finding,
    }
}

/// The place of a token; after the last one for the end.
fn place(cx: &Context<'_>, lexemes: &[Lexeme], at: usize) -> Span {
    match (lexemes.get(at), lexemes.last()) {
        (Some(lexeme), _) => cx.span(lexeme.start, lexeme.end),
        (None, Some(last)) => after(cx.span(last.start, last.end)),
        (None, None) => cx.span(0, 0),
    }
}

/// The empty place after another.
fn after(span: Span) -> Span {
    Span {
        start: span.end,
        ..span
    }
}

/// The token as it is written, in quotes.
fn quoted(cx: &Context<'_>, lexeme: Lexeme) -> String {
    const LONGEST: usize = 30;
    let written = match cx.slice(lexeme.start, lexeme.end) {
        "" => lexeme.token.spelling().unwrap_or_default(),
        written => written,
    };
    let mut shown: String = written.chars().take(LONGEST).collect();
    if shown.len() < written.len() {
        shown.push_str("...");
    }
    format!("`{shown}`")
}
