//! Programs with many errors.

use super::{lines, names};

/// Returns a program with about `n` errors: declarations that do not parse.
pub(super) fn broken_items(n: usize) -> String {
    lines(n, |k| {
        format!("node broken{k} (x: real returns (y: real) let y = x; tel")
    })
}

/// Returns a program with about `n` errors: equations that do not parse.
pub(super) fn broken_equations(n: usize) -> String {
    node(n, |k| format!("  a{k} = u + ;"))
}

/// Returns a program with about `n` errors: undefined names, most of them similar to a defined one.
pub(super) fn unknown_names(n: usize) -> String {
    node(n, |k| format!("  flow{k} = u * glow{k};"))
}

/// Returns a program with about `n` errors: flows that are read and defined but not declared.
pub(super) fn undeclared(n: usize) -> String {
    node(n, |k| format!("  a{k} = u + a{};", k + 1))
}

/// Returns a program with about `n` errors: duplicate declarations of one name.
pub(super) fn duplicates(n: usize) -> String {
    lines(n, |_| "const same: int = 1;".to_owned())
}

/// Returns a program with about `n` errors: duplicate equations for one flow.
pub(super) fn defined_twice(n: usize) -> String {
    node(n, |_| "  y = u;".to_owned())
}

/// Returns a program with about `n` errors: operands of different types and units.
pub(super) fn wrong_types(n: usize) -> String {
    node(n, |k| format!("  a{k} = u + {k}[m];"))
}

/// Returns a program with about `n` errors: unused flows.
pub(super) fn unused(n: usize) -> String {
    node(n, |k| format!("  a{k} = u * {k}.0;"))
}

/// Returns a program with about `n` errors: many dependency cycles of two flows.
pub(super) fn dependency_cycles(n: usize) -> String {
    let count = n / 2;
    let declared = lines(count, |k| format!("  a{k}, b{k}: real;"));
    let body = lines(count, |k| {
        format!("  a{k} = b{k} + u;\n  b{k} = a{k} * 2.0;")
    });
    format!("node faulty (u: real) returns (y: real)\nvar\n{declared}let\n{body}  y = u;\ntel\n")
}

/// Returns a program with about `n` errors: one dependency cycle through all flows.
pub(super) fn one_dependency_cycle(n: usize) -> String {
    let body = lines(n, |k| format!("  a{k} = a{} * 0.5;", (k + 1) % n));
    let flows = names("a", n);
    format!(
        "node faulty (u: real) returns (y: real)\nvar {flows}: real;\nlet\n{body}  y = u;\ntel\n"
    )
}

/// Returns a program with about `n` errors: delays without an initial value, each read in the first cycle by an
/// out-port.
pub(super) fn no_first_value(n: usize) -> String {
    let body = lines(n, |k| format!("  y{k} = pre u + {k}.0;"));
    let flows = names("y", n);
    format!("node faulty (u: real) returns ({flows}: real)\nlet\n{body}tel\n")
}

/// Returns a program with about `n` errors: flows that may be absent, used where presence is required.
pub(super) fn absent(n: usize) -> String {
    let count = n / 3;
    let declared = lines(count, |k| format!("  b{k}: real;"));
    let body = lines(count, |k| {
        format!("  fragment F{k} when u > {k}.0 let a = u; tel\n  b{k} = F{k}.a;")
    });
    format!("node faulty (u: real) returns (y: real)\nvar\n{declared}let\n{body}  y = u;\ntel\n")
}

/// A node with `count` generated equations.
fn node(count: usize, line: impl Fn(usize) -> String) -> String {
    let body = lines(count, line);
    format!("node faulty (u: real) returns (y: real)\nlet\n{body}  y = u;\ntel\n")
}
