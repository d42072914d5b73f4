//! Character cursor of the net parser, and the syntax errors that it reports.

use super::super::parsed_text::{TextRange, Word};
use super::{List, ParseResult, Parser, SyntaxError};
use rpi_diag::{Code, Diagnostic, Span};

/// Movements of the parser over the characters of the text.
impl<'t> Parser<'t> {
    pub(super) fn peek(&self) -> Option<u8> {
        self.out.text.as_bytes().get(self.offset).copied()
    }

    /// Advances the read position by one character.
    pub(super) fn bump(&mut self) {
        let next = self.out.text[self.offset..].chars().next();
        self.offset += next.map_or(0, char::len_utf8);
    }

    pub(super) fn eat(&mut self, sign: u8) -> bool {
        let found = self.peek() == Some(sign);
        self.offset += usize::from(found);
        found
    }

    pub(super) fn space(&mut self) {
        self.offset = after_space(self.out.text.as_bytes(), self.offset);
    }

    pub(super) fn expect(&mut self, sign: u8, why: &str) -> ParseResult<()> {
        self.space();
        if self.eat(sign) {
            return Ok(());
        }
        self.unexpected(&format!("`{}`", char::from(sign)));
        if let Some(diagnostic) = self.diagnostics.last_mut() {
            diagnostic.help.push(why.to_owned());
        }
        Err(SyntaxError)
    }

    pub(super) fn word(&mut self, what: &str) -> ParseResult<Word> {
        self.space();
        let at = self.offset;
        self.offset = after_word(self.out.text.as_bytes(), at);
        if self.offset == at {
            return Err(self.unexpected(what));
        }
        Ok(TextRange::new(at, self.offset))
    }

    /// Parses a quoted text, in which `\'` and `\\` are escapes.
    ///
    /// The reference system does not escape quotes inside of a text. So a quote ends the text only if the next token
    /// can follow a text.
    pub(super) fn quoted(&mut self) -> ParseResult<Word> {
        let bytes = self.out.text.as_bytes();
        let start = self.offset;
        self.offset += 1;
        while let Some(&byte) = bytes.get(self.offset) {
            match byte {
                b'\\' => self.offset = (self.offset + 2).min(bytes.len()),
                b'\'' if ends_text(bytes, self.offset + 1) => {
                    self.offset += 1;
                    return Ok(TextRange::new(start + 1, self.offset - 1));
                }
                _ => self.offset += 1,
            }
        }
        self.offset = bytes.len();
        let diagnostic = Diagnostic::new(Code::RPI0102, "missing closing `'`")
            .primary(self.span(start, start + 1), "opened here")
            .help("close it with `'`, followed by `,` or `)`");
        Err(self.error(diagnostic))
    }
}

/// Creation of diagnostics by the parser.
impl Parser<'_> {
    pub(super) fn span(&self, start: usize, end: usize) -> Span {
        self.out.span(TextRange::new(start, end))
    }

    pub(super) fn error(&mut self, diagnostic: Diagnostic) -> SyntaxError {
        self.diagnostics.push(diagnostic);
        SyntaxError
    }

    pub(super) fn unexpected(&mut self, expected: &str) -> SyntaxError {
        let found = self.out.text[self.offset..].chars().next();
        let end = self.offset + found.map_or(0, char::len_utf8);
        let found = found.map_or("the end of the text".into(), |c| format!("`{c}`"));
        let message = format!("expected {expected}, found {found}");
        let place = self.span(self.offset, end);
        let diagnostic = Diagnostic::new(Code::RPI0101, message).primary(place, "unexpected");
        self.error(match expected.starts_with("`,`") {
            true => diagnostic.help("write `,` between two elements of a list"),
            false => diagnostic,
        })
    }

    pub(super) fn unclosed(&mut self, list: List) -> SyntaxError {
        let close = char::from(list.close);
        let end = self.span(self.offset, self.offset);
        let diagnostic = Diagnostic::new(
            Code::RPI0101,
            format!("expected `{close}`, found the end of the text"),
        )
        .primary(end, "the text ends here")
        .secondary(
            self.span(list.open_offset, list.open_offset + 1),
            "opened here",
        )
        .help("the text may have been cut off");
        self.error(diagnostic)
    }
}

fn after_space(bytes: &[u8], at: usize) -> usize {
    let rest = bytes.get(at..).unwrap_or(&[]);
    at + rest.iter().take_while(|b| b.is_ascii_whitespace()).count()
}

fn after_word(bytes: &[u8], at: usize) -> usize {
    let rest = bytes.get(at..).unwrap_or(&[]);
    let inside = |b: &&u8| IN_WORD[usize::from(**b)];
    at + rest.iter().take_while(inside).count()
}

/// Table of the bytes that may occur in a name: letters, digits, `:` and `_`.
static IN_WORD: [bool; 256] = {
    let (mut table, mut k) = ([false; 256], 0_u8);
    while k < 128 {
        table[k as usize] = k.is_ascii_alphanumeric() || matches!(k, b':' | b'_');
        k += 1;
    }
    table
};

/// Returns whether a quote ends a quoted text, by the token after it: `)`, or a comma that does not belong to the text
/// because the next argument (`name=`) or no valid token follows it. `after_quote` is the byte offset after the quote.
fn ends_text(bytes: &[u8], after_quote: usize) -> bool {
    let at = after_space(bytes, after_quote);
    match bytes.get(at) {
        None | Some(b')') => true,
        Some(b',') => {
            let word = after_space(bytes, at + 1);
            let next = after_space(bytes, after_word(bytes, word));
            word == next || matches!(bytes.get(next), None | Some(b'=' | b'['))
        }
        Some(_) => false,
    }
}
