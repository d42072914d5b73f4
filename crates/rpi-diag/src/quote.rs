//! Quotations of the program in the texts of diagnostics: help for `way.travelled` shows `way.travelled`, not `x`.
//!
//! The checks know locations, but not the text there. A [`Quote`] therefore writes a mark with its location, and
//! [`fill_quotes`] replaces the marks of all diagnostics when the source texts are at hand.

use std::fmt;

use crate::{Diagnostic, FileId, SourceMap, Span};

/// First character of a placeholder for a quotation. It is a private-use character of Unicode, occurs in no program
/// text, and differs from those that `rpi-sema` uses for free units.
const OPEN: char = '\u{F8F0}';
/// Last character of a placeholder for a quotation, chosen like [`OPEN`].
const CLOSE: char = '\u{F8F1}';

/// Maximum length in characters of quoted program text. A longer text, or one of several lines, is quoted as `...`.
const MAX_LENGTH: usize = 60;

/// Quotation of the program text at a location, for use in `format!`. It writes a placeholder, which [`fill_quotes`]
/// replaces by the text.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Quote {
    span: Span,
    /// True if the text is put in parentheses unless it is a name, a number, a call or another expression without an
    /// operator.
    is_operand: bool,
}

impl Quote {
    /// Creates a quotation of the program text as it is.
    pub fn text(span: Span) -> Quote {
        Quote {
            span,
            is_operand: false,
        }
    }

    /// Creates a quotation of an expression that becomes an operand of another one, with parentheses if it has an
    /// operator: `(a + b)` for the text `a + b`.
    pub fn operand(span: Span) -> Quote {
        Quote {
            span,
            is_operand: true,
        }
    }

    fn from_mark(mark: &str) -> Option<Quote> {
        let mut parts = mark.split(' ');
        let mut number = || parts.next()?.parse::<u32>().ok();
        let span = Span {
            file: FileId(number()?),
            start: number()?,
            end: number()?,
        };
        let is_operand = number()? == 1;
        Some(Quote { span, is_operand })
    }

    fn source(self, sources: &SourceMap) -> String {
        let text = sources.slice(self.span).trim();
        if text.is_empty() || text.contains('\n') || text.chars().count() > MAX_LENGTH {
            return "...".to_owned();
        }
        match self.is_operand && !is_atomic(text) {
            true => format!("({text})"),
            false => text.to_owned(),
        }
    }
}

impl fmt::Display for Quote {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Span { file, start, end } = self.span;
        let is_operand = u32::from(self.is_operand);
        write!(f, "{OPEN}{} {start} {end} {is_operand}{CLOSE}", file.0)
    }
}

/// Returns whether an expression needs no parentheses as an operand, because it has no operator outside of brackets.
fn is_atomic(text: &str) -> bool {
    let mut depth = 0_u32;
    text.chars().all(|c| {
        match c {
            '(' | '[' | '{' => depth += 1,
            ')' | ']' | '}' => depth = depth.saturating_sub(1),
            _ => {}
        }
        depth > 0 || c.is_alphanumeric() || "_.:)]}".contains(c)
    })
}

/// Replaces the placeholders of all quotations ([`Quote`]) in the help texts, notes, labels and titles of fixes by the
/// text of the program.
pub fn fill_quotes(diagnostics: &mut [Diagnostic], sources: &SourceMap) {
    for diagnostic in diagnostics {
        let labels = diagnostic.labels.iter_mut().map(|label| &mut label.text);
        let titles = diagnostic.fixes.iter_mut().map(|fix| &mut fix.title);
        let texts = diagnostic.help.iter_mut().chain(&mut diagnostic.notes);
        for text in texts
            .chain(labels)
            .chain(titles)
            .filter(|text| text.contains(OPEN))
        {
            *text = filled(text, sources);
        }
    }
}

fn filled(text: &str, sources: &SourceMap) -> String {
    let mut out = String::new();
    let mut rest = text;
    while let Some((before, behind)) = rest.split_once(OPEN) {
        out.push_str(before);
        let (mark, behind) = behind.split_once(CLOSE).unwrap_or((behind, ""));
        let source = Quote::from_mark(mark).map(|quote| quote.source(sources));
        out.push_str(source.as_deref().unwrap_or("..."));
        rest = behind;
    }
    out + rest
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Code;

    fn help(program: &str, quoted: &str, quote: impl Fn(Span) -> Quote) -> String {
        let mut sources = SourceMap::new();
        let file = sources.add("a.rpi", program);
        let start = program.find(quoted).expect("quoted text") as u32;
        let end = start + quoted.len() as u32;
        let quote = quote(Span { file, start, end });
        let diagnostic = Diagnostic::new(Code::RPI3001, "absent").help(format!("`{quote} ?? 0`"));
        let mut all = [diagnostic];
        fill_quotes(&mut all, &sources);
        all[0].help[0].clone()
    }

    #[test]
    fn an_operand_gets_parentheses_only_if_it_needs_them() {
        let operand = |quoted| help("y = a.b + f(c - d);", quoted, Quote::operand);
        assert_eq!(operand("a.b"), "`a.b ?? 0`");
        assert_eq!(operand("f(c - d)"), "`f(c - d) ?? 0`");
        assert_eq!(operand("a.b + f(c - d)"), "`(a.b + f(c - d)) ?? 0`");
        assert_eq!(help("y = a - b;", "a - b", Quote::text), "`a - b ?? 0`");
    }

    #[test]
    fn long_text_and_several_lines_are_not_quoted() {
        let long = "a".repeat(MAX_LENGTH + 1);
        assert_eq!(help(&long, &long, Quote::operand), "`... ?? 0`");
        assert_eq!(help("a +\nb", "a +\nb", Quote::operand), "`... ?? 0`");
    }

    #[test]
    fn a_broken_mark_is_no_quotation() {
        let sources = SourceMap::new();
        assert_eq!(filled("a \u{F8F0}1 2\u{F8F1} b", &sources), "a ... b");
        assert_eq!(filled("a \u{F8F0}", &sources), "a ...");
    }
}
