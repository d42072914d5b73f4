//! Stack space for recursive walks over deeply nested trees.

/// Minimum free stack in bytes for a recursive walk: about 3 kB for each of the 5000 accepted nesting levels, and five
/// times as much in unoptimised builds.
const MIN_FREE_STACK: usize = 80 << 20;
/// Size in bytes of the new stack that is allocated if less is free.
const STACK_SIZE: usize = 2 * MIN_FREE_STACK;

/// Runs a recursive walk over a syntax tree, or over a structure derived from one. If little stack is free, allocates a
/// stack that is large enough for the deepest accepted nesting.
pub fn with_large_stack<R>(walk: impl FnOnce() -> R) -> R {
    stacker::maybe_grow(MIN_FREE_STACK, STACK_SIZE, walk)
}
