//! Stack space for recursive walks over deeply nested trees.

/// Stack in bytes that a walk may need: about 3 kB for each level that [`nesting`](crate::nesting) accepts, and five
/// times as much in unoptimised builds.
const MIN_FREE_STACK: usize = 80 << 20;
/// Size in bytes of a new stack.
const STACK_SIZE: usize = 2 * MIN_FREE_STACK;

/// Runs a recursive walk over a syntax tree, or a structure derived from one, on a stack that is large enough for the
/// deepest accepted nesting. Threads with a small stack may call it too.
pub fn with_large_stack<R>(walk: impl FnOnce() -> R) -> R {
    stacker::maybe_grow(MIN_FREE_STACK, STACK_SIZE, walk)
}
