//! Abstract syntax tree of a file.
//!
//! Every node has a [`Span`]. Nodes created by a program have [`Span::NONE`] and can be printed too.
//! Names are not resolved. In particular, the predeclared flows (`time`, `cancel`, `none`) are
//! plain names, and the predeclared operators (`present(x)`, `hold(x, init)`, `condact(c, f(x), d)`,
//! `map<<+; 3>>(a, b)`) are plain calls, so that a declaration may shadow them.
//!
//! | file | content |
//! |---|---|
//! | `literal.rs` | numbers, units, clocks |
//! | `expr.rs` | expressions and calls |
//! | `ty.rs` | types |
//! | `body.rs` | equations, local fragments, automata |
//! | `decl.rs` | top-level declarations |
//! | `task.rs` | tasks |
//! | `children.rs`, `children_mut.rs` | direct subexpressions of an expression |
//! | `walk.rs` | visitor of a whole declaration |
//! | `builder.rs` | constructors of nodes without source text |

mod body;
mod builder;
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
pub use walk::{Visitor, Walker};

use crate::Dialect;
pub use crate::name::Name;
use rpi_diag::Span;
use std::sync::Arc;

/// Syntax tree of a source file.
#[derive(Clone, PartialEq, Debug)]
pub struct File {
    /// Declarations of the file in text order.
    pub items: Vec<Item>,
    /// Dialect in which the file is written.
    pub dialect: Dialect,
}

/// Name with its source range. A reference may be qualified (`Core::DoubleAdd`).
#[derive(Clone, PartialEq, Debug)]
pub struct Ident {
    /// Text of the name.
    pub name: Name,
    /// Range of the name in the source text.
    pub span: Span,
}

/// Text of a doc comment (`--|`), without the markers, lines joined by `\n`.
pub type Doc = Arc<str>;

/// Path of names joined by dots: `arm.tcp`, `way.done`.
#[derive(Clone, PartialEq, Debug)]
pub struct Dotted {
    /// Names between the dots, in text order; at least one.
    pub parts: Vec<Ident>,
    /// Source range of the whole path.
    pub span: Span,
}
