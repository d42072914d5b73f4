//! Parses one declaration; where it has a fault, reports it, mends the tokens and tries again.
//!
//! Three ways to mend: a `;` or `tel` that is missing is put in; a phrase with a fault gives way to a
//! [`Token::Broken`]; and if the head of a declaration has a fault, its body is still read for the
//! sake of the findings. So every independent fault is found, each once.

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

/// The tree of one declaration, and what is wrong with it.
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

/// A declaration of which only the names are known.
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

/// Asks the grammar.
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

/// How many faults of one declaration are mended.
const MAX_FAULTS: usize = 200;

/// How many tokens may be read again for the sake of further findings.
const PATIENCE: usize = 1_000_000;

struct Mender<'c, 't, 'f> {
    cx: &'c Context<'t>,
    original: &'c [Lexeme],
    lexemes: Vec<Lexeme>,
    findings: &'f mut Vec<Finding>,
    patience: usize,
    /// Where the last phrase was taken out.
    broken_at: Option<usize>,
    /// Whether a fault at the end has been reported.
    ended: bool,
    /// Reserved words that have been told to be no names.
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

    /// Mends one fault after the other, until the declaration parses. [`None`] if its head does not.
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

    /// Reports the fault and mends it. False if there is no way.
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
        // Whatever is missing at the end, the declaration breaks off there: one fault.
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

    /// Reads a reserved word as a name, here and wherever else it does not fit.
    fn read_as_name(&mut self, at: usize) -> bool {
        let word = &mut self.lexemes[at].token;
        self.reserved.push(*word);
        *word = Token::Ident;
        true
    }

    /// Reports a habit and reads the tokens as they were meant; `phrase` is what is left out otherwise.
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

    /// Whether all that is missing is the `;` of a phrase that was taken out.
    fn ends_broken(&self, fault: &Fault) -> bool {
        let before = fault.at.checked_sub(1).map(|i| self.lexemes[i].token);
        before == Some(Token::Broken) && fault.expected.contains(&Token::Semi)
    }

    /// Takes out what is around a broken phrase that does not fit as such.
    fn take_out_around(&mut self) -> bool {
        let structure = Structure::new(&self.lexemes);
        match self.broken_at.and_then(|at| structure.block_around(at)) {
            Some(block) => self.take_out(structure.phrase(block)),
            None => false,
        }
    }

    /// Puts in what closes the bodies that are open at the end.
    fn close_bodies(&mut self) -> bool {
        let structure = Structure::new(&self.lexemes);
        let cut = structure.unfinished();
        let open = structure.open_blocks().filter(|open| *open < cut);
        let closing = open.filter_map(|open| closing(self.lexemes[open].token));
        let closing: Vec<Token> = closing.collect();
        // A phrase that breaks off: what is missing in it goes with it.
        if cut < self.lexemes.len() && !self.take_out(cut..self.lexemes.len()) {
            return false;
        }
        self.broken_at = None;
        for token in closing.into_iter().rev() {
            self.insert(self.lexemes.len(), token);
        }
        true
    }

    /// Replaces a phrase by a broken one. False if there is nothing to replace.
    fn take_out(&mut self, mut phrase: Range<usize>) -> bool {
        // Between two `;` there is nothing; but a stray `tel` stands for itself.
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

    /// Replaces a phrase by a broken one that defines these names.
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

    /// Whether a broken phrase lacks its `;`.
    fn needs_semi(&self, after: usize) -> bool {
        match self.lexemes.get(after).map(|lexeme| lexeme.token) {
            Some(Token::Semi) => false,
            Some(Token::Let | Token::Var | Token::Const) => true,
            _ => Structure::new(&self.lexemes).is_in_block(after - 1),
        }
    }

    fn insert(&mut self, at: usize, token: Token) {
        let place = at.checked_sub(1).map_or(0, |i| self.lexemes[i].end);
        self.lexemes.insert(at, missing(token, place));
    }

    /// Reads the body of a declaration whose head has a fault, for the sake of the findings.
    fn read_body(self) {
        let is_let = |lexeme: &Lexeme| lexeme.token == Token::Let;
        let Some(body) = self.original.iter().position(is_let) else {
            return;
        };
        let head = match self.original[0].token {
            Token::Task => Token::Task,
            _ => Token::Command,
        };
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

/// A token that the text lacks.
fn missing(token: Token, place: u32) -> Lexeme {
    Lexeme {
        token,
        start: place,
        end: place,
    }
}
