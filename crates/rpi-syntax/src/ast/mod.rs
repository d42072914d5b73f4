//! The syntax tree of a file: what was written, not what it means.
//!
//! Every node has a [`Span`]; nodes made by a program have [`Span::NONE`] and print all the same.
//! Names are not resolved here. In particular the predeclared flows (`time`, `cancel`, `none`) are
//! plain names, and the predeclared operators (`present(x)`, `hold(x, init)`, `condact(c, f(x), d)`,
//! `map<<+; 3>>(a, b)`) are plain calls, so that a declaration may shadow them.
//!
//! | file | idea |
//! |---|---|
//! | `literal.rs` | numbers, units, clocks |
//! | `expr.rs` | expressions and calls |
//! | `ty.rs` | types |
//! | `body.rs` | equations, fragments in place, automata |
//! | `decl.rs` | top-level declarations |
//! | `task.rs` | tasks |
//! | `children.rs`, `children_mut.rs` | what an expression is made of |
//! | `walk.rs` | a walk through all of a declaration |
//! | `build.rs` | short ways to make nodes that have no text |

mod body;
mod build;
mod children;
mod children_mut;
mod decl;
mod expr;
mod literal;
mod task;
mod ty;
mod walk;

pub use body::*;
pub use decl::*;
pub use expr::*;
pub use literal::*;
pub use task::*;
pub use ty::*;
pub use walk::{Visit, Walk};

use crate::Mode;
pub use crate::name::Name;
use rpi_diag::Span;
use std::sync::Arc;

/// One source file.
#[derive(Clone, PartialEq, Debug)]
pub struct File {
    /// Its declarations, in text order.
    pub items: Vec<Item>,
    /// Which words it knows.
    pub mode: Mode,
}

/// A name at a place. It may be qualified (`Core::DoubleAdd`) where it refers to something.
#[derive(Clone, PartialEq, Debug)]
pub struct Ident {
    /// The name.
    pub name: Name,
    /// Where it stands.
    pub span: Span,
}

/// The text of a doc comment (`--|`), without the marks, lines joined by `\n`.
pub type Doc = Arc<str>;

/// Names joined by dots: `arm.tcp`, `way.done`.
#[derive(Clone, PartialEq, Debug)]
pub struct Dotted {
    /// The names, at least one.
    pub parts: Vec<Ident>,
    /// All of it.
    pub span: Span,
}
