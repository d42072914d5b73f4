//! Resolution of contextual keywords: decides where such a word is a keyword and where it is a name.
//!
//! One pass over the tokens, left to right, uses the row of the keyword table and the neighbouring tokens. So few words
//! need to be reserved, and the grammar has no ambiguity to resolve.

use crate::Dialect;
use crate::lexer::Lexeme;
use crate::neighbours;
use crate::neighbours::Neighbours;
use crate::token::Token;

/// Turns each contextual keyword that is used as a name into a name token, and each string that names a claim into a
/// label token.
pub(crate) fn resolve_keywords(lexemes: &mut [Lexeme], mode: Dialect) {
    let has_own_check = mode == Dialect::Rpi && declares_node(lexemes, Token::Check);
    let has_own_last = declares_node(lexemes, Token::Last);
    let matched = matches_on_parentheses(lexemes);
    let enclosed = semicolons_in_brackets(lexemes);
    let mut in_contract = false;
    for at in 0..lexemes.len() {
        let token = lexemes[at].token;
        if token == Token::Str {
            resolve_label(lexemes, at);
        } else if let Some(word) = token.keyword()
            && !word.is_reserved_in(mode)
            && !Neighbours::new(lexemes, at, &enclosed).is_keyword(word)
            && !begins_claim(lexemes, at, in_contract, has_own_check, &enclosed)
            && !is_activate_of_restart(lexemes, at)
            && (has_own_last || !is_last_operator(lexemes, at, &enclosed))
            && matched.binary_search(&at).is_err()
        {
            lexemes[at].token = Token::Ident;
        }
        match lexemes[at].token {
            Token::Con | Token::Contract => in_contract = true,
            Token::Noc | Token::Tel => in_contract = false,
            _ => {}
        }
    }
}

/// Returns the indices of the `;` inside brackets, in text order: `merge(c; start * 2.0; x)`. No statement begins after
/// such a `;`.
///
/// The `;` in a mode of a contract, `mode m (require x; ensure y)`, and in an unclosed bracket are left out.
fn semicolons_in_brackets(lexemes: &[Lexeme]) -> Vec<usize> {
    use Token::{LBracket, LParen, LStatic, Let, RBracket, RParen, RStatic, Semi, Tel};
    let of_mode = |open: usize| open >= 2 && lexemes[open - 2].token == Token::ModeWord;
    // Each open bracket with the number of `;` found before it.
    let mut open: Vec<(usize, usize)> = Vec::new();
    let mut found = Vec::new();
    for (at, lexeme) in lexemes.iter().enumerate() {
        match lexeme.token {
            LParen | LBracket | LStatic => open.push((at, found.len())),
            Let | Tel => {
                truncate_to_first(&mut found, &open);
                open.clear();
            }
            Semi if !open.is_empty() => found.push(at),
            RParen | RBracket | RStatic => {
                if let Some((begin, count)) = open.pop()
                    && of_mode(begin)
                {
                    found.truncate(count);
                }
            }
            _ => {}
        }
    }
    truncate_to_first(&mut found, &open);
    found
}

/// Removes the indices in `found` that were added after the first bracket in `open`. An entry of `open` is the index of
/// an unclosed bracket and the length of `found` at that bracket.
fn truncate_to_first(found: &mut Vec<usize>, open: &[(usize, usize)]) {
    if let Some((_, count)) = open.first() {
        found.truncate(*count);
    }
}

/// Returns whether the token at index `at` is the operator `last` before a bracket: `last (x)`. `enclosed` are the
/// indices of the `;` inside brackets.
fn is_last_operator(lexemes: &[Lexeme], at: usize, enclosed: &[usize]) -> bool {
    let around = Neighbours::new(lexemes, at, enclosed);
    lexemes[at].token == Token::Last && around.after == Some(Token::LParen) && !around.is_field()
}

/// Returns whether the token at index `at` is the keyword in `(activate (restart N every r) every c)`, and not the name
/// of a called node.
fn is_activate_of_restart(lexemes: &[Lexeme], at: usize) -> bool {
    let token = |behind: usize| lexemes.get(at + behind).map(|lexeme| lexeme.token);
    lexemes[at].token == Token::Activate
        && [token(1), token(2)] == [Some(Token::LParen), Some(Token::Restart)]
        && token(3).is_some_and(neighbours::is_name)
}

/// Returns the indices of the keywords `match` before a value in parentheses, `match (o) with A: 1 end`, in text order.
///
/// A `match` without cases after the parentheses is the name of a called node.
fn matches_on_parentheses(lexemes: &[Lexeme]) -> Vec<usize> {
    let mut open = Vec::new();
    let mut found = Vec::new();
    for (at, lexeme) in lexemes.iter().enumerate() {
        match lexeme.token {
            Token::LParen => open.push(at),
            Token::RParen => {
                let word = open.pop().and_then(|open: usize| open.checked_sub(1));
                let word = word.filter(|word| lexemes[*word].token == Token::Match);
                found.extend(word.filter(|_| cases_follow(lexemes, at + 1)));
            }
            _ => {}
        }
    }
    found.sort_unstable();
    found
}

/// Returns whether the cases of a `match` begin at token `at`: `with A: 1`, `with | A: 1`, `with W(A): 1`. An update
/// has the form `with [0] = 1`.
fn cases_follow(lexemes: &[Lexeme], at: usize) -> bool {
    let token = |i: usize| lexemes.get(i).map(|lexeme| lexeme.token);
    let is_case = token(at + 1).is_some_and(neighbours::is_name)
        && matches!(token(at + 2), Some(Token::Colon | Token::LParen));
    token(at) == Some(Token::With) && (is_case || token(at + 1) == Some(Token::Bar))
}

/// Returns whether the file declares a node, function or fragment whose name is the keyword `word`.
fn declares_node(lexemes: &[Lexeme], word: Token) -> bool {
    use Token::{Fragment, Function, Imported, Node};
    let pairs = lexemes.windows(2);
    let declares = |token| matches!(token, Node | Function | Fragment | Imported);
    let mut names = pairs.filter(|pair| declares(pair[0].token));
    names.any(|pair| pair[1].token == word)
}

/// Returns whether the token at index `at` is the keyword of a claim in brackets, not the name of a called node:
/// `guarantee (x > 0);` in a contract, `check (x > 0);` in a body.
///
/// If the file declares a node `check` (`has_own_check`), `check (x > 0);` is a call. `enclosed` are the indices of the
/// `;` inside brackets.
fn begins_claim(
    lexemes: &[Lexeme],
    at: usize,
    in_contract: bool,
    has_own_check: bool,
    enclosed: &[usize],
) -> bool {
    use Token::{Assume, Check, Ensure, Guarantee, LParen, ModeWord, Require};
    let around = Neighbours::new(lexemes, at, enclosed);
    let of_mode = |at: usize| lexemes[at].token == ModeWord;
    let begins = match around.before {
        Some(LParen) => at.checked_sub(3).is_some_and(of_mode),
        _ => around.begins_statement(),
    };
    let is_claim = match lexemes[at].token {
        Check => !in_contract && !has_own_check,
        Assume | Ensure | Guarantee | Require => in_contract,
        _ => false,
    };
    is_claim && begins && around.after == Some(LParen)
}

fn resolve_label(lexemes: &mut [Lexeme], at: usize) {
    use Token::{Assert, Assume, Check, Ensure, Guarantee, Property, Require};
    let before = at.checked_sub(1).map(|i| lexemes[i].token);
    if let Some(Assert | Assume | Check | Ensure | Guarantee | Property | Require) = before {
        lexemes[at].token = Token::Label;
    }
}

/// Inserts the keyword `type` before a real type with a unit in static arguments, so that `f<<real[m]>>` is read as
/// `f<<type real[m]>>`.
pub(crate) fn insert_type_keywords(lexemes: &mut Vec<Lexeme>) {
    use Token::{Comma, LBracket, LStatic, RealType};
    let begins = |at: &usize| {
        let is_type = lexemes[at + 1].token == RealType && lexemes[at + 2].token == LBracket;
        match lexemes[*at].token {
            LStatic => is_type,
            Comma => is_type && innermost_open_bracket(&lexemes[..*at]) == Some(LStatic),
            _ => false,
        }
    };
    let marks: Vec<usize> = (0..lexemes.len().saturating_sub(2))
        .filter(begins)
        .collect();
    if marks.is_empty() {
        return;
    }
    let mut marked = Vec::with_capacity(lexemes.len() + marks.len());
    let mut from = 0;
    for at in marks {
        marked.extend_from_slice(&lexemes[from..=at]);
        let start = lexemes[at + 1].start;
        marked.push(Lexeme {
            token: Token::Type,
            start,
            end: start,
        });
        from = at + 1;
    }
    marked.extend_from_slice(&lexemes[from..]);
    *lexemes = marked;
}

/// Maximum number of tokens searched backwards for the opening bracket of static arguments. Bounds the time for long
/// expressions.
const MAX_LOOKBEHIND: usize = 200;

/// Returns the innermost bracket that is open at the end of the tokens `before`; `None` if there is none nearby.
fn innermost_open_bracket(before: &[Lexeme]) -> Option<Token> {
    use Token::{LBrace, LBracket, LParen, LStatic, RBrace, RBracket, RParen, RStatic};
    let mut depth = 0u32;
    let opens = before
        .iter()
        .rev()
        .take(MAX_LOOKBEHIND)
        .find(|lexeme| match lexeme.token {
            RParen | RBracket | RBrace | RStatic => {
                depth += 1;
                false
            }
            LParen | LBracket | LBrace | LStatic if depth == 0 => true,
            LParen | LBracket | LBrace | LStatic => {
                depth -= 1;
                false
            }
            _ => false,
        });
    opens.map(|lexeme| lexeme.token)
}
