//! Lexer: turns text into tokens. Separates comments, checks numbers and string literals, resolves contextual keywords.

mod marks;
mod numbers;

use crate::comments::{Comment, CommentKind, Comments};
use crate::habits::Becomes;
use crate::seeming::Seeming;
use crate::token::Token;
use crate::{Mode, blocks, habits, lexical, numeral, units, words};
use logos::Logos;
use rpi_diag::{FileId, Finding, Span};
use std::collections::{BTreeMap, BTreeSet};

/// Token with its byte range in the text.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct Lexeme {
    pub(crate) token: Token,
    pub(crate) start: u32,
    pub(crate) end: u32,
}

/// Result of the lexer.
pub(crate) struct Lexed {
    pub(crate) lexemes: Vec<Lexeme>,
    pub(crate) comments: Comments,
    pub(crate) findings: Vec<Finding>,
    /// Spans of comments with contracts and properties, whose content was lexed.
    pub(crate) claims: Vec<Span>,
    /// Replacement text of tokens, by their byte range: `0xFF` for `16#FF`.
    pub(crate) read_as: BTreeMap<(u32, u32), String>,
}

/// Maximum length of a text in bytes. Offsets have 32 bits.
const MAX_LEN: usize = u32::MAX as usize / 2;

/// Lexes a text.
pub(crate) fn lex(file: FileId, text: &str, mode: Mode) -> Lexed {
    lex_skipping(file, text, mode, &BTreeSet::new())
}

/// Lexes a text. Comments that begin at a `skipped` offset stay comments, even if they contain a contract or property.
pub(crate) fn lex_skipping(file: FileId, text: &str, mode: Mode, skipped: &BTreeSet<u32>) -> Lexed {
    let mut lexer = Lexer::new(file, text, mode, skipped);
    if text.len() > MAX_LEN {
        lexer.out.findings.push(lexical::file_too_long(file));
        return lexer.out;
    }
    lexer.stretch(0, text.len());
    lexer.report_unknown();
    words::settle(&mut lexer.out.lexemes, mode);
    words::mark_types(&mut lexer.out.lexemes);
    if mode == Mode::Lustre {
        signs_of_c(&mut lexer);
        words::part_closing(&mut lexer.out.lexemes);
        blocks::mark(text, &mut lexer.out.lexemes);
    }
    lexer.out
}

/// Treats bit operators as Boolean operators in statements that contain comparisons of C, such as `==`.
// In Lustre mode, `&&`, `||` and `!` are bit operators of Kind 2. Next to `==`, the author most likely wrote C.
fn signs_of_c(lexer: &mut Lexer<'_>) {
    use Token::{BitAnd, BitNot, BitOr, Let, Semi, Tel};
    let told = |lexeme: &Lexeme, text: &str| {
        let written = &text[lexeme.start as usize..lexeme.end as usize];
        matches!(written, "==" | "===" | "!=" | "!==")
    };
    let text = lexer.text;
    if !lexer.out.lexemes.iter().any(|lexeme| told(lexeme, text)) {
        return;
    }
    let is_end = |lexeme: &Lexeme| matches!(lexeme.token, Let | Semi | Tel);
    let is_bits = |lexeme: &&mut Lexeme| matches!(lexeme.token, BitAnd | BitNot | BitOr);
    let mut signs = Vec::new();
    for statement in lexer.out.lexemes.split_mut(is_end) {
        if statement.iter().any(|lexeme| told(lexeme, text)) {
            for lexeme in statement.iter_mut().filter(is_bits) {
                let written = &text[lexeme.start as usize..lexeme.end as usize];
                let Some(sign) = habits::sign(written) else {
                    continue;
                };
                let span = Span::new(lexer.file, lexeme.start, lexeme.end);
                signs.push(habits::foreign_sign(span, text, sign));
                lexeme.token = sign.token;
            }
        }
    }
    lexer.out.findings.extend(signs);
}

/// Lazy implication of Kind 2: its right side is evaluated only if the left side holds.
const LAZY_IMPLICATION: &str = "==>";

/// Operator of Kind 2 between an index and its new value, in brackets.
const BECOMES: &str = ":=";

/// Maximum number of tokens that are searched backwards for an open bracket.
const MAX_BACK: usize = 200;

/// Beginning of a contract in a comment.
const CONTRACT: &str = "@contract";

/// Beginning of a property in a comment.
const PROPERTY: &str = "%PROPERTY";

/// State of the lexer.
struct Lexer<'t> {
    file: FileId,
    text: &'t str,
    mode: Mode,
    /// Offsets of comments whose contracts and properties are not lexed.
    skipped: &'t BTreeSet<u32>,
    out: Lexed,
    seeming: Seeming<'t>,
    /// Span of adjacent unknown characters, which are reported together.
    unknown: Option<Span>,
}

impl<'t> Lexer<'t> {
    fn new(file: FileId, text: &'t str, mode: Mode, skipped: &'t BTreeSet<u32>) -> Lexer<'t> {
        let out = Lexed {
            lexemes: Vec::with_capacity(text.len() / 4),
            comments: Comments::default(),
            findings: Vec::new(),
            claims: Vec::new(),
            read_as: BTreeMap::new(),
        };
        Lexer {
            file,
            text,
            mode,
            skipped,
            out,
            seeming: Seeming::new(text),
            unknown: None,
        }
    }

    /// Lexes a byte range of the text.
    fn stretch(&mut self, from: usize, to: usize) {
        let text = &self.text[from..to];
        let mut tokens = Token::lexer(text);
        while let Some(result) = tokens.next() {
            let end = tokens.span().end;
            let pragma = match result {
                Ok(Token::Percent) if self.mode == Mode::Lustre => pragma(tokens.remainder()),
                _ => None,
            };
            let comment = result.is_ok_and(|token| self.begins_comment(token, text, end as u32));
            let more = match result {
                _ if pragma.is_some() => pragma.unwrap_or_default(),
                _ if comment => tokens.remainder().find('\n').unwrap_or(text.len() - end),
                Ok(Token::NumberWord) if numeral::foreign(tokens.slice()).is_none() => {
                    units::rest(tokens.remainder())
                }
                Err(()) if tokens.slice() == "'" => lexical::quoted(tokens.remainder()),
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
                Err(()) => self.unknown(start, end),
            }
        }
    }

    fn token(&mut self, lexeme: Lexeme) {
        use Token::*;
        self.report_unknown();
        match lexeme.token {
            LineComment | BlockComment | OpenComment => self.comment(lexeme),
            SlashComment => self.quotient(lexeme),
            Int | Real => self.number(lexeme),
            IntDotDot => self.int_dot_dot(lexeme),
            NumberWord => self.number_word(lexeme),
            IecLiteral => self.iec_literal(lexeme),
            OpenStr => self.open_str(lexeme),
            Foreign => self.foreign(lexeme),
            BitAnd | BitOr | BitNot if self.mode == Mode::Rpi => self.foreign(lexeme),
            Append if self.mode == Mode::Rpi => self.two_signs(Plus, lexeme),
            TickParen if self.mode == Mode::Lustre => self.push(LParen, lexeme),
            TickParen => {
                self.unknown(lexeme.start, lexeme.start + 1);
                let start = lexeme.start + 1;
                self.token(Lexeme {
                    token: LParen,
                    start,
                    ..lexeme
                });
            }
            Percent if self.mode == Mode::Lustre => self.push(Mod, lexeme),
            Ampersand if self.mode == Mode::Rpi => self.foreign(lexeme),
            Ampersand => self.push(And, lexeme),
            token => self.word_or_sign(token, lexeme),
        }
    }

    fn word_or_sign(&mut self, token: Token, lexeme: Lexeme) {
        let foreign = token.keyword().is_some_and(|word| !word.is_in(self.mode));
        self.push(if foreign { Token::Ident } else { token }, lexeme);
    }

    fn push(&mut self, token: Token, lexeme: Lexeme) {
        self.out.lexemes.push(Lexeme { token, ..lexeme });
    }

    /// Splits `++` into two tokens, where it is not an operator.
    fn two_signs(&mut self, sign: Token, lexeme: Lexeme) {
        let middle = lexeme.start + 1;
        self.push(
            sign,
            Lexeme {
                end: middle,
                ..lexeme
            },
        );
        self.push(
            sign,
            Lexeme {
                start: middle,
                ..lexeme
            },
        );
    }

    /// Reports a foreign operator, such as `==`, and pushes its RPI equivalent.
    fn foreign(&mut self, lexeme: Lexeme) {
        let written = self.slice(lexeme);
        if self.mode == Mode::Lustre && written == LAZY_IMPLICATION {
            return self.push(Token::Implies, lexeme);
        }
        if written == BECOMES {
            return self.becomes(lexeme);
        }
        let Some(sign) = habits::sign(written) else {
            return self.unknown(lexeme.start, lexeme.end);
        };
        let finding = habits::foreign_sign(self.span(lexeme), self.text, sign);
        self.out.findings.push(finding);
        self.push(sign.token, lexeme);
    }

    /// Handles `:=`: an operator of Kind 2 in Lustre files, an error elsewhere.
    fn becomes(&mut self, lexeme: Lexeme) {
        if self.mode == Mode::Lustre && self.is_in_brackets() {
            return self.push(Token::Becomes, lexeme);
        }
        let (finding, token) = habits::becomes(self.span(lexeme), self.text, self.defined());
        self.out.findings.push(finding);
        self.push(token, lexeme);
    }

    /// Returns the construct that a `:=` after the tokens so far belongs to.
    fn defined(&self) -> Becomes {
        use Token::{
            BoolType, Colon, Comma, Dot, Ident, Int, IntType, LBracket, RBracket, RealType,
        };
        use Token::{Const, LParen, Let, Path, RParen, RStatic, Semi, Tel, Var};
        let tokens = self.out.lexemes.iter().rev().take(MAX_BACK);
        let mut tokens = tokens.map(|lexeme| lexeme.token).peekable();
        let is_named =
            tokens.next_if_eq(&Ident).is_some() && matches!(tokens.peek(), Some(LParen | Comma));
        let mut open = 0;
        while let Some(token) = tokens.next() {
            match token {
                RParen => open += 1,
                LParen if open > 0 => open -= 1,
                LParen if is_named && matches!(tokens.peek(), Some(Ident | Path | RStatic)) => {
                    return Becomes::Argument;
                }
                Const | Let | Semi | Tel | Var => return Becomes::Definition,
                BoolType | Colon | Comma | Dot | Ident | Int | IntType | LBracket | Path
                | RBracket | RealType | LParen => {}
                _ if is_named => {}
                _ => return Becomes::Unclear,
            }
        }
        Becomes::Unclear
    }

    /// Returns whether a `[` is open, or another `:=` precedes within the same brackets.
    fn is_in_brackets(&self) -> bool {
        let mut closed = 0u32;
        let before = self.out.lexemes.iter().rev().take(MAX_BACK);
        for lexeme in before {
            match lexeme.token {
                Token::RBracket => closed += 1,
                Token::LBracket | Token::Becomes if closed == 0 => return true,
                Token::LBracket => closed -= 1,
                Token::Let | Token::Tel => return false,
                _ => {}
            }
        }
        false
    }

    fn open_str(&mut self, lexeme: Lexeme) {
        self.out.findings.push(lexical::open_str(self.span(lexeme)));
        self.push(Token::Str, lexeme);
    }

    /// Lexes a contract of Kind 2 in a comment, `(*@contract ... *)`, as `con ... noc`.
    fn contract(&mut self, lexeme: Lexeme) {
        let start = self.claim(lexeme, CONTRACT, Token::Con);
        self.push(Token::Noc, Lexeme { start, ..lexeme });
    }

    /// Lexes a property of Kind 2 in a comment, `--%PROPERTY x;` or `(*%PROPERTY x; *)`, as a statement.
    fn property(&mut self, lexeme: Lexeme) {
        let end = self.claim(lexeme, PROPERTY, Token::Property);
        // Some tools accept a property without `;`.
        if self.out.lexemes.last().map(|last| last.token) != Some(Token::Semi) {
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

    /// Lexes the content of a comment and returns its end. `token` replaces the text up to and including `mark`.
    fn claim(&mut self, lexeme: Lexeme, mark: &str, token: Token) -> u32 {
        let head = self.slice(lexeme).find(mark).unwrap_or_default() + mark.len();
        let inner = lexeme.start + head as u32;
        let close = match lexeme.token {
            Token::BlockComment => lexeme.end - 2,
            _ => lexeme.end,
        };
        self.out.claims.push(self.span(lexeme));
        let end = inner;
        self.push(token, Lexeme { end, ..lexeme });
        self.stretch(inner as usize, close as usize);
        self.report_unknown();
        close
    }

    /// Returns the method that lexes a comment with a contract or property; `None` for other comments.
    fn reader(&self, lexeme: Lexeme, kind: CommentKind) -> Option<fn(&mut Self, Lexeme)> {
        let read = self.mode == Mode::Lustre && !self.skipped.contains(&lexeme.start);
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
        if let Some(read) = self.reader(lexeme, kind) {
            return read(self, lexeme);
        }
        let finding = match lexeme.token {
            Token::OpenComment => Some(lexical::open_comment(span, self.slice(lexeme))),
            Token::SlashComment if self.mode == Mode::Rpi => Some(self.foreign_comment(span, 2)),
            Token::Hash | Token::Percent => Some(self.foreign_comment(span, 1)),
            _ if kind == CommentKind::Contract => Some(lexical::contract_comment(span)),
            _ if kind == CommentKind::Property => Some(lexical::property_comment(span)),
            _ => None,
        };
        self.out.findings.extend(finding);
        self.out.comments.all.push(Comment { kind, span });
    }

    fn unknown(&mut self, start: u32, end: u32) {
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
            self.out.findings.push(lexical::unknown(span, text));
        }
    }

    fn span(&self, lexeme: Lexeme) -> Span {
        Span::new(self.file, lexeme.start, lexeme.end)
    }

    fn slice(&self, lexeme: Lexeme) -> &'t str {
        &self.text[lexeme.start as usize..lexeme.end as usize]
    }
}

/// Returns the length in bytes of the rest of a pragma of Lustre V6, `%ASSUME:name%`, after its first `%`.
// Pragmas are for the tools of Lustre V6. Other tools treat them as comments.
fn pragma(rest: &str) -> Option<usize> {
    let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let word = rest.find(|c| !is_word(c)).filter(|word| *word > 0)?;
    let text = rest[word..].strip_prefix(':')?;
    let end = text.find(['%', ';', '\n'])?;
    text[end..].starts_with('%').then_some(word + 1 + end + 1)
}

/// Classifies a comment by its beginning.
fn comment_kind(text: &str) -> CommentKind {
    match text.get(2..) {
        Some(rest) if rest.starts_with(PROPERTY) => CommentKind::Property,
        Some(rest) if text.starts_with("--") => match rest.bytes().next() {
            Some(b'|') => CommentKind::Doc,
            Some(b'%') => CommentKind::Pragma,
            _ => CommentKind::Line,
        },
        Some(rest) if rest.trim_start().starts_with(CONTRACT) => CommentKind::Contract,
        _ if text.starts_with(['#', '%']) || text.starts_with("//") => CommentKind::Line,
        _ => CommentKind::Block,
    }
}
