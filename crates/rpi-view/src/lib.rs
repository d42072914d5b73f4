//! Page that shows a recording in a browser: the cell in 3D, plots, a timeline and the program.
//!
//! ```text
//! recording -> RunData (rpi-record) -> document: JSON head and blocks of numbers
//!     document, exact      -> ViewServer: page and document over HTTP, on the loopback interface only
//!     document, compressed -> report: page and document in one HTML file
//! ```
//! The page is written in TypeScript in `web/`. Its bundle `web/dist/page.html` is part of the repository, so that the
//! tools are built without Node. This crate must not depend on the compiler.

mod block;
mod document;
mod net_head;
mod report;
mod request;
mod server;

pub use document::{Precision, ViewContent, document};
pub use report::report;
pub use server::{SharedSource, ViewServer, ViewSource};

/// The page: one HTML file with script and style. It has a mark in place of the document.
const PAGE: &str = include_str!("../web/dist/page.html");
