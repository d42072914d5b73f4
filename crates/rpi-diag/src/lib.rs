//! Diagnostics: the table of codes, their explanation pages, suppression of consequences, and rendering.
//!
//! Every stage of the compiler reports a problem as a [`Diagnostic`]: a code, a message, labelled locations and, where one
//! exists, a fix. This crate declares codes, removes diagnostics that only follow from others, and renders the rest; it must
//! not depend on the checks. The message is written in the code that performs the check.
//!
//! | file | idea |
//! |---|---|
//! | `span.rs` | locations in source texts |
//! | `codes.rs` | the table of codes |
//! | `diagnostic.rs` | a diagnostic |
//! | `format.rs` | output formats: `render.rs` (for people), `json.rs`, `sarif.rs`, `github.rs` |
//! | `snippet.rs`, `overlap.rs`, `source_code.rs`, `footer.rs` | parts of the output for people |
//! | `style.rs` | capabilities of the terminal |
//! | `apply.rs` | applying fixes to texts |
//! | `suppression.rs` | removal of diagnostics that follow from others |

mod abbreviate;
mod apply;
mod codes;
mod diagnostic;
mod footer;
mod format;
mod github;
mod json;
mod overlap;
mod quote;
mod render;
mod sarif;
mod snippet;
mod source_code;
mod span;
mod stderr;
mod style;
pub mod suppression;

pub use apply::{apply, sure_edits, sure_fixes};
pub use codes::{Code, CodeGroup, Severity};
pub use diagnostic::{Applicability, Diagnostic, Edit, Fix, Label, Subject};
pub use format::{Format, FormatError, render_as};
pub use quote::{Quote, fill_quotes};
pub use render::render;
pub use rpi_words::{suggest, times, with_noun};
pub use span::{FileId, LineCol, SourceMap, SourcePart, Span};
pub use style::Style;
