//! Automata in the syntax of Heptagon, SCADE and others: `state A do y = x until c then B`.

use super::{ForeignSyntax, Repair, foreign_syntax};
use crate::lexer::Lexeme;
use crate::syntax_errors::ErrorContext;
use crate::token::Token;
use rpi_diag::Fix;
use std::ops::Range;

/// Recognises an automaton with a name: `automaton SM1 initial state A ...`.
pub(super) fn named_automaton(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    use Token::{Automaton, Ident, Initial, State};
    let at = found.error.index;
    let is_name = found.token_before() == Some(Automaton) && found.token_at(at) == Some(Ident);
    let goes_on = matches!(found.token_at(at + 1), Some(Initial | State))
        || is_any_of(found, at + 1, &["initial", "state"]);
    if !is_name
        || !goes_on
        || is_any_of(found, at, INITIAL_WORDS)
        || is_misspelling_of("initial", found.source_text(at))
    {
        return None;
    }
    let diagnostic = foreign_syntax("an automaton has no name")
        .primary(found.token_span(at), "expected a state")
        .fix(Fix::sure("delete it").replace(found.token_span(at), ""));
    Some(ForeignSyntax {
        diagnostic,
        repair: Repair::ReplaceTokens(vec![(at..at + 1, Vec::new())]),
    })
}

/// Words for the initial state in other languages.
const INITIAL_WORDS: &[&str] = &[
    "init", "initial", "start", "begin", "default", "entry", "first",
];

/// Recognises another word for `initial`: `init state A`.
pub(super) fn initial_keyword(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = found.error.index;
    let is_start = is_any_of(found, at, INITIAL_WORDS) && found.expects(Token::State);
    if !is_start
        || found.token_at(at + 1) != Some(Token::State) && !is_any_of(found, at + 1, &["state"])
    {
        return None;
    }
    let diagnostic = foreign_syntax("the first state of an automaton is marked `initial state`")
        .primary(found.token_span(at), "keyword of another language");
    Some(found.replace_word(diagnostic, at, Token::Initial))
}

/// Recognises a transition without `then`: `until c -> B;`, `until c B;`, `until c: B;`.
pub(super) fn missing_then(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    use Token::{Arrow, Colon, Comma, Ident, Implies, Semi, Then, Unless, Until};
    let at = found.error.index;
    let first = (at.saturating_sub(60)..at)
        .rev()
        .take_while(|at| found.token_at(*at) != Some(Semi))
        .find(|at| matches!(found.token_at(*at), Some(Token::On | Unless | Until)))?;
    if !found.expects(Then) && found.token_at(at) != Some(Implies) {
        return None;
    }
    let ends = |at: usize| {
        matches!(
            found.token_at(at),
            Some(Semi | Token::Bar | Token::Tel | Token::State | Token::End)
        )
    };
    let sign = match found.token_at(at)? {
        Semi if at >= first + 4 => at - 2,
        Colon | Comma | Implies | Arrow => at,
        Ident if ends(at + 1) && !is_misspelling_of("then", found.source_text(at)) => {
            let before = found.token_span(at - 1);
            let diagnostic = foreign_syntax("the next state follows `then`")
                .primary(found.token_span(at), "expected `then` before this")
                .fix(Fix::sure("insert `then`").insert_after(before, " then"));
            let repair = Repair::ReplaceTokens(vec![found.insertion(at, Then)]);
            return Some(ForeignSyntax { diagnostic, repair });
        }
        _ => return None,
    };
    let is_sign = matches!(found.token_at(sign), Some(Arrow | Colon | Comma | Implies));
    if !is_sign || found.token_at(sign + 1) != Some(Ident) || !ends(sign + 2) {
        return None;
    }
    let place = found.token_span(sign);
    let diagnostic = foreign_syntax("the next state follows `then`")
        .primary(place, "expected `then`")
        .fix(Fix::sure("write `then`").replace(
            place,
            super::foreign_operators::with_spaces(place, found.cx.text, "then"),
        ));
    Some(ForeignSyntax {
        diagnostic,
        repair: Repair::ReplaceTokens(vec![found.replacement(sign, &[Then])]),
    })
}

/// Returns whether `word` is a misspelling of `meant`, such as `thn` of `then`.
fn is_misspelling_of(meant: &str, word: &str) -> bool {
    rpi_diag::suggest(word, std::iter::once(meant)).is_some()
}

/// Recognises `returns` at the end of a SCADE automaton: `... state B let ... tel until d then A; returns z;`.
pub(super) fn returns_at_end(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = found.error.index;
    if found.token_at(at) != Some(Token::Returns) || !found.expects(Token::End) {
        return None;
    }
    let semi = (at..found.lexemes.len())
        .find(|at| matches!(found.token_at(*at), Some(Token::Semi | Token::Tel)))?;
    let end = semi + usize::from(found.token_at(semi) == Some(Token::Semi));
    let place = found.range_span(at..end);
    let diagnostic = foreign_syntax("an automaton ends with `end`, without a list of flows")
        .primary(
            place,
            "flows defined in states belong to the enclosing body",
        )
        .fix(Fix::sure("write `end`").replace(place, "end"));
    Some(ForeignSyntax {
        diagnostic,
        repair: Repair::ReplaceTokens(vec![(at..end, found.replacement(at, &[Token::End]).1)]),
    })
}

/// Recognises states in foreign syntax: `state A do y = x until c then B`, `A -> do ...`, `state A { y = x; }`.
pub(super) fn foreign_states(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = found.error.index;
    let is_state = found.token_before() == Some(Token::Ident)
        && at
            .checked_sub(2)
            .is_some_and(|at| found.token_at(at) == Some(Token::State));
    let is_body = is_state && body_start(found, at).is_some();
    let is_bare = found.token_at(at) == Some(Token::Ident)
        && matches!(found.token_before(), Some(Token::Automaton | Token::Bar))
        && body_start(found, at + 1).is_some();
    let is_braced =
        found.token_at(at) == Some(Token::LBrace) && found.token_before() == Some(Token::Automaton);
    if !is_body && !is_bare && !is_braced {
        return None;
    }
    let open = (0..at)
        .rev()
        .find(|at| found.token_at(*at) == Some(Token::Automaton))?;
    let edits = Rewriter {
        found,
        at: open + 1,
        edits: Vec::new(),
    }
    .automaton()?;
    let diagnostic = foreign_syntax("the equations of a state are written between `let` and `tel`")
        .primary(
            found.token_span(at),
            "state in the syntax of another language",
        )
        .help("`initial state A let y = x; tel until c then B;`");
    let fix = edits
        .iter()
        .fold(Fix::maybe("write `state`, `let` and `tel`"), |fix, edit| {
            edit.add_to_fix(found, fix)
        });
    let repair = Repair::ReplaceTokens(edits.iter().map(|edit| edit.token_edit(found)).collect());
    Some(ForeignSyntax {
        diagnostic: diagnostic.fix(fix),
        repair,
    })
}

/// Returns whether token `at` is one of `words`, ignoring case.
fn is_any_of(found: &ErrorContext<'_, '_>, at: usize, words: &[&str]) -> bool {
    words
        .iter()
        .any(|word| found.source_text(at).eq_ignore_ascii_case(word))
}

/// Returns the index one past the tokens that open a body instead of `let`: `do`, `{`, `: do`, `-> do`, `begin`.
fn body_start(found: &ErrorContext<'_, '_>, at: usize) -> Option<usize> {
    match found.token_at(at)? {
        Token::LBrace => Some(at + 1),
        Token::Arrow | Token::Colon | Token::Implies
            if is_any_of(found, at + 1, &["do", "begin", "var"]) =>
        {
            Some(at + 2)
        }
        Token::Arrow | Token::Implies => Some(at + 1),
        _ if is_any_of(found, at, &["do", "begin", "entry", "during"]) => Some(at + 1),
        _ => None,
    }
}

/// Replacement of a range of tokens by others.
struct Edit {
    range: Range<usize>,
    tokens: Vec<Token>,
}

impl Edit {
    fn token_edit(&self, found: &ErrorContext<'_, '_>) -> (Range<usize>, Vec<Lexeme>) {
        let mut lexemes = Vec::new();
        for token in &self.tokens {
            lexemes.extend(found.insertion(self.range.start, *token).1);
        }
        (self.range.clone(), lexemes)
    }

    fn add_to_fix(&self, found: &ErrorContext<'_, '_>, fix: Fix) -> Fix {
        let words: Vec<&str> = self
            .tokens
            .iter()
            .filter_map(|token| token.spelling())
            .collect();
        let text = words.join(" ").replace(" ;", ";");
        if !self.range.is_empty() {
            return fix.replace(found.range_span(self.range.clone()), text);
        }
        let behind = found.token_span(self.range.start.saturating_sub(1));
        match text.starts_with(';') {
            true => fix.insert_after(behind, text),
            false => fix.insert_after(behind, format!(" {text}")),
        }
    }
}

/// Walker over the states of a foreign automaton. Collects the edits that turn it into an RPI automaton.
struct Rewriter<'r, 'f, 't> {
    found: &'r ErrorContext<'f, 't>,
    at: usize,
    edits: Vec<Edit>,
}

impl Rewriter<'_, '_, '_> {
    fn automaton(mut self) -> Option<Vec<Edit>> {
        let mut first = true;
        let is_braced = self.token() == Some(Token::LBrace);
        if is_braced {
            self.replace(1, &[]);
        }
        loop {
            if self.token() == Some(Token::Bar) {
                self.replace(1, &[]);
            }
            if self.is_end() {
                break;
            }
            self.header(first)?;
            self.body();
            self.transitions();
            first = false;
        }
        match self.token() {
            Some(Token::End) => {}
            Some(Token::RBrace) if is_braced => self.replace(1, &[Token::End]),
            _ => self.insert(&[Token::End]),
        }
        Some(self.edits)
    }

    fn is_end(&self) -> bool {
        matches!(
            self.token(),
            None | Some(Token::End | Token::RBrace | Token::Tel)
        )
    }

    /// Walks over `initial state A` and inserts the missing keywords. Returns `None` without a state name.
    fn header(&mut self, first: bool) -> Option<()> {
        let is_initial = self.token() == Some(Token::Initial);
        self.at += usize::from(is_initial);
        let has_word = self.token() == Some(Token::State);
        let words: &[Token] = match (first && !is_initial && !self.any_initial(), has_word) {
            (true, true) => &[Token::Initial],
            (true, false) => &[Token::Initial, Token::State],
            (false, true) => &[],
            (false, false) => &[Token::State],
        };
        self.insert(words);
        self.at += usize::from(has_word);
        let is_name = self.token() == Some(Token::Ident);
        self.at += 1;
        is_name.then_some(())
    }

    /// Returns whether any later state is marked `initial`.
    fn any_initial(&self) -> bool {
        let after = self.at..self.found.lexemes.len();
        let mut tokens = after.map(|at| self.found.token_at(at));
        tokens.any(|token| token == Some(Token::Initial))
    }

    fn body(&mut self) {
        if self.token() == Some(Token::Unless) {
            self.transition();
        }
        if self.token() == Some(Token::Let) {
            let close = self.found.structure.partner(self.at);
            self.at = close.map_or(self.found.lexemes.len(), |close| close + 1);
            return;
        }
        let Some(start) = body_start(self.found, self.at) else {
            return;
        };
        self.replace(start - self.at, &[Token::Let]);
        while !self.ends_body() {
            self.at += 1;
        }
        let lacks_semi = self.at > start && self.before() != Some(Token::Semi);
        let tokens: &[Token] = if lacks_semi {
            &[Token::Semi, Token::Tel]
        } else {
            &[Token::Tel]
        };
        let closes =
            self.token() == Some(Token::RBrace) || is_any_of(self.found, self.at, &["done"]);
        match closes {
            true => self.replace(1, tokens),
            false => self.insert(tokens),
        }
    }

    fn ends_body(&self) -> bool {
        use Token::{Bar, End, Initial, RBrace, State, Tel, Unless, Until};
        let ends = matches!(
            self.token(),
            None | Some(Bar | End | Initial | RBrace | State | Tel | Unless | Until)
        );
        ends || is_any_of(self.found, self.at, &["done"]) || self.begins_bare_state()
    }

    /// Returns whether a state without `state` begins here: `B -> do ...`.
    fn begins_bare_state(&self) -> bool {
        self.token() == Some(Token::Ident)
            && self.found.token_at(self.at + 1) == Some(Token::Arrow)
            && body_start(self.found, self.at + 1) == Some(self.at + 3)
    }

    fn transitions(&mut self) {
        while matches!(self.token(), Some(Token::Until | Token::Unless)) {
            self.transition();
        }
    }

    fn transition(&mut self) {
        use Token::{End, Initial, Let, Semi, State, Tel, Unless, Until};
        self.at += 1;
        loop {
            match self.token() {
                Some(Semi) => {
                    self.at += 1;
                    return;
                }
                None | Some(End | Initial | Let | Token::RBrace | State | Tel | Unless | Until) => {
                    break;
                }
                Some(_)
                    if self.begins_bare_state()
                        || body_start(self.found, self.at) == Some(self.at + 1)
                            && self.token() != Some(Token::Arrow) =>
                {
                    break;
                }
                Some(_) => self.at += 1,
            }
        }
        self.insert(&[Semi]);
    }

    fn token(&self) -> Option<Token> {
        self.found.token_at(self.at)
    }

    fn before(&self) -> Option<Token> {
        self.found.token_at(self.at - 1)
    }

    fn insert(&mut self, tokens: &[Token]) {
        if !tokens.is_empty() {
            self.edit(0, tokens);
        }
    }

    fn replace(&mut self, count: usize, tokens: &[Token]) {
        self.edit(count, tokens);
        self.at += count;
    }

    /// Records an edit of the next `count` tokens. Insertions at the same position become one edit.
    fn edit(&mut self, count: usize, tokens: &[Token]) {
        let range = self.at..self.at + count;
        match self.edits.last_mut() {
            Some(last) if last.range.end == range.start && last.range.is_empty() => {
                last.range.end = range.end;
                last.tokens.extend_from_slice(tokens);
            }
            _ => self.edits.push(Edit {
                range,
                tokens: tokens.to_vec(),
            }),
        }
    }
}

/// Recognises a transition after a body with another keyword than `until`: `when c then B;`, `if c then B;`.
pub(super) fn transition_keyword(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = found.error.index;
    let is_word = matches!(found.token_at(at), Some(Token::When | Token::If))
        || is_any_of(found, at, &["on", "transition", "goto", "trans", "exit"]);
    if !is_word || !found.expects(Token::Until) || !found.expects(Token::State) {
        return None;
    }
    let diagnostic =
        foreign_syntax("a transition begins with `until` after the body, or `unless` before it")
            .primary(found.token_span(at), "expected `until`");
    Some(found.replace_word(diagnostic, at, Token::Until))
}

/// Recognises a foreign closing keyword: `automaton ... end_automaton`.
pub(super) fn foreign_end(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    const ENDS: &[&str] = &[
        "end_automaton",
        "endautomaton",
        "end",
        "endstate",
        "done",
        "end_state_machine",
    ];
    let at = found.error.index;
    let is_here = found.expects(Token::End) && found.expects(Token::State);
    if !is_here || !is_any_of(found, at, ENDS) || found.token_at(at) == Some(Token::End) {
        return None;
    }
    let diagnostic = foreign_syntax("an automaton ends with `end`")
        .primary(found.token_span(at), "keyword of another language");
    Some(found.replace_word(diagnostic, at, Token::End))
}

/// Recognises another keyword for `automaton`: `state_machine initial state A ...`.
pub(super) fn automaton_keyword(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    const WORDS: &[&str] = &[
        "state_machine",
        "statemachine",
        "fsm",
        "machine",
        "automata",
        "states",
        "sm",
    ];
    let word = found.error.index.checked_sub(1)?;
    let goes_on = is_any_of(found, word + 1, &["initial", "state"]);
    if !goes_on || !is_any_of(found, word, WORDS) || found.token_at(word) != Some(Token::Ident) {
        return None;
    }
    let diagnostic = foreign_syntax("a state machine begins with `automaton`")
        .primary(found.token_span(word), "keyword of another language")
        .fix(Fix::sure("write `automaton`").replace(found.token_span(word), "automaton"));
    Some(ForeignSyntax {
        diagnostic,
        repair: Repair::RemoveItem,
    })
}
