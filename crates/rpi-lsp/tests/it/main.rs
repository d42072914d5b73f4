//! Integration tests of the server over pipes, as an editor uses it.

mod completion;
mod findings;
mod life;
mod names;
mod prefixes;
mod support;
