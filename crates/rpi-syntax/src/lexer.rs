//! Lexer: turns text into tokens. Separates comments, checks numbers and string literals, resolves contextual keywords.

mod comment_marks;
mod error;
mod numbers;
mod operators;

pub(crate) use self::error::{LexicalError, LexicalErrorKind};

use crate::comments::{Comment, CommentKind, Comments};
use crate::guessed_names::GuessedNames;
use crate::token::Token;
use crate::{
    Dialect, closing_brackets, foreign_literal, keywords, kind2_blocks, lexical_errors, unit_suffix,
};
use logos::Logos;
use rpi_diag::{Diagnostic, FileId, Span};
use std::collections::{BTreeMap, BTreeSet};

/// Token with its byte range in the source text.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct Lexeme {
    pub(crate) token: Token,
    pub(crate) start: u32,
    pub(crate) end: u32,
}

/// Result of the lexer: tokens, comments and errors of a text.
pub(crate) struct LexOutput {
    pub(crate) lexemes: Vec<Lexeme>,
    pub(crate) comments: Comments,
    pub(crate) errors: Vec<LexicalError>,
    /// Spans of the comments that contain a contract or property, whose content was read as tokens.
    pub(crate) lexed_comments: Vec<Span>,
    /// Texts that replace the source text of tokens, by the byte range of the token: `0xFF` for `16#FF`.
    pub(crate) replaced_text: BTreeMap<(u32, u32), String>,
}

/// Maximum length of a source text in bytes. Offsets have 32 bits.
const MAX_LEN: usize = u32::MAX as usize / 2;

/// Splits a source text into tokens and comments.
pub(crate) fn lex(file: FileId, text: &str, mode: Dialect) -> LexOutput {
    lex_skipping(file, text, mode, &BTreeSet::new(), &GuessedNames::new(text))
}

/// Splits a source text into tokens and comments. A comment that begins at one of the byte offsets `skipped` is not
/// read as tokens, even if it contains a contract or property. `guessed_names` are those of the whole file, of which `text`
/// may be a part.
pub(crate) fn lex_skipping(
    file: FileId,
    text: &str,
    mode: Dialect,
    skipped: &BTreeSet<u32>,
    guessed_names: &GuessedNames<'_>,
) -> LexOutput {
    let mut lexer = Lexer::new(file, text, mode, (skipped, guessed_names));
    if text.len() > MAX_LEN {
        lexer.report(
            LexicalErrorKind::Other,
            lexical_errors::file_too_large(file),
        );
        return lexer.output;
    }
    lexer.lex_range(0, text.len());
    lexer.report_unknown();
    keywords::resolve_keywords(&mut lexer.output.lexemes, mode);
    keywords::insert_type_keywords(&mut lexer.output.lexemes);
    if mode == Dialect::Lustre {
        operators::convert_c_operators(&mut lexer);
        closing_brackets::split_closing(&mut lexer.output.lexemes);
        kind2_blocks::mark_blocks(text, &mut lexer.output.lexemes);
    }
    lexer.output
}

/// Start of a comment with a contract, after the comment marker.
const CONTRACT_MARK: &str = "@contract";

/// Start of a comment with a property, after the comment marker.
const PROPERTY_MARK: &str = "%PROPERTY";

/// State of the lexer: the source text and the result so far.
struct Lexer<'t> {
    file: FileId,
    text: &'t str,
    mode: Dialect,
    /// Byte offsets of the comments whose contracts and properties are not read as tokens.
    skipped_claims: &'t BTreeSet<u32>,
    output: LexOutput,
    guessed_names: &'t GuessedNames<'t>,
    /// Span of the adjacent unknown characters read so far, which are reported together; `None` if the last character
    /// was known.
    unknown: Option<Span>,
}

impl<'t> Lexer<'t> {
    fn new(
        file: FileId,
        text: &'t str,
        mode: Dialect,
        (skipped, guessed_names): (&'t BTreeSet<u32>, &'t GuessedNames<'t>),
    ) -> Lexer<'t> {
        let out = LexOutput {
            lexemes: Vec::with_capacity(text.len() / 4),
            comments: Comments::default(),
            errors: Vec::new(),
            lexed_comments: Vec::new(),
            replaced_text: BTreeMap::new(),
        };
        Lexer {
            file,
            text,
            mode,
            skipped_claims: skipped,
            output: out,
            guessed_names,
            unknown: None,
        }
    }

    /// Splits the bytes `from..to` of the text into tokens and comments.
    fn lex_range(&mut self, from: usize, to: usize) {
        let text = &self.text[from..to];
        let mut tokens = Token::lexer(text);
        while let Some(result) = tokens.next() {
            let end = tokens.span().end;
            let pragma = match result {
                Ok(Token::Percent) if self.mode == Dialect::Lustre => pragma(tokens.remainder()),
                _ => None,
            };
            let comment = result.is_ok_and(|token| self.begins_comment(token, text, end as u32));
            let more = match result {
                _ if pragma.is_some() => pragma.unwrap_or_default(),
                _ if comment => tokens.remainder().find('\n').unwrap_or(text.len() - end),
                Ok(Token::NumberWord)
                    if foreign_literal::convert_number(tokens.slice()).is_none() =>
                {
                    unit_suffix::unit_rest_len(tokens.remainder())
                }
                Err(()) if tokens.slice() == "'" => {
                    lexical_errors::single_quoted_len(tokens.remainder())
                }
                _ => 0,
            };
            tokens.bump(more);
            let [start, end] =
                [tokens.span().start, tokens.span().end].map(|at| (from + at) as u32);
            match result {
                Ok(_) if pragma.is_some() => self.comment(Lexeme {
                    token: Token::BlockComment,
                    start,
                    end,
                }),
                Ok(token) if comment => self.comment(Lexeme { token, start, end }),
                Ok(token) => self.token(Lexeme { token, start, end }),
                Err(()) => self.unknown_chars(start, end),
            }
        }
    }

    fn token(&mut self, lexeme: Lexeme) {
        use Token::*;
        self.report_unknown();
        match lexeme.token {
            LineComment | BlockComment | OpenComment => self.comment(lexeme),
            SlashComment => self.slash_division(lexeme),
            Int | Real => self.number(lexeme),
            IntDotDot => self.int_dot_dot(lexeme),
            NumberWord => self.number_with_suffix(lexeme),
            IecLiteral => self.iec_literal(lexeme),
            OpenStr => self.unterminated_string(lexeme),
            Foreign => self.foreign_operator(lexeme),
            BitAnd | BitOr | BitNot if self.mode == Dialect::Rpi => self.foreign_operator(lexeme),
            Append if self.mode == Dialect::Rpi => self.split_operator(Plus, lexeme),
            TickParen if self.mode == Dialect::Lustre => self.push(LParen, lexeme),
            TickParen => self.stray_tick(lexeme),
            Percent if self.mode == Dialect::Lustre => self.push(Mod, lexeme),
            Ampersand if self.mode == Dialect::Rpi => self.foreign_operator(lexeme),
            Ampersand => self.push(And, lexeme),
            token => self.push_keyword_or_symbol(token, lexeme),
        }
    }

    /// Reports the tick of `'(`, which begins an expression only in Lustre files, and continues with the parenthesis as
    /// a token.
    fn stray_tick(&mut self, lexeme: Lexeme) {
        let start = lexeme.start + 1;
        self.unknown_chars(lexeme.start, start);
        self.token(Lexeme {
            token: Token::LParen,
            start,
            ..lexeme
        });
    }

    fn push_keyword_or_symbol(&mut self, token: Token, lexeme: Lexeme) {
        let foreign = token.keyword().is_some_and(|word| !word.is_in(self.mode));
        self.push(if foreign { Token::Ident } else { token }, lexeme);
    }

    fn push(&mut self, token: Token, lexeme: Lexeme) {
        self.output.lexemes.push(Lexeme { token, ..lexeme });
    }

    fn unterminated_string(&mut self, lexeme: Lexeme) {
        self.report(
            LexicalErrorKind::Unclosed,
            lexical_errors::unterminated_string(self.span(lexeme)),
        );
        self.push(Token::Str, lexeme);
    }

    /// Reads a comment with a contract of Kind 2, `(*@contract ... *)`, as the tokens of `con ... noc`.
    fn contract(&mut self, lexeme: Lexeme) {
        let start = self.lex_claim(lexeme, CONTRACT_MARK, Token::Con);
        self.push(Token::Noc, Lexeme { start, ..lexeme });
    }

    /// Reads a comment with a property of Kind 2, `--%PROPERTY x;` or `(*%PROPERTY x; *)`, as the tokens of a
    /// statement.
    fn property(&mut self, lexeme: Lexeme) {
        let end = self.lex_claim(lexeme, PROPERTY_MARK, Token::Property);
        // Some tools accept a property without `;`.
        if self.output.lexemes.last().map(|last| last.token) != Some(Token::Semi) {
            let start = end;
            self.push(
                Token::Semi,
                Lexeme {
                    start,
                    end,
                    ..lexeme
                },
            );
        }
    }

    /// Reads the content of a comment as tokens and returns the byte offset of its end. `token` replaces the text up to
    /// the end of `mark`, which is `@contract` or `%PROPERTY`.
    fn lex_claim(&mut self, lexeme: Lexeme, mark: &str, token: Token) -> u32 {
        let head = self.slice(lexeme).find(mark).unwrap_or_default() + mark.len();
        let inner = lexeme.start + head as u32;
        let close = match lexeme.token {
            Token::BlockComment => lexeme.end - 2,
            _ => lexeme.end,
        };
        self.output.lexed_comments.push(self.span(lexeme));
        let end = inner;
        self.push(token, Lexeme { end, ..lexeme });
        self.lex_range(inner as usize, close as usize);
        self.report_unknown();
        close
    }

    /// Returns the method that reads a comment with a contract or property as tokens; `None` for other comments.
    fn claim_lexer(&self, lexeme: Lexeme, kind: CommentKind) -> Option<fn(&mut Self, Lexeme)> {
        let read = self.mode == Dialect::Lustre && !self.skipped_claims.contains(&lexeme.start);
        let whole = lexeme.token != Token::OpenComment;
        match kind {
            CommentKind::Contract if read && lexeme.token == Token::BlockComment => {
                Some(Self::contract)
            }
            CommentKind::Property if read && whole => Some(Self::property),
            _ => None,
        }
    }

    fn comment(&mut self, lexeme: Lexeme) {
        let span = self.span(lexeme);
        let kind = comment_kind(self.slice(lexeme));
        if let Some(read) = self.claim_lexer(lexeme, kind) {
            return read(self, lexeme);
        }
        use LexicalErrorKind::{ForeignSyntax, Other, Unclosed};
        match lexeme.token {
            Token::OpenComment => {
                let text = self.slice(lexeme);
                self.report(Unclosed, lexical_errors::unterminated_comment(span, text));
            }
            Token::SlashComment if self.mode == Dialect::Rpi => {
                self.report(ForeignSyntax, self.foreign_comment(span, 2));
            }
            Token::Hash | Token::Percent => {
                self.report(ForeignSyntax, self.foreign_comment(span, 1));
            }
            _ if kind == CommentKind::Contract => {
                self.report(Other, lexical_errors::unsupported_contract(span, self.mode));
            }
            _ if kind == CommentKind::Property => {
                self.report(Other, lexical_errors::unsupported_property(span, self.mode));
            }
            _ => {}
        }
        self.output.comments.all.push(Comment { kind, span });
    }

    fn unknown_chars(&mut self, start: u32, end: u32) {
        let span = Span::new(self.file, start, end);
        let adjacent = self.unknown.is_some_and(|before| before.end == start);
        if !adjacent {
            self.report_unknown();
        }
        self.unknown = Some(self.unknown.map_or(span, |before| before.merge(span)));
    }

    fn report_unknown(&mut self) {
        if let Some(span) = self.unknown.take() {
            let text = &self.text[span.start as usize..span.end as usize];
            self.report(
                LexicalErrorKind::UnknownChars,
                lexical_errors::unknown_chars(span, text),
            );
        }
    }

    fn report(&mut self, kind: LexicalErrorKind, diagnostic: Diagnostic) {
        self.output.errors.push(LexicalError { kind, diagnostic });
    }

    fn span(&self, lexeme: Lexeme) -> Span {
        Span::new(self.file, lexeme.start, lexeme.end)
    }

    fn slice(&self, lexeme: Lexeme) -> &'t str {
        &self.text[lexeme.start as usize..lexeme.end as usize]
    }
}

/// Returns the length in bytes of the rest of a Lustre V6 pragma such as `%ASSUME:name%` after its first `%`; `None` if
/// `rest` does not continue a pragma.
// Pragmas are for the tools of Lustre V6. Other tools treat them as comments.
fn pragma(rest: &str) -> Option<usize> {
    let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let word = rest.find(|c| !is_word(c)).filter(|word| *word > 0)?;
    let text = rest[word..].strip_prefix(':')?;
    let end = text.find(['%', ';', '\n'])?;
    text[end..].starts_with('%').then_some(word + 1 + end + 1)
}

/// Returns the kind of a comment by its first characters.
fn comment_kind(text: &str) -> CommentKind {
    match text.get(2..) {
        Some(rest) if rest.starts_with(PROPERTY_MARK) => CommentKind::Property,
        Some(rest) if text.starts_with("--") => match rest.bytes().next() {
            Some(b'|') => CommentKind::Doc,
            Some(b'%') => CommentKind::Pragma,
            _ => CommentKind::Line,
        },
        Some(rest) if rest.trim_start().starts_with(CONTRACT_MARK) => CommentKind::Contract,
        _ if text.starts_with(['#', '%']) || text.starts_with("//") => CommentKind::Line,
        _ => CommentKind::Block,
    }
}
