//! The reference of a project, as pages in HTML: what `rpic doc` writes.
//!
//! [`Site::of`] takes checked modules and gives files: a page for each module with its declarations, doc comments and nets, the
//! source texts, and an index that can be searched. The pages need no network and no server, and the same modules give the
//! same bytes. This crate knows how declarations are shown; it must not know what makes them right, and opens no file.
//!
//! | file | idea |
//! |---|---|
//! | `site.rs` | the files |
//! | `places.rs` | on which page a declaration stands |
//! | `module.rs`, `declaration.rs`, `parts.rs` | a module, a declaration, its parameters, ports and results |
//! | `code.rs` | programs: coloured, and with links |
//! | `markdown.rs` | doc comments |
//! | `html.rs` | the frame around every page |
//! | `drawing/` | nets and tasks, drawn |

mod code;
mod declaration;
mod drawing;
mod html;
mod markdown;
mod module;
mod parts;
mod places;
mod site;

pub use site::{Module, Site};
