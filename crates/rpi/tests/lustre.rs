//! Programs with tables: `tests/lustre/NAME.lus` and `tests/nodes/NAME.rpi` give `NAME.out.csv` from `NAME.in.csv`.

mod support;

use std::path::Path;

use rpi_image::Scalar;
use rpi_testkit::files_below;
use support::rpi;

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[test]
fn every_program_gives_the_table_beside_it() {
    let mut programs = files_below("tests/lustre", &[".lus"]);
    programs.extend(files_below("tests/nodes", &[".rpi"]));
    assert!(programs.len() > 1, "there are no programs");
    let mut wrong = Vec::new();
    for program in programs {
        let (inputs, outputs) = (with(&program, "in.csv"), with(&program, "out.csv"));
        let output = rpi(&["run", &program.display().to_string(), "--inputs", &inputs]);
        let wanted = std::fs::read_to_string(&outputs).expect("a table stands beside it");
        if text(&output.stdout) != wanted || output.status.code() != Some(0) {
            let (out, err) = (text(&output.stdout), text(&output.stderr));
            wrong.push(format!("{}\n{out}{err}", program.display()));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

fn with(program: &Path, extension: &str) -> String {
    program.with_extension(extension).display().to_string()
}

/// Runs a program on a table. Returns standard output, standard error and exit status.
fn run(program: &str, table: &str, more: &[&str]) -> (String, String, Option<i32>) {
    run_as("a.lus", program, table, more)
}

fn run_as(name: &str, program: &str, table: &str, more: &[&str]) -> (String, String, Option<i32>) {
    let folder = tempfile::tempdir().expect("a folder");
    let (path, inputs) = (folder.path().join(name), folder.path().join("a.csv"));
    std::fs::write(&path, program).expect("it is written");
    std::fs::write(&inputs, table).expect("it is written");
    let (path, inputs) = (path.display().to_string(), inputs.display().to_string());
    let output = rpi(&[&["run", &path, "--inputs", &inputs], more].concat());
    (
        text(&output.stdout),
        text(&output.stderr),
        output.status.code(),
    )
}

/// Rule M2.2.
#[test]
fn a_fault_ends_the_run_and_is_told_with_code_cycle_and_place() {
    let program = "node a (x, y: int) returns (z: int); let z = x * y; tel\n";
    let (out, err, status) = run(program, "x,y\n2,3\n9223372036854775807,2\n1,1\n", &[]);
    assert_eq!((out.as_str(), status), ("z\n6\n", Some(3)), "{err}");
    assert!(err.contains("RPI9011") && err.contains("cycle 1"), "{err}");
    assert!(err.contains("a.lus:1:46"), "{err}");
}

/// Rule M6.6: the same for a variable and for a constant condition.
#[test]
fn state_in_a_branch_that_is_never_chosen_faults_like_any() {
    let callee = "node Power (x: int) returns (p: int) let p = x -> pre p * x; tel\n";
    for condition in ["c", "false"] {
        let caller = "node main (x: int; c: bool) returns (y: int) let";
        let program = format!("{callee}{caller} y = if {condition} then Power(x) else 1; tel\n");
        let table = "x,c\n4611686018427387904,false\n4611686018427387904,false\n";
        let (out, err, status) = run_as("a.rpi", &program, table, &["--node", "main"]);
        assert_eq!((out.as_str(), status), ("y\n1\n", Some(3)), "{err}");
        assert!(
            err.contains("RPI9011") && err.contains("a.rpi:1:51"),
            "{err}"
        );
    }
}

#[test]
fn a_claim_that_does_not_hold_is_told_and_the_run_goes_on() {
    let program = "node a (x: int) returns (y: int); let assert x > 0; y = x; tel\n";
    let (out, err, status) = run(program, "x\n1\n0\n2\n", &[]);
    assert_eq!((out.as_str(), status), ("y\n1\n0\n2\n", Some(0)), "{err}");
    assert!(err.contains("RPI9012") && err.contains("cycle 1"), "{err}");
}

#[test]
fn local_flows_and_numbers_of_enums_are_shown_if_asked_for() {
    let program = "type m = enum { A, B };\nnode a (x: bool) returns (y: m); var n: bool;
let n = not x; y = if n then A else B; tel\n";
    let (out, err, status) = run(program, "x\ntrue\n", &["--locals", "--numbers"]);
    assert_eq!((out.as_str(), status), ("y,n\n1,false\n", Some(0)), "{err}");
}

#[test]
fn flows_of_a_state_are_absent_while_it_is_not_active() {
    let program = "node a (x: bool) returns (y: int)\nlet automaton\n\
        initial state Off let y = 0; k = 7; tel until x then On;\n\
        state On let y = 1; tel until not x then Off;\nend tel\n";
    let table = "x\ntrue\ntrue\nfalse\nfalse\n";
    let (out, err, status) = run_as("a.rpi", program, table, &["--locals"]);
    let rows = "y,k,Off.y,Off.k,On.y\n0,7,0,7,\n1,,,,1\n1,,,,1\n0,7,0,7,\n";
    assert_eq!((out.as_str(), status), (rows, Some(0)), "{err}");
}

#[test]
fn bad_tables_are_told_with_their_line() {
    let program = "node a (x: int) returns (y: int); let y = x; tel\n";
    let (_, err, status) = run(program, "x\n1\ntrue\n", &[]);
    assert_eq!(status, Some(2), "{err}");
    assert!(
        err.contains("a.csv:3: x: `true` is not an integer"),
        "{err}"
    );
    let (_, err, status) = run(program, "y\n1\n", &[]);
    assert_eq!(status, Some(2), "{err}");
    assert!(err.contains("no column is called `x`"), "{err}");
}

/// One millisecond in nanoseconds.
const PERIOD: u64 = 1_000_000;

/// Returns a flow name as in an emitted program: `x[2].f` becomes `x_2_f`.
fn plain(name: &str) -> String {
    name.replace(']', "").replace(['[', '.'], "_")
}

/// Returns a program emitted by `--emit lustre`, and its table of inputs with plain names and with numbers for enum
/// values.
fn emitted(program: &Path, table: &str) -> (String, String) {
    let input = rpi_driver::read(program).expect("it is read");
    let compiled = rpi_driver::compile_node(&input, None, rpi_driver::ClaimPolicy::Fault, false);
    let node = compiled
        .expect("it is a program")
        .node
        .expect("it is right");
    let boundary = rpi_net::lustre::NodeInterface {
        inputs: &node.inputs,
        outputs: &node.outputs,
    };
    let (text, left_open) = rpi_driver::emit::lustre(&node.net, &boundary, PERIOD);
    assert!(left_open.is_empty(), "{}: {left_open:?}", program.display());
    let number = |cell: &str| {
        let mut values = node
            .inputs
            .iter()
            .flat_map(|column| column.enum_values.iter().zip(0..));
        let found = values.find(|(value, _)| *value == cell);
        found.map_or(cell.to_owned(), |(_, k): (_, i32)| k.to_string())
    };
    let mut lines = table.lines();
    let head = lines.next().unwrap_or_default().split(',');
    let optional: Vec<Option<Scalar>> = head
        .clone()
        .map(|name| type_if_optional(&node, name))
        .collect();
    let names = head
        .zip(&optional)
        .flat_map(|(name, optional)| match optional {
            Some(_) => vec![plain(name), format!("{}_is", plain(name))],
            None => vec![plain(name)],
        });
    let names: Vec<String> = names.collect();
    let cells = |(cell, optional): (&str, &Option<Scalar>)| match (cell, optional) {
        ("", Some(Scalar::Bool)) => "false,false".to_owned(),
        ("", Some(_)) => "0,false".to_owned(),
        (cell, Some(_)) => format!("{},true", number(cell)),
        (cell, None) => number(cell),
    };
    let rows = lines.map(|line| {
        line.split(',')
            .zip(&optional)
            .map(cells)
            .collect::<Vec<_>>()
    });
    let rows = rows.map(|row| row.join(","));
    let rows: Vec<String> = std::iter::once(names.join(",")).chain(rows).collect();
    (text, rows.join("\n") + "\n")
}

/// Returns the type of an optional in-port. In Lustre, a Boolean in-port beside it says whether it is present.
fn type_if_optional(node: &rpi_driver::Node, name: &str) -> Option<Scalar> {
    let mut columns = node.inputs.iter();
    let column = columns.find(|column| column.key == name)?;
    column.optional.then_some(column.scalar)
}

/// Returns the columns of a table by plain name.
fn columns(table: &str) -> Vec<(String, Vec<String>)> {
    let rows: Vec<Vec<&str>> = table
        .lines()
        .map(|line| line.split(',').collect())
        .collect();
    let Some((head, rows)) = rows.split_first() else {
        return Vec::new();
    };
    let column = |(k, name): (usize, &&str)| {
        let cells = rows
            .iter()
            .map(|row| row.get(k).copied().unwrap_or_default().to_owned());
        (plain(name), cells.collect())
    };
    head.iter().enumerate().map(column).collect()
}

/// Programs that cannot be compared: machine integers have no primitives in Lustre V6, and values that a program leaves
/// open become in-ports, for which the tables have no columns.
const NOT_EMITTED: &[&str] = &["machine_integers.lus", "open_values.lus"];

#[test]
fn what_is_emitted_as_lustre_gives_the_same_bits() {
    let mut wrong = Vec::new();
    let mut programs = files_below("tests/lustre", &[".lus"]);
    programs.extend(files_below("tests/nodes", &[".rpi"]));
    programs.retain(|path| !NOT_EMITTED.iter().any(|name| path.ends_with(name)));
    for program in programs {
        let inputs = with(&program, "in.csv");
        let path = program.display().to_string();
        let wanted = rpi(&["run", &path, "--inputs", &inputs, "--numbers"]);
        let table = std::fs::read_to_string(&inputs).expect("a table stands beside it");
        let (text, table) = emitted(&program, &table);
        let (found, err, status) = run(&text, &table, &[]);
        let found = columns(&found);
        for (name, cells) in columns(&self::text(&wanted.stdout)) {
            let other = found
                .iter()
                // `last` is a keyword of Kind 2, so a flow of this name gets a number.
                .find(|column| column.0 == name || column.0 == format!("{name}_2"))
                .map(|column| &column.1);
            let is_same = |(a, b): (&String, &String)| a.is_empty() || a == b;
            let same = other.is_some_and(|other| {
                cells.len() == other.len() && cells.iter().zip(other).all(is_same)
            });
            let reads_all = !err.contains("RPI3101");
            if !same || !reads_all || status != Some(0) {
                wrong.push(format!("{path}: {name}: {cells:?}, {other:?}\n{text}{err}"));
                break;
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Emits a command by `--emit lustre`. Returns the text and the diagnostics about open inputs.
fn command(text: &str) -> (String, Vec<rpi_diag::Diagnostic>) {
    let compiled = rpi_driver::compile_with(&source(text), rpi_driver::ClaimPolicy::Fault);
    let compiled = compiled.expect("a program is text");
    let [net] = compiled.nets() else {
        panic!("{:?}", compiled.diagnostics)
    };
    let boundary = rpi_net::lustre::NodeInterface::default();
    rpi_driver::emit::lustre(net, &boundary, PERIOD)
}

fn source(text: &str) -> rpi_driver::Input {
    rpi_driver::Input {
        path: "page.rpi".into(),
        kind: rpi_driver::InputKind::Rpi,
        bytes: text.as_bytes().to_vec(),
    }
}

#[test]
fn what_has_no_form_in_lustre_is_told() {
    let page = rpi_diag::Code::RPI9103.page();
    for (fence, expected) in [
        ("```rpi-wrong emit-lustre", 1),
        ("```rpi-right emit-lustre", 0),
    ] {
        let text = page.split(fence).nth(1);
        let text = text.and_then(|rest| rest.split("```").next());
        let (text, diagnostics) = command(text.expect("the page has both"));
        assert_eq!(diagnostics.len(), expected, "{diagnostics:?}");
        assert!(text.contains("done: bool"), "{text}");
    }
}

#[test]
fn of_the_results_of_a_command_only_the_chosen_one_is_true() {
    let (text, open) = command(
        "command Watch () let n = 0 -> pre n + 1;
finish big when n >= 1 and time < 1.0[s]; finish other when n >= 1 or time > 5.0[s] + dt;
fail bad when n >= 3 and dt < 0.5[s]; yield on when n >= 1; tel",
    );
    // All reads of `time` share one input in ticks, and `dt` is known.
    assert_eq!(open.len(), 2, "{open:?}\n{text}");
    let table = "elapsed,takeover\n0,true\n0,true\n2000,true\n2000,true\n";
    let (out, err, status) = run(&text, table, &[]);
    let wanted = "big,other,bad,on\nfalse,false,false,false\ntrue,false,false,false\n\
        false,true,false,false\nfalse,false,true,false\n";
    assert_eq!((out.as_str(), status), (wanted, Some(0)), "{text}{err}");
}

#[test]
fn what_holds_by_the_writers_word_is_not_to_be_proved() {
    let (text, _) = command(
        "node Half (x: int) returns (y: int) con assume x > -5; guarantee y < 7; noc let y = x div 2; tel
command Watch () let n = 0 -> pre n + 1; assert n < 100; y = Half(n); finish done when y > 9; tel",
    );
    let lines = |start: &str| text.lines().filter(|line| line.starts_with(start)).count();
    assert_eq!(
        (lines("  assert "), lines("  --%PROPERTY ")),
        (1, 2),
        "{text}"
    );
    let program = "node a (x: int) returns (y: int) con assume x > 0; guarantee y > 1; noc let y = x + 1; tel";
    let (path, folder) = ("a.rpi", tempfile::tempdir().expect("a folder"));
    let path = folder.path().join(path);
    std::fs::write(&path, program).expect("it is written");
    let (text, _) = emitted(&path, "x\n1\n");
    let assumed = text.lines().filter(|line| line.starts_with("  assert "));
    assert_eq!(assumed.count(), 1, "{text}");
    assert_eq!(text.matches("--%PROPERTY").count(), 1, "{text}");
}

#[test]
fn a_table_is_not_replaced_while_it_is_read_and_ends_where_told() {
    let dir = tempfile::tempdir().expect("a folder");
    let put = |name: &str, text: &str| {
        let path = dir.path().join(name);
        std::fs::write(&path, text).expect("it is written");
        path.display().to_string()
    };
    let node = put("n.lus", "node n(x: int) returns (y: int); let y = x; tel");
    let table = put("t.csv", "x\n1\n2\n3\n");
    let run = ["run", &node, "--inputs", &table];
    let refused = rpi(&[&run[..], &["--outputs", &table]].concat());
    assert_eq!(refused.status.code(), Some(2));
    assert_eq!(
        std::fs::read_to_string(&table).expect("it is there"),
        "x\n1\n2\n3\n"
    );
    let two = rpi(&[&run[..], &["--cycles", "2"]].concat());
    assert_eq!(text(&two.stdout), "y\n1\n2\n");
    let json = rpi(&[&run[..], &["--json"]].concat());
    assert_eq!(json.status.code(), Some(2));
    assert!(text(&json.stderr).contains("--json applies to commands"));
}
