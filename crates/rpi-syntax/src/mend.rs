//! Parses one declaration with error recovery: reports a syntax error, repairs the tokens and parses again.
//!
//! There are three kinds of repair. A missing `;` or `tel` is inserted. A phrase with an error is replaced by a
//! [`Token::Broken`]. If the header of a declaration has an error, its body is still parsed for its diagnostics. So
//! every independent error is reported exactly once.

use crate::ast::{Declared, DeclaredKind, Ident, Item, ItemKind};
use crate::context::Context;
use crate::declared;
use crate::explain::{Fault, Found};
use crate::grammar::ItemParser;
use crate::habits::{self, Habit, Mend};
use crate::lexer::Lexeme;
use crate::reserved;
use crate::structure::{Structure, closing};
use crate::token::Token;
use crate::unclosed::{self, unclosed};
use lalrpop_util::ParseError;
use rpi_diag::Finding;
use std::ops::Range;

/// Parses the tokens of one declaration and appends its diagnostics.
pub(crate) fn item(cx: &Context<'_>, lexemes: &[Lexeme], findings: &mut Vec<Finding>) -> Item {
    let meant = habits::without_first_values(cx, lexemes, findings);
    let lexemes = meant.as_deref().unwrap_or(lexemes);
    match attempt(cx, lexemes) {
        Ok(item) => {
            findings.extend(cx.take_findings());
            item
        }
        Err(fault) => Mender::new(cx, lexemes, findings).item(fault),
    }
}

/// Creates the error node of a declaration, with the names that it seems to declare.
pub(crate) fn broken_item(cx: &Context<'_>, lexemes: &[Lexeme]) -> Item {
    let kind = declared_kind(lexemes);
    let names = declared::by_item(cx, lexemes);
    let declared = |name: Ident| kind.map(|kind| Declared { kind, name });
    let start = lexemes.first().map_or(0, |lexeme| lexeme.start);
    let end = lexemes.last().map_or(0, |lexeme| lexeme.end);
    let named = names.into_iter().filter_map(declared);
    let kind = ItemKind::Broken(named.chain(declared::alternatives(cx, lexemes)).collect());
    cx.item(start, kind, end)
}

/// Returns the kind of declaration from its first keyword.
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

/// Parses the tokens with the grammar, without recovery.
fn attempt(cx: &Context<'_>, lexemes: &[Lexeme]) -> Result<Item, Fault> {
    let tokens = lexemes
        .iter()
        .map(|lexeme| (lexeme.start, lexeme.token, lexeme.end));
    let parsed = ItemParser::new().parse(cx, tokens);
    parsed.map_err(|error| {
        cx.take_findings();
        fault(lexemes, error)
    })
}

/// Converts an error of the parser generator into a [`Fault`] with a token index.
fn fault(lexemes: &[Lexeme], error: ParseError<u32, Token, ()>) -> Fault {
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
        } => Fault::new(index(start, token), expected),
        ParseError::ExtraToken {
            token: (start, token, _),
        } => Fault::new(index(start, token), Vec::new()),
        ParseError::UnrecognizedEof { expected, .. } => Fault::new(lexemes.len(), expected),
        ParseError::InvalidToken { .. } | ParseError::User { .. } => {
            Fault::new(lexemes.len(), Vec::new())
        }
    }
}

/// Maximum number of syntax errors that are repaired in one declaration.
const MAX_FAULTS: usize = 200;

/// Maximum number of tokens that are parsed again after repairs, summed over one declaration.
const PATIENCE: usize = 1_000_000;

/// Error recovery of one declaration.
struct Mender<'c, 't, 'f> {
    cx: &'c Context<'t>,
    /// Tokens as written.
    original: &'c [Lexeme],
    /// Tokens after the repairs so far.
    lexemes: Vec<Lexeme>,
    findings: &'f mut Vec<Finding>,
    /// Number of tokens that may still be parsed again.
    patience: usize,
    /// Index of the last phrase that was replaced by an error token.
    broken_at: Option<usize>,
    /// Whether an error at the end of the declaration has been reported.
    ended: bool,
    /// Reserved words that have been reported as used for names.
    reserved: Vec<Token>,
}

impl<'c, 't, 'f> Mender<'c, 't, 'f> {
    fn new(
        cx: &'c Context<'t>,
        lexemes: &'c [Lexeme],
        findings: &'f mut Vec<Finding>,
    ) -> Mender<'c, 't, 'f> {
        Mender {
            cx,
            original: lexemes,
            lexemes: lexemes.to_vec(),
            findings,
            patience: PATIENCE,
            broken_at: None,
            ended: false,
            reserved: Vec::new(),
        }
    }

    fn item(mut self, fault: Fault) -> Item {
        match self.mend_all(fault) {
            Some(item) => item,
            None => {
                let broken = broken_item(self.cx, self.original);
                self.read_body();
                broken
            }
        }
    }

    /// Repairs one error after the other until the declaration parses. Returns [`None`] if no repair applies.
    fn mend_all(&mut self, mut fault: Fault) -> Option<Item> {
        for _ in 0..MAX_FAULTS {
            if !self.mend(&fault) || !self.cx.may_mend() {
                return None;
            }
            self.patience = self.patience.checked_sub(self.lexemes.len())?;
            match attempt(self.cx, &self.lexemes) {
                Ok(item) => {
                    self.findings.extend(self.cx.take_findings());
                    return Some(item);
                }
                Err(next) => fault = next,
            }
        }
        None
    }

    /// Reports the error and repairs the tokens. Returns false if no repair applies.
    fn mend(&mut self, fault: &Fault) -> bool {
        if let Some(at) = reserved::again(&self.reserved, &self.lexemes, fault.at) {
            self.lexemes[at].token = Token::Ident;
            return true;
        }
        if self.broken_at.is_some_and(|at| fault.at <= at) {
            return self.take_out_around();
        }
        let at_end = fault.at == self.lexemes.len();
        if self.ends_broken(fault) {
            self.insert(fault.at, Token::Semi);
            return true;
        }
        // An unfinished declaration is one error, however many tokens are missing at its end.
        if at_end && std::mem::replace(&mut self.ended, true) {
            return false;
        }
        let structure = Structure::new(&self.lexemes);
        let found = Found {
            cx: self.cx,
            lexemes: &self.lexemes,
            structure: &structure,
            fault,
        };
        let phrase = structure.phrase(fault.at);
        if let Some(habit) = habits::recognise(&found) {
            return self.follow(habit, phrase);
        }
        let open_let = structure.open_let().filter(|_| at_end);
        if let Some(unclosed) = open_let.and_then(|_| unclosed(&found)) {
            self.findings.push(unclosed::finding(&found, unclosed));
            self.insert(unclosed.before, Token::Tel);
            self.ended = false;
            return true;
        }
        if let Some(open) = open_let {
            self.findings.push(found.open_body(open));
            return self.close_bodies();
        }
        if found.lacks_semi() {
            self.findings.push(found.missing_semi());
            self.insert(fault.at, Token::Semi);
            return true;
        }
        if let Some(finding) = found.reserved_as_name() {
            self.findings.push(finding);
            return self.read_as_name(fault.at);
        }
        self.findings.push(found.unexpected());
        self.take_out(phrase)
    }

    /// Treats a reserved word as a name, here and wherever else the grammar rejects it.
    fn read_as_name(&mut self, at: usize) -> bool {
        let word = &mut self.lexemes[at].token;
        self.reserved.push(*word);
        *word = Token::Ident;
        true
    }

    /// Reports foreign syntax and applies its repair. `phrase` is the range that the usual repair removes.
    fn follow(&mut self, habit: Habit, phrase: Range<usize>) -> bool {
        self.findings.push(habit.finding);
        match habit.mend {
            Mend::Tokens(edits) => {
                for (range, tokens) in edits.into_iter().rev() {
                    self.lexemes.splice(range, tokens);
                }
                true
            }
            Mend::Phrase(phrase, names) => self.take_out_defining(phrase, names),
            Mend::Usual => self.take_out(phrase),
            Mend::Item => false,
        }
    }

    /// Returns whether only the `;` of a removed phrase is missing.
    fn ends_broken(&self, fault: &Fault) -> bool {
        let before = fault.at.checked_sub(1).map(|i| self.lexemes[i].token);
        before == Some(Token::Broken) && fault.expected.contains(&Token::Semi)
    }

    /// Removes the block around a removed phrase, where the grammar does not accept an error token.
    fn take_out_around(&mut self) -> bool {
        let structure = Structure::new(&self.lexemes);
        match self.broken_at.and_then(|at| structure.block_around(at)) {
            Some(block) => self.take_out(structure.phrase(block)),
            None => false,
        }
    }

    /// Inserts the closing keywords of the bodies that are open at the end of the declaration.
    fn close_bodies(&mut self) -> bool {
        let structure = Structure::new(&self.lexemes);
        let cut = structure.unfinished();
        let open = structure.open_blocks().filter(|open| *open < cut);
        let closing = open.filter_map(|open| closing(self.lexemes[open].token));
        let closing: Vec<Token> = closing.collect();
        // An unfinished phrase is removed as a whole, so its missing tokens need no repair.
        if cut < self.lexemes.len() && !self.take_out(cut..self.lexemes.len()) {
            return false;
        }
        self.broken_at = None;
        for token in closing.into_iter().rev() {
            self.insert(self.lexemes.len(), token);
        }
        true
    }

    /// Replaces a phrase by an error token that defines its names. Returns false if there is nothing to replace.
    fn take_out(&mut self, mut phrase: Range<usize>) -> bool {
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
        let names = declared::by_phrase(self.cx, taken);
        self.take_out_defining(phrase, names)
    }

    /// Replaces a phrase by an error token that defines `names`.
    fn take_out_defining(&mut self, phrase: Range<usize>, names: Vec<Ident>) -> bool {
        let Some(first) = self.lexemes.get(phrase.start).copied() else {
            return false;
        };
        let taken = &self.lexemes[phrase.clone()];
        let end = taken.last().map_or(first.start, |lexeme| lexeme.end);
        self.cx.set_broken(first.start, names);
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

    /// Returns whether the error token before index `after` needs a `;`.
    fn needs_semi(&self, after: usize) -> bool {
        match self.lexemes.get(after).map(|lexeme| lexeme.token) {
            Some(Token::Semi) => false,
            Some(Token::Let | Token::Var | Token::Const) => true,
            _ => Structure::new(&self.lexemes).is_in_block(after - 1),
        }
    }

    /// Inserts a token without text before index `at`.
    fn insert(&mut self, at: usize, token: Token) {
        let place = at.checked_sub(1).map_or(0, |i| self.lexemes[i].end);
        self.lexemes.insert(at, missing(token, place));
    }

    /// Parses the body of a declaration whose header has an error, only for its diagnostics.
    fn read_body(self) {
        let is_let = |lexeme: &Lexeme| lexeme.token == Token::Let;
        let Some(body) = self.original.iter().position(is_let) else {
            return;
        };
        let head = match self.original[0].token {
            Token::Task => Token::Task,
            _ => Token::Command,
        };
        // A minimal header: the keyword and a name without text. A command accepts every kind of statement.
        let mut lexemes = vec![missing(head, self.original[body].start); 2];
        lexemes[1].token = Token::Ident;
        lexemes.extend_from_slice(&self.original[body..]);
        match attempt(self.cx, &lexemes) {
            Ok(_) => self.findings.extend(self.cx.take_findings()),
            Err(fault) => {
                Mender::new(self.cx, &lexemes, self.findings).mend_all(fault);
            }
        }
    }
}

/// Creates a token without text at byte offset `place`.
fn missing(token: Token, place: u32) -> Lexeme {
    Lexeme {
        token,
        start: place,
        end: place,
    }
}
