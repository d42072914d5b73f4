//! Tokens and trees as text, for `--emit tokens`, `--emit ast` and the tests. Places are left out.

mod decl;
mod expr;
mod sexp;

use crate::ast::File;
use crate::lexer::lex;
use crate::{Mode, with_stack};
use rpi_diag::FileId;
use sexp::Sexp;
use std::fmt::Write as _;

/// Whether the parentheses that a writer set show in the dump of a tree.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Parens {
    /// They show: the tree as it is.
    Keep,
    /// They do not: two trees that mean the same look the same.
    Drop,
}

/// The tree as nested lists, one declaration after the other.
pub fn dump_ast(file: &File, parens: Parens) -> String {
    let dumper = Dumper { parens };
    let mut out = String::new();
    with_stack(|| {
        for item in &file.items {
            dumper.item(item).write(&mut out);
            out.push('\n');
        }
    });
    out
}

/// The tokens as the parser sees them, a line each: place, kind, text.
pub fn dump_tokens(text: &str, mode: Mode) -> String {
    let mut out = String::new();
    for lexeme in lex(FileId(0), text, mode).lexemes {
        let written = &text[lexeme.start as usize..lexeme.end as usize];
        let kind = match lexeme.token.spelling() {
            Some(_) => "word or sign".to_owned(),
            None => format!("{:?}", lexeme.token).to_lowercase(),
        };
        let _ = writeln!(out, "{}..{} {kind} {written}", lexeme.start, lexeme.end);
    }
    out
}

/// Turns nodes into nested lists.
struct Dumper {
    parens: Parens,
}

/// A list of what a name is followed by.
fn node(name: &str, parts: impl IntoIterator<Item = Sexp>) -> Sexp {
    Sexp::List(std::iter::once(Sexp::atom(name)).chain(parts).collect())
}

fn nodes<T>(name: &str, elements: &[T], one: impl Fn(&T) -> Sexp) -> Sexp {
    node(name, elements.iter().map(one))
}
