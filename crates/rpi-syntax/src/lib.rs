//! Text to tokens to syntax tree, and back to formatted text.
//!
//! [`parse`] never fails: it always returns a tree and the findings, and what is broken in a text
//! does not hide what is not. [`format()`] sets a text in the one style of the language;
//! [`print()`] writes a tree that has no text, such as an imported net.
//!
//! This crate knows what programs look like. It must not know what they mean: names, types and
//! units are not resolved here, and no file is opened. No type of the parser generator or of the
//! lexer crosses its interface.

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

/// Which words are keywords, and what `%` means. The name of a file decides: see [`Mode::of_path`].
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Mode {
    /// `.rpi`: the whole language.
    Rpi,
    /// `.lus`: Lustre; the words of the robot world are plain names and `%` is the remainder.
    Lustre,
}

impl Mode {
    /// The mode of a file by its name: Lustre for `.lus`, else RPI.
    pub fn of_path(path: &str) -> Mode {
        match path.ends_with(".lus") {
            true => Mode::Lustre,
            false => Mode::Rpi,
        }
    }
}

/// What [`parse`] makes of a text.
#[derive(Clone, PartialEq, Debug)]
pub struct Parse {
    /// The tree; faulty parts of the text are `Broken` nodes in it.
    pub file: ast::File,
    /// The comments of the text.
    pub comments: Comments,
    /// What is wrong with the text, in text order.
    pub findings: Vec<Finding>,
}
