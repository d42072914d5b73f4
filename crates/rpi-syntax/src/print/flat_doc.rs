//! A document as a flat sequence of pieces, into which comments can be inserted at any token.

use super::layout::Doc;
use crate::token::Token;
use logos::Logos;
use std::collections::BTreeMap;

/// Node of a document that encloses other nodes. In a flattened document it becomes an opening and a closing piece.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Enclosure {
    Indent(usize),
    Hang,
    Flat,
    Group,
}

/// Piece of a document that has been flattened from a tree to a list.
#[derive(Clone, Debug)]
pub(super) enum DocPiece {
    Open(Enclosure),
    Close(Enclosure),
    /// One token of the language.
    Token(String),
    /// White space or a comment.
    Text(String),
    Line,
    Soft,
    Hard,
    Empty,
    Suffix(String),
    SourceOffset(u32),
}

impl DocPiece {
    pub(super) fn is_break(&self) -> bool {
        matches!(self, DocPiece::Line | DocPiece::Soft | DocPiece::Hard)
    }

    pub(super) fn is_separator(&self) -> bool {
        matches!(self, DocPiece::Token(text) if is_separator(text))
    }
}

/// Returns whether a token separates elements of a list (`,` or `;`). A line may break after it.
pub(super) fn is_separator(token: &str) -> bool {
    matches!(token, "," | ";")
}

/// Returns the pieces of a document in text order. Works without recursion, as documents may be nested deeply.
pub(super) fn flatten(doc: &Doc) -> Vec<DocPiece> {
    enum Todo<'d> {
        Doc(&'d Doc),
        Close(Enclosure),
    }
    let mut pieces = Vec::new();
    let mut todo = vec![Todo::Doc(doc)];
    while let Some(next) = todo.pop() {
        let doc = match next {
            Todo::Doc(doc) => doc,
            Todo::Close(frame) => {
                pieces.push(DocPiece::Close(frame));
                continue;
            }
        };
        let mut open = |frame, inner| {
            todo.extend([Todo::Close(frame), Todo::Doc(inner)]);
            DocPiece::Open(frame)
        };
        let piece = match doc {
            Doc::Text(text) => {
                tokens(text, &mut pieces);
                continue;
            }
            Doc::Word(word) => {
                tokens(word, &mut pieces);
                continue;
            }
            Doc::Concat(parts) => {
                todo.extend(parts.iter().rev().map(Todo::Doc));
                continue;
            }
            Doc::Indent(by, inner) => open(Enclosure::Indent(*by), inner),
            Doc::Hang(inner) => open(Enclosure::Hang, inner),
            Doc::Flat(inner) => open(Enclosure::Flat, inner),
            Doc::Group(inner) => open(Enclosure::Group, inner),
            Doc::Line => DocPiece::Line,
            Doc::SoftLine => DocPiece::Soft,
            Doc::HardLine => DocPiece::Hard,
            Doc::EmptyLine => DocPiece::Empty,
            Doc::LineSuffix(comment) => DocPiece::Suffix(comment.clone()),
            Doc::SourceOffset(offset) => DocPiece::SourceOffset(*offset),
        };
        pieces.push(piece);
    }
    pieces
}

/// Appends the tokens of a text, and the white space between them, to `pieces`.
fn tokens(text: &str, pieces: &mut Vec<DocPiece>) {
    let mut done = 0;
    for (_, range) in Token::lexer(text).spanned() {
        if done < range.start {
            pieces.push(DocPiece::Text(text[done..range.start].to_owned()));
        }
        done = range.end;
        pieces.push(DocPiece::Token(text[range].to_owned()));
    }
    if done < text.len() {
        pieces.push(DocPiece::Text(text[done..].to_owned()));
    }
}

/// Builds a document from pieces. `put` holds pieces to insert, by the index of the piece before which they are
/// inserted.
pub(super) fn rebuild(pieces: Vec<DocPiece>, mut put: BTreeMap<usize, Vec<DocPiece>>) -> Doc {
    let mut open: Vec<Vec<Doc>> = Vec::new();
    let mut parts = Vec::new();
    let mut add = |piece| {
        let doc = match piece {
            DocPiece::Open(_) => {
                open.push(std::mem::take(&mut parts));
                return;
            }
            DocPiece::Close(frame) => {
                let outer = open.pop().unwrap_or_default();
                enclose(frame, Doc::Concat(std::mem::replace(&mut parts, outer)))
            }
            DocPiece::Token(text) | DocPiece::Text(text) => Doc::Text(text),
            DocPiece::Line => Doc::Line,
            DocPiece::Soft => Doc::SoftLine,
            DocPiece::Hard => Doc::HardLine,
            DocPiece::Empty => Doc::EmptyLine,
            DocPiece::Suffix(comment) => Doc::LineSuffix(comment),
            DocPiece::SourceOffset(_) => return,
        };
        parts.push(doc);
    };
    for (i, piece) in pieces.into_iter().enumerate() {
        put.remove(&i).into_iter().flatten().for_each(&mut add);
        add(piece);
    }
    put.into_values().flatten().for_each(&mut add);
    Doc::Concat(parts)
}

fn enclose(frame: Enclosure, doc: Doc) -> Doc {
    let doc = Box::new(doc);
    match frame {
        Enclosure::Indent(by) => Doc::Indent(by, doc),
        Enclosure::Hang => Doc::Hang(doc),
        Enclosure::Flat => Doc::Flat(doc),
        Enclosure::Group => Doc::Group(doc),
    }
}
