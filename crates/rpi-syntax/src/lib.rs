//! Lexer, parser, syntax tree and formatter for `.rpi` and `.lus` files.
//!
//! [`parse`] never fails: it always returns a tree and diagnostics. An error in one declaration does not hide the
//! others. [`format()`] formats source text; [`print()`] prints a tree that has no source text, such as an imported
//! net.
//!
//! This crate handles syntax only: it resolves no names, types or units, and opens no files. Its interface exposes no
//! type of the parser generator or of the lexer.

pub mod ast;
mod blocks;
mod chain;
mod comments;
mod context;
mod declared;
mod dump;
mod expected;
mod explain;
mod grammar;
mod habits;
mod lexer;
mod lexical;
mod make;
mod make_blocks;
mod make_expr;
mod mend;
mod name;
mod nesting;
mod numeral;
pub mod ops;
mod outside;
mod parse;
mod phrase;
mod pieces;
mod print;
mod reserved;
mod seeming;
mod sizes;
mod split;
mod stack;
mod structure;
mod text;
mod token;
mod unclosed;
mod units;
mod words;

pub use comments::{Comment, CommentKind, Comments};
pub use dump::{Parens, dump_ast, dump_tokens};
pub use name::Name;
pub use parse::parse;
pub use pieces::{Piece, PieceKind, pieces};
pub use print::{format, head, print};
pub use stack::with_stack;
pub use token::{KEYWORDS, Keyword, Place, is_name, signs};

use rpi_diag::Finding;

/// Dialect of a source file: selects the keywords and the meaning of `%`. See [`Mode::of_path`].
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Mode {
    /// `.rpi` files: the whole language.
    Rpi,
    /// `.lus` files: Lustre. Robotics keywords are plain names, and `%` is the remainder operator.
    Lustre,
}

impl Mode {
    /// Returns the mode of a file by its extension: Lustre for `.lus`, else RPI.
    pub fn of_path(path: &str) -> Mode {
        match path.ends_with(".lus") {
            true => Mode::Lustre,
            false => Mode::Rpi,
        }
    }
}

/// Result of [`parse`].
#[derive(Clone, PartialEq, Debug)]
pub struct Parse {
    /// Syntax tree. Parts of the text with errors are `Broken` nodes.
    pub file: ast::File,
    /// Comments of the text.
    pub comments: Comments,
    /// Diagnostics in text order.
    pub findings: Vec<Finding>,
}
