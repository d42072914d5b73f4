//! Dumps of tokens and trees as text, for `--emit tokens`, `--emit ast` and the tests. Trees are dumped without spans.

mod decl;
mod expr;
mod sexp;

use crate::ast::File;
use crate::lexer::lex;
use crate::{Dialect, with_large_stack};
use rpi_diag::FileId;
use sexp::Sexp;
use std::fmt::Write as _;

/// Whether the dump of a tree shows the parentheses of the source.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Parens {
    /// Shows the parentheses of expressions as they are in the source text.
    Keep,
    /// Omits parentheses, so that expressions that differ only in redundant parentheses have the same dump.
    Drop,
}

/// Returns the syntax tree as nested lists (S-expressions), one line or block per declaration.
pub fn dump_ast(file: &File, parens: Parens) -> String {
    let dumper = Dumper { parens };
    let mut out = String::new();
    with_large_stack(|| {
        for item in &file.items {
            dumper.item(item).write(&mut out);
            out.push('\n');
        }
    });
    out
}

/// Returns the tokens of the text, one per line, with byte range, kind and text.
pub fn dump_tokens(text: &str, mode: Dialect) -> String {
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

/// Converter of syntax trees into nested lists (S-expressions).
struct Dumper {
    parens: Parens,
}

/// Creates a list that consists of `name` and the given parts.
fn list_node(name: &str, parts: impl IntoIterator<Item = Sexp>) -> Sexp {
    Sexp::List(std::iter::once(Sexp::atom(name)).chain(parts).collect())
}

/// Creates a list that consists of `name` and the elements, each converted by `one`.
fn nodes<T>(name: &str, elements: &[T], one: impl Fn(&T) -> Sexp) -> Sexp {
    list_node(name, elements.iter().map(one))
}
