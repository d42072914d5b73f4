//! The control core on the command line.
fn main() {}
