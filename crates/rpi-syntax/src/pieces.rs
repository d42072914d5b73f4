//! Flat list of the tokens and comments of a text with their byte ranges, for tools that work on erroneous text.

use crate::Mode;
use crate::comments::CommentKind;
use crate::lexer::lex;
use crate::token::Token;
use rpi_diag::FileId;
use std::ops::Range;

/// Token or comment of a text.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Piece {
    /// Kind of the token or comment.
    pub kind: PieceKind,
    /// Byte range in the text.
    pub range: Range<usize>,
}

/// Kind of a [`Piece`].
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum PieceKind {
    /// Plain or qualified name.
    Name,
    /// Keyword or symbol.
    Fixed,
    /// Number literal.
    Number,
    /// String literal.
    Text,
    /// Comment.
    Comment(CommentKind),
}

/// Returns the tokens and comments of a text, in text order. Characters that form no token are left out.
#[must_use]
pub fn pieces(text: &str, mode: Mode) -> Vec<Piece> {
    let lexed = lex(FileId(0), text, mode);
    let range = |start: u32, end: u32| start as usize..end as usize;
    let tokens = lexed.lexemes.iter().map(|lexeme| Piece {
        kind: kind(lexeme.token),
        range: range(lexeme.start, lexeme.end),
    });
    let comments = lexed.comments.all.iter().map(|comment| Piece {
        kind: PieceKind::Comment(comment.kind),
        range: range(comment.span.start, comment.span.end),
    });
    let mut all: Vec<Piece> = tokens.chain(comments).collect();
    all.sort_by_key(|piece| piece.range.start);
    all
}

fn kind(token: Token) -> PieceKind {
    match token {
        Token::Ident | Token::Path => PieceKind::Name,
        Token::Int | Token::IntDotDot | Token::Real | Token::NumberWord | Token::IecLiteral => {
            PieceKind::Number
        }
        Token::Str | Token::OpenStr | Token::Label => PieceKind::Text,
        _ => PieceKind::Fixed,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_of_piece_is_told() {
        let text = "x = 3 -- why\n \u{e4} \"t\"";
        let found = pieces(text, Mode::Rpi);
        let kinds: Vec<PieceKind> = found.iter().map(|piece| piece.kind).collect();
        use PieceKind::{Comment, Fixed, Name, Number, Text};
        assert_eq!(
            kinds,
            [Name, Fixed, Number, Comment(CommentKind::Line), Text]
        );
        assert_eq!(&text[found[3].range.clone()], "-- why");
    }
}
