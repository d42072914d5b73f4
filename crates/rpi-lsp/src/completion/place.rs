//! Place of the cursor: the kind of name that may follow, determined from the tokens before it.

use std::ops::Range;

use rpi_syntax::{CommentKind, Dialect, SourceToken, SourceTokenKind, source_tokens};

use super::expected::ExpectedType;
use super::structure::{Bracket, Open, Structure};
use crate::cursor_tokens::{self, CursorToken, strip_brackets};

/// Position at which the user types: the part of the word already typed, and the kind of name that may follow.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) struct Cursor {
    /// Range in bytes of the part of a word before the cursor, which a suggestion replaces.
    pub(super) prefix: Range<usize>,
    /// Place at the cursor. It selects the suggestions.
    pub(super) place: Place,
    /// Names before the cursor that decide the expected type: the flow that an equation defines, or an operand.
    pub(super) expected: Option<ExpectedType>,
}

/// Place at which a name is completed.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) enum Place {
    /// Member of the value before the dot, such as a field or an out-port. The path leads to that value; the flag is true
    /// on the left of an equation.
    Member(MemberPath, bool),
    /// Unit of measure, such as `mm/s`.
    Unit,
    /// Name of a module, as after `use`.
    Module,
    /// Type, as after the colon of a declaration.
    Type,
    /// Value. At the start of an argument of a call, the call is given, because the names of its parameters are also
    /// possible.
    Value(Option<ArgumentContext>),
    /// Word after an operand, such as an operator.
    Operator,
    /// Start of a statement in a body.
    Statement,
    /// Start of a step in a task.
    Step,
    /// Command or task that a labelled step runs.
    Run,
    /// Word after a step of a task.
    AfterStep,
    /// Result of a command, as after `on`.
    Result(String),
    /// Step with which a task continues.
    NextStep,
    /// State to which an automaton changes.
    NextState,
    /// Word between the states of an automaton.
    State,
    /// Field in a struct value of a type; the fields that have a value are given.
    Field(String, Vec<String>),
    /// Start of a declaration at the top level.
    Declaration,
    /// Word in the header of a declaration.
    Header,
    /// Word after the name of a result in `finish done when`.
    ResultCondition,
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
    /// True in static arguments, `<<...>>`.
    pub(super) is_static: bool,
    /// Names of the parameters to which the call already passes arguments by name.
    pub(super) passed: Vec<String>,
    /// Number of the argument, from 0.
    pub(super) position: usize,
}

impl Cursor {
    /// Returns the word and the place at a byte offset in `text`. Returns [`None`] where no declared name is possible:
    /// inside comments, strings and numbers, and where a new name is declared. `mode` is the language of the text.
    pub(super) fn from_offset(text: &str, offset: usize, mode: Dialect) -> Option<Cursor> {
        let before = text.get(..offset)?;
        let start = word_start(before);
        let all = source_tokens(text, mode);
        if all.iter().any(|piece| excludes_names(piece, offset)) {
            return None;
        }
        let words = cursor_tokens::before(text, &all, start);
        Some(Cursor {
            prefix: start..offset,
            place: place(&words)?,
            expected: ExpectedType::from_tokens(&words),
        })
    }
}

/// Returns the keyword of the declaration at the top level around a byte offset; `None` before the first one.
pub(super) fn declaration(text: &str, offset: usize, mode: Dialect) -> Option<&str> {
    let words = cursor_tokens::before(text, &source_tokens(text, mode), offset);
    Structure::new(&words).declaration()
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

/// Keywords after which a new name is declared.
const NEW_NAMES: &[&str] = &[
    "node",
    "function",
    "fragment",
    "command",
    "task",
    "test",
    "device",
    "frame",
    "primitive",
    "state",
    "include",
    "type",
    "const",
    "var",
    "finish",
    "yield",
    "actuator",
    "sensor",
    "status",
    "enum",
    "struct",
    "contract",
];

/// Returns the place after the tokens; `None` if a new name is declared there.
fn place(words: &[CursorToken<'_>]) -> Option<Place> {
    let Some((last, before)) = words.split_last() else {
        return Some(Place::Declaration);
    };
    let structure = Structure::new(words);
    if last.text == "." {
        let path = member_path(before);
        return path
            .map(|(path, at)| Place::Member(path, begins_statement(&structure, &words[..at])));
    }
    if expects_module(words) {
        return Some(Place::Module);
    }
    if expects_unit(words) {
        return Some(Place::Unit);
    }
    let is_word = is_keyword(&structure, last, before);
    if is_word && NEW_NAMES.contains(&last.text)
        || is_word && last.text == "fail" && !in_branch(words)
    {
        return None;
    }
    match last.text {
        ":" => Some(after_colon(&structure, words)),
        "on" if is_word => Some(Place::Result(run_callee(words))),
        "," if in_branch(words) => Some(Place::Result(run_callee(words))),
        "start" if is_word => Some(Place::NextStep),
        "continue" if is_word => Some(Place::NextState),
        "then" => Some(after_then(&structure, words)),
        _ => match structure.bracket() {
            Some((at, bracket)) => in_bracket(words, at, bracket),
            None => in_statement(&structure, words),
        },
    }
}

/// Returns whether a token is a keyword. In unfinished text, some keywords are names for the lexer, because no name
/// follows them.
fn is_keyword(
    structure: &Structure<'_, '_>,
    word: &CursorToken<'_>,
    before: &[CursorToken<'_>],
) -> bool {
    let previous = before.last().map_or(";", |word| word.text);
    let begins = matches!(previous, ";" | "let" | "tel" | "end");
    let in_steps = structure.body() == Some(Open::Steps);
    let is_unfinished = match word.text {
        "on" => in_steps,
        "start" => in_steps && begins,
        "finish" | "yield" | "fail" | "fragment" => begins && structure.body() == Some(Open::Body),
        "use" | "include" => begins,
        _ => false,
    };
    word.kind == SourceTokenKind::KeywordOrSymbol || is_unfinished
}

/// Returns whether a statement begins after the tokens.
fn begins_statement(structure: &Structure<'_, '_>, words: &[CursorToken<'_>]) -> bool {
    let last = words.last().map_or(";", |word| word.text);
    let is_end = matches!(last, ";" | "let" | "tel" | "end");
    is_end && structure.bracket().is_none() && structure.body() == Some(Open::Body)
}

fn after_colon(structure: &Structure<'_, '_>, words: &[CursorToken<'_>]) -> Place {
    match structure.bracket() {
        Some((_, Bracket::Parameters | Bracket::Members)) => return Place::Type,
        Some(_) => return Place::Value(None),
        None => {}
    }
    let section = ["var", "const", "let", "tel", "actuator", "sensor", "status"];
    let head = words.iter().rev().find(|word| section.contains(&word.text));
    match head.map(|word| word.text) {
        Some("let" | "tel") if structure.body() == Some(Open::Steps) => Place::Run,
        Some("let" | "tel") => Place::Value(None),
        _ => Place::Type,
    }
}

fn after_then(structure: &Structure<'_, '_>, words: &[CursorToken<'_>]) -> Place {
    if structure.body() == Some(Open::Steps) {
        return Place::NextStep;
    }
    let is_head =
        |word: &&CursorToken<'_>| matches!(word.text, "if" | "until" | "unless" | ";" | "|");
    let head = words.iter().rev().find(is_head).map(|word| word.text);
    // `|` separates the transitions of a state.
    let is_transition = matches!(head, Some("until" | "unless" | "|"));
    match is_transition {
        true => Place::NextState,
        false => Place::Value(None),
    }
}

fn in_bracket(words: &[CursorToken<'_>], at: usize, bracket: Bracket) -> Option<Place> {
    let last = words.last()?;
    let begins = matches!(last.text, "(" | "<<" | "," | ";" | "{" | "with");
    let inside = &words[at + 1..];
    match bracket {
        Bracket::Parameters | Bracket::Members if begins => None,
        Bracket::FieldValues(ty) if begins => Some(Place::Field(ty, named(inside, "="))),
        Bracket::Call(callee) if begins => Some(Place::Value(Some(ArgumentContext {
            callee,
            is_static: words[at].text == "<<",
            passed: named(inside, ":"),
            position: separators(inside),
        }))),
        _ if ends_operand(last) => Some(Place::Operator),
        _ => Some(Place::Value(None)),
    }
}

/// Returns the names before a separator such as `:` in the tokens of a list, outside of nested brackets.
fn named(inside: &[CursorToken<'_>], separator: &str) -> Vec<String> {
    let mut names = Vec::new();
    for (k, word) in top_level(inside) {
        if word.text == separator && k > 0 {
            names.push(inside[k - 1].text.to_owned());
        }
    }
    names
}

/// Returns the number of separators of arguments in the tokens of a list, outside of nested brackets.
fn separators(inside: &[CursorToken<'_>]) -> usize {
    let all = top_level(inside).into_iter();
    all.filter(|(_, word)| matches!(word.text, "," | ";"))
        .count()
}

/// Returns the tokens of a list that are outside of nested brackets, with their numbers.
fn top_level<'a, 't>(inside: &'a [CursorToken<'t>]) -> Vec<(usize, &'a CursorToken<'t>)> {
    let mut depth = 0_usize;
    let mut found = Vec::new();
    for (k, word) in inside.iter().enumerate() {
        match word.text {
            "(" | "[" | "{" | "<<" => depth += 1,
            ")" | "]" | "}" | ">>" => depth = depth.saturating_sub(1),
            _ if depth == 0 => found.push((k, word)),
            _ => {}
        }
    }
    found
}

fn in_statement(structure: &Structure<'_, '_>, words: &[CursorToken<'_>]) -> Option<Place> {
    let last = words.last()?;
    let ends = matches!(last.text, ";" | "let" | "tel" | "end");
    Some(match structure.body() {
        Some(Open::Steps) if ends => Place::Step,
        Some(Open::Steps) if ends_operand(last) || last.text == "|" => Place::AfterStep,
        Some(Open::States) if ends || last.text == "automaton" => Place::State,
        Some(Open::States) if ends_operand(last) && !in_transition(words) => Place::State,
        Some(Open::Body) if ends => Place::Statement,
        Some(Open::Body) if is_result_name(words) => Place::ResultCondition,
        Some(Open::Body) if follows(words, "fragment") => Place::Header,
        None if structure.in_header() && (ends || ends_operand(last)) => match in_section(words) {
            true => return None,
            false => Place::Header,
        },
        None if ends || structure.declaration().is_none() => Place::Declaration,
        _ if ends_operand(last) => Place::Operator,
        _ => Place::Value(None),
    })
}

/// Returns whether the last token follows a keyword, as in `fragment F`.
fn follows(words: &[CursorToken<'_>], keyword: &str) -> bool {
    let before = words.len().checked_sub(2).map(|k| words[k].text);
    before == Some(keyword)
}

/// Returns whether the last token is the name of a result, as in `finish done`.
fn is_result_name(words: &[CursorToken<'_>]) -> bool {
    ["finish", "yield", "fail"]
        .iter()
        .any(|keyword| follows(words, keyword))
}

/// Returns whether the condition of a transition is before the cursor.
fn in_transition(words: &[CursorToken<'_>]) -> bool {
    let head = words
        .iter()
        .rev()
        .find(|word| matches!(word.text, "until" | "unless" | ";" | "state"));
    head.is_some_and(|word| matches!(word.text, "until" | "unless"))
}

/// Returns whether the name of a declaration is before the cursor, as in `var x`.
fn in_section(words: &[CursorToken<'_>]) -> bool {
    let keyword = words.len().checked_sub(2).map_or("", |k| words[k].text);
    matches!(keyword, "var" | "const")
}

/// Returns whether a token can end an operand, so that an operator may follow.
fn ends_operand(word: &CursorToken<'_>) -> bool {
    match word.kind {
        SourceTokenKind::Name | SourceTokenKind::Number | SourceTokenKind::String => true,
        _ => matches!(word.text, ")" | "]" | "}" | ">>" | "true" | "false" | "?"),
    }
}

/// Returns whether the tokens end with a list of results after `on`.
fn in_branch(words: &[CursorToken<'_>]) -> bool {
    let in_list = |word: &&CursorToken<'_>| {
        matches!(word.text, "," | "fail" | "any") || word.kind == SourceTokenKind::Name
    };
    let head = words.iter().rev().find(|word| !in_list(word));
    head.is_some_and(|word| word.text == "on")
}

/// Returns the name of the command or task that the step before the cursor runs; empty if there is none.
fn run_callee(words: &[CursorToken<'_>]) -> String {
    let start = words
        .iter()
        .rposition(|word| matches!(word.text, ";" | "let" | "tel"));
    let step = &words[start.map_or(0, |k| k + 1)..];
    let is_called = |pair: &&[CursorToken<'_>]| {
        pair[0].kind == SourceTokenKind::Name && matches!(pair[1].text, "(" | "<<")
    };
    let callee = step.windows(2).find(is_called);
    callee.map_or(String::new(), |pair| pair[0].text.to_owned())
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

/// Returns the path of names at the end of `words`, the tokens before a dot, and the number of its first token; `None`
/// if they do not end with a name.
pub(super) fn member_path(words: &[CursorToken<'_>]) -> Option<(MemberPath, usize)> {
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
        let root = name.text.to_owned();
        let path = MemberPath {
            root,
            is_call,
            rest,
        };
        return Some((path, before.len()));
    }
}
