//! Message of a test that cannot run.

/// Prints the reason why a test is skipped to standard error, even if the test harness captures output.
pub(crate) fn report_skip(reason: &str) {
    let line = format!("SKIPPED: {reason}\n");
    // Captured output is shown for failing tests only, and a skipped test does not fail.
    let _ = std::io::Write::write_all(&mut std::io::stderr(), line.as_bytes());
}
