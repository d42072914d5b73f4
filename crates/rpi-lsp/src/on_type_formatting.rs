//! Indentation while the user types: of a new line, and of a line that closes a block.
//!
//! The text is unfinished then, so the formatter cannot help. The tokens before the line determine its indentation, by the
//! same rules as the formatter's.

use lsp_types::{DocumentOnTypeFormattingParams, Range, TextEdit};
use rpi_syntax::{Dialect, SourceToken, SourceTokenKind, source_tokens};

use crate::line_index::LineIndex;
use crate::uri;
use crate::workspace::Workspace;

/// Characters after which the client requests the edits: the first, and the others. The others end `tel` and `end`, and
/// close brackets.
pub(crate) const TRIGGERS: (&str, [&str; 5]) = ("\n", ["l", "d", ")", ">", "}"]);

/// Width of a level of indentation in columns, as the formatter writes it.
const LEVEL: usize = 2;

/// Handles `textDocument/onTypeFormatting`: returns the edit that indents the line of the cursor, empty if it is indented
/// already. Returns [`None`] if the document is not open.
pub(crate) fn on_type_formatting(
    world: &mut Workspace,
    params: DocumentOnTypeFormattingParams,
) -> Option<Vec<TextEdit>> {
    let uri = params.text_document_position.text_document.uri;
    let document = world.document(&uri)?;
    let mode = Dialect::from_path(&uri::to_path(&uri).display().to_string());
    let (text, encoding) = (document.text.as_str(), world.client.encoding);
    let lines = LineIndex::new(text);
    let cursor = lines.offset(text, params.text_document_position.position, encoding);
    let start = text[..cursor].rfind(['\n', '\r']).map_or(0, |at| at + 1);
    let line = text[start..].lines().next().unwrap_or("");
    if params.ch != "\n" && !is_closer(line.trim()) {
        return Some(Vec::new());
    }
    let old = line.len() - line.trim_start_matches([' ', '\t']).len();
    let Some(depth) = depth(text, start, mode) else {
        return Some(Vec::new());
    };
    let new = " ".repeat(LEVEL * depth);
    if line[..old] == new {
        return Some(Vec::new());
    }
    let at = |offset| lines.position(text, offset, encoding);
    let range = Range::new(at(start), at(start + old));
    Some(vec![TextEdit::new(range, new)])
}

fn is_closer(word: &str) -> bool {
    ["tel", "end", ")", ">>", "}"].contains(&word)
}

/// Token that opens a block or a bracket and is not closed yet.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Open {
    Let,
    Automaton,
    State,
    Bracket,
}

/// Returns the number of levels by which the line that starts at a byte offset is indented; `None` for a line in a
/// comment, which keeps its own indentation.
fn depth(text: &str, start: usize, mode: Dialect) -> Option<usize> {
    let tokens = source_tokens(text, mode);
    let is_comment = |token: &SourceToken| matches!(token.kind, SourceTokenKind::Comment(_));
    if tokens
        .iter()
        .any(|token| is_comment(token) && token.range.start < start && start < token.range.end)
    {
        return None;
    }
    let words = tokens.iter().filter(|token| !is_comment(token));
    let (before, after): (Vec<_>, Vec<_>) = words.partition(|token| token.range.start < start);
    let mut open = Vec::new();
    let mut last = "";
    for token in before {
        last = &text[token.range.clone()];
        step(&mut open, last);
    }
    let end = text[start..]
        .find('\n')
        .map_or(text.len(), |len| start + len);
    let first = after.first().filter(|token| token.range.start < end);
    let first = first.map_or("", |token| &text[token.range.clone()]);
    close(&mut open, first);
    let continues = CONTINUED.contains(&last) && open.last() != Some(&Open::Bracket);
    Some(open.len() + usize::from(continues))
}

/// Tokens after which an equation goes on in the next line.
const CONTINUED: &[&str] = &[
    "=", "->", "+", "-", "*", "/", "??", "and", "or", "xor", "=>", "<", "<=", ">=", "<>", "then",
    "else", "not", "pre", "when",
];

/// Follows a token: opens or closes a block.
fn step(open: &mut Vec<Open>, word: &str) {
    match word {
        "let" => open.push(Open::Let),
        "automaton" => open.push(Open::Automaton),
        "state" if is_in_automaton(open) => {
            close(open, word);
            open.push(Open::State);
        }
        "(" | "<<" | "[" | "{" => open.push(Open::Bracket),
        _ => close(open, word),
    }
}

/// Returns whether a state can stand here. Elsewhere `state` is a name.
fn is_in_automaton(open: &[Open]) -> bool {
    let block = open.iter().rfind(|one| **one != Open::Bracket);
    matches!(block, Some(Open::Automaton | Open::State))
}

/// Closes what a token ends. Brackets that a block leaves open are closed with it.
fn close(open: &mut Vec<Open>, word: &str) {
    let ends: &[Open] = match word {
        ")" | ">>" | "]" | "}" => &[Open::Bracket],
        "tel" => &[Open::Let],
        // The state before this one.
        "state" | "initial" => &[Open::State],
        "end" => &[Open::Automaton],
        _ => return,
    };
    // A state ends only the state of its own automaton, and a bracket is not closed over the border of a block.
    let stop = match word {
        "state" | "initial" => Some(Open::Automaton),
        "tel" | "end" => None,
        _ => Some(Open::Let),
    };
    let found = open.iter().rposition(|one| ends.contains(one));
    let border = stop.and_then(|stop| open.iter().rposition(|one| *one == stop));
    if let Some(at) = found.filter(|at| border.is_none_or(|border| border < *at)) {
        open.truncate(at);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rpi_syntax::format;

    /// Words at the start of lines of formatted text whose indentation is that of their blocks. Other lines may continue
    /// an expression.
    const BEGINNINGS: [&str; 7] = [
        "let",
        "tel",
        "state",
        "initial",
        "end",
        "automaton",
        "finish",
    ];

    /// Compares the depths of the lines of a formatted text with their indentation. Returns the number of lines.
    fn compare(text: &str) -> usize {
        let (mut start, mut compared) = (0, 0);
        for line in text.split_inclusive('\n') {
            let indent = line.len() - line.trim_start().len();
            if BEGINNINGS.contains(&line.trim().split(' ').next().unwrap_or("")) {
                let found = depth(text, start, Dialect::Rpi);
                assert_eq!(found, Some(indent / LEVEL), "{line} in\n{text}");
                compared += 1;
            }
            start += line.len();
        }
        compared
    }

    #[test]
    fn formatted_programs_keep_their_indentation() {
        let folders = ["examples", "stdlib", "tests/meaning"];
        let paths = folders.map(|folder| rpi_testkit::files_below(folder, &[".rpi"]));
        let texts = paths
            .iter()
            .flatten()
            .map(|path| rpi_testkit::read_maybe_gz(path).unwrap());
        let formatted = texts.filter_map(|text| format(&text, Dialect::Rpi).ok());
        let compared: usize = formatted.map(|text| compare(&text)).sum();
        assert!(compared > 500, "{compared}");
    }

    #[test]
    fn unfinished_text_has_the_depth_of_its_open_blocks() {
        let cases = [
            ("node N () returns ()\nlet\n", 1),
            ("node N () returns ()\nlet\n  x = \n", 2),
            ("node N () returns ()\nlet\n  x = f(\n", 2),
            ("command C ()\nlet\n  automaton\n    initial state A\n", 3),
            ("command C ()\nlet\n  x = f(1\ntel\n", 0),
            ("command C ()\nlet\n  fragment F when b\n  let\n", 2),
            ("", 0),
        ];
        for (text, expected) in cases {
            let found = depth(text, text.len(), Dialect::Rpi);
            assert_eq!(found, Some(expected), "{text}");
        }
    }
}
