//! Integration tests of the server over pipes, as an editor uses it.

mod completion;
mod diagnostics;
mod lifecycle;
mod navigation;
mod robustness;
mod support;
