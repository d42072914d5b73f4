//! Flat list of the tokens and comments of a text with their byte ranges, for tools that work on erroneous text.

use crate::Dialect;
use crate::comments::CommentKind;
use crate::lexer::lex;
use crate::token::Token;
use rpi_diag::FileId;
use std::ops::Range;

/// Token or comment of a source text, for syntax highlighting.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct SourceToken {
    /// Class of the token, or kind of the comment.
    pub kind: SourceTokenKind,
    /// Byte range of the token in the source text.
    pub range: Range<usize>,
}

/// Class of a token or comment, for syntax highlighting.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum SourceTokenKind {
    /// Plain or qualified name, such as `x` or `motion::Move`.
    Name,
    /// Reserved word, operator or punctuation mark.
    KeywordOrSymbol,
    /// Literal of an integer or real.
    Number,
    /// Text in double quotes.
    String,
    /// Comment of the given kind.
    Comment(CommentKind),
}

/// Returns the tokens and comments of a text, in text order. Characters that form no token are left out.
#[must_use]
pub fn source_tokens(text: &str, mode: Dialect) -> Vec<SourceToken> {
    let lexed = lex(FileId(0), text, mode);
    let range = |start: u32, end: u32| start as usize..end as usize;
    let tokens = lexed.lexemes.iter().map(|lexeme| SourceToken {
        kind: token_kind(lexeme.token),
        range: range(lexeme.start, lexeme.end),
    });
    let comments = lexed.comments.all.iter().map(|comment| SourceToken {
        kind: SourceTokenKind::Comment(comment.kind),
        range: range(comment.span.start, comment.span.end),
    });
    let mut all: Vec<SourceToken> = tokens.chain(comments).collect();
    all.sort_by_key(|piece| piece.range.start);
    all
}

fn token_kind(token: Token) -> SourceTokenKind {
    match token {
        Token::Ident | Token::Path => SourceTokenKind::Name,
        Token::Int | Token::IntDotDot | Token::Real | Token::NumberWord | Token::IecLiteral => {
            SourceTokenKind::Number
        }
        Token::Str | Token::OpenStr | Token::Label => SourceTokenKind::String,
        _ => SourceTokenKind::KeywordOrSymbol,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_of_piece_is_told() {
        let text = "x = 3 -- why\n \u{e4} \"t\"";
        let found = source_tokens(text, Dialect::Rpi);
        let kinds: Vec<SourceTokenKind> = found.iter().map(|piece| piece.kind).collect();
        use SourceTokenKind::{Comment, KeywordOrSymbol, Name, Number, String};
        assert_eq!(
            kinds,
            [
                Name,
                KeywordOrSymbol,
                Number,
                Comment(CommentKind::Line),
                String
            ]
        );
        assert_eq!(&text[found[3].range.clone()], "-- why");
    }
}
