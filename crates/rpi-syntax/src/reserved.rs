//! Words of the language where names belong: told once, and then read as the names that they were meant to be.

use crate::explain::Found;
use crate::lexer::Lexeme;
use crate::split::{begins_declaration, follows_name};
use crate::token::Token;
use rpi_diag::{Code, Finding, Fix};

impl Found<'_, '_> {
    /// A reserved word stands where a name is wanted: as such, or it is defined or declared as one.
    pub(crate) fn reserved_as_name(&self) -> Option<Finding> {
        use Token::{Colon, Comma, Eq, Int, LParen, Let, Tel, Then, When};
        let here = self.lexemes.get(self.fault.at)?;
        let word = here.token.keyword()?;
        let wants = |token| self.fault.expected.contains(&token);
        // What was put in is no word of the text.
        let is_written = here.start < here.end;
        if !is_written || !word.is_reserved_in(self.cx.mode) || !wants(Token::Ident) {
            return None;
        }
        let next = self.lexemes.get(self.fault.at + 1).map(|next| next.token);
        let is_name = match !wants(Int) && !wants(Tel) {
            true => {
                matches!(next, Some(Colon | Comma | Eq))
                    || here.token == When && next == Some(LParen)
                    || !matches!(here.token, When | Let | Tel | Then)
            }
            false => wants(Tel) && next == Some(Eq),
        };
        is_name.then(|| self.reserved(*here))
    }

    fn reserved(&self, here: Lexeme) -> Finding {
        let written = self.cx.slice(here.start, here.end);
        let message = format!("`{written}` is a word of the language, not a name");
        let span = self.cx.span(here.start, here.end);
        let finding = Finding::new(Code::RPI0012, message).at(span, "reserved");
        match self.renamed(here) {
            Some(fix) => finding.fix(fix),
            None => finding.help("choose another name"),
        }
    }

    /// Another name, wherever the declaration has the word as one. [`None`] for values and types, which can stand in the
    /// places of names.
    fn renamed(&self, here: Lexeme) -> Option<Fix> {
        use Token::{BoolType, False, IntType, RealType, True};
        let is_value = matches!(here.token, BoolType | False | IntType | RealType | True);
        let word = self.cx.slice(here.start, here.end);
        let names = ["", "1", "2"].map(|tail| format!("{word}_{tail}"));
        let mut free = names
            .into_iter()
            .filter(|name| !self.cx.text.contains(name));
        let name = free.next().filter(|_| !is_value)?;
        let is_name = |(at, lexeme): &(usize, &Lexeme)| {
            lexeme.start == here.start || lexeme.token == here.token && self.is_name_at(*at)
        };
        let places = self.lexemes.iter().enumerate().filter(is_name);
        let fix = Fix::maybe(format!("call it `{name}`"));
        Some(places.fold(fix, |fix, (_, lexeme)| {
            fix.replace(self.cx.span(lexeme.start, lexeme.end), name.clone())
        }))
    }

    /// Whether a name could stand at a token, by those on both sides.
    fn is_name_at(&self, at: usize) -> bool {
        use Token::{Dot, Ident, Int, Minus, Path, RBracket, RParen, Real};
        let token = |at: usize| self.lexemes.get(at).map(|lexeme| lexeme.token);
        let before = at.checked_sub(1).and_then(token);
        let goes_on = matches!(
            before,
            None | Some(Dot | Ident | Int | Path | RBracket | RParen | Real)
        );
        // `not - x` is no difference.
        let next = token(at + 1)
            .filter(|next| *next != Minus || begins_declaration(self.lexemes[at].token));
        !goes_on && next.is_some_and(follows_name)
    }
}

/// Where one of these words stands as a name again: at a fault, or before it.
pub(crate) fn again(told: &[Token], lexemes: &[Lexeme], fault: usize) -> Option<usize> {
    let places = [Some(fault), fault.checked_sub(1)].into_iter().flatten();
    let is_told = |at: &usize| {
        let lexeme = lexemes.get(*at);
        lexeme.is_some_and(|lexeme| told.contains(&lexeme.token))
    };
    places.into_iter().find(is_told)
}
