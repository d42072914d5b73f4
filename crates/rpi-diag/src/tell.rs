//! What the tools say on standard error. Whoever has closed it, or a disk that is full, does not want to know: that is no
//! reason to end in a panic, as `eprint!` does.

/// Writes to standard error, as `eprint!` does.
#[macro_export]
macro_rules! tell {
    ($($text:tt)*) => {{
        use std::io::Write as _;
        let _ = write!(std::io::stderr(), $($text)*);
    }};
}

/// Writes a line to standard error, as `eprintln!` does.
#[macro_export]
macro_rules! tell_line {
    ($($text:tt)*) => {{
        use std::io::Write as _;
        let _ = writeln!(std::io::stderr(), $($text)*);
    }};
}
