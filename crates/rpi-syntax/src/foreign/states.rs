//! Automata in the syntax of Heptagon, SCADE and others: `state A do y = x until c then B`.

use super::{ForeignSyntax, Repair, foreign_syntax};
use crate::foreign::state_rewriter::Rewriter;
use crate::syntax_errors::ErrorContext;
use crate::token::Token;
use rpi_diag::{Code, Diagnostic, Fix};

/// Recognises an automaton with a name, which RPI does not have: `automaton SM1 initial state A ...`.
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

/// Words that mark the initial state of an automaton in other languages.
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

/// Recognises a first state without `state`: `initial A let`.
pub(super) fn missing_state(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    use Token::{Ident, Initial, Let, State, Unless, Var};
    let at = found.error.index;
    let is_name = [found.token_before(), found.token_at(at)] == [Some(Initial), Some(Ident)];
    let begins = matches!(found.token_at(at + 1), Some(Let | Unless | Var));
    if !is_name || !begins || !found.expects(State) {
        return None;
    }
    let diagnostic = Diagnostic::new(Code::RPI0001, "expected `state` after `initial`")
        .primary(found.token_span(at), "the name of the state")
        .fix(Fix::sure("insert `state`").insert_before(found.token_span(at), "state "));
    let repair = Repair::ReplaceTokens(vec![found.insertion(at, State)]);
    Some(ForeignSyntax { diagnostic, repair })
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

/// Returns whether `word` is a misspelling of the keyword `meant`, as `thn` is of `then`.
fn is_misspelling_of(meant: &str, word: &str) -> bool {
    rpi_diag::suggest(word, std::iter::once(meant)).is_some()
}

/// Recognises the list of flows at the end of a SCADE automaton: `... state B let ... tel until d then A; returns z;`.
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

/// Returns whether the text of token `at` is one of `words`, ignoring case.
pub(crate) fn is_any_of(found: &ErrorContext<'_, '_>, at: usize, words: &[&str]) -> bool {
    words
        .iter()
        .any(|word| found.source_text(at).eq_ignore_ascii_case(word))
}

/// Returns the index one past the tokens at `at` that open a body in place of `let`: `do`, `{`, `: do`, `-> do`,
/// `begin`. `None` if there are no such tokens.
pub(crate) fn body_start(found: &ErrorContext<'_, '_>, at: usize) -> Option<usize> {
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

/// Recognises a transition after the body of a state with another keyword than `until`: `when c then B;`,
/// `if c then B;`.
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
