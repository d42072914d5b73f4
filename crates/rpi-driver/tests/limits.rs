//! Excessively large programs either compile or are rejected with a diagnostic; nothing overflows or hangs.

use std::fmt::Write;

use rpi_diag::Code;
use rpi_driver::{Input, InputKind, compile};
use rpi_syntax::Dialect;

/// Returns the codes and messages of the diagnostics of a program.
fn found(text: &str) -> Vec<(Code, String)> {
    let input = Input {
        path: "limits.rpi".into(),
        kind: InputKind::Rpi,
        bytes: text.as_bytes().to_vec(),
    };
    let compiled = compile(&input).expect("programs are read");
    let output = compiled.diagnostics.into_iter();
    output
        .map(|diagnostic| (diagnostic.code, diagnostic.message))
        .collect()
}

/// Returns `n` consecutive declarations.
fn row(n: usize, one: impl Fn(usize) -> String) -> String {
    (0..n).fold(String::new(), |mut text, k| {
        let _ = writeln!(text, "{}", one(k));
        text
    })
}

/// Checks that the diagnostics begin with the given code and that there are fewer than 20.
fn is_said(text: &str, code: Code) {
    let found = found(text);
    assert!(
        (1..20).contains(&found.len()),
        "{} diagnostics",
        found.len()
    );
    assert_eq!(found[0].0, code, "{found:?}");
}

#[test]
fn constants_in_reverse_order_cost_no_stack() {
    let few = row(100, |k| format!("const c{k}: int = c{} + 1;", k + 1)) + "const c100 = 1;\n";
    assert_eq!(found(&few), []);
    let many =
        row(20_000, |k| format!("const c{k}: int = c{} + 1;", k + 1)) + "const c20000 = 1;\n";
    is_said(&many, Code::RPI1011);
}

#[test]
fn constants_in_order_may_be_many() {
    let many = row(5_000, |k| format!("const c{}: int = c{k} + 1;", k + 1));
    assert_eq!(found(&format!("const c0 = 1;\n{many}")), []);
}

/// Test threads have small stacks, like the threads of a server.
#[test]
fn expressions_may_nest_as_deeply_as_they_may() {
    let node = |of: &str, y: &str| format!("node N(x: {of}) returns (y: {of})\nlet y = {y}; tel\n");
    let sum = node("real", &format!("x{}", " + x".repeat(4_990)));
    let brackets = node(
        "real",
        &format!("{}x{}", "(".repeat(2_490), " + 1.0)".repeat(2_490)),
    );
    let choice = (0..1_660).fold(String::new(), |text, k| {
        format!("{text}if x = {k} then {k} else ")
    });
    let delays = format!("{}x{}", "0 -> pre (".repeat(1_660), ")".repeat(1_660));
    for text in [
        sum,
        brackets,
        node("int", &format!("{choice} x")),
        node("int", &delays),
    ] {
        assert_eq!(found(&text), []);
        let formatted = rpi_syntax::format(&text, Dialect::Rpi).expect("it has no faults");
        assert_eq!(found(&formatted), []);
        let size = formatted.len();
        assert!(size < 100 * text.len(), "{size} bytes");
    }
    is_said(
        &node("real", &format!("x{}", " + x".repeat(5_010))),
        Code::RPI0011,
    );
}

#[test]
fn types_in_reverse_order_cost_no_stack() {
    let aliases = row(50_000, |k| format!("type T{k} = T{};", k + 1)) + "type T50000 = int;\n";
    is_said(&aliases, Code::RPI1011);
}

#[test]
fn faults_without_end_are_told_to_a_limit() {
    let found = found(&"node ".repeat(100_000));
    assert!(found.len() < 10_100, "{} diagnostics", found.len());
    assert!(found.iter().any(|(code, _)| *code == Code::RPI0011));
}

#[test]
fn a_merge_may_have_as_many_cases_as_an_enum_has_values() {
    let list = |join: &str, one: &dyn Fn(usize) -> String| {
        let all: Vec<String> = (0..20_000).map(one).collect();
        all.join(join)
    };
    let values = list(", ", &|k| format!("V{k}"));
    let cases = list(" ", &|k| format!("(V{k} -> x when V{k}(e))"));
    let text = format!(
        "type E = enum {{ {values} }};\nnode N (e: E; x: int) returns (y: int)\nlet\n  y = merge e {cases};\ntel\n"
    );
    assert_eq!(found(&text), []);
}

#[test]
fn delays_without_first_values_are_looked_for_to_a_limit() {
    let n = 150;
    let all =
        |one: &dyn Fn(usize) -> String, join: &str| (0..n).map(one).collect::<Vec<_>>().join(join);
    let names = all(&|k| format!("x{k}"), ", ");
    let sum = all(&|k| format!("last x{k}"), " + ");
    let equations = row(n, |k| format!("  x{k} = a + {sum};"));
    let text = format!(
        "node N (a: real) returns (y: real)\nvar {names}: real;\nlet\n{equations}  y = x0;\ntel\n"
    );
    assert!(found(&text).iter().any(|(code, _)| *code == Code::RPI5001));
}

#[test]
fn structs_do_not_nest_without_end() {
    let reverse = row(50_000, |k| {
        format!("type T{k} = struct {{ a: T{} }};", k + 1)
    });
    is_said(&(reverse + "type T50000 = int;\n"), Code::RPI1011);
    let ordered = row(2_000, |k| {
        format!("type T{} = struct {{ a: T{k} }};", k + 1)
    });
    is_said(&format!("type T0 = int;\n{ordered}"), Code::RPI2009);
    let doubled = row(60, |k| {
        format!("type T{} = struct {{ a: T{k}; b: T{k} }};", k + 1)
    });
    is_said(&format!("type T0 = int;\n{doubled}"), Code::RPI2009);
}

#[test]
fn calls_that_double_are_counted_although_all_folds() {
    let functions = row(30, |k| {
        let next = k + 1;
        format!("function f{k} (x: int) returns (y: int) let y = f{next}(x) + f{next}(x); tel")
    });
    let last = "function f30 (x: int) returns (y: int) let y = x; tel\nconst c: int = f0(1);\n";
    is_said(&(functions + last), Code::RPI2010);
}

#[test]
fn calls_in_a_long_row_are_too_deep_and_not_endless() {
    let nodes = row(500, |k| {
        let next = k + 1;
        format!("node f{k} (x: int) returns (y: int) let y = f{next}(x); tel")
    });
    let text = nodes
        + "node f500 (x: int) returns (y: int) let y = x; tel\n\
           command C () let y = f0(1); export y; finish done when true; tel\n";
    let found = found(&text);
    let deep = "calls are nested more than 400 deep";
    assert!(
        found.iter().any(|(_, message)| message == deep),
        "{found:?}"
    );
}

#[test]
fn static_parameters_may_be_many() {
    let params = row(2_000, |k| format!("; p{}: int = p{k} + 1", k + 1));
    let node =
        format!("node f <<p0: int = 1{params}>> (x: int) returns (y: int) let y = x + p2000; tel");
    assert_eq!(found(&node), []);
}

#[test]
fn default_values_in_a_long_row_cost_no_stack() {
    let nodes = row(20_000, |k| {
        let next = k + 1;
        format!("node n{k} (x: int = n{next}()) returns (y: int) let y = x; tel")
    });
    let last = "node n20000 (x: int = 1) returns (y: int) let y = x; tel\n";
    is_said(&(nodes + last), Code::RPI1011);
}

#[test]
fn contracts_in_a_long_row_cost_no_stack() {
    let contracts = row(20_000, |k| {
        let next = k + 1;
        format!("contract c{k} (x: int) returns (y: int); let import c{next}(x) returns (y); tel")
    });
    let last = "contract c20000 (x: int) returns (y: int); let tel\n";
    is_said(&(contracts + last), Code::RPI1011);
}

#[test]
fn names_for_names_may_be_some_and_not_many() {
    let names = |n: usize| {
        row(n, |k| format!("node n{k} = n{};", k + 1))
            + &format!("node n{n} (x: int) returns (y: int) let y = x; tel\n")
    };
    assert_eq!(found(&names(50)), []);
    is_said(&names(4_000), Code::RPI1011);
}

const COMMAND: &str = "command C (n: int) let finish d when time > real(n) * 1[s]; tel\n";

/// A task is inlined wherever another one calls it.
#[test]
fn tasks_that_double_are_not_written_out_without_end() {
    let inner = row(40, |k| {
        format!(
            "task T{k} (n: int) let T{0}(2 * n); T{0}(2 * n + 1); tel",
            k + 1
        )
    });
    let ends = "task T40 (n: int) let C(n); tel\ntask Whole let T0(1); tel\n";
    is_said(&format!("{COMMAND}{inner}{ends}"), Code::RPI1011);
}

#[test]
fn tasks_in_a_long_row_are_too_deep_and_not_endless() {
    let inner = row(4_000, |k| format!("task T{k} let T{}(); tel", k + 1));
    let last = "task T4000 let C(1); tel\n";
    is_said(&format!("{COMMAND}{inner}{last}"), Code::RPI1011);
}

#[test]
fn a_command_may_have_many_results() {
    let results = row(3_000, |k| format!("  finish r{k} when n = {k};"));
    let text = format!("command C ()\nlet\n  n = 0 -> pre n + 1;\n{results}tel\n");
    assert_eq!(found(&text), []);
}
