//! Diagnostics for tokens that the grammar rejected.

use crate::comments::Comment;
use crate::context::Context;
use crate::expected;
use crate::lexer::Lexeme;
use crate::outside;
use crate::structure::{Structure, closing};
use crate::token::Token;
use crate::words::begins_operand;
use rpi_diag::{Code, Finding, Fix, Span};

/// Syntax error: a token that the grammar rejected.
pub(crate) struct Fault {
    /// Index of the rejected token; the number of tokens at the end of the input.
    pub(crate) at: usize,
    /// Tokens that the grammar would have accepted.
    pub(crate) expected: Vec<Token>,
}

impl Fault {
    /// Creates a syntax error. `expected` holds token names as written in the grammar.
    pub(crate) fn new(at: usize, expected: Vec<String>) -> Fault {
        let expected = expected.iter().filter_map(|name| expected::token(name));
        Fault {
            at,
            expected: expected.collect(),
        }
    }
}

/// Syntax error with the tokens around it and their nesting.
pub(crate) struct Found<'f, 't> {
    pub(crate) cx: &'f Context<'t>,
    pub(crate) lexemes: &'f [Lexeme],
    pub(crate) structure: &'f Structure<'f>,
    pub(crate) fault: &'f Fault,
}

impl Found<'_, '_> {
    /// Returns whether only a `;` is missing: the grammar accepts one here, and a new phrase begins.
    pub(crate) fn lacks_semi(&self) -> bool {
        let expects = |token| self.fault.expected.contains(&token);
        let fits = expects(Token::Semi) && !expects(Token::Let);
        let open = self.structure.open_bracket(self.fault.at);
        fits && open.is_none() && self.begins_phrase()
    }

    fn begins_phrase(&self) -> bool {
        match (self.before(), self.here()) {
            (None, _) => false,
            // An empty token was inserted by error recovery: inserting another one would not help.
            (Some(before), _) if before.start == before.end => false,
            (Some(_), None) => true,
            (Some(before), Some(here)) => {
                matches!(here.token, Token::Tel | Token::Noc | Token::End)
                    || self.cx.slice(before.end, here.start).contains('\n')
            }
        }
    }

    /// Creates the diagnostic for a `;` that is missing before the rejected token (RPI0006).
    pub(crate) fn missing_semi(&self) -> Finding {
        let before = self.before().unwrap_or(NO_LEXEME);
        let span = self.cx.span(before.start, before.end);
        let finding = Finding::new(
            Code::RPI0006,
            format!("expected `;` after {}", self.quoted(before)),
        )
        .at(after(span), "expected `;` here");
        let finding = match self.is_hidden() {
            true => finding.help("the comment extends to the end of its line and contains the `;`"),
            false => finding,
        };
        finding.fix(self.ended().insert_after(span, ";"))
    }

    /// Returns whether a comment before the rejected token contains a `;`.
    fn is_hidden(&self) -> bool {
        let end = self.before().map_or(0, |before| before.end);
        let start = self.here().map_or(end, |here| here.start);
        let text = |comment: &Comment| self.cx.slice(comment.span.start, comment.span.end);
        let mut comments = self.cx.comments_between(end, start).iter();
        comments.any(|comment| text(comment).contains(';'))
    }

    /// Returns the fix that inserts the missing `;`. It is sure if the expression cannot continue, and no comment
    /// contains a `;`.
    fn ended(&self) -> Fix {
        let in_value = self.fault.expected.contains(&Token::Plus);
        let title = "insert `;`";
        match self.is_hidden() {
            false if !in_value || self.begins_another() => Fix::sure(title),
            _ => Fix::maybe(title),
        }
    }

    /// Returns whether the next tokens cannot continue an expression: a keyword that begins no operand, or the left
    /// side of an equation.
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

    /// Creates the diagnostic for a body that is still open at the end of the declaration (RPI0004). `open` is the
    /// index of its `let`.
    pub(crate) fn open_body(&self, open: usize) -> Finding {
        let open = self.lexemes[open];
        let last = self.place(self.lexemes.len());
        Finding::new(Code::RPI0004, "this body is not closed")
            .at(
                self.cx.span(open.start, open.end),
                "this `let` has no matching `tel`",
            )
            .also(last, "the declaration ends here")
            .fix(Fix::maybe("insert `tel`").insert_after(last, "\ntel"))
    }

    /// Creates the diagnostic for a rejected token without a more specific explanation.
    pub(crate) fn unexpected(&self) -> Finding {
        let open = self.structure.open_bracket(self.fault.at);
        match (open, self.here()) {
            (Some(open), here) if self.ends_bracket(open, here) => self.open_bracket(open),
            // No token is expected: the declaration is complete.
            (_, Some(_)) if self.fault.expected.is_empty() => {
                outside::stray(self.cx, self.before(), &self.lexemes[self.fault.at..])
            }
            _ => self.expected(),
        }
    }

    /// Returns whether the bracket `open` should have been closed before the token `here`.
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

    /// Creates the diagnostic for a bracket that is not closed before the syntax error (RPI0004).
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

    /// Returns the span of a token; the empty span after the last token for the end of the input.
    fn place(&self, at: usize) -> Span {
        match (self.lexemes.get(at), self.lexemes.last()) {
            (Some(lexeme), _) => self.cx.span(lexeme.start, lexeme.end),
            (None, Some(last)) => after(self.cx.span(last.start, last.end)),
            (None, None) => self.cx.span(0, 0),
        }
    }

    /// Returns the source text of a token in backticks, cut off after 30 characters.
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

/// Maximum number of tokens searched for the `=` of an equation.
const LONGEST_TARGET: usize = 40;

/// Placeholder for the token before the first one.
const NO_LEXEME: Lexeme = Lexeme {
    token: Token::Broken,
    start: 0,
    end: 0,
};

/// Returns the empty span at the end of a span.
pub(crate) fn after(span: Span) -> Span {
    Span {
        start: span.end,
        ..span
    }
}
