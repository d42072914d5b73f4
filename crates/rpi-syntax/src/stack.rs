//! Room for walks over trees that nest as deeply as a text may.

/// What a walk may need: about 3 kB for each level that [`nesting`](crate::nesting) accepts, and five times as much for
/// builds that spare no stack.
const NEEDED: usize = 80 << 20;
const SIZE: usize = 2 * NEEDED;

/// Runs something that walks over syntax trees, or over what is made of them, on a stack that bears the deepest nesting
/// that is accepted: wherever it is called from, a thread with a small stack included.
pub fn with_stack<R>(walk: impl FnOnce() -> R) -> R {
    stacker::maybe_grow(NEEDED, SIZE, walk)
}
