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

/// Names of the forms, and programs that double by them.
fn programs() -> Vec<(&'static str, String)> {
    let last = LINES;
    let with_flows = [
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
    let mut programs: Vec<(&str, String)> = with_flows
        .into_iter()
        .map(|(name, first, step)| (name, flows(first, step)))
        .collect();
    let unary = "function f0 (x: real) returns (y: real) let y = x + 1.0; tel";
    let twice = format!(
        "{unary}\nfunction twice <<function f (a: real) returns (b: real)>> (x: real) returns (y: real) let y = f(f(x)); tel"
    );
    let applied = format!("z = f{last}(a);");
    programs.extend([
        ("constant tuple", declarations("const c0: real = 1.0;", "const c@ = (c#, c#);", "z = 1.0;")),
        ("constant array", declarations("const c0 = [1.0, 2.0];", "const c@ = [c#, c#];", "z = 1.0;")),
        ("constant concatenation", declarations("const c0 = [1.0, 2.0];", "const c@ = c# | c#;", "z = 1.0;")),
        ("struct", declarations("type T0 = struct { a: real };", "type T@ = struct { a, b: T# };", "z = 1.0;")),
        ("array type", declarations("type T0 = real^2;", "type T@ = T#^2;", "z = 1.0;")),
        ("calls", declarations(unary, "function f@ (x: real) returns (y: real) let y = f#(f#(x)); tel", &applied)),
        ("calls of nodes", declarations("node f0 (x: real) returns (y: real) let y = x -> pre x; tel", "node f@ (x: real) returns (y: real) let y = f#(f#(x)); tel", &applied)),
        ("outputs", declarations("function f0 (x: real) returns (y, w: real) let y = x; w = x; tel", "function f@ (x: real) returns (y, w: real) let y = f#(x).y; w = f#(x).w; tel", &format!("z = f{last}(a).y;"))),
        ("static arguments", declarations("function f0 <<n: int>> (x: real) returns (y: real) let y = x + real(n); tel", "function f@ <<n: int>> (x: real) returns (y: real) let y = f#<<n: 2 * n>>(x) + f#<<n: 2 * n + 1>>(x); tel", &format!("z = f{last}<<n: 0>>(a);"))),
        ("functions as arguments", declarations(&twice, "function f@ (x: real) returns (y: real) let y = twice<<f#>>(x); tel", &applied)),
        ("map", declarations(unary, "function f@ (x: real) returns (y: real) var t: real^2; let t = map<<f#, 2>>(x ^ 2); y = t[0]; tel", &applied)),
        ("fragments", declarations("fragment F0 (x: real) returns (y: real) let y = x -> pre x; tel", "fragment F@ (x: real) returns (y: real) let u = F#(x); v = F#(u.y); y = v.y; tel", &format!("w = F{last}(a); z = w.y;"))),
        ("argument", command(&format!("{PAIR}\n{}z = g(p{last});\n", lines("p@ = (p#, p#);"))) + "function g (x, y: real) returns (s: real) let s = x + y; tel\n"),
        ("tasks", format!("command C () let finish done when true; tel\ntask T0 let C(); tel\n{}", lines("task T@ let T#(); T#(); tel"))),
        ("tasks in parallel", format!("command C () let finish done when true; tel\ntask T0 let C(); tel\n{}", lines("task T@ let parallel let T#(); tel let T#(); tel end tel"))),
    ]);
    programs
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
