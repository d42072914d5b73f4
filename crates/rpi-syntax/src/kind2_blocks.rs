//! Marks Kind 2 constructs in the tokens of a `.lus` file: the blocks of equations `if`, `when`, `cond` and `frame`,
//! the alternatives of `match`, and the constructor test `A?(x)`.
//!
//! Their keywords also occur in expressions and as names, so only the position distinguishes them: an equation never
//! begins with `if`, and `fi`, `elsif`, `cond`, `frame` and `end` are names everywhere else. One pass over the tokens
//! keeps a stack of open constructs and replaces these keywords by tokens of their own.

use crate::lexer::Lexeme;
use crate::token::Token;

/// Construct of Kind 2, such as a `when` block, that is open while the tokens are read.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum OpenConstruct {
    /// The body after a `let`: a list of statements.
    Body,
    /// The condition of a block that began with `opener`. `waiting` is the number of `if` expressions in the condition
    /// whose `then` is still to come.
    Condition { opener: Token, waiting: u32 },
    /// The branches of a block, with the token that began the block.
    Branches(Token),
    /// The header of a `frame` block, which ends at its `let`.
    FrameHead,
    /// A `match` expression.
    Match,
    /// A bracket, which is closed by its counterpart and not by a keyword.
    Bracket,
}

/// Returns for each token whether a keyword that closes blocks (`fi` or `end`) follows in the same body.
fn closed_later(text: &str, lexemes: &[Lexeme]) -> Vec<bool> {
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

/// Replaces the keywords of Kind 2 blocks by separate tokens, so that the grammar can distinguish them from other uses
/// of the words.
pub(crate) fn mark_blocks(text: &str, lexemes: &mut [Lexeme]) {
    let mut marker = BlockMarker {
        text,
        open: Vec::new(),
        at_statement_start: false,
        closed_later: closed_later(text, lexemes),
    };
    for at in 0..lexemes.len() {
        let marked = marker.mark_token(lexemes, at);
        lexemes[at].token = marked;
    }
}

/// State of the pass that replaces the keywords of Kind 2 blocks.
struct BlockMarker<'t> {
    text: &'t str,
    /// Open constructs, innermost last.
    open: Vec<OpenConstruct>,
    /// Whether a statement may begin at the next token.
    at_statement_start: bool,
    /// For each token of the file, whether a keyword that closes blocks follows in the same body.
    closed_later: Vec<bool>,
}

impl BlockMarker<'_> {
    fn mark_token(&mut self, lexemes: &[Lexeme], at: usize) -> Token {
        let lexeme = lexemes[at];
        let begins = std::mem::take(&mut self.at_statement_start);
        let marked = match begins && self.in_statements() {
            true => self.mark_statement_start(lexemes, at),
            false => None,
        };
        if let Some(marked) = marked {
            return marked;
        }
        self.track(lexeme, lexemes.get(at + 1).map(|next| next.token))
    }

    fn in_statements(&self) -> bool {
        matches!(
            self.open.last(),
            Some(OpenConstruct::Body | OpenConstruct::Branches(_))
        )
    }

    /// Returns the token that replaces the token at index `at`, the first one of a statement, if it begins, continues
    /// or closes a block; `None` otherwise.
    fn mark_statement_start(&mut self, lexemes: &[Lexeme], at: usize) -> Option<Token> {
        let next = lexemes.get(at + 1).map(|lexeme| lexeme.token);
        let is_name = matches!(
            next,
            Some(Token::Eq | Token::Comma | Token::Dot | Token::LBracket | Token::Colon)
        );
        let block = match self.open.last() {
            Some(OpenConstruct::Branches(block)) => Some(*block),
            _ => None,
        };
        match (lexemes[at].token, self.source_text(lexemes[at])) {
            // After `fi`, which was a name so far, `check` was taken for a name, too.
            (Token::Ident, "check") if !is_name => Some(Token::Check),
            (Token::If, _) if self.closed_later[at] => Some(self.open_block(Token::IfBlock)),
            (Token::When, _) => Some(self.open_block(Token::WhenBlock)),
            (_, "cond") if next == Some(Token::Bar) => {
                self.open.push(OpenConstruct::Branches(Token::CondBlock));
                self.at_statement_start = true;
                Some(Token::CondBlock)
            }
            (_, "frame") if next == Some(Token::LParen) => {
                self.open.push(OpenConstruct::FrameHead);
                Some(Token::FrameBlock)
            }
            (Token::Bar, _) if block == Some(Token::CondBlock) => {
                self.open.push(OpenConstruct::Condition {
                    opener: Token::CondBlock,
                    waiting: 0,
                });
                Some(Token::Case)
            }
            (Token::Else, _) if block.is_some() => self.continue_block(Token::ElseBlock),
            (_, "otherwise") if block == Some(Token::CondBlock) => {
                self.continue_block(Token::ElseBlock)
            }
            (_, "elsif") if !is_name && block.is_some() => {
                self.open.push(OpenConstruct::Condition {
                    opener: Token::ElsIf,
                    waiting: 0,
                });
                Some(Token::ElsIf)
            }
            (_, "fi" | "end") if !is_name && block.is_some() => {
                self.open.pop();
                self.at_statement_start = true;
                Some(Token::EndBlock)
            }
            _ => None,
        }
    }

    fn open_block(&mut self, opener: Token) -> Token {
        self.open.push(OpenConstruct::Branches(opener));
        self.open
            .push(OpenConstruct::Condition { opener, waiting: 0 });
        opener
    }

    fn continue_block(&mut self, as_token: Token) -> Option<Token> {
        self.at_statement_start = true;
        Some(as_token)
    }

    /// Updates the stack of open constructs for a token. Returns the class of the token, or a special class in its
    /// place: for example, for the `end` of a `match` expression. `next` is the token after it.
    fn track(&mut self, lexeme: Lexeme, next: Option<Token>) -> Token {
        use Token::{
            Bar, Colon, End, If, LBrace, LBracket, LParen, LStatic, Let, Match, Question, RBrace,
            RBracket, RParen, RStatic, Semi, Tel, Then, With,
        };
        let ends = lexeme.token == End || self.source_text(lexeme) == "end";
        match (lexeme.token, self.open.last_mut()) {
            (Question, _) if next == Some(LParen) => return Token::Asks,
            (LParen | LBracket | LBrace | LStatic, _) => self.open.push(OpenConstruct::Bracket),
            (RParen | RBracket | RBrace | RStatic, Some(OpenConstruct::Bracket)) => {
                self.open.pop();
            }
            (Let, Some(OpenConstruct::FrameHead)) => {
                self.open.pop();
                self.open_body();
            }
            (Let, _) => self.open_body(),
            (Tel, _) => self.close_body(),
            (Semi, _) => self.at_statement_start = true,
            (If | With, Some(OpenConstruct::Condition { waiting, .. })) => *waiting += 1,
            (Then, Some(OpenConstruct::Condition { waiting, .. })) if *waiting > 0 => *waiting -= 1,
            (Then, Some(OpenConstruct::Condition { .. }))
            | (
                Colon,
                Some(OpenConstruct::Condition {
                    opener: Token::CondBlock,
                    ..
                }),
            ) => {
                self.open.pop();
                self.at_statement_start = true;
            }
            (Match, _) => self.open.push(OpenConstruct::Match),
            (Bar, Some(OpenConstruct::Match)) => return Token::Case,
            (_, Some(OpenConstruct::Match)) if ends => {
                self.open.pop();
                return Token::EndBlock;
            }
            _ => {}
        }
        lexeme.token
    }

    fn open_body(&mut self) {
        self.open.push(OpenConstruct::Body);
        self.at_statement_start = true;
    }

    /// Closes the innermost open body and all constructs that are still open inside it.
    fn close_body(&mut self) {
        let body = self
            .open
            .iter()
            .rposition(|open| *open == OpenConstruct::Body);
        self.open.truncate(body.unwrap_or(0));
        self.at_statement_start = true;
    }

    fn source_text(&self, lexeme: Lexeme) -> &str {
        &self.text[lexeme.start as usize..lexeme.end as usize]
    }
}
