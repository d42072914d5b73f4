//! Structure of the text before the cursor: open bodies and brackets, found in the tokens alone, because the text may be
//! unfinished.

use rpi_syntax::SourceTokenKind;

use crate::cursor_tokens::{BRACKETS, CursorToken, callee_name};

/// Keywords that begin a declaration at the start of a line.
const DECLARATIONS: &[&str] = &[
    "node",
    "function",
    "fragment",
    "command",
    "task",
    "test",
    "const",
    "type",
    "device",
    "frame",
    "primitive",
    "use",
    "include",
    "unsafe",
    "extern",
    "contract",
];

/// Keywords of declarations with a body.
const WITH_BODY: &[&str] = &["node", "function", "fragment", "command", "task", "test"];

/// Construct that is open at the cursor.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Open {
    /// Body of a declaration, between `let` and `tel`.
    Body,
    /// Steps of a task, between `let` and `tel`.
    Steps,
    /// States of an automaton, between `automaton` and `end`.
    States,
    /// Bracket, with the number of its token.
    Bracket(usize),
}

/// Open constructs at the cursor, the innermost one last.
pub(super) struct Structure<'w, 't> {
    words: &'w [CursorToken<'t>],
    open: Vec<Open>,
    /// Keyword of the declaration at the top level that contains the cursor; `None` before the first one.
    declaration: Option<&'t str>,
    /// True if the body of the declaration has not begun.
    in_header: bool,
}

/// Kind of bracket around the cursor.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) enum Bracket {
    /// Arguments of a call, with the callee.
    Call(String),
    /// Parameters or ports of a declaration.
    Parameters,
    /// Fields of the declaration of a struct, or values of an enum.
    Members,
    /// Values of the fields of a struct, with its type.
    FieldValues(String),
    /// Bracket that groups an expression, an array or an index.
    Group,
}

impl<'w, 't> Structure<'w, 't> {
    /// Returns the structure of the text before the cursor, given by its tokens.
    pub(super) fn new(words: &'w [CursorToken<'t>]) -> Structure<'w, 't> {
        let mut structure = Structure {
            words,
            open: Vec::new(),
            declaration: None,
            in_header: false,
        };
        (0..words.len()).for_each(|k| structure.token(k));
        structure
    }

    fn token(&mut self, k: usize) {
        let word = self.words[k];
        let is_bracket = |(open, close): &&(&str, &str)| *open == word.text || *close == word.text;
        let begins = word.begins_line || self.open.is_empty();
        match word.text {
            text if begins
                && DECLARATIONS.contains(&text)
                && word.kind != SourceTokenKind::Name =>
            {
                self.open.clear();
                self.declaration = Some(text);
                self.in_header = WITH_BODY.contains(&text);
            }
            "let" => {
                self.close_brackets();
                let is_task = self.declaration == Some("task");
                self.open
                    .push(if is_task { Open::Steps } else { Open::Body });
                self.in_header = false;
            }
            "tel" => {
                self.close_brackets();
                self.open.pop();
            }
            "automaton" => self.open.push(Open::States),
            "end" if self.open.last() == Some(&Open::States) => {
                self.open.pop();
            }
            // A semicolon ends an unfinished expression in a body, but not a list of arguments in `<<...>>`.
            ";" if self.open.iter().any(|one| !matches!(one, Open::Bracket(_))) => {
                while let Some(Open::Bracket(at)) = self.open.last()
                    && matches!(self.words[*at].text, "(" | "[")
                    && self.bracket_at(*at) != Bracket::Parameters
                {
                    self.open.pop();
                }
            }
            text if BRACKETS.iter().any(|pair| is_bracket(&pair)) => {
                let opens = BRACKETS.iter().any(|(open, _)| *open == text);
                if opens {
                    self.open.push(Open::Bracket(k));
                } else if let Some(Open::Bracket(_)) = self.open.last() {
                    self.open.pop();
                }
            }
            _ => {}
        }
    }

    fn close_brackets(&mut self) {
        while let Some(Open::Bracket(_)) = self.open.last() {
            self.open.pop();
        }
    }

    /// Returns the innermost bracket around the cursor, with the number of its token; `None` if none is open in the
    /// current statement.
    pub(super) fn bracket(&self) -> Option<(usize, Bracket)> {
        match self.open.last() {
            Some(Open::Bracket(at)) => Some((*at, self.bracket_at(*at))),
            _ => None,
        }
    }

    fn bracket_at(&self, at: usize) -> Bracket {
        let before = &self.words[..at];
        let last = before.last().map_or("", |word| word.text);
        match self.words[at].text {
            "(" if matches!(last, "returns" | "given") => Bracket::Parameters,
            "{" if matches!(last, "struct" | "enum" | "=") => Bracket::Members,
            "{" => before
                .last()
                .filter(|word| word.kind == SourceTokenKind::Name)
                .map_or(Bracket::Group, |word| {
                    Bracket::FieldValues(word.text.to_owned())
                }),
            open => match callee_name(before, open) {
                Some(_) if self.is_declared(before) => Bracket::Parameters,
                Some(callee) => Bracket::Call(callee),
                None => Bracket::Group,
            },
        }
    }

    /// Returns whether the name before an opening bracket is declared there: `node f (`, `fragment F <<n: int>> (`.
    fn is_declared(&self, before: &[CursorToken<'_>]) -> bool {
        let before = crate::cursor_tokens::strip_brackets(before, "<<", ">>");
        let keyword = before.len().checked_sub(2).map(|k| before[k].text);
        let is_title = |word: &str| DECLARATIONS.contains(&word) || word == "imported";
        keyword.is_some_and(is_title)
    }

    /// Returns the innermost body, list of steps or list of states around the cursor; `None` at the top level.
    pub(super) fn body(&self) -> Option<Open> {
        let bodies = self.open.iter().rev();
        let mut bodies = bodies.filter(|one| !matches!(one, Open::Bracket(_)));
        bodies.next().copied()
    }

    /// Returns the keyword of the declaration at the top level around the cursor.
    pub(super) fn declaration(&self) -> Option<&'t str> {
        self.declaration
    }

    /// Returns whether the cursor is in the header of a declaration: after its keyword and before its body.
    pub(super) fn in_header(&self) -> bool {
        self.in_header
    }
}
