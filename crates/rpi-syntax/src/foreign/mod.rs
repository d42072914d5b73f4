//! Recognises syntax of other languages in place of the equivalent RPI syntax.
//!
//! Each construct is reported once, with a fix. The tokens are then replaced by the equivalent RPI tokens, so that no
//! follow-up errors arise. The lexer recognises foreign operators ([`sign`]). All other constructs are recognised at
//! the token that the grammar rejected ([`recognise`]).

mod bodies;
mod brackets;
mod closing_keywords;
mod conditional_extent;
mod declarations;
mod equation_values;
mod expressions;
mod foreign_operators;
mod headers;
mod if_statement;
mod imperative;
mod initial_values;
mod kind2;
mod misspelt_keywords;
mod operators;
mod ports;
mod state_rewriter;
mod statement_kinds;
mod statements;
mod states;
mod steps;
mod transitions;
mod type_first;
mod typed_equations;
mod updates;
mod word_operators;

pub(crate) use foreign_operators::{
    AssignContext, assign_diagnostic, find_operator, operator_diagnostic, with_spaces,
};
pub(crate) use initial_values::remove_initial_values;

use crate::ast::Ident;
use crate::lexer::Lexeme;
use crate::syntax_errors::ErrorContext;
use crate::token::Token;
use rpi_diag::{Code, Diagnostic, Fix, Span};
use std::ops::Range;

/// Construct of another language that explains a syntax error: the diagnostic, and the repair of the tokens with which
/// parsing continues.
pub(crate) struct ForeignSyntax {
    pub(crate) diagnostic: Diagnostic,
    pub(crate) repair: Repair,
}

/// Change of the tokens of a declaration after a syntax error, so that parsing can continue.
pub(crate) enum Repair {
    /// Replaces each range of token indices by other tokens. The ranges are in ascending order and do not overlap.
    ReplaceTokens(Vec<(Range<usize>, Vec<Lexeme>)>),
    /// Replaces a range of token indices by one error token. The following rules treat the given names as defined.
    RemovePhrase(Range<usize>, Vec<Ident>),
    /// Replaces the statement or inner declaration that contains the error by an error token, as for other syntax
    /// errors.
    RemoveErrorPhrase,
    /// Replaces the whole declaration by an error node of the tree.
    RemoveItem,
}

/// Functions that recognise constructs of other languages at a syntax error. Each inspects the rejected token and its
/// neighbours.
// The order matters: the first recogniser that matches wins, so specific ones stand before general ones.
const RECOGNISERS: &[fn(&ErrorContext<'_, '_>) -> Option<ForeignSyntax>] = &[
    equation_values::doubled_semi,
    steps::step_by_condition,
    steps::step_without_arguments,
    steps::repeat_without_times,
    steps::times_without_repeat,
    steps::steps_without_semi,
    steps::step_with_value,
    steps::result_without_keyword,
    ports::matlab_header,
    declarations::enum_without_keyword,
    declarations::module_by_path,
    type_first::ports_with_type_first,
    ports::incomplete_port,
    ports::returns_sign,
    ports::bare_ports,
    ports::locals_keyword,
    ports::locals_closing_keyword,
    ports::let_rec,
    type_first::const_with_type_first,
    type_first::array_type,
    type_first::declared_in_body,
    type_first::array_in_body,
    states::named_automaton,
    states::initial_keyword,
    states::missing_state,
    states::returns_at_end,
    states::transition_keyword,
    states::foreign_end,
    states::automaton_keyword,
    expressions::case_expression,
    expressions::lambda,
    expressions::dictionary,
    expressions::unless_expression,
    expressions::several_indices,
    expressions::call_keyword,
    expressions::if_function,
    expressions::merge_without_cases,
    expressions::misplaced_every,
    expressions::method_call,
    brackets::array_in_braces,
    brackets::targets_in_brackets,
    brackets::arguments_in_static_brackets,
    brackets::range_test,
    brackets::comprehension,
    brackets::string_as_comment,
    word_operators::prefix_word,
    word_operators::bool_conversion,
    word_operators::counted_condition,
    equation_values::tuple_without_parens,
    equation_values::increment,
    equation_values::upper_case_conditional,
    equation_values::conditional_with_braces,
    equation_values::fby_function,
    equation_values::operator_argument,
    kind2::set_or_map,
    kind2::reachability_query,
    kind2::recursive_function,
    operators::percent_product,
    operators::remainder,
    operators::else_if,
    transitions::transition_with_if,
    transitions::foreign_target_word,
    transitions::doubled_target_word,
    transitions::unless_after_body,
    states::missing_then,
    transitions::state_without_let,
    states::foreign_states,
    closing_keywords::end_for_tel,
    transitions::state_without_tel,
    transitions::automaton_without_end,
    closing_keywords::python_conditional,
    closing_keywords::automaton_in_lustre,
    operators::missing_else,
    operators::c_conditional,
    word_operators::infix_word,
    statements::statement,
    misspelt_keywords::keyword,
    expressions::clock_expression,
    operators::missing_star,
    operators::bare_unit,
    operators::field_by_colon,
    updates::update_without_parens,
    updates::field_without_dot,
    operators::struct_without_type,
    headers::array_of,
    headers::enum_by_semi,
    headers::size_in_brackets,
    headers::unit_of_int,
    operators::closing_keyword,
    typed_equations::shift,
    operators::unmatched_bracket,
    headers::missing_returns,
    bodies::body_in_braces,
    bodies::body_without_let,
    bodies::no_let_after_locals,
    bodies::begin_end,
    headers::comma_for_semi,
    headers::unclosed_ports,
    headers::missing_semi,
    headers::missing_colon,
    headers::type_first,
    typed_equations::semi_in_head,
    typed_equations::arguments_by_semi,
    typed_equations::cast,
    typed_equations::as_cast,
    imperative::doubled_semi,
    imperative::declaration_keyword,
    typed_equations::typed_equation_keyword,
    imperative::declaration_after_let,
    imperative::compound_assignment,
    imperative::return_statement,
    if_statement::if_statement,
    imperative::unnamed_result,
    misspelt_keywords::statement_keyword,
    misspelt_keywords::tel,
    typed_equations::typed_equation,
    typed_equations::missing_eq,
    typed_equations::le_assignment,
    expressions::call_without_parens,
];

/// Returns the first construct of another language that explains the syntax error; `None` if no recogniser matches.
pub(crate) fn recognise(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    RECOGNISERS.iter().find_map(|recogniser| recogniser(found))
}

/// Creates a diagnostic (RPI0016) about syntax of another language, without labels and fixes.
fn foreign_syntax(message: impl Into<String>) -> Diagnostic {
    Diagnostic::new(Code::RPI0016, message)
}

/// Placeholder for a token where the list of tokens is empty.
const EMPTY_LEXEME: Lexeme = Lexeme {
    token: Token::Broken,
    start: 0,
    end: 0,
};

/// Access of the recognisers of foreign syntax to the tokens around a syntax error, and construction of repairs.
impl ErrorContext<'_, '_> {
    fn token_at(&self, at: usize) -> Option<Token> {
        self.lexemes.get(at).map(|lexeme| lexeme.token)
    }

    /// Returns the token before the rejected one; `None` at the start of the declaration.
    fn token_before(&self) -> Option<Token> {
        self.error
            .index
            .checked_sub(1)
            .and_then(|at| self.token_at(at))
    }

    fn expects(&self, token: Token) -> bool {
        self.error.expected.contains(&token)
    }

    /// Returns whether the grammar accepts an equation at the rejected token.
    fn expects_equation(&self) -> bool {
        self.expects(Token::Assert) && self.expects(Token::Automaton)
    }

    /// Returns the source text of the token at index `at`; empty for an index past the last token.
    fn source_text(&self, at: usize) -> &str {
        let lexeme = self.lexemes.get(at);
        lexeme.map_or("", |lexeme| self.cx.slice(lexeme.start, lexeme.end))
    }

    /// Returns the source text from the first to the last token of a range, gaps included.
    fn range_text(&self, range: Range<usize>) -> &str {
        let span = self.range_span(range);
        self.cx.slice(span.start, span.end)
    }

    fn token_span(&self, at: usize) -> Span {
        self.range_span(at..at + 1)
    }

    fn range_span(&self, range: Range<usize>) -> Span {
        let last = self.lexemes.len().saturating_sub(1);
        let place = |at: usize| {
            self.lexemes
                .get(at.min(last))
                .copied()
                .unwrap_or(EMPTY_LEXEME)
        };
        let (first, last) = (place(range.start), place(range.end.saturating_sub(1)));
        self.cx.span(first.start, last.end)
    }

    /// Returns the edit that replaces the token at index `at` by `tokens`, which all get the location of the old token.
    fn replacement(&self, at: usize, tokens: &[Token]) -> (Range<usize>, Vec<Lexeme>) {
        let old = self.lexemes[at];
        let lexemes = tokens.iter().map(|&token| Lexeme { token, ..old });
        (at..at + 1, lexemes.collect())
    }

    /// Returns the repair that replaces an opening and a closing bracket, at the token indices `open` and `close`, by
    /// two other tokens.
    fn replace_brackets(&self, open: usize, close: usize, [first, last]: [Token; 2]) -> Repair {
        Repair::ReplaceTokens(vec![
            self.replacement(open, &[first]),
            self.replacement(close, &[last]),
        ])
    }

    /// Adds a sure fix that replaces the text of token `at` by the keyword or symbol `meant`. The repair replaces the
    /// token in the same way.
    fn replace_word(&self, diagnostic: Diagnostic, at: usize, meant: Token) -> ForeignSyntax {
        let (place, word) = (self.token_span(at), meant.spelling().unwrap_or_default());
        let fix = Fix::sure(format!("write `{word}`")).replace(place, word);
        ForeignSyntax {
            diagnostic: diagnostic.fix(fix),
            repair: Repair::ReplaceTokens(vec![self.replacement(at, &[meant])]),
        }
    }

    /// Returns the edit that inserts an empty token before token `at`; after the last token if `at` lies past it.
    fn insertion(&self, at: usize, token: Token) -> (Range<usize>, Vec<Lexeme>) {
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
