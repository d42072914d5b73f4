//! Recognises syntax of other languages in place of the equivalent RPI syntax.
//!
//! Each construct is reported once, with a fix. The tokens are then replaced by the equivalent RPI tokens, so that no
//! follow-up errors arise. The lexer recognises foreign operators ([`sign`]). All other constructs are recognised at
//! the token that the grammar rejected ([`recognise`]).

mod automata;
mod bodies;
mod choice;
mod declared;
mod endings;
mod firsts;
mod foreign;
mod forms;
mod heads;
mod kind2;
mod lists;
mod misspelt;
mod operators;
mod ports;
mod signs;
mod states;
mod typed;
mod updates;
mod values;
mod words;

pub(crate) use firsts::without_first_values;
pub(crate) use signs::{Becomes, NAMED, apart, becomes, foreign_sign, sign};

use crate::ast::Ident;
use crate::explain::Found;
use crate::lexer::Lexeme;
use crate::token::Token;
use rpi_diag::{Code, Finding, Fix, Span};
use std::ops::Range;

/// A recognised construct of another language: its diagnostic and the repair of the tokens.
pub(crate) struct Habit {
    pub(crate) finding: Finding,
    pub(crate) mend: Mend,
}

/// Repair of the tokens after a syntax error, so that parsing can continue.
pub(crate) enum Mend {
    /// Replaces each range of token indices by other tokens. The ranges are in text order.
    Tokens(Vec<(Range<usize>, Vec<Lexeme>)>),
    /// Replaces the range of token indices by one error node that defines the given names.
    Phrase(Range<usize>, Vec<Ident>),
    /// Replaces the whole phrase with the error, as for any other syntax error.
    Usual,
    /// Replaces the whole declaration by an error node.
    Item,
}

/// Recognisers of foreign syntax. Each inspects the rejected token and its neighbours.
// The order matters: the first recogniser that matches wins, so specific ones stand before general ones.
const HABITS: &[fn(&Found<'_, '_>) -> Option<Habit>] = &[
    values::empty,
    foreign::step_by_condition,
    foreign::step_without_arguments,
    foreign::repeat_without_times,
    foreign::times_without_repeat,
    foreign::steps_in_row,
    foreign::step_with_value,
    foreign::result_without_word,
    ports::matlab,
    declared::enum_without_word,
    declared::module,
    ports::typed_first,
    ports::half_port,
    ports::result,
    ports::bare_ports,
    ports::locals,
    ports::end_of_locals,
    ports::recursive,
    ports::typed_const,
    ports::array_type,
    ports::declared_in_body,
    ports::array_in_body,
    states::named,
    states::initial,
    states::returning,
    states::transition_word,
    states::foreign_end,
    states::machine,
    forms::cases,
    forms::lambda,
    forms::dictionary,
    forms::unless,
    forms::several_indices,
    forms::called_by_word,
    forms::called_if,
    forms::merge,
    forms::every,
    forms::method,
    lists::braces,
    lists::targets,
    lists::only_static,
    lists::range,
    lists::comprehension,
    lists::text,
    words::prefix,
    words::truth,
    words::times,
    values::no_tuple,
    values::stepped,
    values::capitals,
    values::braces,
    values::fby_called,
    values::operator_given,
    kind2::container,
    kind2::reachable,
    kind2::recursive,
    operators::remainder,
    operators::else_if,
    automata::conditional,
    automata::entry,
    automata::entry_twice,
    automata::late_unless,
    states::no_then,
    automata::no_let,
    states::bodies,
    endings::end_for_tel,
    automata::open_state,
    automata::no_end,
    endings::choice_behind,
    endings::automaton_in_lustre,
    operators::no_else,
    operators::conditional,
    words::infix,
    foreign::statement,
    misspelt::word,
    forms::clock,
    operators::product,
    operators::bare_unit,
    operators::field_by_colon,
    updates::no_parentheses,
    updates::no_dot,
    operators::struct_without_type,
    heads::array_of,
    heads::enum_by_semi,
    heads::size_in_brackets,
    heads::unit_of_int,
    operators::end_if,
    typed::shift,
    operators::stray_bracket,
    heads::returns,
    heads::braces,
    heads::no_let,
    heads::no_let_after_locals,
    heads::begin_end,
    heads::comma,
    heads::open_ports,
    heads::no_semi,
    heads::no_colon,
    heads::type_first,
    typed::semi_in_head,
    typed::arguments_by_semi,
    typed::cast,
    typed::cast_behind,
    bodies::doubled_semi,
    bodies::needless_word,
    typed::typed_word,
    bodies::late_declaration,
    bodies::compound,
    bodies::returned,
    choice::choice,
    bodies::nameless,
    misspelt::statement,
    misspelt::tel,
    typed::typed,
    typed::no_sign,
    typed::assigned,
    forms::applied,
];

/// Returns the first construct of another language that explains a rejected token.
pub(crate) fn recognise(found: &Found<'_, '_>) -> Option<Habit> {
    HABITS.iter().find_map(|habit| habit(found))
}

/// Creates a diagnostic (RPI0016) about syntax of another language.
fn habit(message: impl Into<String>) -> Finding {
    Finding::new(Code::RPI0016, message)
}

/// Placeholder lexeme for an empty list of tokens.
const NOTHING: Lexeme = Lexeme {
    token: Token::Broken,
    start: 0,
    end: 0,
};

/// Access to the tokens around a syntax error, and construction of repairs.
impl Found<'_, '_> {
    fn token(&self, at: usize) -> Option<Token> {
        self.lexemes.get(at).map(|lexeme| lexeme.token)
    }

    /// Returns the token before the rejected one.
    fn token_before(&self) -> Option<Token> {
        self.fault.at.checked_sub(1).and_then(|at| self.token(at))
    }

    fn expects(&self, token: Token) -> bool {
        self.fault.expected.contains(&token)
    }

    /// Returns whether the grammar accepts an equation at the rejected token.
    fn expects_equation(&self) -> bool {
        self.expects(Token::Assert) && self.expects(Token::Automaton)
    }

    /// Returns the source text of a token; empty for an index past the last token.
    fn written(&self, at: usize) -> &str {
        let lexeme = self.lexemes.get(at);
        lexeme.map_or("", |lexeme| self.cx.slice(lexeme.start, lexeme.end))
    }

    /// Returns the source text from the first to the last token of a range, gaps included.
    fn text(&self, range: Range<usize>) -> &str {
        let span = self.span_of(range);
        self.cx.slice(span.start, span.end)
    }

    fn span_at(&self, at: usize) -> Span {
        self.span_of(at..at + 1)
    }

    fn span_of(&self, range: Range<usize>) -> Span {
        let last = self.lexemes.len().saturating_sub(1);
        let place = |at: usize| self.lexemes.get(at.min(last)).copied().unwrap_or(NOTHING);
        let (first, last) = (place(range.start), place(range.end.saturating_sub(1)));
        self.cx.span(first.start, last.end)
    }

    /// Returns the edit that replaces one token by `tokens`, all at the location of the old one.
    fn instead(&self, at: usize, tokens: &[Token]) -> (Range<usize>, Vec<Lexeme>) {
        let old = self.lexemes[at];
        let lexemes = tokens.iter().map(|&token| Lexeme { token, ..old });
        (at..at + 1, lexemes.collect())
    }

    /// Returns the repair that replaces an opening and a closing bracket by two other tokens.
    fn brackets(&self, open: usize, close: usize, [first, last]: [Token; 2]) -> Mend {
        Mend::Tokens(vec![
            self.instead(open, &[first]),
            self.instead(close, &[last]),
        ])
    }

    /// Adds the sure fix that replaces token `at` by `meant`, with the same repair of the tokens.
    fn written_for(&self, finding: Finding, at: usize, meant: Token) -> Habit {
        let (place, word) = (self.span_at(at), meant.spelling().unwrap_or_default());
        let fix = Fix::sure(format!("write `{word}`")).replace(place, word);
        Habit {
            finding: finding.fix(fix),
            mend: Mend::Tokens(vec![self.instead(at, &[meant])]),
        }
    }

    /// Returns the edit that inserts a token without text before token `at`, or after the last token.
    fn before_token(&self, at: usize, token: Token) -> (Range<usize>, Vec<Lexeme>) {
        let place = match self.lexemes.get(at) {
            Some(next) => next.start,
            None => self.lexemes.last().map_or(0, |last| last.end),
        };
        let lexeme = Lexeme {
            token,
            start: place,
            end: place,
        };
        (at..at, vec![lexeme])
    }
}
