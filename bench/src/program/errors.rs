//! Programs with many errors.

use super::{lines, names};

/// Returns a program with about `n` errors for benchmarks: declarations that cannot be parsed.
pub(super) fn broken_items(n: usize) -> String {
    lines(n, |k| {
        format!("node broken{k} (x: real returns (y: real) let y = x; tel")
    })
}

/// Returns a program with about `n` errors for benchmarks: equations that cannot be parsed.
pub(super) fn broken_equations(n: usize) -> String {
    node(n, |k| format!("  a{k} = u + ;"))
}

/// Returns a program with about `n` errors for benchmarks: undefined names, most of them similar to a defined name.
pub(super) fn unknown_names(n: usize) -> String {
    node(n, |k| format!("  flow{k} = u * glow{k};"))
}

/// Returns a program with about `n` errors for benchmarks: flows that are read and defined but not declared.
pub(super) fn undeclared(n: usize) -> String {
    node(n, |k| format!("  a{k} = u + a{};", k + 1))
}

/// Returns a program with about `n` errors for benchmarks: duplicate declarations of one constant.
pub(super) fn duplicates(n: usize) -> String {
    lines(n, |_| "const same: int = 1;".to_owned())
}

/// Returns a program with about `n` errors for benchmarks: duplicate equations for one flow.
pub(super) fn defined_twice(n: usize) -> String {
    node(n, |_| "  y = u;".to_owned())
}

/// Returns a program with about `n` errors for benchmarks: sums of operands with different units.
pub(super) fn wrong_types(n: usize) -> String {
    node(n, |k| format!("  a{k} = u + {k}[m];"))
}

/// Returns a program with about `n` warnings for benchmarks: flows that no other equation reads.
pub(super) fn unused(n: usize) -> String {
    node(n, |k| format!("  a{k} = u * {k}.0;"))
}

/// Returns a program with about `n` equations for benchmarks, whose errors are dependency cycles of two flows each.
pub(super) fn dependency_cycles(n: usize) -> String {
    let count = n / 2;
    let declared = lines(count, |k| format!("  a{k}, b{k}: real;"));
    let body = lines(count, |k| {
        format!("  a{k} = b{k} + u;\n  b{k} = a{k} * 2.0;")
    });
    format!("node faulty (u: real) returns (y: real)\nvar\n{declared}let\n{body}  y = u;\ntel\n")
}

/// Returns a program with about `n` equations for benchmarks, whose error is one dependency cycle through all flows.
pub(super) fn one_dependency_cycle(n: usize) -> String {
    let body = lines(n, |k| format!("  a{k} = a{} * 0.5;", (k + 1) % n));
    let flows = names("a", n);
    format!(
        "node faulty (u: real) returns (y: real)\nvar {flows}: real;\nlet\n{body}  y = u;\ntel\n"
    )
}

/// Returns a program with about `n` errors for benchmarks: delays without an initial value, each read by an out-port in
/// the first cycle.
pub(super) fn no_first_value(n: usize) -> String {
    let body = lines(n, |k| format!("  y{k} = pre u + {k}.0;"));
    let flows = names("y", n);
    format!("node faulty (u: real) returns ({flows}: real)\nlet\n{body}tel\n")
}

/// Returns a program with about `n` equations for benchmarks, whose errors are flows that may be absent where a value
/// is required.
pub(super) fn absent(n: usize) -> String {
    let count = n / 3;
    let declared = lines(count, |k| format!("  b{k}: real;"));
    let body = lines(count, |k| {
        format!("  fragment F{k} when u > {k}.0 let a = u; tel\n  b{k} = F{k}.a;")
    });
    format!("node faulty (u: real) returns (y: real)\nvar\n{declared}let\n{body}  y = u;\ntel\n")
}

/// Returns the text of a node with `count` generated equations. `line` returns the text of the equation with a given
/// number, from 0.
fn node(count: usize, line: impl Fn(usize) -> String) -> String {
    let body = lines(count, line);
    format!("node faulty (u: real) returns (y: real)\nlet\n{body}  y = u;\ntel\n")
}
