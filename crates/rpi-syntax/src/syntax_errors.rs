//! Diagnostics for tokens that the grammar rejected.

use crate::comments::Comment;
use crate::context::ParseContext;
use crate::expected;
use crate::lexer::Lexeme;
use crate::neighbours::begins_operand;
use crate::stray_tokens;
use crate::token::Token;
use crate::token_tree::{TokenTree, closing_token};
use rpi_diag::{Code, Diagnostic, Fix, Span};

/// Syntax error in a declaration: the token that the grammar rejected, and the tokens that it would have accepted.
pub(crate) struct SyntaxError {
    /// Index of the rejected token; the number of tokens if the declaration ends too early.
    pub(crate) index: usize,
    /// Tokens that the grammar would have accepted instead.
    pub(crate) expected: Vec<Token>,
}

impl SyntaxError {
    /// Creates a syntax error at token `at`. `expected` holds the accepted tokens by their names in the grammar.
    pub(crate) fn new(at: usize, expected: Vec<String>) -> SyntaxError {
        let expected = expected
            .iter()
            .filter_map(|name| expected::token_from_grammar_name(name));
        SyntaxError {
            index: at,
            expected: expected.collect(),
        }
    }
}

/// Syntax error with its context: the tokens of the declaration and their nesting.
pub(crate) struct ErrorContext<'f, 't> {
    pub(crate) cx: &'f ParseContext<'t>,
    pub(crate) lexemes: &'f [Lexeme],
    pub(crate) structure: &'f TokenTree<'f>,
    pub(crate) error: &'f SyntaxError,
}

impl ErrorContext<'_, '_> {
    /// Returns whether only a `;` is missing at the syntax error: the grammar accepts one, and a new line or a closing
    /// keyword follows.
    pub(crate) fn lacks_semi(&self) -> bool {
        let expects = |token| self.error.expected.contains(&token);
        let expects_semi = expects(Token::Semi) && !expects(Token::Let);
        let open = self.structure.unclosed_bracket(self.error.index);
        expects_semi && open.is_none() && self.begins_phrase()
    }

    fn begins_phrase(&self) -> bool {
        match (self.previous_lexeme(), self.rejected_lexeme()) {
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
    pub(crate) fn missing_semi(&self) -> Diagnostic {
        let before = self.previous_lexeme().unwrap_or(EMPTY_LEXEME);
        let span = self.cx.span(before.start, before.end);
        let diagnostic = Diagnostic::new(
            Code::RPI0006,
            format!("expected `;` after {}", self.quoted(before)),
        )
        .primary(end_of_span(span), "expected `;` here");
        let diagnostic = match self.comment_with_semi() {
            Some(comment) => with_comment_help(diagnostic, comment),
            None => diagnostic,
        };
        diagnostic.fix(self.insert_semi_fix().insert_after(span, ";"))
    }

    /// Returns the text of the comment before the rejected token that contains a `;`.
    fn comment_with_semi(&self) -> Option<&str> {
        let end = self.previous_lexeme().map_or(0, |before| before.end);
        let start = self.rejected_lexeme().map_or(end, |here| here.start);
        let text = |comment: &Comment| self.cx.slice(comment.span.start, comment.span.end);
        let comments = self.cx.comments_between(end, start).iter();
        comments.map(text).find(|text| text.contains(';'))
    }

    /// Returns the fix that inserts the missing `;`. The fix is sure if the expression cannot continue and no comment
    /// contains a `;`.
    fn insert_semi_fix(&self) -> Fix {
        let in_value = self.error.expected.contains(&Token::Plus);
        let title = "insert `;`";
        match self.comment_with_semi().is_some() {
            false if !in_value || self.cannot_continue_expr() => Fix::sure(title),
            _ => Fix::maybe(title),
        }
    }

    /// Returns whether the tokens from the rejected one on cannot continue an expression: a keyword that begins no
    /// operand, or the left side of an equation.
    fn cannot_continue_expr(&self) -> bool {
        use Token::{Comma, Dot, Eq, Ident, Int, LBracket, LParen, Path, RBracket, RParen};
        let rest = self.lexemes.get(self.error.index..).unwrap_or_default();
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
        let mut after = rest
            .iter()
            .take(MAX_TARGET_TOKENS)
            .map(|lexeme| lexeme.token);
        is_target(first.token) && after.find(|token| !is_target(*token)) == Some(Eq)
    }

    /// Creates the diagnostic for a body that is still open at the end of the declaration (RPI0004). `open` is the
    /// token index of its `let`.
    pub(crate) fn unclosed_body(&self, open: usize) -> Diagnostic {
        let open = self.lexemes[open];
        let last = self.span_or_end(self.lexemes.len());
        Diagnostic::new(Code::RPI0004, "this body is not closed")
            .primary(
                self.cx.span(open.start, open.end),
                "this `let` has no matching `tel`",
            )
            .secondary(last, "the declaration ends here")
            .fix(Fix::maybe("insert `tel`").insert_after(last, "\ntel"))
    }

    /// Creates the diagnostic for a syntax error without a more specific explanation.
    pub(crate) fn unexpected_token(&self) -> Diagnostic {
        let open = self.structure.unclosed_bracket(self.error.index);
        match (open, self.rejected_lexeme()) {
            (Some(open), here) if self.ends_unclosed_bracket(open, here) => {
                self.unclosed_bracket(open)
            }
            // No token is expected: the declaration is complete.
            (_, Some(_)) if self.error.expected.is_empty() => stray_tokens::stray_tokens(
                self.cx,
                self.previous_lexeme(),
                &self.lexemes[self.error.index..],
            ),
            _ => self.expected_token(),
        }
    }

    /// Returns whether the bracket at token `open` should have been closed before the token `here` (`None` at the end
    /// of the declaration).
    fn ends_unclosed_bracket(&self, open: usize, here: Option<Lexeme>) -> bool {
        use Token::{Let, RBrace, RBracket, RParen, RStatic, Semi, Tel};
        let close = closing_token(self.lexemes[open].token);
        let is_expected = close.is_some_and(|close| self.error.expected.contains(&close));
        let ends = |token| {
            matches!(
                token,
                Semi | Let | Tel | RParen | RBracket | RBrace | RStatic
            )
        };
        here.is_none_or(|here| is_expected && ends(here.token))
    }

    /// Creates the diagnostic for the bracket at token `open`, which is not closed before the syntax error (RPI0004).
    pub(crate) fn unclosed_bracket(&self, open: usize) -> Diagnostic {
        let bracket = self.lexemes[open];
        let close = closing_token(bracket.token).and_then(Token::spelling);
        let span = self.cx.span(bracket.start, bracket.end);
        let here = format!("expected `{}` before this", close.unwrap_or_default());
        Diagnostic::new(
            Code::RPI0004,
            format!("{} is not closed", self.quoted(bracket)),
        )
        .primary(span, "opened here")
        .secondary(self.span_or_end(self.error.index), here)
        .fix(self.insert_close_fix(close.unwrap_or_default()))
    }

    /// Returns the fix that inserts a closing bracket before the rejected token.
    fn insert_close_fix(&self, close: &str) -> Fix {
        let before = self.previous_lexeme().unwrap_or(EMPTY_LEXEME);
        Fix::maybe(format!("insert `{close}`"))
            .insert_after(self.cx.span(before.start, before.end), close)
    }

    fn expected_token(&self) -> Diagnostic {
        let (before, here) = (self.previous_lexeme(), self.rejected_lexeme());
        let what = expected::describe(&self.error.expected, before.map(|lexeme| lexeme.token));
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
        let diagnostic = Diagnostic::new(Code::RPI0001, message)
            .primary(self.span_or_end(self.error.index), found);
        let here = here.map(|lexeme| lexeme.token);
        match expected::help_text(here).or_else(|| self.operand_help(here)) {
            Some(hint) => diagnostic.help(hint),
            None => diagnostic,
        }
    }

    /// Returns advice on an operand or operator that is missing before the rejected token `here`; `None` if none fits.
    fn operand_help(&self, here: Option<Token>) -> Option<&'static str> {
        let expects = |token| self.error.expected.contains(&token);
        let begins_operand = matches!(here, Some(Token::Ident | Token::Int | Token::Real));
        match () {
            () if here == Some(Token::Question) => {
                Some("`?` follows the type of an optional flow, as in `int?`")
            }
            () if expects(Token::Bar) && !expects(Token::Plus) && here == Some(Token::Ident) => {
                Some("write `|` between two alternatives")
            }
            () if expects(Token::Colon) && expects(Token::RParen) && begins_operand => Some(
                "write `,` between two arguments, `:` after the name of a port, or an operator between two operands",
            ),
            () if expects(Token::Plus) && expects(Token::RParen) && begins_operand => {
                Some("write `,` between two arguments, or an operator between two operands")
            }
            () if expects(Token::Plus) && begins_operand => {
                Some("write an operator between two operands")
            }
            () if expects(Token::Plus) && here == Some(Token::If) => Some(
                "a conditional expression begins with `if`: delete the value before it, or write an operator between them",
            ),
            () if expects(Token::Colon) && here == Some(Token::Ident) => {
                Some("write `,` between two names, or `:` between a name and its type")
            }
            () if self.follows_operator() && here.is_some_and(is_binary_operator) => {
                Some("delete one of the two operators, or write a value between them")
            }
            () if expects(Token::Not) && expects(Token::LParen) => {
                Some("write a value here, such as a number or the name of a flow")
            }
            () => None,
        }
    }

    fn follows_operator(&self) -> bool {
        self.previous_lexeme()
            .is_some_and(|before| is_binary_operator(before.token))
    }

    fn previous_lexeme(&self) -> Option<Lexeme> {
        self.error.index.checked_sub(1).map(|i| self.lexemes[i])
    }

    fn rejected_lexeme(&self) -> Option<Lexeme> {
        self.lexemes.get(self.error.index).copied()
    }

    /// Returns the span of the token at index `at`; for an index past the last token, the empty span after the last
    /// token.
    fn span_or_end(&self, at: usize) -> Span {
        match (self.lexemes.get(at), self.lexemes.last()) {
            (Some(lexeme), _) => self.cx.span(lexeme.start, lexeme.end),
            (None, Some(last)) => end_of_span(self.cx.span(last.start, last.end)),
            (None, None) => self.cx.span(0, 0),
        }
    }

    /// Returns the source text of a token in backticks, shortened to 30 characters.
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

/// Adds that a comment hides the missing `;`, and the form of a difference if the comment may be meant as one: `x --1`.
fn with_comment_help(diagnostic: Diagnostic, comment: &str) -> Diagnostic {
    let diagnostic =
        diagnostic.help("the comment extends to the end of its line and contains the `;`");
    let operand = comment
        .strip_prefix("--")
        .and_then(|rest| rest.split(';').next());
    let is_operand = |text: &&str| text.starts_with(|c: char| c.is_alphanumeric() || c == '(');
    match operand.filter(is_operand) {
        Some(operand) => diagnostic.help(format!(
            "`--` begins a comment; two minus signs need a space: `- -{operand}`"
        )),
        None => diagnostic,
    }
}

/// Maximum number of tokens of an equation's left side that are searched for the `=`. Bounds the time per syntax error.
const MAX_TARGET_TOKENS: usize = 40;

/// Returns whether a token is an operator between two operands.
fn is_binary_operator(token: Token) -> bool {
    use Token::{And, Arrow, Div, Fby, Ge, Gt, Le, Lt, Minus, Mod, Ne, Or, Plus, Slash, Star, Xor};
    matches!(
        token,
        And | Arrow
            | Div
            | Fby
            | Ge
            | Gt
            | Le
            | Lt
            | Minus
            | Mod
            | Ne
            | Or
            | Plus
            | Slash
            | Star
            | Xor
    )
}

/// Placeholder for the token before the first token of a declaration.
const EMPTY_LEXEME: Lexeme = Lexeme {
    token: Token::Broken,
    start: 0,
    end: 0,
};

/// Returns the empty span at the end of `span`, for labels and insertions after it.
pub(crate) fn end_of_span(span: Span) -> Span {
    Span {
        start: span.end,
        ..span
    }
}
