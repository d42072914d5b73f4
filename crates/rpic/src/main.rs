//! The compiler on the command line.
fn main() {}
