//! Says in words what the grammar did not accept.

use crate::comments::Comment;
use crate::context::Context;
use crate::expected;
use crate::lexer::Lexeme;
use crate::outside;
use crate::structure::{Structure, closing};
use crate::token::Token;
use crate::words::begins_operand;
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
}

/// A fault among the tokens that it was found in.
pub(crate) struct Found<'f, 't> {
    pub(crate) cx: &'f Context<'t>,
    pub(crate) lexemes: &'f [Lexeme],
    pub(crate) structure: &'f Structure<'f>,
    pub(crate) fault: &'f Fault,
}

impl Found<'_, '_> {
    /// Whether all that is wrong is a missing `;`: one would fit, and a new phrase begins here.
    pub(crate) fn lacks_semi(&self) -> bool {
        let expects = |token| self.fault.expected.contains(&token);
        let fits = expects(Token::Semi) && !expects(Token::Let);
        let open = self.structure.open_bracket(self.fault.at);
        fits && open.is_none() && self.begins_phrase()
    }

    fn begins_phrase(&self) -> bool {
        match (self.before(), self.here()) {
            (None, _) => false,
            // Where one has been put in, another would not help.
            (Some(before), _) if before.start == before.end => false,
            (Some(_), None) => true,
            (Some(before), Some(here)) => {
                matches!(here.token, Token::Tel | Token::Noc | Token::End)
                    || self.cx.slice(before.end, here.start).contains('\n')
            }
        }
    }

    /// A `;` is missing before the token.
    pub(crate) fn missing_semi(&self) -> Finding {
        let before = self.before().unwrap_or(NO_LEXEME);
        let span = self.cx.span(before.start, before.end);
        let finding = Finding::new(
            Code::RPI0006,
            format!("expected `;` after {}", self.quoted(before)),
        )
        .at(after(span), "this phrase has no end");
        let finding = match self.is_hidden() {
            true => finding.help("a comment takes in the rest of its line, with its `;`"),
            false => finding,
        };
        finding.fix(self.ended().insert_after(span, ";"))
    }

    /// Whether a comment before the token has taken in a `;`.
    fn is_hidden(&self) -> bool {
        let end = self.before().map_or(0, |before| before.end);
        let start = self.here().map_or(end, |here| here.start);
        let text = |comment: &Comment| self.cx.slice(comment.span.start, comment.span.end);
        let mut comments = self.cx.comments_between(end, start).iter();
        comments.any(|comment| text(comment).contains(';'))
    }

    /// The fix that ends a phrase: sure if what follows begins another one, and no comment has taken in a `;`.
    fn ended(&self) -> Fix {
        let in_value = self.fault.expected.contains(&Token::Plus);
        let title = "insert `;`";
        match self.is_hidden() {
            false if !in_value || self.begins_another() => Fix::sure(title),
            _ => Fix::maybe(title),
        }
    }

    /// Whether no value goes on here: a word follows by which something begins, or what an equation defines.
    fn begins_another(&self) -> bool {
        use Token::{Comma, Dot, Eq, Ident, Int, LBracket, LParen, Path, RBracket, RParen};
        let rest = self.lexemes.get(self.fault.at..).unwrap_or_default();
        let Some(first) = rest.first() else {
            return true;
        };
        if first.token.keyword().is_some() {
            return !begins_operand(first.token);
        }
        let is_target = |token| {
            matches!(
                token,
                Comma | Dot | Ident | Int | LBracket | LParen | Path | RBracket | RParen
            )
        };
        let mut after = rest.iter().take(LONGEST_TARGET).map(|lexeme| lexeme.token);
        is_target(first.token) && after.find(|token| !is_target(*token)) == Some(Eq)
    }

    /// A body is open at the end of the declaration; `open` is its `let`.
    pub(crate) fn open_body(&self, open: usize) -> Finding {
        let open = self.lexemes[open];
        let last = self.place(self.lexemes.len());
        Finding::new(Code::RPI0004, "this body has no end")
            .at(
                self.cx.span(open.start, open.end),
                "no `tel` for this `let`",
            )
            .also(last, "the declaration ends here")
            .fix(Fix::maybe("insert `tel`").insert_after(last, "\ntel"))
    }

    /// The token fits nowhere.
    pub(crate) fn unexpected(&self) -> Finding {
        let open = self.structure.open_bracket(self.fault.at);
        match (open, self.here()) {
            (Some(open), here) if self.ends_bracket(open, here) => self.open_bracket(open),
            // The declaration was complete.
            (_, Some(_)) if self.fault.expected.is_empty() => {
                outside::stray(self.cx, self.before(), &self.lexemes[self.fault.at..])
            }
            _ => self.expected(),
        }
    }

    /// Whether a bracket that is open here should have been closed before.
    fn ends_bracket(&self, open: usize, here: Option<Lexeme>) -> bool {
        use Token::{Let, RBrace, RBracket, RParen, RStatic, Semi, Tel};
        let close = closing(self.lexemes[open].token);
        let fits = close.is_some_and(|close| self.fault.expected.contains(&close));
        let ends = |token| {
            matches!(
                token,
                Semi | Let | Tel | RParen | RBracket | RBrace | RStatic
            )
        };
        here.is_none_or(|here| fits && ends(here.token))
    }

    /// The bracket is not closed before the fault.
    pub(crate) fn open_bracket(&self, open: usize) -> Finding {
        let bracket = self.lexemes[open];
        let close = closing(bracket.token).and_then(Token::spelling);
        let span = self.cx.span(bracket.start, bracket.end);
        let here = format!("expected `{}` before this", close.unwrap_or_default());
        Finding::new(
            Code::RPI0004,
            format!("{} is not closed", self.quoted(bracket)),
        )
        .at(span, "opened here")
        .also(self.place(self.fault.at), here)
    }

    fn expected(&self) -> Finding {
        let (before, here) = (self.before(), self.here());
        let what = expected::in_words(&self.fault.expected, before.map(|lexeme| lexeme.token));
        let message = match before {
            Some(before) if before.token != Token::Broken => {
                format!("expected {what} after {}", self.quoted(before))
            }
            _ => format!("expected {what}"),
        };
        let found = match here {
            Some(here) => format!("found {}", self.quoted(here)),
            None => "the declaration ends here".to_owned(),
        };
        let finding = Finding::new(Code::RPI0001, message).at(self.place(self.fault.at), found);
        match expected::hint(here.map(|lexeme| lexeme.token)) {
            Some(hint) => finding.help(hint),
            None => finding,
        }
    }

    fn before(&self) -> Option<Lexeme> {
        self.fault.at.checked_sub(1).map(|i| self.lexemes[i])
    }

    fn here(&self) -> Option<Lexeme> {
        self.lexemes.get(self.fault.at).copied()
    }

    /// The place of a token; after the last one for the end.
    fn place(&self, at: usize) -> Span {
        match (self.lexemes.get(at), self.lexemes.last()) {
            (Some(lexeme), _) => self.cx.span(lexeme.start, lexeme.end),
            (None, Some(last)) => after(self.cx.span(last.start, last.end)),
            (None, None) => self.cx.span(0, 0),
        }
    }

    /// The token as it is written, in quotes.
    fn quoted(&self, lexeme: Lexeme) -> String {
        const LONGEST: usize = 30;
        let written = match self.cx.slice(lexeme.start, lexeme.end) {
            "" => lexeme.token.spelling().unwrap_or_default(),
            written => written,
        };
        let mut shown: String = written.chars().take(LONGEST).collect();
        if shown.len() < written.len() {
            shown.push_str("...");
        }
        format!("`{shown}`")
    }
}

/// How many tokens before its `=` are looked at.
const LONGEST_TARGET: usize = 40;

/// Stands before the first token.
const NO_LEXEME: Lexeme = Lexeme {
    token: Token::Broken,
    start: 0,
    end: 0,
};

/// The empty place after another.
pub(crate) fn after(span: Span) -> Span {
    Span {
        start: span.end,
        ..span
    }
}
