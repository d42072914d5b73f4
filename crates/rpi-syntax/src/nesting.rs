//! Rejects declarations nested so deeply that a recursive walk over their tree could overflow the stack.
//!
//! Works on tokens, before a tree is built. The depth of the content of a bracket is at most the number of operators in
//! one element, plus the depth of the deepest bracket in that element.

use crate::context::ParseContext;
use crate::lexer::Lexeme;
use crate::token::Token;
use rpi_diag::{Code, Diagnostic};

/// Maximum accepted nesting depth. Functions that walk over a tree may recurse this deep: see
/// [`with_large_stack`](crate::with_large_stack).
pub(crate) const MAX_DEPTH: u32 = 5_000;

/// Bracket or body that is open during the check of the nesting depth. Its elements are separated by `,` or `;`.
#[derive(Clone, Copy, Default)]
struct OpenLevel {
    /// Number of operators in the current element, each of which may be one level of the tree.
    operators: u32,
    /// Maximum number of nested brackets in the current element.
    inner: u32,
    /// Maximum depth of the elements before the current one.
    deepest: u32,
}

impl OpenLevel {
    fn depth(self) -> u32 {
        self.deepest.max(self.operators + self.inner)
    }

    fn next_element(&mut self) {
        *self = OpenLevel {
            deepest: self.depth(),
            ..OpenLevel::default()
        };
    }
}

/// Returns a diagnostic (RPI0011) if the declaration is nested deeper than [`MAX_DEPTH`]; `None` otherwise.
pub(crate) fn too_deep(cx: &ParseContext<'_>, lexemes: &[Lexeme]) -> Option<Diagnostic> {
    // Each level takes at least one token, so a short declaration cannot be too deep.
    if lexemes.len() <= MAX_DEPTH as usize {
        return None;
    }
    let mut levels = vec![OpenLevel::default()];
    for lexeme in lexemes {
        count_token(&mut levels, lexeme.token);
        let here = levels
            .last()
            .map_or(0, |level| level.operators + level.inner);
        if here + levels.len() as u32 > MAX_DEPTH {
            let span = cx.span(lexeme.start, lexeme.end);
            return Some(
                too_deep_diagnostic()
                    .primary(span, format!("more than {MAX_DEPTH} levels deep here")),
            );
        }
    }
    None
}

fn count_token(levels: &mut Vec<OpenLevel>, token: Token) {
    use Token::{
        Automaton, Comma, End, LBrace, LBracket, LParen, LStatic, Let, RBrace, RBracket, RParen,
        RStatic, Semi, Tel,
    };
    match token {
        LParen | LBracket | LBrace | LStatic | Let | Automaton => levels.push(OpenLevel::default()),
        RBracket => {
            close_level(levels);
            // `a[i][j]` is nested in the tree, although the brackets are side by side.
            current_level(levels).operators += 1;
        }
        RParen | RBrace | RStatic | Tel | End => close_level(levels),
        Comma | Semi => current_level(levels).next_element(),
        token => current_level(levels).operators += u32::from(is_operator(token)),
    }
}

fn current_level(levels: &mut Vec<OpenLevel>) -> &mut OpenLevel {
    if levels.is_empty() {
        levels.push(OpenLevel::default());
    }
    let last = levels.len() - 1;
    &mut levels[last]
}

/// Closes the innermost bracket and counts its depth in the element that contains it.
fn close_level(levels: &mut Vec<OpenLevel>) {
    let closed = levels.pop().unwrap_or_default();
    let outer = current_level(levels);
    outer.inner = outer.inner.max(closed.depth() + 1);
}

fn is_operator(token: Token) -> bool {
    use Token::*;
    matches!(
        token,
        Arrow
            | Implies
            | Coalesce
            | Question
            | Le
            | Ge
            | Ne
            | Lt
            | Gt
            | Eq
            | Plus
            | Minus
            | Star
            | Slash
            | Pow
            | Hat
            | Bar
            | And
            | Or
            | Xor
            | Not
            | Div
            | Mod
            | Pre
            | Fby
            | Current
            | Last
            | IntType
            | RealType
            | When
            | If
            | With
            | Dot
            | Percent
            | In
            | BitAnd
            | BitOr
            | BitNot
            | ShiftLeft
            | ShiftRight
            | Forall
            | Exists
            | Match
            | Int8
            | Int16
            | Int32
            | Int64
            | UInt8
            | UInt16
            | UInt32
            | UInt64
            | SInt
            | UInt
            | Append
    )
}

fn too_deep_diagnostic() -> Diagnostic {
    Diagnostic::new(Code::RPI0011, "the nesting is too deep")
        .help("define parts of it by separate equations: `part = ...;`")
}
