//! A document as a flat sequence of pieces, into which comments can be inserted at any token.

use super::layout::Doc;
use crate::token::Token;
use logos::Logos;
use std::collections::BTreeMap;

/// Node of a document that encloses other pieces.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Frame {
    Indent(usize),
    Hang,
    Flat,
    Group,
}

/// Element of a flat document.
#[derive(Clone, Debug)]
pub(super) enum Piece {
    Open(Frame),
    Close(Frame),
    /// Token of the language.
    Token(String),
    /// White space or a comment.
    Other(String),
    Line,
    Soft,
    Hard,
    Empty,
    Suffix(String),
    At(u32),
}

impl Piece {
    pub(super) fn is_break(&self) -> bool {
        matches!(self, Piece::Line | Piece::Soft | Piece::Hard)
    }

    pub(super) fn is_separator(&self) -> bool {
        matches!(self, Piece::Token(text) if is_separator(text))
    }
}

/// Returns whether a token is a separator.
pub(super) fn is_separator(token: &str) -> bool {
    matches!(token, "," | ";")
}

/// Flattens a document into pieces, without recursion.
pub(super) fn pieces(doc: &Doc) -> Vec<Piece> {
    enum Todo<'d> {
        Doc(&'d Doc),
        Close(Frame),
    }
    let mut pieces = Vec::new();
    let mut todo = vec![Todo::Doc(doc)];
    while let Some(next) = todo.pop() {
        let doc = match next {
            Todo::Doc(doc) => doc,
            Todo::Close(frame) => {
                pieces.push(Piece::Close(frame));
                continue;
            }
        };
        let mut open = |frame, inner| {
            todo.extend([Todo::Close(frame), Todo::Doc(inner)]);
            Piece::Open(frame)
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
            Doc::Indent(by, inner) => open(Frame::Indent(*by), inner),
            Doc::Hang(inner) => open(Frame::Hang, inner),
            Doc::Flat(inner) => open(Frame::Flat, inner),
            Doc::Group(inner) => open(Frame::Group, inner),
            Doc::Line => Piece::Line,
            Doc::Soft => Piece::Soft,
            Doc::Hard => Piece::Hard,
            Doc::Empty => Piece::Empty,
            Doc::Suffix(comment) => Piece::Suffix(comment.clone()),
            Doc::At(offset) => Piece::At(*offset),
        };
        pieces.push(piece);
    }
    pieces
}

/// Appends the tokens of a text and the white space between them.
fn tokens(text: &str, pieces: &mut Vec<Piece>) {
    let mut done = 0;
    for (_, range) in Token::lexer(text).spanned() {
        if done < range.start {
            pieces.push(Piece::Other(text[done..range.start].to_owned()));
        }
        done = range.end;
        pieces.push(Piece::Token(text[range].to_owned()));
    }
    if done < text.len() {
        pieces.push(Piece::Other(text[done..].to_owned()));
    }
}

/// Rebuilds a document from pieces. `put` holds the pieces to insert before an index.
pub(super) fn rebuilt(pieces: Vec<Piece>, mut put: BTreeMap<usize, Vec<Piece>>) -> Doc {
    let mut open: Vec<Vec<Doc>> = Vec::new();
    let mut parts = Vec::new();
    let mut add = |piece| {
        let doc = match piece {
            Piece::Open(_) => {
                open.push(std::mem::take(&mut parts));
                return;
            }
            Piece::Close(frame) => {
                let outer = open.pop().unwrap_or_default();
                framed(frame, Doc::Concat(std::mem::replace(&mut parts, outer)))
            }
            Piece::Token(text) | Piece::Other(text) => Doc::Text(text),
            Piece::Line => Doc::Line,
            Piece::Soft => Doc::Soft,
            Piece::Hard => Doc::Hard,
            Piece::Empty => Doc::Empty,
            Piece::Suffix(comment) => Doc::Suffix(comment),
            Piece::At(_) => return,
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

fn framed(frame: Frame, doc: Doc) -> Doc {
    let doc = Box::new(doc);
    match frame {
        Frame::Indent(by) => Doc::Indent(by, doc),
        Frame::Hang => Doc::Hang(doc),
        Frame::Flat => Doc::Flat(doc),
        Frame::Group => Doc::Group(doc),
    }
}
