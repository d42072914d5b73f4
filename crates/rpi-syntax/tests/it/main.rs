//! The front end on whole programs, on broken ones, and on made-up trees.

mod borders;
mod broken;
mod format;
mod names;
mod precedence;
mod prefixes;
mod support;
mod trees;
