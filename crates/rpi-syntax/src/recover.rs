//! Parses one declaration with error recovery: reports a syntax error, repairs the tokens and parses again.
//!
//! There are three kinds of repair. A missing `;` or `tel` is inserted. A phrase with an error is replaced by a
//! [`Token::Broken`]. If the header of a declaration has an error, its body is still parsed for its diagnostics. So
//! every independent error is reported exactly once.

use crate::actions::declarations;
use crate::ast::{DeclaredKind, DeclaredName, Ident, Item, ItemKind};
use crate::context::ParseContext;
use crate::foreign::{self, ForeignSyntax, Repair};
use crate::grammar::ItemParser;
use crate::guessed_declarations;
use crate::lexer::Lexeme;
use crate::reserved_words;
use crate::syntax_errors::{ErrorContext, SyntaxError};
use crate::token::Token;
use crate::token_tree::{TokenTree, closing_token};
use crate::unclosed::{self, find_unclosed_body};
use lalrpop_util::ParseError;
use rpi_diag::Diagnostic;
use std::ops::Range;

/// Parses the tokens of one declaration and appends its diagnostics. Always returns a node, which may be an error node.
pub(crate) fn parse_item(
    cx: &ParseContext<'_>,
    lexemes: &[Lexeme],
    diagnostics: &mut Vec<Diagnostic>,
) -> Item {
    let meant = foreign::remove_initial_values(cx, lexemes, diagnostics);
    let lexemes = meant.as_deref().unwrap_or(lexemes);
    match parse_strict(cx, lexemes) {
        Ok(item) => {
            diagnostics.extend(cx.take_diagnostics());
            item
        }
        Err(fault) => Recovery::new(cx, lexemes, diagnostics).recover_item(fault),
    }
}

/// Creates the error node for a declaration that cannot be parsed, with the names that it seems to declare.
pub(crate) fn broken_item(cx: &ParseContext<'_>, lexemes: &[Lexeme]) -> Item {
    let kind = declared_kind(lexemes);
    let names = guessed_declarations::names_of_item(cx, lexemes);
    let declared = |name: Ident| kind.map(|kind| DeclaredName { kind, name });
    let start = lexemes.first().map_or(0, |lexeme| lexeme.start);
    let end = lexemes.last().map_or(0, |lexeme| lexeme.end);
    let named = names.into_iter().filter_map(declared);
    let kind = ItemKind::Error(
        named
            .chain(guessed_declarations::datatype_constructors(cx, lexemes))
            .collect(),
    );
    declarations::item(cx, start, kind, end)
}

/// Returns the kind of entity that a declaration declares, by its first keyword; `None` if no keyword of a declaration
/// is first.
fn declared_kind(lexemes: &[Lexeme]) -> Option<DeclaredKind> {
    use Token::*;
    Some(match lexemes.first()?.token {
        Const => DeclaredKind::Const,
        Datatype | Type => DeclaredKind::Type,
        Node | Function | Unsafe | Extern | Fragment | Primitive => DeclaredKind::Callable,
        Device => DeclaredKind::Device,
        Frame => DeclaredKind::Frame,
        Command => DeclaredKind::Command,
        Task => DeclaredKind::Task,
        _ => return None,
    })
}

/// Parses the tokens of one declaration with the grammar, without error recovery.
fn parse_strict(cx: &ParseContext<'_>, lexemes: &[Lexeme]) -> Result<Item, SyntaxError> {
    let tokens = lexemes
        .iter()
        .map(|lexeme| (lexeme.start, lexeme.token, lexeme.end));
    let parsed = ItemParser::new().parse(cx, tokens);
    parsed.map_err(|error| {
        cx.take_diagnostics();
        syntax_error(lexemes, error)
    })
}

/// Converts an error of the generated parser into a [`SyntaxError`] with a token index.
fn syntax_error(lexemes: &[Lexeme], error: ParseError<u32, Token, ()>) -> SyntaxError {
    let index = |start: u32, token: Token| {
        let from = lexemes.partition_point(|lexeme| lexeme.start < start);
        let same = lexemes[from..]
            .iter()
            .position(|lexeme| lexeme.token == token);
        same.map_or(lexemes.len(), |offset| from + offset)
    };
    match error {
        ParseError::UnrecognizedToken {
            token: (start, token, _),
            expected,
        } => SyntaxError::new(index(start, token), expected),
        ParseError::ExtraToken {
            token: (start, token, _),
        } => SyntaxError::new(index(start, token), Vec::new()),
        ParseError::UnrecognizedEof { expected, .. } => SyntaxError::new(lexemes.len(), expected),
        ParseError::InvalidToken { .. } | ParseError::User { .. } => {
            SyntaxError::new(lexemes.len(), Vec::new())
        }
    }
}

/// Maximum number of syntax errors from which parsing recovers in one declaration.
const MAX_ERRORS: usize = 200;

/// Maximum number of tokens that are parsed again after repairs, summed over all repairs of one declaration.
const MAX_REPARSED_TOKENS: usize = 1_000_000;

/// State of the error recovery in one declaration: repairs the tokens and parses again after each syntax error.
struct Recovery<'c, 't, 'f> {
    cx: &'c ParseContext<'t>,
    /// Tokens of the declaration as written in the source.
    source_lexemes: &'c [Lexeme],
    /// Tokens of the declaration after the repairs so far.
    lexemes: Vec<Lexeme>,
    diagnostics: &'f mut Vec<Diagnostic>,
    /// Number of tokens that may still be parsed again before recovery stops.
    token_budget: usize,
    /// Token index of the last phrase (statement, declaration or step) that was replaced by an error token; `None`
    /// before the first.
    broken_at: Option<usize>,
    /// Whether a syntax error at the end of the declaration has been reported.
    end_reported: bool,
    /// Reserved words that have been reported because the program uses them as names. Their further uses as names cause
    /// no diagnostics.
    reserved_names: Vec<Token>,
}

impl<'c, 't, 'f> Recovery<'c, 't, 'f> {
    fn new(
        cx: &'c ParseContext<'t>,
        lexemes: &'c [Lexeme],
        diagnostics: &'f mut Vec<Diagnostic>,
    ) -> Recovery<'c, 't, 'f> {
        Recovery {
            cx,
            source_lexemes: lexemes,
            lexemes: lexemes.to_vec(),
            diagnostics,
            token_budget: MAX_REPARSED_TOKENS,
            broken_at: None,
            end_reported: false,
            reserved_names: Vec::new(),
        }
    }

    fn recover_item(mut self, fault: SyntaxError) -> Item {
        match self.repair_all(fault) {
            Some(item) => item,
            None => {
                let broken = broken_item(self.cx, self.source_lexemes);
                self.parse_body();
                broken
            }
        }
    }

    /// Repairs one syntax error after the other until the declaration parses. Returns [`None`] if no repair applies or
    /// a limit is reached.
    fn repair_all(&mut self, mut fault: SyntaxError) -> Option<Item> {
        for _ in 0..MAX_ERRORS {
            if !self.repair(&fault) || !self.cx.may_recover() {
                return None;
            }
            self.token_budget = self.token_budget.checked_sub(self.lexemes.len())?;
            match parse_strict(self.cx, &self.lexemes) {
                Ok(item) => {
                    self.diagnostics.extend(self.cx.take_diagnostics());
                    return Some(item);
                }
                Err(next) => fault = next,
            }
        }
        None
    }

    /// Reports a syntax error and repairs the tokens, so that parsing can be repeated. Returns false if no repair
    /// applies.
    fn repair(&mut self, fault: &SyntaxError) -> bool {
        if let Some(at) =
            reserved_words::find_reported_word(&self.reserved_names, &self.lexemes, fault.index)
        {
            self.lexemes[at].token = Token::Ident;
            return true;
        }
        if self.broken_at.is_some_and(|at| fault.index <= at) {
            return self.remove_enclosing_block();
        }
        let at_end = fault.index == self.lexemes.len();
        if self.lacks_semi_after_error(fault) {
            self.insert(fault.index, Token::Semi);
            return true;
        }
        // An unfinished declaration is one error, however many tokens are missing at its end.
        if at_end && std::mem::replace(&mut self.end_reported, true) {
            return false;
        }
        let structure = TokenTree::new(&self.lexemes);
        let found = ErrorContext {
            cx: self.cx,
            lexemes: &self.lexemes,
            structure: &structure,
            error: fault,
        };
        let phrase = structure.phrase(fault.index);
        if let Some(construct) = foreign::recognise(&found) {
            return self.apply_foreign(construct, phrase);
        }
        let open_let = structure.unclosed_let().filter(|_| at_end);
        if let Some(unclosed) = open_let.and_then(|_| find_unclosed_body(&found)) {
            self.diagnostics
                .push(unclosed::unclosed_body(&found, unclosed));
            self.insert(unclosed.next_index, Token::Tel);
            self.end_reported = false;
            return true;
        }
        if let Some(open) = open_let {
            self.diagnostics.push(found.unclosed_body(open));
            return self.close_bodies();
        }
        if found.lacks_semi() {
            self.diagnostics.push(found.missing_semi());
            self.insert(fault.index, Token::Semi);
            return true;
        }
        if let Some(diagnostic) = found.reserved_as_name() {
            self.diagnostics.push(diagnostic);
            return self.treat_as_name(fault.index);
        }
        self.diagnostics.push(found.unexpected_token());
        self.remove_phrase(phrase)
    }

    /// Replaces the reserved word at token `at` by a name, and records the word so that its further uses as a name are
    /// replaced too. Returns true.
    fn treat_as_name(&mut self, at: usize) -> bool {
        let word = &mut self.lexemes[at].token;
        self.reserved_names.push(*word);
        *word = Token::Ident;
        true
    }

    /// Reports foreign syntax and repairs the tokens. `phrase` is the token range that the default repair removes.
    /// Returns whether parsing can be repeated.
    fn apply_foreign(&mut self, construct: ForeignSyntax, phrase: Range<usize>) -> bool {
        self.diagnostics.push(construct.diagnostic);
        match construct.repair {
            Repair::ReplaceTokens(edits) => {
                for (range, tokens) in edits.into_iter().rev() {
                    self.lexemes.splice(range, tokens);
                }
                true
            }
            Repair::RemovePhrase(phrase, names) => self.remove_phrase_defining(phrase, names),
            Repair::RemoveErrorPhrase => self.remove_phrase(phrase),
            Repair::RemoveItem => false,
        }
    }

    /// Returns whether the syntax error is only a missing `;` after an error token.
    fn lacks_semi_after_error(&self, fault: &SyntaxError) -> bool {
        let before = fault.index.checked_sub(1).map(|i| self.lexemes[i].token);
        before == Some(Token::Broken) && fault.expected.contains(&Token::Semi)
    }

    /// Removes the block that contains the last error token, if the grammar does not accept an error token there.
    /// Returns false if there is no such block.
    fn remove_enclosing_block(&mut self) -> bool {
        let structure = TokenTree::new(&self.lexemes);
        match self.broken_at.and_then(|at| structure.inner_parent(at)) {
            Some(block) => self.remove_phrase(structure.phrase(block)),
            None => false,
        }
    }

    /// Inserts the closing keywords of the bodies that are still open at the end of the declaration. Returns false if
    /// an incomplete phrase before them cannot be removed.
    fn close_bodies(&mut self) -> bool {
        let structure = TokenTree::new(&self.lexemes);
        let cut = structure.incomplete_phrase_start();
        let open = structure.unclosed_blocks().filter(|open| *open < cut);
        let closing = open.filter_map(|open| closing_token(self.lexemes[open].token));
        let closing: Vec<Token> = closing.collect();
        // An unfinished phrase is removed as a whole, so its missing tokens need no repair.
        if cut < self.lexemes.len() && !self.remove_phrase(cut..self.lexemes.len()) {
            return false;
        }
        self.broken_at = None;
        for token in closing.into_iter().rev() {
            self.insert(self.lexemes.len(), token);
        }
        true
    }

    /// Replaces a phrase (token range of a statement, declaration or step) by an error token with the names that it
    /// seems to define. Returns false if there is nothing to replace.
    fn remove_phrase(&mut self, mut phrase: Range<usize>) -> bool {
        // An empty phrase before a `;` has no token to replace; a stray `tel` or `end` is replaced itself.
        let closes = |lexeme: &Lexeme| lexeme.token != Token::Semi;
        if phrase.is_empty() && self.lexemes.get(phrase.start).is_some_and(closes) {
            phrase.end += 1;
        }
        let taken = self.lexemes.get(phrase.clone()).unwrap_or(&[]);
        if let [
            Lexeme {
                token: Token::Broken,
                ..
            },
        ] = taken
        {
            return false;
        }
        let names = guessed_declarations::names_of_phrase(self.cx, taken);
        self.remove_phrase_defining(phrase, names)
    }

    /// Replaces a phrase (token range of a statement, declaration or step) by an error token with the given names.
    /// Returns false if the range begins past the last token.
    fn remove_phrase_defining(&mut self, phrase: Range<usize>, names: Vec<Ident>) -> bool {
        let Some(first) = self.lexemes.get(phrase.start).copied() else {
            return false;
        };
        let taken = &self.lexemes[phrase.clone()];
        let end = taken.last().map_or(first.start, |lexeme| lexeme.end);
        self.cx.set_error_names(first.start, names);
        let broken = Lexeme {
            token: Token::Broken,
            start: first.start,
            end,
        };
        self.broken_at = Some(phrase.start);
        self.lexemes.splice(phrase.clone(), [broken]);
        if self.needs_semi(phrase.start + 1) {
            self.insert(phrase.start + 1, Token::Semi);
        }
        true
    }

    /// Returns whether the grammar needs a `;` after the error token that precedes the index `after`.
    fn needs_semi(&self, after: usize) -> bool {
        match self.lexemes.get(after).map(|lexeme| lexeme.token) {
            Some(Token::Semi) => false,
            Some(Token::Let | Token::Var | Token::Const) => true,
            _ => TokenTree::new(&self.lexemes).is_in_block(after - 1),
        }
    }

    /// Inserts an empty token before index `at`.
    fn insert(&mut self, at: usize, token: Token) {
        let place = at.checked_sub(1).map_or(0, |i| self.lexemes[i].end);
        self.lexemes.insert(at, inserted_token(token, place));
    }

    /// Parses the body of a declaration whose header could not be repaired, only to report the errors in the body.
    fn parse_body(self) {
        let is_let = |lexeme: &Lexeme| lexeme.token == Token::Let;
        let Some(body) = self.source_lexemes.iter().position(is_let) else {
            return;
        };
        let head = match self.source_lexemes[0].token {
            Token::Task => Token::Task,
            _ => Token::Command,
        };
        // A minimal header: the keyword and a name without text. A command accepts every kind of statement.
        let mut lexemes = vec![inserted_token(head, self.source_lexemes[body].start); 2];
        lexemes[1].token = Token::Ident;
        lexemes.extend_from_slice(&self.source_lexemes[body..]);
        match parse_strict(self.cx, &lexemes) {
            Ok(_) => self.diagnostics.extend(self.cx.take_diagnostics()),
            Err(fault) => {
                Recovery::new(self.cx, &lexemes, self.diagnostics).repair_all(fault);
            }
        }
    }
}

/// Creates an empty token at byte offset `place`.
fn inserted_token(token: Token, place: u32) -> Lexeme {
    Lexeme {
        token,
        start: place,
        end: place,
    }
}
