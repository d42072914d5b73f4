//! Tests of a program.

use rpi_diag::Span;
use rpi_net::Net;

/// Test that can be run.
#[derive(Clone, Debug)]
pub struct Test {
    /// Title of the test.
    pub title: String,
    /// Location of the title.
    pub span: Span,
    /// Net of the test.
    pub net: Net,
}
