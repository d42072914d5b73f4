//! Marks statements of Kind 2 that hold equations: `if`, `when`, `cond` and `frame`, the alternatives of `match`, and the
//! question `A?(x)`.
//!
//! Their words are those of expressions and names, and only the place tells them apart: an equation never begins with
//! `if`, and `fi`, `elsif`, `cond`, `frame` and `end` are names everywhere else. One pass over the tokens of a `.lus` file, which
//! keeps what is open on a stack; the grammar sees tokens of their own.

use crate::lexer::Lexeme;
use crate::token::Token;

/// What is open, innermost last.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Open {
    /// `let`: statements follow one another.
    Body,
    /// The condition of a block: so many `if` of values wait for their `then`.
    Condition { opener: Token, waiting: u32 },
    /// The branches of a block.
    Branches(Token),
    /// From `frame` to its `let`.
    FrameHead,
    /// `match` of values.
    Match,
    /// A bracket.
    Bracket,
}

/// For each token whether a word that ends blocks follows in its body.
fn closed(text: &str, lexemes: &[Lexeme]) -> Vec<bool> {
    let mut is_closed = false;
    let mut closed = vec![false; lexemes.len()];
    for (at, lexeme) in lexemes.iter().enumerate().rev() {
        match lexeme.token {
            Token::Let | Token::Tel => is_closed = false,
            Token::End => is_closed = true,
            Token::Ident => {
                let written = &text[lexeme.start as usize..lexeme.end as usize];
                is_closed |= matches!(written, "fi" | "end");
            }
            _ => {}
        }
        closed[at] = is_closed;
    }
    closed
}

/// Marks the tokens.
pub(crate) fn mark(text: &str, lexemes: &mut [Lexeme]) {
    let mut marker = Marker {
        text,
        open: Vec::new(),
        begins: false,
        closed: closed(text, lexemes),
    };
    for at in 0..lexemes.len() {
        let marked = marker.token(lexemes, at);
        lexemes[at].token = marked;
    }
}

struct Marker<'t> {
    text: &'t str,
    open: Vec<Open>,
    /// Whether a statement may begin here.
    begins: bool,
    /// Where a block could still be ended.
    closed: Vec<bool>,
}

impl Marker<'_> {
    fn token(&mut self, lexemes: &[Lexeme], at: usize) -> Token {
        let lexeme = lexemes[at];
        let begins = std::mem::take(&mut self.begins);
        let marked = match begins && self.in_statements() {
            true => self.first(lexemes, at),
            false => None,
        };
        if let Some(marked) = marked {
            return marked;
        }
        self.follow(lexeme, lexemes.get(at + 1).map(|next| next.token))
    }

    fn in_statements(&self) -> bool {
        matches!(self.open.last(), Some(Open::Body | Open::Branches(_)))
    }

    /// The token of a statement of Kind 2 that begins, goes on or ends here.
    fn first(&mut self, lexemes: &[Lexeme], at: usize) -> Option<Token> {
        let next = lexemes.get(at + 1).map(|lexeme| lexeme.token);
        let is_name = matches!(
            next,
            Some(Token::Eq | Token::Comma | Token::Dot | Token::LBracket | Token::Colon)
        );
        let block = match self.open.last() {
            Some(Open::Branches(block)) => Some(*block),
            _ => None,
        };
        match (lexemes[at].token, self.written(lexemes[at])) {
            // What goes before it may be `fi`, which was a name so far.
            (Token::Ident, "check") if !is_name => Some(Token::Check),
            (Token::If, _) if self.closed[at] => Some(self.opens(Token::IfBlock)),
            (Token::When, _) => Some(self.opens(Token::WhenBlock)),
            (_, "cond") if next == Some(Token::Bar) => {
                self.open.push(Open::Branches(Token::CondBlock));
                self.begins = true;
                Some(Token::CondBlock)
            }
            (_, "frame") if next == Some(Token::LParen) => {
                self.open.push(Open::FrameHead);
                Some(Token::FrameBlock)
            }
            (Token::Bar, _) if block == Some(Token::CondBlock) => {
                self.open.push(Open::Condition {
                    opener: Token::CondBlock,
                    waiting: 0,
                });
                Some(Token::Case)
            }
            (Token::Else, _) if block.is_some() => self.goes_on(Token::ElseBlock),
            (_, "otherwise") if block == Some(Token::CondBlock) => self.goes_on(Token::ElseBlock),
            (_, "elsif") if !is_name && block.is_some() => {
                self.open.push(Open::Condition {
                    opener: Token::ElsIf,
                    waiting: 0,
                });
                Some(Token::ElsIf)
            }
            (_, "fi" | "end") if !is_name && block.is_some() => {
                self.open.pop();
                self.begins = true;
                Some(Token::EndBlock)
            }
            _ => None,
        }
    }

    fn opens(&mut self, opener: Token) -> Token {
        self.open.push(Open::Branches(opener));
        self.open.push(Open::Condition { opener, waiting: 0 });
        opener
    }

    fn goes_on(&mut self, as_token: Token) -> Option<Token> {
        self.begins = true;
        Some(as_token)
    }

    /// Keeps count of what is open.
    fn follow(&mut self, lexeme: Lexeme, next: Option<Token>) -> Token {
        use Token::{
            Bar, Colon, End, If, LBrace, LBracket, LParen, LStatic, Let, Match, Question, RBrace,
            RBracket, RParen, RStatic, Semi, Tel, Then, With,
        };
        let ends = lexeme.token == End || self.written(lexeme) == "end";
        match (lexeme.token, self.open.last_mut()) {
            (Question, _) if next == Some(LParen) => return Token::Asks,
            (LParen | LBracket | LBrace | LStatic, _) => self.open.push(Open::Bracket),
            (RParen | RBracket | RBrace | RStatic, Some(Open::Bracket)) => {
                self.open.pop();
            }
            (Let, Some(Open::FrameHead)) => {
                self.open.pop();
                self.body();
            }
            (Let, _) => self.body(),
            (Tel, _) => self.tel(),
            (Semi, _) => self.begins = true,
            (If | With, Some(Open::Condition { waiting, .. })) => *waiting += 1,
            (Then, Some(Open::Condition { waiting, .. })) if *waiting > 0 => *waiting -= 1,
            (Then, Some(Open::Condition { .. }))
            | (
                Colon,
                Some(Open::Condition {
                    opener: Token::CondBlock,
                    ..
                }),
            ) => {
                self.open.pop();
                self.begins = true;
            }
            (Match, _) => self.open.push(Open::Match),
            (Bar, Some(Open::Match)) => return Token::Case,
            (_, Some(Open::Match)) if ends => {
                self.open.pop();
                return Token::EndBlock;
            }
            _ => {}
        }
        lexeme.token
    }

    fn body(&mut self) {
        self.open.push(Open::Body);
        self.begins = true;
    }

    /// Whatever is still open in a body ends with it.
    fn tel(&mut self) {
        let body = self.open.iter().rposition(|open| *open == Open::Body);
        self.open.truncate(body.unwrap_or(0));
        self.begins = true;
    }

    fn written(&self, lexeme: Lexeme) -> &str {
        &self.text[lexeme.start as usize..lexeme.end as usize]
    }
}
