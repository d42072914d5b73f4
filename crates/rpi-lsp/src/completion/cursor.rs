//! Syntactic context of the cursor, determined from the tokens before it.

use std::ops::Range;

use rpi_syntax::{CommentKind, Dialect, SourceToken, SourceTokenKind, source_tokens};

/// Position at which the user types: the part of the word already typed, and the kind of name that may follow.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) struct Cursor {
    /// Range in bytes of the part of a word before the cursor, which a suggestion replaces.
    pub(super) prefix: Range<usize>,
    /// Kind of name that the grammar allows at the cursor. It selects the suggestions.
    pub(super) expected: ExpectedName,
}

/// Kind of name that the grammar allows at the cursor.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) enum ExpectedName {
    /// Member of the value before the dot, such as a field or an out-port. The path leads to that value.
    Member(MemberPath),
    /// Unit of measure, such as `mm/s`.
    Unit,
    /// Name of a module, as after `use`.
    Module,
    /// Any name that is visible at the cursor. At the start of an argument of a call, the call is given, because the
    /// names of its parameters are also possible.
    Name(Option<ArgumentContext>),
}

/// Path of names before the dot at the cursor, such as `way.pose` or `f(x).pose`.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) struct MemberPath {
    /// Name before the first dot of the path: `way` in `way.pose.`.
    pub(super) root: String,
    /// True if arguments follow the first name, as in `Line(arm, to).`.
    pub(super) is_call: bool,
    /// Names after the first dot, in order: `pose` in `way.pose.`; empty if there is only one name.
    pub(super) rest: Vec<String>,
}

/// Call around the cursor, if one of its arguments begins at the cursor.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) struct ArgumentContext {
    /// Name of the called node or function.
    pub(super) callee: String,
    /// Names of the parameters to which the call already passes arguments by name.
    pub(super) passed: Vec<String>,
}

/// Opening brackets, each with its closing bracket. The search for the call around the cursor skips bracketed lists
/// before the cursor.
const BRACKETS: &[(&str, &str)] = &[("(", ")"), ("<<", ">>"), ("[", "]"), ("{", "}")];

/// Tokens at which the search for an open bracket before the cursor ends, because no bracket extends over them.
const BRACKET_ENDS: &[&str] = &[";", "let", "tel"];

impl Cursor {
    /// Returns the word and the expected kind of name at a byte offset in `text`. Returns [`None`] inside comments,
    /// strings and numbers. `mode` is the language of the text.
    pub(super) fn from_offset(text: &str, offset: usize, mode: Dialect) -> Option<Cursor> {
        let before = text.get(..offset)?;
        let start = word_start(before);
        let all = source_tokens(text, mode);
        if all.iter().any(|piece| excludes_names(piece, offset)) {
            return None;
        }
        let words = all
            .iter()
            .filter(|piece| !matches!(piece.kind, SourceTokenKind::Comment(_)));
        let words = words.filter(|piece| piece.range.end <= start);
        let words: Vec<CursorToken<'_>> = words
            .map(|piece| CursorToken {
                text: &text[piece.range.clone()],
                kind: piece.kind,
            })
            .collect();
        Some(Cursor {
            prefix: start..offset,
            expected: expected_name(&words),
        })
    }
}

/// Returns the byte offset at which the word at the end of `before`, the text before the cursor, starts.
fn word_start(before: &str) -> usize {
    let in_word = |c: char| c.is_ascii_alphanumeric() || matches!(c, '_' | '\'' | ':');
    let start = before.trim_end_matches(in_word).len();
    // `name:` precedes a word, whereas `Core::` is part of one.
    let word = &before[start..];
    match word.rfind(':') {
        Some(colon) if !word.contains("::") => start + colon + 1,
        _ => start,
    }
}

/// Returns whether a byte offset is inside a token in which no name is possible: a comment, string or number.
fn excludes_names(piece: &SourceToken, offset: usize) -> bool {
    let Range { start, end } = piece.range;
    let to_line_end = match piece.kind {
        SourceTokenKind::Comment(kind) => {
            !matches!(kind, CommentKind::Block | CommentKind::Contract)
        }
        SourceTokenKind::String => false,
        SourceTokenKind::Number => true,
        SourceTokenKind::Name | SourceTokenKind::KeywordOrSymbol => return false,
    };
    start < offset && (offset < end || to_line_end && offset == end)
}

/// Token of the text before the cursor. The last few tokens decide the kind of name that may follow.
#[derive(Clone, Copy)]
struct CursorToken<'t> {
    text: &'t str,
    kind: SourceTokenKind,
}

fn expected_name(words: &[CursorToken<'_>]) -> ExpectedName {
    let Some((last, before)) = words.split_last() else {
        return ExpectedName::Name(None);
    };
    if last.text == "." {
        return member_path(before).map_or(ExpectedName::Name(None), ExpectedName::Member);
    }
    if expects_module(words) {
        return ExpectedName::Module;
    }
    if expects_unit(words) {
        return ExpectedName::Unit;
    }
    let begins = matches!(last.text, "(" | "<<" | "," | ";");
    ExpectedName::Name(if begins {
        argument_context(words)
    } else {
        None
    })
}

/// Returns whether the tokens before the cursor require the name of a module, as in `use a, `.
fn expects_module(words: &[CursorToken<'_>]) -> bool {
    let in_list = |word: &&CursorToken<'_>| word.text == "," || word.kind == SourceTokenKind::Name;
    let head = words.iter().rev().find(|word| !in_list(word));
    let begins = words
        .last()
        .is_some_and(|word| word.text == "," || word.text == "use");
    begins && head.is_some_and(|word| word.text == "use")
}

/// Returns whether the tokens before the cursor require a unit of measure, as in `250[mm/` or `real[`.
fn expects_unit(words: &[CursorToken<'_>]) -> bool {
    let inside = |word: &CursorToken<'_>| {
        matches!(word.kind, SourceTokenKind::Name | SourceTokenKind::Number)
            || matches!(word.text, "/" | "*" | "^")
    };
    let Some(open) = words.iter().rposition(|word| !inside(word)) else {
        return false;
    };
    let of = open.checked_sub(1).map(|k| words[k]);
    let measured =
        of.is_some_and(|word| word.kind == SourceTokenKind::Number || word.text == "real");
    words[open].text == "[" && measured
}

/// Returns the path of names at the end of `words`, the tokens before a dot; `None` if they do not end with a name.
fn member_path(words: &[CursorToken<'_>]) -> Option<MemberPath> {
    let mut rest = Vec::new();
    let mut left = words;
    loop {
        left = strip_brackets(left, "[", "]");
        let called = strip_brackets(left, "(", ")");
        let is_call = called.len() < left.len();
        let named = strip_brackets(called, "<<", ">>");
        let (name, before) = named.split_last()?;
        if name.kind != SourceTokenKind::Name {
            return None;
        }
        if let Some((dot, before)) = before.split_last()
            && dot.text == "."
            && !is_call
        {
            rest.push(name.text.to_owned());
            left = before;
            continue;
        }
        rest.reverse();
        return Some(MemberPath {
            root: name.text.to_owned(),
            is_call,
            rest,
        });
    }
}

/// Returns the tokens without the list in brackets at their end; all tokens if they do not end with such a list.
fn strip_brackets<'a, 't>(
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

/// Returns the call of which an argument begins after `words`, the tokens before the cursor; `None` if the cursor is
/// not in the arguments of a call.
fn argument_context(words: &[CursorToken<'_>]) -> Option<ArgumentContext> {
    let mut given = Vec::new();
    let mut closed = 0_usize;
    for (k, word) in words.iter().enumerate().rev() {
        let opens = BRACKETS.iter().any(|(open, _)| *open == word.text);
        let closes = BRACKETS.iter().any(|(_, close)| *close == word.text);
        if closes {
            closed += 1;
        } else if opens && closed > 0 {
            closed -= 1;
        } else if opens {
            let callee = callee_name(&words[..k], word.text)?;
            return Some(ArgumentContext {
                callee,
                passed: given,
            });
        } else if closed == 0 && word.text == ":" {
            given.extend(k.checked_sub(1).map(|k| words[k].text.to_owned()));
        } else if closed == 0 && BRACKET_ENDS.contains(&word.text) && !is_separator(words, k) {
            return None;
        }
    }
    None
}

/// Returns whether the token with index `at` is a `;` that separates static arguments inside `<<`, so that the call
/// continues after it.
fn is_separator(words: &[CursorToken<'_>], at: usize) -> bool {
    let before = words[..at].iter().rev();
    let mut until_end = before.take_while(|word| !BRACKET_ENDS[1..].contains(&word.text));
    words[at].text == ";" && until_end.any(|word| word.text == "<<")
}

fn callee_name(words: &[CursorToken<'_>], open: &str) -> Option<String> {
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

    /// Returns the context at `|`.
    fn at(text: &str) -> Option<Cursor> {
        let offset = text.find('|').unwrap();
        Cursor::from_offset(&text.replace('|', ""), offset, Dialect::Rpi)
    }

    fn member(root: &str, is_call: bool, rest: &[&str]) -> ExpectedName {
        let rest = rest.iter().map(|&name| name.to_owned()).collect();
        let root = root.to_owned();
        ExpectedName::Member(MemberPath {
            root,
            is_call,
            rest,
        })
    }

    fn argument_of(callee: &str, given: &[&str]) -> ExpectedName {
        let given = given.iter().map(|&name| name.to_owned()).collect();
        let callee = callee.to_owned();
        ExpectedName::Name(Some(ArgumentContext {
            callee,
            passed: given,
        }))
    }

    #[test]
    fn what_is_wanted_is_told_by_what_stands_before() {
        let cases = [
            ("x = wa|", ExpectedName::Name(None)),
            ("arm.tcp = way.|", member("way", false, &[])),
            ("x = F.way.po|", member("F", false, &["way"])),
            ("x = a[2].b.|", member("a", false, &["b"])),
            ("x = f<<1>>(y, z).|", member("f", true, &[])),
            ("use mo|", ExpectedName::Module),
            ("use motion, |", ExpectedName::Module),
            ("x = 250[mm/|", ExpectedName::Unit),
            ("x: real[|", ExpectedName::Unit),
            ("x = a[i|", ExpectedName::Name(None)),
            ("way = Line<<to: c, sp|", argument_of("Line", &["to"])),
            ("way = Line<<to: c>>(fr|", argument_of("Line", &[])),
            ("x = f(g(1, b: 2), a: 3, |", argument_of("f", &["a"])),
            ("x = f(a: |", ExpectedName::Name(None)),
            ("x = f(a: y|", ExpectedName::Name(None)),
            ("x = f(1); |", ExpectedName::Name(None)),
            ("x = (1 + |", ExpectedName::Name(None)),
            ("let |", ExpectedName::Name(None)),
            ("|", ExpectedName::Name(None)),
        ];
        for (text, wanted) in cases {
            assert_eq!(
                at(text).map(|cursor| cursor.expected),
                Some(wanted),
                "{text}"
            );
        }
    }

    #[test]
    fn qualified_names_are_one_word() {
        let cursor = at("x = Core::Dou|").unwrap();
        assert_eq!(cursor.prefix, 4..13);
        assert_eq!(at("x = Core::|").unwrap().prefix, 4..10);
        assert_eq!(at("f(a:b|)").unwrap().prefix, 4..5);
    }

    #[test]
    fn nothing_is_wanted_in_comments_texts_and_numbers() {
        for text in [
            "x = 1; -- re|",
            "(* a | b *)",
            "assume \"a|b\" x;",
            "x = 25|",
            "--| do|",
        ] {
            let offset = text.rfind('|').unwrap();
            let text = format!("{}{}", &text[..offset], &text[offset + 1..]);
            assert_eq!(
                Cursor::from_offset(&text, offset, Dialect::Rpi),
                None,
                "{text}"
            );
        }
    }
}
