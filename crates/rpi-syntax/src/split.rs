//! Splits the tokens of a file into top-level declarations, so that an error in one does not affect the next.
//!
//! A declaration begins at its keyword where no body or bracket is open. A keyword of a declaration that is never
//! nested begins one even if a `tel` or closing bracket is missing before it.

use crate::Dialect;
use crate::lexer::Lexeme;
use crate::stray_tokens::{corresponding_keyword, is_type_without_keyword};
use crate::token::{KEYWORDS, Keyword, KeywordContext, Token};
use rpi_diag::suggest;
use std::ops::Range;

/// Range of tokens that is parsed as one declaration, or reported as text outside of declarations.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Chunk {
    /// Range of token indices that the chunk covers.
    pub(crate) range: Range<usize>,
    /// Classification of the first token of the chunk.
    pub(crate) kind: ChunkKind,
    /// Whether the declaration of the chunk is complete: its body and brackets are closed, and it ends with `tel` or `;`.
    pub(crate) is_closed: bool,
}

/// Class of a [`Chunk`], by its first token.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum ChunkKind {
    /// The first token is the keyword of a declaration.
    Declaration,
    /// The first token is a name in the place of a keyword, with the keyword that it resembles, if any.
    Misspelt(Option<Token>),
    /// The first token begins a package or model of Lustre V6. The chunk extends to the end of the file.
    Package,
    /// The first token is any other one, with which no declaration begins.
    Stray,
}

/// Splits the tokens of a file into chunks. Every token is in exactly one chunk.
pub(crate) fn split(text: &str, lexemes: &[Lexeme], mode: Dialect) -> Vec<Chunk> {
    let mut splitter = Splitter {
        text,
        lexemes,
        dialect: mode,
        chunks: Vec::new(),
        open_lets: 0,
        open_brackets: 0,
        open_statics: 0,
        in_contract: false,
        is_complete: true,
    };
    for at in 0..lexemes.len() {
        splitter.push_token(at);
    }
    splitter.chunks
}

struct Splitter<'t> {
    text: &'t str,
    lexemes: &'t [Lexeme],
    dialect: Dialect,
    chunks: Vec<Chunk>,
    /// Number of `let` in the current chunk whose `tel` has not been read.
    open_lets: u32,
    /// Number of brackets that are open in the current header or body, including `<<`.
    open_brackets: u32,
    /// Number of `<<` among the open brackets.
    open_statics: u32,
    /// Whether a contract is open: its `con` has been read, but not its `noc`.
    in_contract: bool,
    /// Whether the body of the current chunk is closed, or there is no chunk yet.
    is_complete: bool,
}

impl Splitter<'_> {
    fn push_token(&mut self, at: usize) {
        match self.chunk_kind(at) {
            Some(head) => self.begin_chunk(at, head),
            None => self.extend_chunk(at),
        }
        self.count_open(at);
        let is_closed = self.is_closed(at);
        if let Some(chunk) = self.chunks.last_mut() {
            chunk.is_closed = is_closed;
        }
    }

    /// Returns whether the declaration of the current chunk is complete after token `at`.
    fn is_closed(&self, at: usize) -> bool {
        let last = self.lexemes[at].token;
        let is_whole = self.is_complete && matches!(last, Token::Tel | Token::Semi);
        let declares = (self.chunks.last()).is_some_and(|one| one.kind == ChunkKind::Declaration);
        (is_whole || self.may_have_ended(Some(last)))
            && declares
            && self.open_lets == 0
            && self.open_statics == 0
            && !self.in_contract
    }

    /// Returns the class of the chunk that begins at token `at`; `None` if the token continues the current chunk.
    fn chunk_kind(&self, at: usize) -> Option<ChunkKind> {
        if self.in_package() {
            return None;
        }
        if self.begins_declaration(at) {
            return Some(ChunkKind::Declaration);
        }
        if self.begins_package(at) {
            return Some(ChunkKind::Package);
        }
        if self.begins_unknown_declaration(at) || self.is_unresolved_keyword(at) {
            return Some(ChunkKind::Misspelt(self.intended_keyword(at)));
        }
        if self.may_have_ended(at.checked_sub(1).and_then(|i| self.token_at(i)))
            && is_type_without_keyword(&self.lexemes[at..])
        {
            return Some(ChunkKind::Stray);
        }
        let closes = matches!(self.token_at(at), Some(Token::Semi | Token::Dot));
        (self.is_complete && (self.chunks.is_empty() || !closes)).then_some(ChunkKind::Stray)
    }

    fn begin_chunk(&mut self, at: usize, head: ChunkKind) {
        // Adjacent tokens outside of declarations form one chunk, so that they cause one error.
        let outside =
            |head: &ChunkKind| matches!(head, ChunkKind::Stray | ChunkKind::Misspelt(None));
        let joins = head == ChunkKind::Stray && !is_type_without_keyword(&self.lexemes[at..]);
        if joins && self.chunks.last().is_some_and(|chunk| outside(&chunk.kind)) {
            return self.extend_chunk(at);
        }
        self.is_complete = outside(&head);
        (self.open_lets, self.open_brackets, self.open_statics) = (0, 0, 0);
        self.in_contract = false;
        let range = at..at + 1;
        self.chunks.push(Chunk {
            range,
            kind: head,
            is_closed: false,
        });
    }

    fn in_package(&self) -> bool {
        self.chunks
            .last()
            .is_some_and(|chunk| chunk.kind == ChunkKind::Package)
    }

    fn begins_package(&self, at: usize) -> bool {
        let word = self.is_complete
            && self.dialect == Dialect::Lustre
            && self.token_at(at) == Some(Token::Ident);
        word && matches!(self.source_text(at), "package" | "model")
    }

    fn extend_chunk(&mut self, at: usize) {
        if let Some(chunk) = self.chunks.last_mut() {
            chunk.range.end = at + 1;
        }
    }

    /// Updates the counts of open bodies and brackets for the token at index `at`.
    fn count_open(&mut self, at: usize) {
        use Token::{
            Con, LBrace, LBracket, LParen, LStatic, Let, Noc, RBrace, RBracket, RParen, RStatic,
            Tel,
        };
        match self.lexemes[at].token {
            Con | Noc => self.in_contract = self.lexemes[at].token == Con,
            Let => {
                (self.open_lets, self.open_brackets, self.open_statics) =
                    (self.open_lets + 1, 0, 0);
                self.in_contract = false;
            }
            Tel => {
                self.is_complete |= self.open_lets <= 1;
                (self.open_lets, self.open_brackets) = (self.open_lets.saturating_sub(1), 0);
                self.open_statics = 0;
            }
            LStatic => {
                (self.open_brackets, self.open_statics) =
                    (self.open_brackets + 1, self.open_statics + 1)
            }
            RStatic if self.open_statics > 0 => {
                (self.open_brackets, self.open_statics) =
                    (self.open_brackets.saturating_sub(1), self.open_statics - 1);
            }
            LParen | LBracket | LBrace => self.open_brackets += 1,
            RParen | RBracket | RBrace | RStatic => {
                self.open_brackets = self.open_brackets.saturating_sub(1)
            }
            _ => {}
        }
    }

    fn begins_declaration(&self, at: usize) -> bool {
        let token = self.lexemes[at].token;
        let outside = self.open_brackets == 0 || self.begins_line(at);
        begins_declaration(token)
            && outside
            && !self.begins_static_param(at)
            && !self.follows_modifier(at)
            && !self.is_used_as_name(at)
            && match token {
                // Inside a body, `fragment` begins a local fragment.
                Token::Fragment => self.open_lets == 0,
                Token::Const => self.open_lets == 0 && !self.is_local_const(at),
                _ => true,
            }
    }

    /// Returns whether the keyword at token `at` is used as a name: `var node: int`, `y = type + 1`.
    fn is_used_as_name(&self, at: usize) -> bool {
        let next = self.token_at(at + 1);
        !self.is_complete && next.is_some_and(follows_name)
    }

    /// Returns whether the keyword at token `at` begins a static parameter or argument:
    /// `<<const n: int; node f (...) returns (...)>>`.
    fn begins_static_param(&self, at: usize) -> bool {
        use Token::{Comma, LStatic, Semi};
        let before = at.checked_sub(1).and_then(|i| self.token_at(i));
        self.open_statics > 0 && matches!(before, Some(LStatic | Comma | Semi))
    }

    /// Returns whether the token at index `at` follows a modifier: `unsafe`, `extern`, `opaque` or `transparent`.
    fn follows_modifier(&self, at: usize) -> bool {
        let before = at.checked_sub(1).and_then(|i| self.token_at(i));
        matches!(
            before,
            Some(Token::Unsafe | Token::Extern | Token::Opaque | Token::Transparent)
        )
    }

    /// Returns whether the `const` at token `at` declares a local constant in the header of the current declaration.
    fn is_local_const(&self, at: usize) -> bool {
        let chunk = self.chunks.last().filter(|_| !self.is_complete);
        let head = chunk.and_then(|chunk| self.token_at(chunk.range.start));
        if !head.is_some_and(takes_locals) {
            return false;
        }
        let mut next = self.lexemes[at..].iter().map(|lexeme| lexeme.token);
        let ends = |token: &Token| *token == Token::Let || begins_declaration(*token);
        let first = next.find(|token| *token != Token::Const && ends(token));
        self.in_contract || !self.begins_line(at) || first == Some(Token::Let)
    }

    /// Returns whether token `at` and the next one are two names with which a declaration begins whose keyword is
    /// misspelt or from another language: `comand MoveToC`.
    fn begins_unknown_declaration(&self, at: usize) -> bool {
        use Token::{Dot, Ident, Path, Semi, Str, Tel};
        let before = at.checked_sub(1).and_then(|i| self.token_at(i));
        let ends = matches!(before, None | Some(Semi | Tel | Dot | Str)) || self.begins_line(at);
        let is_foreign =
            self.begins_line(at) && corresponding_keyword(self.source_text(at)).is_some();
        ends && (self.is_complete || is_foreign || self.may_have_ended(before))
            && self.token_at(at) == Some(Ident)
            && matches!(self.token_at(at + 1), Some(Ident | Path | Str))
    }

    /// Returns whether the current declaration may end before the current token: it has no body, and `before` is its
    /// `;`.
    fn may_have_ended(&self, before: Option<Token>) -> bool {
        use Token::{Const, Frame, Include, Primitive, Type, Use};
        let head = self
            .chunks
            .last()
            .and_then(|chunk| self.token_at(chunk.range.start));
        let flat = matches!(head, Some(Const | Frame | Include | Primitive | Type | Use));
        flat && self.open_brackets == 0 && before == Some(Token::Semi)
    }

    /// Returns whether token `at` is a declaration keyword that was taken for a name because no name follows:
    /// `command (arm: Arm)`.
    fn is_unresolved_keyword(&self, at: usize) -> bool {
        let is_name = self.is_complete && self.token_at(at) == Some(Token::Ident);
        is_name
            && self
                .declaration_keywords()
                .any(|word| word.text == self.source_text(at))
    }

    /// Returns the declaration keyword that the name at token `at` is or resembles; `None` if there is none.
    fn intended_keyword(&self, at: usize) -> Option<Token> {
        let texts = self.declaration_keywords().map(|word| word.text);
        let written = self.source_text(at);
        let meant = match self.declaration_keywords().any(|word| word.text == written) {
            true => written.to_owned(),
            false => match corresponding_keyword(written) {
                Some(meant) => return Some(meant),
                None => suggest(written, texts)?,
            },
        };
        self.declaration_keywords()
            .find(|word| word.text == meant)
            .map(|word| word.token)
    }

    /// Returns the keywords that begin declarations in the dialect of the file.
    fn declaration_keywords(&self) -> impl Iterator<Item = &'static Keyword> {
        let mode = self.dialect;
        KEYWORDS
            .iter()
            .filter(move |word| begins_declaration(word.token) && word.is_in(mode))
    }

    fn source_text(&self, at: usize) -> &str {
        let Lexeme { start, end, .. } = self.lexemes[at];
        &self.text[start as usize..end as usize]
    }

    fn begins_line(&self, at: usize) -> bool {
        let start = self.lexemes[at].start as usize;
        start == 0 || self.text.as_bytes()[start - 1] == b'\n'
    }

    fn token_at(&self, at: usize) -> Option<Token> {
        self.lexemes.get(at).map(|lexeme| lexeme.token)
    }
}

/// Returns whether the token is a keyword with which declarations begin.
pub(crate) fn begins_declaration(token: Token) -> bool {
    use Token::{Const, Extern, Function, Include, Node, Type, Unsafe};
    match token.keyword() {
        Some(word) => {
            word.context == KeywordContext::Declaration
                || matches!(
                    token,
                    Const | Extern | Function | Include | Node | Type | Unsafe
                )
        }
        None => false,
    }
}

/// Returns whether the token may follow a name but never a declaration keyword.
pub(crate) fn follows_name(token: Token) -> bool {
    use Token::{
        And, Arrow, Colon, Comma, Dot, Else, Eq, Ge, Gt, Le, Lt, Minus, Ne, Or, Plus, RBracket,
        RParen, Semi, Slash, Star, Then,
    };
    matches!(
        token,
        And | Arrow
            | Colon
            | Comma
            | Dot
            | Else
            | Eq
            | Ge
            | Gt
            | Le
            | Lt
            | Minus
            | Ne
            | Or
            | Plus
            | RBracket
            | RParen
            | Semi
            | Slash
            | Star
            | Then
    )
}

/// Returns whether a declaration that begins with this keyword may have local declarations before its `let`.
fn takes_locals(head: Token) -> bool {
    use Token::{Command, Fragment, Function, Node, Opaque, Test, Transparent, Unsafe};
    matches!(
        head,
        Command | Fragment | Function | Node | Opaque | Test | Transparent | Unsafe
    )
}
