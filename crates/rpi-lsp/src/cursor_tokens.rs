//! Tokens before the cursor, in text that may be unfinished, and the call around the cursor.

use rpi_syntax::{Dialect, SourceToken, SourceTokenKind, source_tokens};

/// Opening brackets, each with its closing bracket. The search for the call around the cursor skips bracketed lists
/// before the cursor.
pub(crate) const BRACKETS: &[(&str, &str)] = &[("(", ")"), ("<<", ">>"), ("[", "]"), ("{", "}")];

/// Tokens at which the search for an open bracket before the cursor ends, because no bracket extends over them.
pub(crate) const BRACKET_ENDS: &[&str] = &[";", "let", "tel"];

/// Token of the text before the cursor. The last few tokens decide the kind of name that may follow.
#[derive(Clone, Copy)]
pub(crate) struct CursorToken<'t> {
    pub(crate) text: &'t str,
    pub(crate) kind: SourceTokenKind,
    /// True if the token is at the start of a line, without a space before it.
    pub(crate) begins_line: bool,
}

/// Returns the tokens of a text that end at or before a byte offset, without comments. `all` are the tokens of the text.
pub(crate) fn before<'t>(text: &'t str, all: &[SourceToken], end: usize) -> Vec<CursorToken<'t>> {
    let words = all.iter().take_while(|piece| piece.range.start < end);
    let words = words.filter(|piece| !matches!(piece.kind, SourceTokenKind::Comment(_)));
    let words = words.filter(|piece| piece.range.end <= end);
    let token = |piece: &SourceToken| CursorToken {
        text: &text[piece.range.clone()],
        kind: piece.kind,
        begins_line: piece.range.start == 0 || text[..piece.range.start].ends_with('\n'),
    };
    words.map(token).collect()
}

/// Call around the cursor, with the argument at the cursor.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) struct OpenCall {
    /// Name of the callee.
    pub(crate) callee: String,
    /// True if the cursor is in the static arguments, `<<...>>`.
    pub(crate) is_static: bool,
    /// Number of the argument at the cursor, from 0.
    pub(crate) argument: usize,
    /// Name by which the argument at the cursor is passed; `None` if it is passed by position.
    pub(crate) name: Option<String>,
}

impl OpenCall {
    /// Returns the innermost call whose brackets are open at a byte offset; `None` if there is none.
    pub(crate) fn around(text: &str, offset: usize, mode: Dialect) -> Option<OpenCall> {
        let words = before(text, &source_tokens(text, mode), offset);
        let (mut closed, mut argument, mut name) = (0_usize, 0, None);
        for (k, word) in words.iter().enumerate().rev() {
            let opens = BRACKETS.iter().any(|(open, _)| *open == word.text);
            let closes = BRACKETS.iter().any(|(_, close)| *close == word.text);
            if closes {
                closed += 1;
            } else if opens && closed > 0 {
                closed -= 1;
            } else if opens {
                match callee_name(&words[..k], word.text) {
                    Some(callee) => {
                        return Some(OpenCall {
                            callee,
                            is_static: word.text == "<<",
                            argument,
                            name,
                        });
                    }
                    // A bracket that only groups is part of an argument.
                    None => (argument, name) = (0, None),
                }
            } else if closed == 0 && word.text == ":" && argument == 0 {
                name = k.checked_sub(1).map(|k| words[k].text.to_owned());
            } else if closed == 0 && (word.text == "," || is_separator(&words, k)) {
                argument += 1;
            } else if closed == 0 && BRACKET_ENDS.contains(&word.text) {
                return None;
            }
        }
        None
    }
}

/// Returns the tokens without the list in brackets at their end; all tokens if they do not end with such a list.
pub(crate) fn strip_brackets<'a, 't>(
    words: &'a [CursorToken<'t>],
    open: &str,
    close: &str,
) -> &'a [CursorToken<'t>] {
    if words.last().is_none_or(|word| word.text != close) {
        return words;
    }
    let mut depth = 0_usize;
    for (k, word) in words.iter().enumerate().rev() {
        if word.text == close {
            depth += 1;
        } else if word.text == open {
            depth -= 1;
        }
        if depth == 0 {
            return &words[..k];
        }
    }
    words
}

/// Returns whether the token with index `at` is a `;` that separates static arguments inside `<<`, so that the call
/// continues after it.
pub(crate) fn is_separator(words: &[CursorToken<'_>], at: usize) -> bool {
    let before = words[..at].iter().rev();
    let mut until_end = before.take_while(|word| !BRACKET_ENDS[1..].contains(&word.text));
    words[at].text == ";" && until_end.any(|word| word.text == "<<")
}

/// Returns the name of the callee before an opening bracket of a call; `None` if the bracket only groups.
pub(crate) fn callee_name(words: &[CursorToken<'_>], open: &str) -> Option<String> {
    let words = match open {
        "(" => strip_brackets(words, "<<", ">>"),
        "<<" => words,
        _ => return None,
    };
    let last = words
        .last()
        .filter(|word| word.kind == SourceTokenKind::Name)?;
    Some(last.text.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_call_around_the_cursor_has_its_argument() {
        let call = |callee: &str, is_static, argument, name: Option<&str>| {
            Some(OpenCall {
                callee: callee.to_owned(),
                is_static,
                argument,
                name: name.map(str::to_owned),
            })
        };
        let cases = [
            ("x = f(|", call("f", false, 0, None)),
            ("x = f(a, b|", call("f", false, 1, None)),
            ("x = f(g(1, 2), |", call("f", false, 1, None)),
            ("x = f(a, (b + |", call("f", false, 1, None)),
            ("x = f(a: 1, to: p|", call("f", false, 1, Some("to"))),
            ("x = f<<a: 1; |", call("f", true, 1, None)),
            ("x = f<<a: 1>>(|", call("f", false, 0, None)),
            ("x = (a, |", None),
            ("x = f(1); y = |", None),
        ];
        for (text, expected) in cases {
            let offset = text.find('|').unwrap();
            let text = text.replace('|', "");
            assert_eq!(
                OpenCall::around(&text, offset, Dialect::Rpi),
                expected,
                "{text}"
            );
        }
    }
}
