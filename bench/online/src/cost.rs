//! Time of a calculation.

/// Measures.
pub fn measure() {}
