//! Reserved words used as names. Each word is reported once; its other uses in the declaration are parsed as names.

use crate::lexer::Lexeme;
use crate::split::{begins_declaration, follows_name};
use crate::syntax_errors::ErrorContext;
use crate::token::Token;
use rpi_diag::{Code, Diagnostic, Fix};

impl ErrorContext<'_, '_> {
    /// Returns a diagnostic for a reserved word at the syntax error that the program uses as a name. Returns [`None`]
    /// if the grammar expects no name, or if the word is more likely meant as a keyword.
    pub(crate) fn reserved_as_name(&self) -> Option<Diagnostic> {
        use Token::{Colon, Comma, Eq, Int, LParen, Let, Tel, Then, When};
        let here = self.lexemes.get(self.error.index)?;
        let word = here.token.keyword()?;
        let wants = |token| self.error.expected.contains(&token);
        // A token inserted by error recovery is empty: it is no word of the text.
        let is_written = here.start < here.end;
        if !is_written || !word.is_reserved_in(self.cx.dialect) || !wants(Token::Ident) {
            return None;
        }
        let next = self
            .lexemes
            .get(self.error.index + 1)
            .map(|next| next.token);
        let is_name = match !wants(Int) && !wants(Tel) {
            true => {
                matches!(next, Some(Colon | Comma | Eq))
                    || here.token == When && next == Some(LParen)
                    || !matches!(here.token, When | Let | Tel | Then)
            }
            false => wants(Tel) && next == Some(Eq),
        };
        is_name.then(|| self.reserved_word_diagnostic(*here))
    }

    fn reserved_word_diagnostic(&self, here: Lexeme) -> Diagnostic {
        let written = self.cx.slice(here.start, here.end);
        let message = format!("`{written}` is a reserved word and cannot be a name");
        let span = self.cx.span(here.start, here.end);
        let diagnostic = Diagnostic::new(Code::RPI0012, message).primary(span, "expected a name");
        match self.rename_fix(here) {
            Some(fix) => diagnostic.fix(fix),
            None => diagnostic.help("choose another name"),
        }
    }

    /// Returns a fix that renames the reserved word `here` at all its uses as a name in the declaration.
    ///
    /// Returns [`None`] for keywords that are values or types. They are also valid in the places of names, so their
    /// uses as names cannot be recognised.
    fn rename_fix(&self, here: Lexeme) -> Option<Fix> {
        use Token::{BoolType, False, IntType, RealType, True};
        let is_value = matches!(here.token, BoolType | False | IntType | RealType | True);
        let word = self.cx.slice(here.start, here.end);
        let names = ["", "1", "2"].map(|tail| format!("{word}_{tail}"));
        let mut free = names
            .into_iter()
            .filter(|name| !self.cx.guessed_names.contains(name));
        let name = free.next().filter(|_| !is_value)?;
        let is_name = |(at, lexeme): &(usize, &Lexeme)| {
            lexeme.start == here.start || lexeme.token == here.token && self.may_be_name(*at)
        };
        let places = self.lexemes.iter().enumerate().filter(is_name);
        let fix = Fix::maybe(format!("rename it to `{name}`"));
        Some(places.fold(fix, |fix, (_, lexeme)| {
            fix.replace(self.cx.span(lexeme.start, lexeme.end), name.clone())
        }))
    }

    /// Returns whether the tokens around the index `at` allow a name there.
    fn may_be_name(&self, at: usize) -> bool {
        use Token::{Dot, Ident, Int, Minus, Path, RBracket, RParen, Real};
        let token = |at: usize| self.lexemes.get(at).map(|lexeme| lexeme.token);
        let before = at.checked_sub(1).and_then(token);
        let goes_on = matches!(
            before,
            None | Some(Dot | Ident | Int | Path | RBracket | RParen | Real)
        );
        // In `not - x` the `-` is a prefix operator, so `not` is not an operand. After a keyword of a declaration, as
        // in
        // `type - 1`, it is a binary operator.
        let next = token(at + 1)
            .filter(|next| *next != Minus || begins_declaration(self.lexemes[at].token));
        !goes_on && next.is_some_and(follows_name)
    }
}

/// Returns the token index of a word in `reported`, at the syntax error `fault` or directly before it; `None` if there
/// is none. `reported` lists the reserved words already reported as names.
pub(crate) fn find_reported_word(
    reported: &[Token],
    lexemes: &[Lexeme],
    fault: usize,
) -> Option<usize> {
    let places = [Some(fault), fault.checked_sub(1)].into_iter().flatten();
    let is_told = |at: &usize| {
        let lexeme = lexemes.get(*at);
        lexeme.is_some_and(|lexeme| reported.contains(&lexeme.token))
    };
    places.into_iter().find(is_told)
}
