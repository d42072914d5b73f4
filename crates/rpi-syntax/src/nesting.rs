//! Rejects declarations nested so deeply that a recursive walk over their tree could overflow the stack.
//!
//! Works on tokens, before a tree is built. The depth of the content of a bracket is at most the number of operators in
//! one element, plus the depth of the deepest bracket in that element.

use crate::context::Context;
use crate::lexer::Lexeme;
use crate::token::Token;
use rpi_diag::{Code, Finding};

/// Maximum accepted nesting depth. Every walk over a tree may recurse this deep: see
/// [`with_stack`](crate::with_stack).
pub(crate) const MAX_DEPTH: u32 = 5_000;

/// Open bracket or body.
#[derive(Clone, Copy, Default)]
struct Level {
    /// Number of operators in the current element.
    operators: u32,
    /// Depth of the deepest bracket in the current element.
    inner: u32,
    /// Depth of the deepest previous element.
    deepest: u32,
}

impl Level {
    fn depth(self) -> u32 {
        self.deepest.max(self.operators + self.inner)
    }

    fn next_element(&mut self) {
        *self = Level {
            deepest: self.depth(),
            ..Level::default()
        };
    }
}

/// Returns a diagnostic (RPI0011) if the declaration is nested too deeply.
pub(crate) fn too_deep(cx: &Context<'_>, lexemes: &[Lexeme]) -> Option<Finding> {
    // Each level takes at least one token, so a short declaration cannot be too deep.
    if lexemes.len() <= MAX_DEPTH as usize {
        return None;
    }
    let mut levels = vec![Level::default()];
    for lexeme in lexemes {
        step(&mut levels, lexeme.token);
        let here = levels
            .last()
            .map_or(0, |level| level.operators + level.inner);
        if here + levels.len() as u32 > MAX_DEPTH {
            let span = cx.span(lexeme.start, lexeme.end);
            return Some(finding().at(span, format!("more than {MAX_DEPTH} levels deep here")));
        }
    }
    None
}

fn step(levels: &mut Vec<Level>, token: Token) {
    use Token::{
        Automaton, Comma, End, LBrace, LBracket, LParen, LStatic, Let, RBrace, RBracket, RParen,
        RStatic, Semi, Tel,
    };
    match token {
        LParen | LBracket | LBrace | LStatic | Let | Automaton => levels.push(Level::default()),
        RBracket => {
            close(levels);
            // `a[i][j]` is nested in the tree, although the brackets are side by side.
            top(levels).operators += 1;
        }
        RParen | RBrace | RStatic | Tel | End => close(levels),
        Comma | Semi => top(levels).next_element(),
        token => top(levels).operators += u32::from(is_operator(token)),
    }
}

fn top(levels: &mut Vec<Level>) -> &mut Level {
    if levels.is_empty() {
        levels.push(Level::default());
    }
    let last = levels.len() - 1;
    &mut levels[last]
}

/// Closes a bracket and adds its depth to the enclosing element.
fn close(levels: &mut Vec<Level>) {
    let closed = levels.pop().unwrap_or_default();
    let outer = top(levels);
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

fn finding() -> Finding {
    Finding::new(Code::RPI0011, "the nesting is too deep")
        .help("define parts of it by separate equations: `part = ...;`")
}
