//! Programs with one long body.

use super::{lines, names};

/// Returns a Lustre program of about `n` equations for benchmarks: a chain in which each flow reads the previous one.
/// All flows are declared with their types.
pub(super) fn chain_declared(n: usize) -> String {
    let flows = names("x", n);
    let body = lines(n, |k| match k {
        0 => "  x0 = u;".to_owned(),
        _ => format!("  x{k} = x{} * 0.5 + {k}.0;", k - 1),
    });
    format!(
        "node chain (u: real) returns (y: real);\nvar {flows}: real;\nlet\n{body}  y = x{};\ntel\n",
        n - 1
    )
}

/// Returns a program of about `n` equations for benchmarks: a chain in which each flow reads the next one in the text.
/// The flows are not declared, so that their types are inferred.
pub(super) fn chain(n: usize) -> String {
    let body = lines(n, |k| match n - 1 - k {
        0 => "  x0 = u;".to_owned(),
        k => format!("  x{k} = x{} * 0.5 + {k}.0[mm];", k - 1),
    });
    format!(
        "node chain (u: real[m]) returns (y: real[m])\nlet\n  y = x{};\n{body}tel\n",
        n - 1
    )
}

/// Returns a program of about `n` equations for benchmarks: each flow is a copy of the next one in the text.
pub(super) fn copies(n: usize) -> String {
    let body = lines(n, |k| format!("  x{k} = x{};", k + 1));
    let flows = names("x", n + 1);
    format!(
        "node copies (u: int) returns (y: int)\nvar {flows}: int;\nlet\n  y = x0;\n{body}  x{n} = u;\ntel\n"
    )
}

/// Returns a Lustre program of about `n` equations for benchmarks: half of the flows read only in-ports, and the other
/// half sums them up.
pub(super) fn layer(n: usize) -> String {
    let half = (n / 2).max(1);
    let products = lines(half, |k| format!("  p{k} = a{} * a{};", k % 16, k % 7));
    let sums = lines(half, |k| match k {
        0 => "  s0 = p0;".to_owned(),
        _ => format!("  s{k} = s{} + p{k};", k - 1),
    });
    format!(
        "node layer ({}: real) returns (y: real);\nvar {}, {}: real;\nlet\n{products}{sums}  y = s{};\ntel\n",
        names("a", 16),
        names("p", half),
        names("s", half),
        half - 1
    )
}

/// Returns a program of about `n` equations for benchmarks: counters and edge detectors, with a delay in most
/// equations.
pub(super) fn delays(n: usize) -> String {
    let third = (n / 3).max(1);
    let body = lines(third, |k| {
        let before = match k {
            0 => "go".to_owned(),
            _ => format!("up{}", k - 1),
        };
        format!(
            "  count{k} = 0 -> if {before} then pre count{k} + 1 else pre count{k};\n  \
             old{k} = false -> pre {before};\n  up{k} = (count{k} > {k}) and not old{k};"
        )
    });
    format!(
        "node delays (go: bool) returns (y: bool)\nlet\n{body}  y = up{};\ntel\n",
        third - 1
    )
}

/// Returns a Lustre program for benchmarks: arrays with `n` values together, and iterators (`map`, `red`, `fillred`)
/// over them.
pub(super) fn arrays(n: usize) -> String {
    let size = (n / 4).max(1);
    format!(
        "const n = {size};\n\
         node step (acc, x: int) returns (next, out: int);\nlet next = acc + x; out = acc - x; tel\n\
         node arrays (a: int^n) returns (total: int; b: int^n);\nvar c, d: int^n; s: int;\nlet\n  \
         c = map<<+, n>>(a, a);\n  (s, d) = fillred<<step, n>>(0, c);\n  \
         total = red<<+, n>>(s, d);\n  b = c[1 .. n - 1] | [total];\ntel\n"
    )
}

/// Returns a program of about `n` equations for benchmarks: a chain of small arrays, each computed from the previous
/// one by slice, concatenation, `with` and element access.
pub(super) fn array_chain(n: usize) -> String {
    let body = lines(n, |k| match k {
        0 => "  a0 = u;".to_owned(),
        _ => {
            let (from, at) = (k - 1, k % 8);
            match k % 3 {
                0 => format!("  a{k} = a{from}[1 .. 7] | a{from}[0 .. 0];"),
                1 => format!("  a{k} = (a{from} with [{at}] = a{from}[{}] * 0.5);", at),
                _ => format!("  a{k} = a{from};"),
            }
        }
    });
    format!(
        "node chain (u: real^8) returns (y: real^8)\nlet\n{body}  y = a{};\ntel\n",
        n - 1
    )
}
