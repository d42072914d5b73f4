//! Nesting of brackets and bodies, and the extent of the phrase around a token.
//!
//! A phrase is the text between two `;`: an equation, a step, a transition, a port. The tokens need not form a valid
//! program.

use crate::lexer::Lexeme;
use crate::token::Token;
use std::ops::Range;

/// Nesting of the brackets and blocks in the tokens of one declaration. A phrase is a statement, step, parameter or
/// other element of a list in it.
pub(crate) struct TokenTree<'t> {
    lexemes: &'t [Lexeme],
    /// For each token that opens or closes a bracket or block, the index of its partner; `None` for other tokens and
    /// without a partner.
    partners: Vec<Option<usize>>,
    /// For each token, the index of the innermost opening token around it that has a partner or is a `let`; `None` at
    /// the outermost level.
    parents: Vec<Option<usize>>,
}

impl<'t> TokenTree<'t> {
    pub(crate) fn new(lexemes: &'t [Lexeme]) -> TokenTree<'t> {
        let partners = pair_tokens(lexemes);
        let parents = find_parents(lexemes, &partners);
        TokenTree {
            lexemes,
            partners,
            parents,
        }
    }

    /// Returns the token index of the innermost `let` without `tel`; `None` if all bodies are closed.
    pub(crate) fn unclosed_let(&self) -> Option<usize> {
        let is_let = |open: &usize| self.lexemes[*open].token == Token::Let;
        self.unclosed_blocks().filter(is_let).last()
    }

    /// Returns the token indices of each `let` without `tel` and each `automaton` without `end`, outermost first.
    pub(crate) fn unclosed_blocks(&self) -> impl Iterator<Item = usize> {
        let is_block = |i: &usize| matches!(self.lexemes[*i].token, Token::Let | Token::Automaton);
        (0..self.lexemes.len()).filter(move |i| is_block(i) && self.partners[*i].is_none())
    }

    /// Returns the token index of the start of the incomplete phrase (statement or step) at the end of the declaration;
    /// the number of tokens if there is none.
    pub(crate) fn incomplete_phrase_start(&self) -> usize {
        let Some(open) = self.unclosed_blocks().last() else {
            return self.lexemes.len();
        };
        if self.lexemes[open].token == Token::Automaton {
            return open;
        }
        let mut start = open + 1;
        while start < self.lexemes.len() {
            let end = self.phrase_end(start, start, Some(open));
            match self.token_at(end) {
                Some(Token::Semi) => start = end + 1,
                Some(_) if end > start => start = end,
                _ if end > start && self.closes_body(end - 1) => start = end,
                _ => break,
            }
        }
        start
    }

    /// Returns whether token `at` is the `tel` or `end` of a body or automaton, which also ends the phrase that
    /// contains the body.
    fn closes_body(&self, at: usize) -> bool {
        matches!(self.lexemes[at].token, Token::Tel | Token::End) && self.partners[at].is_some()
    }

    /// Returns the token index of the nearest bracket before token `at` that is in the same phrase (statement, step or
    /// parameter) and never closed.
    pub(crate) fn unclosed_bracket(&self, at: usize) -> Option<usize> {
        let phrase = self.phrase(at);
        let unclosed =
            |i: &usize| is_bracket(self.lexemes[*i].token) && self.partners[*i].is_none();
        (phrase.start..at.min(self.lexemes.len()))
            .rev()
            .find(unclosed)
    }

    /// Returns the token range of the phrase that contains token `at`, without its `;`. A phrase is a statement, step,
    /// parameter or other element of a list.
    pub(crate) fn phrase(&self, at: usize) -> Range<usize> {
        let (at, parent) = self.phrase_member(self.element_token(at));
        let start = self.phrase_start(at, parent);
        start..self.phrase_end(start, at, parent)
    }

    /// Returns the index `at`, or the index before it if token `at` closes a list or lies past the last token.
    fn element_token(&self, at: usize) -> usize {
        let opens = self
            .partners
            .get(at)
            .copied()
            .flatten()
            .filter(|open| *open < at);
        let ends_list = opens.is_some_and(|open| {
            is_bracket(self.lexemes[open].token) && self.is_header_list(open) && open + 1 < at
        });
        match ends_list || at >= self.lexemes.len() {
            true => at.saturating_sub(1),
            false => at,
        }
    }

    /// Returns the index of the token or bracket at or around token `at` that lies directly in a list of phrases, and
    /// the index of the opening token of that list (`None` at the outermost level).
    fn phrase_member(&self, mut at: usize) -> (usize, Option<usize>) {
        loop {
            let Some(parent) = self.parents.get(at).copied().flatten() else {
                return (at, None);
            };
            if !is_bracket(self.lexemes[parent].token) || self.is_header_list(parent) {
                return (at, Some(parent));
            }
            at = parent;
        }
    }

    /// Returns whether the bracket at token `open` encloses a list of parameters, ports or fields, each of which is a
    /// phrase of its own.
    fn is_header_list(&self, open: usize) -> bool {
        let outside = self.parents[open].is_none();
        outside && !matches!(self.lexemes[open].token, Token::LBracket)
    }

    /// Returns the index of the innermost opening token around token `at`; `None` if that is the outermost one or there
    /// is none.
    pub(crate) fn inner_parent(&self, at: usize) -> Option<usize> {
        let open = self.parents.get(at).copied().flatten()?;
        self.parents[open].map(|_| open)
    }

    /// Returns whether token `at` lies directly in a body, contract or automaton, and not in brackets.
    pub(crate) fn is_in_block(&self, at: usize) -> bool {
        let parent = self.parents.get(at).copied().flatten();
        parent.is_some_and(|open| is_block(self.lexemes[open].token))
    }

    /// Returns the index of the token that closes the bracket or block opened at `at`, or opens the one closed there;
    /// `None` without a partner.
    pub(crate) fn partner(&self, at: usize) -> Option<usize> {
        self.partners.get(at).copied().flatten()
    }

    /// Returns the index of the innermost opening token around token `at`, such as a bracket or `let`; `None` at the
    /// outermost level.
    pub(crate) fn parent(&self, at: usize) -> Option<usize> {
        self.parents.get(at).copied().flatten()
    }

    fn phrase_start(&self, at: usize, parent: Option<usize>) -> usize {
        let first = parent.map_or(0, |open| open + 1);
        let mut start = at;
        while start > first {
            let before = start - 1;
            match self.lexemes[before].token {
                Token::Unless | Token::Until => return before,
                token if ends_phrase(token) => break,
                _ => {
                    start = self.partners[before]
                        .filter(|p| *p < before)
                        .unwrap_or(before)
                }
            }
        }
        start.max(first)
    }

    fn phrase_end(&self, start: usize, at: usize, parent: Option<usize>) -> usize {
        let close = parent.and_then(|open| self.partners[open]);
        let last = close.unwrap_or(self.lexemes.len());
        let is_fragment = self.token_at(start) == Some(Token::Fragment);
        let mut end = at;
        while end < last {
            match self.lexemes[end].token {
                Token::Semi if is_fragment && self.continues_locals(end + 1) => end += 1,
                Token::Semi | Token::Tel | Token::Noc => break,
                // The body of the declaration itself is not part of a phrase of its header.
                Token::Let if parent.is_none() => break,
                Token::Let => {
                    let tel = self.partners[end];
                    return tel.map_or(last, |tel| tel + 1).min(last);
                }
                _ => end = self.partners[end].filter(|p| *p > end).unwrap_or(end) + 1,
            }
        }
        end.min(last)
    }

    /// Returns whether token `at`, after a `;`, continues the local declarations of a fragment or begins its body.
    fn continues_locals(&self, at: usize) -> bool {
        use Token::{Colon, Comma, Con, Const, Ident, Let, Var};
        match self.token_at(at) {
            Some(Var | Const | Con | Let) => true,
            Some(Ident) => matches!(self.token_at(at + 1), Some(Colon | Comma)),
            Some(_) => false,
            // The header of a fragment is incomplete.
            None => true,
        }
    }

    fn token_at(&self, at: usize) -> Option<Token> {
        self.lexemes.get(at).map(|lexeme| lexeme.token)
    }
}

fn ends_phrase(token: Token) -> bool {
    use Token::{Con, Const, End, Let, Noc, Semi, Tel, Var};
    matches!(token, Semi | Let | Tel | Con | Noc | End | Var | Const)
}

fn is_bracket(token: Token) -> bool {
    closing_token(token).is_some() && !is_block(token)
}

fn is_block(token: Token) -> bool {
    matches!(token, Token::Let | Token::Automaton | Token::Con)
}

/// Returns the token that closes a bracket or block, such as `)` for `(`; `None` for a token that opens none.
pub(crate) fn closing_token(open: Token) -> Option<Token> {
    use Token::*;
    Some(match open {
        LParen => RParen,
        LBracket => RBracket,
        LBrace => RBrace,
        LStatic => RStatic,
        Let => Tel,
        Automaton => End,
        Con => Noc,
        _ => return None,
    })
}

/// Returns for each token the index of its partner if it opens or closes a bracket or block. A bracket never pairs with
/// one outside of its block.
fn pair_tokens(lexemes: &[Lexeme]) -> Vec<Option<usize>> {
    let mut partners = vec![None; lexemes.len()];
    let mut open: Vec<usize> = Vec::new();
    for (at, lexeme) in lexemes.iter().enumerate() {
        if closing_token(lexeme.token).is_some() {
            open.push(at);
        } else if let Some(depth) = find_partner(lexemes, &open, lexeme.token) {
            let partner = open[depth];
            open.truncate(depth);
            (partners[at], partners[partner]) = (Some(partner), Some(at));
        }
    }
    partners
}

/// Returns the position in `open` of the token that the token `close` closes; `None` if there is none. `open` holds the
/// indices of the opening tokens, innermost last.
fn find_partner(lexemes: &[Lexeme], open: &[usize], close: Token) -> Option<usize> {
    use Token::{End, Noc, RBrace, RBracket, RParen, RStatic, Tel};
    let is_bracket_end = matches!(close, RParen | RBracket | RBrace | RStatic);
    if !is_bracket_end && !matches!(close, Tel | End | Noc) {
        return None;
    }
    let token = |depth: usize| lexemes[open[depth]].token;
    let in_reach = |depth: &usize| !is_bracket_end || !is_block(token(*depth));
    let mut inward = (0..open.len()).rev().take_while(in_reach);
    inward.find(|depth| closing_token(token(*depth)) == Some(close))
}

fn find_parents(lexemes: &[Lexeme], partners: &[Option<usize>]) -> Vec<Option<usize>> {
    let mut parents = Vec::with_capacity(lexemes.len());
    let mut open: Vec<usize> = Vec::new();
    for (at, lexeme) in lexemes.iter().enumerate() {
        let closes = partners[at].filter(|p| *p < at);
        if let Some(partner) = closes {
            while open.last().is_some_and(|last| *last >= partner) {
                open.pop();
            }
        }
        parents.push(open.last().copied());
        let opens = partners[at].is_some_and(|p| p > at) || lexeme.token == Token::Let;
        if opens && closing_token(lexeme.token).is_some() {
            open.push(at);
        }
    }
    parents
}
