//! Programs in which each line doubles the size of what it defines: short texts with values, types, nets or tasks of any
//! size. Each is checked in a process of its own with little memory and time: it is accepted or refused with a
//! diagnostic, and the process ends on its own.

#![cfg(target_os = "linux")]

use std::path::Path;
use std::process::Command;

/// Lines of each program; 2^LINES of anything fits nowhere.
const LINES: usize = 60;

/// Address space in KiB and processor time in seconds of the compiler. They are far above what a program needs, so that
/// a slow machine does not matter, and far below what doubling takes.
const LIMITS: &str = "ulimit -v 1500000; ulimit -t 60";

/// Lines from a template in which `@` is the number of the line and `#` that of the line before.
fn lines(template: &str) -> String {
    (1..=LINES)
        .map(|line| {
            let (this, before) = (line.to_string(), (line - 1).to_string());
            template.replace('@', &this).replace('#', &before) + "\n"
        })
        .collect()
}

/// A command with these equations.
fn command(body: &str) -> String {
    format!("command X (a: real)\nlet\n{body}export z;\nfinish done when true;\ntel\n")
}

/// A command in which every line defines `p` of its number from that of the line before.
fn flows(first: &str, step: &str) -> String {
    command(&format!("{first}\n{}z = 1.0;\n", lines(step)))
}

/// Declarations, and a command with the equation `z`.
fn declarations(first: &str, step: &str, z: &str) -> String {
    format!("{first}\n{}{}", lines(step), command(&format!("{z}\n")))
}

const PAIR: &str = "p0 = (1.0, a);";

/// Forms of the definitions of flows: name, first definition, and that of each line.
const FLOWS: &[(&str, &str, &str)] = &[
    ("tuple", PAIR, "p@ = (p#, p#);"),
    ("triple", PAIR, "p@ = (p#, p#, p#);"),
    ("array", "p0 = [1.0, a];", "p@ = [p#, p#];"),
    ("repeat", "p0 = [1.0, a];", "p@ = p# ^ 2;"),
    ("concatenation", "p0 = [1.0, a];", "p@ = p# | p#;"),
    ("tuple of arrays", PAIR, "p@ = ([p#, p#], 1.0);"),
    ("array of tuples", PAIR, "p@ = [(p#, p#)];"),
    ("choice", PAIR, "p@ = if true then (p#, p#) else (p#, p#);"),
    ("arrow", PAIR, "p@ = (p#, p#) -> pre (p#, p#);"),
    ("followed by", PAIR, "p@ = (p#, p#) fby (p#, p#);"),
    ("fallback", PAIR, "p@ = (p#, p#) ?? (p#, p#);"),
    (
        "sample",
        "c = true; p0 = (1.0, a);",
        "p@ = (p#, p#) when c;",
    ),
    ("comparison", PAIR, "p@ = ((p#, p#) = (p#, p#), p#);"),
    ("sum", "p0 = a;", "p@ = p# + p#;"),
    ("product of units", "p0 = 2[m];", "p@ = p# * p#;"),
    ("update", PAIR, "p@ = ((p#, p#) with [0] = p#);"),
    ("vector", "p0 = a;", "p@ = norm(vector(p#, p#, p#));"),
    (
        "merge",
        "c = true; p0 = (1.0, a);",
        "p@ = merge c (true -> (p#, p#) when c) (false -> (p#, p#) when not c);",
    ),
    (
        "match",
        "p0 = (1.0, a); b = true;",
        "p@ = match b with true: (p#, p#) | false: (p#, p#) end;",
    ),
];

/// Forms of declarations: name, first declaration, that of each line, and the equation that uses the last one, `$`.
#[rustfmt::skip]
const DECLARATIONS: &[(&str, &str, &str, &str)] = &[
    ("constant tuple", "const c0: real = 1.0;", "const c@ = (c#, c#);", "z = 1.0;"),
    ("constant array", "const c0 = [1.0, 2.0];", "const c@ = [c#, c#];", "z = 1.0;"),
    ("constant concatenation", "const c0 = [1.0, 2.0];", "const c@ = c# | c#;", "z = 1.0;"),
    ("struct", "type T0 = struct { a: real };", "type T@ = struct { a, b: T# };", "z = 1.0;"),
    ("array type", "type T0 = real^2;", "type T@ = T#^2;", "z = 1.0;"),
    ("calls", UNARY, "function f@ (x: real) returns (y: real) let y = f#(f#(x)); tel", "z = f$(a);"),
    ("calls of nodes", "node f0 (x: real) returns (y: real) let y = x -> pre x; tel", "node f@ (x: real) returns (y: real) let y = f#(f#(x)); tel", "z = f$(a);"),
    ("outputs", "function f0 (x: real) returns (y, w: real) let y = x; w = x; tel", "function f@ (x: real) returns (y, w: real) let y = f#(x).y; w = f#(x).w; tel", "z = f$(a).y;"),
    ("static arguments", "function f0 <<n: int>> (x: real) returns (y: real) let y = x + real(n); tel", "function f@ <<n: int>> (x: real) returns (y: real) let y = f#<<n: 2 * n>>(x) + f#<<n: 2 * n + 1>>(x); tel", "z = f$<<n: 0>>(a);"),
    ("functions as arguments", TWICE, "function f@ (x: real) returns (y: real) let y = twice<<f#>>(x); tel", "z = f$(a);"),
    ("map", UNARY, "function f@ (x: real) returns (y: real) var t: real^2; let t = map<<f#, 2>>(x ^ 2); y = t[0]; tel", "z = f$(a);"),
    ("fragments", "fragment F0 (x: real) returns (y: real) let y = x -> pre x; tel", "fragment F@ (x: real) returns (y: real) let u = F#(x); v = F#(u.y); y = v.y; tel", "w = F$(a); z = w.y;"),
];

const UNARY: &str = "function f0 (x: real) returns (y: real) let y = x + 1.0; tel";

/// A function that applies another one twice, and the first one to apply.
const TWICE: &str = "function twice <<function f (a: real) returns (b: real)>> (x: real) returns (y: real) let y = f(f(x)); tel
function f0 (x: real) returns (y: real) let y = x + 1.0; tel";

/// Tasks that double: name and the task of each line.
const TASKS: &[(&str, &str)] = &[
    ("tasks", "task T@ let T#(); T#(); tel"),
    (
        "tasks in parallel",
        "task T@ let parallel let T#(); tel let T#(); tel tel",
    ),
];

/// Names of the forms, and programs that double by them.
fn programs() -> Vec<(&'static str, String)> {
    let of_flows = FLOWS.iter();
    let of_flows = of_flows.map(|(name, first, step)| (*name, flows(first, step)));
    let of_declarations = DECLARATIONS.iter().map(|(name, first, step, z)| {
        let z = z.replace('$', &LINES.to_string());
        (*name, declarations(first, step, &z))
    });
    let of_tasks = TASKS.iter().map(|(name, step)| {
        let first = "command C () let finish done when true; tel\ntask T0 let C(); tel\n";
        (*name, format!("{first}{}", lines(step)))
    });
    let last = LINES;
    let argument = command(&format!(
        "{PAIR}\n{}z = g(p{last});\n",
        lines("p@ = (p#, p#);")
    )) + "function g (x, y: real) returns (s: real) let s = x + y; tel\n";
    let programs = of_flows.chain(of_declarations).chain(of_tasks);
    programs.chain([("argument", argument)]).collect()
}

/// Checks a program in a process with limits. Returns the exit code, and the output.
fn check(path: &Path) -> (Option<i32>, String) {
    let program = env!("CARGO_BIN_EXE_rpic");
    let line = format!("{LIMITS}; exec \"$0\" check --format short \"$1\"");
    let output = Command::new("sh")
        .args(["-c", &line, program])
        .arg(path)
        .output()
        .expect("it starts");
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    let printed = String::from_utf8_lossy(&output.stdout).into_owned();
    (output.status.code(), printed + &text)
}

#[test]
fn what_doubles_with_every_line_is_refused_or_small() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("doubling.rpi");
    for (name, program) in programs() {
        std::fs::write(&path, &program).expect("it is written");
        let (code, output) = check(&path);
        assert!(matches!(code, Some(0 | 1)), "{name}: {code:?} {output}");
        // A mistake in the form itself would hide what it is about.
        let is_syntax = output.contains("RPI0001") || output.contains("RPI1001");
        assert!(!is_syntax, "{name}: {output}");
    }
}
