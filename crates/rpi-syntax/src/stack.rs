//! Stack space for recursive walks over deeply nested trees.

/// Stack in bytes that a walk may need: about 3 kB for each level that [`nesting`](crate::nesting) accepts, and five
/// times as much in unoptimised builds.
const NEEDED: usize = 80 << 20;
/// Size in bytes of a new stack.
const SIZE: usize = 2 * NEEDED;

/// Runs a recursive walk over a syntax tree, or a structure derived from one, on a stack that is large enough for the
/// deepest accepted nesting. Threads with a small stack may call it too.
pub fn with_stack<R>(walk: impl FnOnce() -> R) -> R {
    stacker::maybe_grow(NEEDED, SIZE, walk)
}
