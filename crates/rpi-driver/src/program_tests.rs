//! Tests of a program.

use crate::analysed_net::AnalysedNet;
use rpi_diag::Span;

/// Test that can be run.
#[derive(Clone, Debug)]
pub struct Test {
    /// Title of the test.
    pub title: String,
    /// Location of the title.
    pub span: Span,
    /// Net of the test.
    pub net: AnalysedNet,
}
