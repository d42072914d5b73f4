//! Where an equation can be added to the text of a program, so that it sees the flows at a line.

use rpi_syntax::{Dialect, SourceToken, SourceTokenKind, source_tokens};

/// Returns the offset in bytes at which an equation can be inserted to be evaluated with those of a line (counted from 1): behind the
/// `let` of the innermost body around the line, or of the body whose head is there. `None` if the line is in no body.
///
/// Nothing is inserted before the line itself, so that its number stays the same.
pub(crate) fn insertion_point(text: &str, dialect: Dialect, line: u32) -> Option<usize> {
    let start = line_start(text, line)?;
    let end = text[start..].find('\n').map_or(text.len(), |k| start + k);
    let tokens = source_tokens(text, dialect);
    let words = tokens.iter().filter_map(|token| keyword(text, token));
    let mut open: Vec<usize> = Vec::new();
    // A declaration whose body has not begun.
    let mut head: Option<usize> = None;
    for (word, at) in words {
        let is_past = at >= end;
        match word {
            "let" if is_past => return head.map(|_| at + word.len()).or(open.last().copied()),
            _ if is_past && head.is_none() => return open.last().copied(),
            "let" => {
                open.push(at + word.len());
                head = None;
            }
            "tel" if at < start => {
                open.pop();
            }
            "fragment" | "command" | "node" | "function" | "state" if at >= start => {
                head = Some(at)
            }
            _ => {}
        }
    }
    open.last().copied()
}

/// Returns the offset of the first byte of a line, counted from 1.
fn line_start(text: &str, line: u32) -> Option<usize> {
    let line = usize::try_from(line).ok()?.checked_sub(1)?;
    let starts = text.match_indices('\n').map(|(k, _)| k + 1);
    std::iter::once(0).chain(starts).nth(line)
}

fn keyword<'t>(text: &'t str, token: &SourceToken) -> Option<(&'t str, usize)> {
    let is_word = token.kind == SourceTokenKind::KeywordOrSymbol;
    let word = text.get(token.range.clone()).filter(|_| is_word)?;
    Some((word, token.range.start))
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "command Main ()\nlet\n  n = 0;\n  fragment Late when n > 2\n  let\n    k = n;\n  tel\n  m = 1;\ntel\n";

    /// Returns the text with a mark where an equation for a line is inserted.
    fn marked(line: u32) -> Option<String> {
        let at = insertion_point(TEXT, Dialect::Rpi, line)?;
        Some(format!("{}^{}", &TEXT[..at], &TEXT[at..]))
    }

    #[test]
    fn an_equation_joins_those_of_its_line() {
        let outer = Some(TEXT.replacen("let", "let^", 1));
        let inner = Some(TEXT.replacen("  let", "  let^", 1));
        for (line, expected) in [
            (1, &outer),
            (3, &outer),
            (8, &outer),
            (4, &inner),
            (6, &inner),
        ] {
            assert_eq!(marked(line), *expected, "line {line}");
        }
        assert_eq!(marked(40), None);
    }
}
