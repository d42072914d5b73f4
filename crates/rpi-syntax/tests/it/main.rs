//! The front end on whole programs, on broken ones, and on made-up trees.

mod format;
mod support;
