//! Marks Kind 2 constructs in the tokens of a `.lus` file: the blocks of equations `if`, `when`, `cond` and `frame`,
//! the alternatives of `match`, and the constructor test `A?(x)`.
//!
//! Their keywords also occur in expressions and as names, so only the position distinguishes them: an equation never
//! begins with `if`, and `fi`, `elsif`, `cond`, `frame` and `end` are names everywhere else. One pass over the tokens
//! keeps a stack of open constructs and replaces these keywords by tokens of their own.

use crate::lexer::Lexeme;
use crate::token::Token;

/// Open construct on the stack of the [`Marker`].
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Open {
    /// Body after `let`: a list of statements.
    Body,
    /// Condition of a block. `waiting` counts the `if` of expressions in it that still need their `then`.
    Condition { opener: Token, waiting: u32 },
    /// Branches of a block.
    Branches(Token),
    /// Header of a `frame`, up to its `let`.
    FrameHead,
    /// `match` expression.
    Match,
    /// Bracket.
    Bracket,
}

/// Returns for each token whether a keyword that closes blocks follows in the same body.
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

/// Replaces the keywords of Kind 2 constructs by tokens of their own.
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

/// State of the pass over the tokens.
struct Marker<'t> {
    text: &'t str,
    /// Open constructs, innermost last.
    open: Vec<Open>,
    /// Whether a statement may begin at the next token.
    begins: bool,
    /// For each token, whether a keyword that closes blocks follows in the same body.
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

    /// Returns the token that replaces the first token of a statement, if it begins, continues or closes a block.
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
            // After `fi`, which was a name so far, `check` was taken for a name, too.
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

    /// Updates the stack of open constructs and returns the token, replaced where necessary.
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

    /// Closes the innermost body with everything that is still open in it.
    fn tel(&mut self) {
        let body = self.open.iter().rposition(|open| *open == Open::Body);
        self.open.truncate(body.unwrap_or(0));
        self.begins = true;
    }

    fn written(&self, lexeme: Lexeme) -> &str {
        &self.text[lexeme.start as usize..lexeme.end as usize]
    }
}
