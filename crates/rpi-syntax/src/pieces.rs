//! The pieces of a text: words, signs and comments, each at its place, for tools that look around in broken texts.

use crate::Mode;
use crate::comments::CommentKind;
use crate::lexer::lex;
use crate::token::Token;
use rpi_diag::FileId;
use std::ops::Range;

/// A piece of a text.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Piece {
    /// What it is.
    pub kind: PieceKind,
    /// Its bytes.
    pub range: Range<usize>,
}

/// What a piece is.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum PieceKind {
    /// A name, plain or qualified.
    Name,
    /// A word or sign of the language.
    Fixed,
    /// A number.
    Number,
    /// A text in quotes.
    Text,
    /// A comment.
    Comment(CommentKind),
}

/// The pieces of a text in its order. Characters that belong to none are left out.
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
