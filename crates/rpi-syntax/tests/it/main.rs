//! Tests of the front end on whole programs, on programs with errors, and on generated trees.

mod comment_positions;
mod contextual_keywords;
mod diagnostics;
mod format;
mod generated_trees;
mod precedence;
mod support;
mod tree_strategies;
mod truncated;
