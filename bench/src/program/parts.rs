//! Programs of many parts: nodes, calls, fragments, states.

use super::{lines, names};

/// Number of equations in the body of each generated node.
const EQUATIONS_PER_PART: usize = 8;

/// Returns a Lustre program of about `n` equations for benchmarks: many small nodes, and a node that calls each of them
/// once in a chain.
pub(super) fn nodes(n: usize) -> String {
    let count = (n / (EQUATIONS_PER_PART + 2)).max(1);
    let parts = lines(count, |k| {
        let body = lines(EQUATIONS_PER_PART, |e| match e {
            0 => "  x0 = u + v;".to_owned(),
            _ => format!("  x{e} = u -> pre x{} * v;", e - 1),
        });
        format!(
            "node part{k} (u, v: real) returns (y: real);\nvar {}: real;\nlet\n{body}  y = x{};\ntel",
            names("x", EQUATIONS_PER_PART),
            EQUATIONS_PER_PART - 1
        )
    });
    let calls = lines(count, |k| match k {
        0 => "  c0 = part0(u, u);".to_owned(),
        _ => format!("  c{k} = part{k}(c{}, u);", k - 1),
    });
    format!(
        "{parts}node whole (u: real) returns (y: real);\nvar {}: real;\nlet\n{calls}  y = c{};\ntel\n",
        names("c", count),
        count - 1
    )
}

/// Returns a program of about `n` equations after inlining for benchmarks: one small node that another node calls many
/// times.
pub(super) fn calls(n: usize) -> String {
    let count = (n / (EQUATIONS_PER_PART + 2)).max(1);
    let body = lines(EQUATIONS_PER_PART, |e| match e {
        0 => "  x0 = u + v;".to_owned(),
        _ => format!("  x{e} = u -> pre x{} * v;", e - 1),
    });
    let calls = lines(count, |k| match k {
        0 => "  c0 = part(u, u);".to_owned(),
        _ => format!("  c{k} = part(c{}, u);", k - 1),
    });
    format!(
        "node part (u, v: real) returns (y: real)\nlet\n{body}  y = x{};\ntel\n\
         node whole (u: real) returns (y: real)\nlet\n{calls}  y = c{};\ntel\n",
        EQUATIONS_PER_PART - 1,
        count - 1
    )
}

/// Returns a program of about `n` equations after inlining for benchmarks: each node calls the previous one ten times,
/// so that few lines give many equations.
pub(super) fn ladder(n: usize) -> String {
    let mut text =
        "node part0 (u: real) returns (y: real)\nlet y = u -> pre u * 0.5; tel\n".to_owned();
    let (mut rung, mut size) = (0, 1);
    while size * 10 <= n {
        let calls = lines(10, |k| match k {
            0 => format!("  c0 = part{rung}(u);"),
            _ => format!("  c{k} = part{rung}(c{});", k - 1),
        });
        rung += 1;
        size *= 10;
        text.push_str(&format!(
            "node part{rung} (u: real) returns (y: real)\nlet\n{calls}  y = c9;\ntel\n"
        ));
    }
    text
}

/// Returns a program of about `n` equations for benchmarks: fragments side by side, each of which reads the result of
/// the previous one.
pub(super) fn fragments(n: usize) -> String {
    let count = (n / 5).max(1);
    let body = lines(count, |k| {
        let before = match k {
            0 => "u".to_owned(),
            _ => format!("y{}", k - 1),
        };
        format!(
            "  on{k} = {before} > {k}.0;\n  fragment F{k} when on{k} restart\n  let\n    \
             a = {before} * 0.5;\n    b = a -> pre b + a;\n    c = b - a;\n  tel\n  y{k} = F{k}.c ?? {before};"
        )
    });
    format!(
        "node whole (u: real) returns (y: real)\nlet\n{body}  y = y{};\ntel\n",
        count - 1
    )
}

/// Returns a program of about `n` equations for benchmarks: automata of two states each, side by side.
pub(super) fn automata(n: usize) -> String {
    let count = (n / 5).max(1);
    let body = lines(count, |k| {
        let before = match k {
            0 => "go".to_owned(),
            _ => format!("on{}", k - 1),
        };
        format!(
            "  automaton\n    initial state Off{k} let on{k} = false; tel until {before} then On{k};\n    \
             state On{k} let n{k} = 0 -> pre n{k} + 1; on{k} = n{k} > {k}; tel until n{k} > 5 then Off{k};\n  end"
        )
    });
    format!(
        "node whole (go: bool) returns (y: bool)\nlet\n{body}  y = on{};\ntel\n",
        count - 1
    )
}

/// Returns a program of about `n` equations for benchmarks: one automaton of many states.
pub(super) fn automaton(n: usize) -> String {
    let count = (n / 5).max(2);
    let states = lines(count, |k| {
        let initial = if k == 0 { "initial " } else { "" };
        format!(
            "    {initial}state S{k} let n{k} = 0 -> pre n{k} + 1; y = n{k} + {k}; tel until go and n{k} > 2 then S{};",
            (k + 1) % count
        )
    });
    format!("node whole (go: bool) returns (y: int)\nlet\n  automaton\n{states}  end\ntel\n")
}

/// Returns a Lustre program of about `n` equations for benchmarks: sampled flows with a clock for every five equations.
pub(super) fn clocks(n: usize) -> String {
    let count = (n / 5).max(1);
    let body = lines(count, |k| {
        let before = match k {
            0 => "u".to_owned(),
            _ => format!("y{}", k - 1),
        };
        format!(
            "  c{k} = {before} > {k};\n  a{k} = {before} when c{k};\n  s{k} = a{k} -> pre s{k} + a{k};\n  \
             r{k} = {before} when not c{k};\n  y{k} = merge c{k} (true -> s{k}) (false -> r{k});"
        )
    });
    let flows = |prefix| names(prefix, count);
    let declared = lines(count, |k| {
        format!("  a{k}, s{k}: int when c{k}; r{k}: int when not c{k};")
    });
    format!(
        "node whole (u: int) returns (y: int);\nvar\n  {}: bool;\n  {}: int;\n{declared}let\n{body}  y = y{};\ntel\n",
        flows("c"),
        flows("y"),
        count - 1
    )
}

/// Returns a program of about `n` equations for benchmarks: commands with one fragment each.
pub(super) fn commands(n: usize) -> String {
    let count = (n / 5).max(1);
    lines(count, |k| {
        format!(
            "command Wait{k} ()\nlet\n  late = time > {k}[s];\n  fragment Late when late\n  let\n    \
             n = 0 -> pre n + 1;\n    enough = n > {k};\n  tel\n  over = Late.enough ?? false;\n  \
             finish done when over;\ntel"
        )
    })
}
