//! Nets of any size, for tests of limits.

use std::fmt::Write;

/// Returns the text of a net (`.rpinet`) with `additions` additions in a row, at least one. All but the
/// first add `constant`, the text of a real number; the last result is exported as `sum`.
#[must_use]
pub fn net_of_additions(additions: usize, constant: &str) -> String {
    let mut net = String::from("{a0=Core::DoubleAdd(First='1.0',Second='1.0')");
    for k in 1..additions {
        let before = k - 1;
        // Writing to a string does not fail.
        let _ = write!(
            net,
            ",a{k}=Core::DoubleAdd(inFirst=a{before}.outValue,Second='{constant}')"
        );
    }
    let last = additions - 1;
    let _ = write!(
        net,
        ",out=Core::DoubleNetcommOut(inValue=a{last}.outValue,Key='sum')}}"
    );
    net
}
