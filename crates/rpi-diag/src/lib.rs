//! Findings: the one table of codes, their pages, and how they are shown.
//!
//! Every stage that looks at a program says what it found as a [`Finding`]: a code, a sentence, the
//! places involved and, where one exists, the fix. This crate knows how findings are declared and
//! shown; it must not know what any of them means. The words for people live beside the check that
//! knows the facts.
//!
//! | file | idea |
//! |---|---|
//! | `span.rs` | places in source texts |
//! | `codes.rs` | the table of codes |
//! | `finding.rs` | one finding |
//! | `format.rs` | the forms of output: `render.rs` (for people), `json.rs`, `sarif.rs`, `github.rs` |
//! | `snippet.rs`, `apart.rs`, `texts.rs`, `footer.rs` | the parts of the form for people |
//! | `style.rs` | what a terminal can show |
//! | `apply.rs` | applying fixes to texts |

mod apart;
mod apply;
mod codes;
mod cut;
mod finding;
mod footer;
mod format;
mod github;
mod json;
mod render;
mod sarif;
mod snippet;
mod span;
mod style;
mod tell;
mod texts;

pub use apply::{apply, sure_edits, sure_fixes};
pub use codes::{Code, Severity};
pub use finding::{Applicability, Edit, Finding, Fix, Label};
pub use format::{Format, render_as};
pub use render::render;
pub use rpi_words::{counted, suggest, times};
pub use span::{FileId, LineCol, SourceMap, Span};
pub use style::Style;
