//! Character cursor of the net parser, and the syntax errors that it reports.

use super::super::text::{Place, Word};
use super::{List, Parsed, Parser, Stop};
use rpi_diag::{Code, Finding, Span};

/// Steps through characters.
impl<'t> Parser<'t> {
    pub(super) fn peek(&self) -> Option<u8> {
        self.out.text.as_bytes().get(self.at).copied()
    }

    /// Skips one character.
    pub(super) fn bump(&mut self) {
        let next = self.out.text[self.at..].chars().next();
        self.at += next.map_or(0, char::len_utf8);
    }

    pub(super) fn eat(&mut self, sign: u8) -> bool {
        let found = self.peek() == Some(sign);
        self.at += usize::from(found);
        found
    }

    pub(super) fn space(&mut self) {
        self.at = after_space(self.out.text.as_bytes(), self.at);
    }

    pub(super) fn expect(&mut self, sign: u8, why: &str) -> Parsed<()> {
        self.space();
        if self.eat(sign) {
            return Ok(());
        }
        self.unexpected(&format!("`{}`", char::from(sign)));
        if let Some(finding) = self.findings.last_mut() {
            finding.help.push(why.to_owned());
        }
        Err(Stop)
    }

    pub(super) fn word(&mut self, what: &str) -> Parsed<Word> {
        self.space();
        let at = self.at;
        self.at = after_word(self.out.text.as_bytes(), at);
        if self.at == at {
            return Err(self.unexpected(what));
        }
        Ok(Place::new(at, self.at))
    }

    /// Parses a quoted text. `\'` and `\\` are escapes. The reference system does not escape quotes in a text; so a
    /// quote ends the text only if a token follows that may follow a text.
    pub(super) fn quoted(&mut self) -> Parsed<Word> {
        let bytes = self.out.text.as_bytes();
        let start = self.at;
        self.at += 1;
        while let Some(&byte) = bytes.get(self.at) {
            match byte {
                b'\\' => self.at = (self.at + 2).min(bytes.len()),
                b'\'' if ends_text(bytes, self.at + 1) => {
                    self.at += 1;
                    return Ok(Place::new(start + 1, self.at - 1));
                }
                _ => self.at += 1,
            }
        }
        self.at = bytes.len();
        let finding = Finding::new(Code::RPI0102, "missing closing `'`")
            .at(self.span(start, start + 1), "opened here")
            .help("close it with `'`, followed by `,` or `)`");
        Err(self.fault(finding))
    }
}

/// Diagnostics.
impl Parser<'_> {
    pub(super) fn span(&self, start: usize, end: usize) -> Span {
        self.out.span(Place::new(start, end))
    }

    pub(super) fn fault(&mut self, finding: Finding) -> Stop {
        self.findings.push(finding);
        Stop
    }

    pub(super) fn unexpected(&mut self, expected: &str) -> Stop {
        let found = self.out.text[self.at..].chars().next();
        let end = self.at + found.map_or(0, char::len_utf8);
        let found = found.map_or("the end of the text".into(), |c| format!("`{c}`"));
        let message = format!("expected {expected}, found {found}");
        let place = self.span(self.at, end);
        self.fault(Finding::new(Code::RPI0101, message).at(place, "unexpected"))
    }

    pub(super) fn unclosed(&mut self, list: List) -> Stop {
        let close = char::from(list.close);
        let end = self.span(self.at, self.at);
        let finding = Finding::new(
            Code::RPI0101,
            format!("expected `{close}`, found the end of the text"),
        )
        .at(end, "the text ends here")
        .also(self.span(list.open, list.open + 1), "opened here")
        .help("the text may have been cut off");
        self.fault(finding)
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

/// For each byte, whether it may occur in a name.
static IN_WORD: [bool; 256] = {
    let (mut table, mut k) = ([false; 256], 0_u8);
    while k < 128 {
        table[k as usize] = k.is_ascii_alphanumeric() || matches!(k, b':' | b'_');
        k += 1;
    }
    table
};

/// Whether the token after a quote shows that the text ends there: `)`, or a comma that is not part of the text because
/// the next argument (`name=`) or no valid token follows it.
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
