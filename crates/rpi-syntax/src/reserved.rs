//! Words of the language where names belong: told once, and then read as the names that they were meant to be.

use crate::explain::Found;
use crate::lexer::Lexeme;
use crate::token::Token;
use rpi_diag::{Code, Finding};

impl Found<'_, '_> {
    /// A reserved word stands where a name is wanted: as such, or it is defined or declared as one.
    pub(crate) fn reserved_as_name(&self) -> Option<Finding> {
        use Token::{Colon, Comma, Eq, Int, LParen, Let, Tel, Then, When};
        let here = self.lexemes.get(self.fault.at)?;
        let word = here.token.keyword()?;
        let wants = |token| self.fault.expected.contains(&token);
        if !word.is_reserved_in(self.cx.mode) || !wants(Token::Ident) {
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
        Finding::new(Code::RPI0012, message)
            .at(self.cx.span(here.start, here.end), "reserved")
            .help("choose another name")
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
