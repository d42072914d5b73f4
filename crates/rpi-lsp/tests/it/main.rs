//! Integration tests of the server over pipes, as an editor uses it.

mod cases;
mod completion;
mod diagnostics;
mod editing;
mod edits;
mod lifecycle;
mod methods;
mod navigation;
mod refactor;
mod rename;
mod rename_programs;
mod robustness;
mod support;
