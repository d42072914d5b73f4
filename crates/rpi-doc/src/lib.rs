//! Reference documentation of a project as HTML pages, written by `rpic doc`.
//!
//! [`Site::new`] converts checked modules to files: a page for each module with its declarations, doc comments and nets,
//! the source texts, and a searchable index. The pages need no network and no server, and the output is deterministic.
//! This crate only shows declarations; it must not check them, and it opens no file.
//!
//! | file | idea |
//! |---|---|
//! | `site.rs` | files of the site |
//! | `links.rs` | links to declarations |
//! | `module.rs`, `declaration.rs`, `members.rs` | pages of modules, declarations, and their members |
//! | `code.rs` | highlighted programs with links |
//! | `markdown.rs` | doc comments |
//! | `html.rs` | frame of every page |
//! | `drawing/` | drawings of nets and tasks |

mod code;
mod declaration;
mod drawing;
mod html;
mod links;
mod markdown;
mod members;
mod module;
mod site;

pub use site::{Module, Site};
