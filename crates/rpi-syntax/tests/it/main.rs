//! Tests of the front end on whole programs, on programs with errors, and on generated trees.

mod borders;
mod broken;
mod format;
mod names;
mod precedence;
mod prefixes;
mod support;
mod trees;
