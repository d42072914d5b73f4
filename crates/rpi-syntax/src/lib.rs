//! Lexer, parser, syntax tree and formatter for `.rpi` and `.lus` files.
//!
//! [`parse`] never fails: it always returns a tree and diagnostics. An error in one declaration does not hide the
//! others. [`format()`] formats source text; [`print()`] prints a tree that has no source text, such as an imported
//! net.
//!
//! This crate handles syntax only: it resolves no names, types or units, and opens no files. Its interface exposes no
//! type of the parser generator or of the lexer.

mod actions;
pub mod ast;
mod closing_brackets;
mod comments;
mod context;
mod dump;
mod expected;
mod foreign;
mod foreign_literal;
mod grammar;
mod guessed_declarations;
mod guessed_names;
mod keywords;
mod kind2_blocks;
mod lexer;
mod lexical_errors;
mod name;
mod neighbours;
mod nesting;
pub mod ops;
mod parse;
mod parts;
mod precedence;
mod print;
mod recover;
mod reserved_words;
mod size_ports;
mod source_tokens;
mod split;
mod stack;
mod stray_tokens;
mod string_literal;
mod syntax_errors;
mod token;
mod token_tree;
mod unclosed;
mod unit_suffix;
mod validation;

pub use comments::{Comment, CommentKind, Comments};
pub use dump::{Parens, dump_ast, dump_tokens};
pub use name::Name;
pub use parse::parse;
pub use parts::{Division, PartParse, divide, parse_part};
pub use print::{format, header, print};
pub use source_tokens::{SourceToken, SourceTokenKind, source_tokens};
pub use stack::with_large_stack;
pub use token::{KEYWORDS, Keyword, KeywordContext, is_name, symbols};

use rpi_diag::Diagnostic;

/// Dialect of a source file. It selects the keywords and some operators. See [`Dialect::from_path`].
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Dialect {
    /// `.rpi` files: the whole language.
    Rpi,
    /// `.lus` files: Lustre. Robotics keywords are plain names, and `%` is the remainder operator.
    Lustre,
}

impl Dialect {
    /// Returns the dialect of a file by its extension: Lustre for `.lus`, else RPI.
    pub fn from_path(path: &str) -> Dialect {
        match path.ends_with(".lus") {
            true => Dialect::Lustre,
            false => Dialect::Rpi,
        }
    }
}

/// Result of parsing a file: the syntax tree, the comments and the diagnostics. See [`parse`].
#[derive(Clone, PartialEq, Debug)]
pub struct Parse {
    /// Syntax tree. Parts of the text with errors are error nodes.
    pub file: ast::File,
    /// All comments of the source text.
    pub comments: Comments,
    /// Diagnostics of the parser, in text order.
    pub diagnostics: Vec<Diagnostic>,
}
