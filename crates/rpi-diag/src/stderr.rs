//! Macros that write to standard error and ignore write errors (closed pipe, full disk). `eprint!` would panic then.

/// Writes to standard error like `eprint!`, but ignores write errors.
#[macro_export]
macro_rules! print_stderr {
    ($($text:tt)*) => {{
        use std::io::Write as _;
        let _ = write!(std::io::stderr(), $($text)*);
    }};
}

/// Writes a line to standard error like `eprintln!`, but ignores write errors.
#[macro_export]
macro_rules! println_stderr {
    ($($text:tt)*) => {{
        use std::io::Write as _;
        let _ = writeln!(std::io::stderr(), $($text)*);
    }};
}
