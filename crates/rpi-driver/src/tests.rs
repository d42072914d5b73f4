//! The tests of a program.

use rpi_diag::Span;
use rpi_net::Net;

/// A test, ready to be run.
#[derive(Clone, Debug)]
pub struct Test {
    /// What it shows, in words.
    pub title: String,
    /// Where its title stands.
    pub span: Span,
    /// What is run.
    pub net: Net,
}
