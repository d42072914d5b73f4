//! The command-line tool: arguments in, text and exit status out.

mod support;

use std::path::Path;
use std::process::{Command, Output};

use support::rpi;

const NET: &str = "{a=Core::Clock(Increment='1'),b=Core::DoubleAdd(inFirst=a.outValue,Second='1')}";
const TRACE: &str = "0\t#t0\t0\tcycle=1\n1\ta.outValue\t0.025\n1\tb.outValue\t1.025\n\
    2\ta.outValue\t0.05\n2\tb.outValue\t1.05\n";

/// Creates a folder with the net and the trace above.
fn folder() -> tempfile::TempDir {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("small.rpinet"), NET).unwrap();
    std::fs::write(dir.path().join("small.trace"), TRACE).unwrap();
    dir
}

fn path(dir: &tempfile::TempDir, name: &str) -> String {
    dir.path().join(name).display().to_string()
}

fn out(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

fn err(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn a_replay_that_agrees_ends_with_0() {
    let dir = folder();
    let output = rpi(&[
        "replay",
        &path(&dir, "small.rpinet"),
        "--trace",
        &path(&dir, "small.trace"),
    ]);
    assert_eq!(output.status.code(), Some(0), "{}", err(&output));
    assert!(out(&output).contains("4 values"), "{}", out(&output));
}

#[test]
fn a_replay_that_differs_ends_with_1_and_says_where() {
    let dir = folder();
    let wrong = TRACE.replace("1.05\n", "1.06\n");
    std::fs::write(dir.path().join("wrong.trace"), wrong).unwrap();
    let args = [
        "replay",
        &path(&dir, "small.rpinet"),
        "--trace",
        &path(&dir, "wrong.trace"),
    ];
    let output = rpi(&args);
    assert_eq!(output.status.code(), Some(1));
    assert!(
        out(&output).contains("first divergence, in cycle 2"),
        "{}",
        out(&output)
    );
    let json = out(&rpi(&[&args[..], &["--json"]].concat()));
    assert!(json.contains("\"differing\": 1"), "{json}");
    let wide = rpi(&[&args[..], &["--tolerance", "0.1"]].concat());
    assert_eq!(wide.status.code(), Some(0));
}

#[test]
fn what_needs_no_device_needs_no_cell() {
    let dir = folder();
    let file = path(&dir, "alone.rpi");
    let text = "command Alone () let finish done when true; tel\n";
    std::fs::write(&file, text).unwrap();
    let output = rpi(&["run", &file]);
    assert_eq!(output.status.code(), Some(0), "{}", err(&output));
    let output = rpi(&["run", &file, "--command", "Alne"]);
    assert!(err(&output).contains("Alone"), "{}", err(&output));
}

/// Rule M8.3.
#[test]
fn a_missing_device_is_told_once_with_those_that_are_there() {
    let dir = folder();
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/first");
    let described = std::fs::read_to_string(examples.join("cell.toml")).unwrap();
    let cell = path(&dir, "other.toml");
    std::fs::write(&cell, described.replace("[devices.arm]", "[devices.lwr]")).unwrap();
    let program = examples.join("first.rpi").display().to_string();
    let stderr = err(&rpi(&["run", &program, "--cell", &cell]));
    assert_eq!(stderr.matches("no device `arm`").count(), 1, "{stderr}");
    assert!(stderr.contains("the cell has lwr"), "{stderr}");
}

#[test]
fn options_that_mean_nothing_are_refused() {
    let (dir, trace) = (folder(), "small.trace");
    let net = path(&dir, "small.rpinet");
    for tolerance in ["nan", "inf", "-1", "x"] {
        let flag = format!("--tolerance={tolerance}");
        let output = rpi(&["replay", &net, "--trace", &path(&dir, trace), &flag]);
        assert_eq!(output.status.code(), Some(2), "{tolerance}");
    }
    assert_eq!(rpi(&["run", &net, "--cycles", "0"]).status.code(), Some(2));
    let both = rpi(&["run", &net, "--record", "both.csv", "--plot", "both.csv"]);
    assert!(err(&both).contains("different files"), "{}", err(&both));
}

#[test]
fn what_is_no_text_is_named() {
    let dir = folder();
    let net = path(&dir, "small.rpinet");
    let binary = path(&dir, "binary.trace");
    std::fs::write(&binary, [0xff, 0xfe, b'a', 0]).unwrap();
    let trace = err(&rpi(&["replay", &net, "--trace", &binary]));
    assert!(
        trace.contains("binary.trace") && trace.contains("not a text"),
        "{trace}"
    );
    let cell = err(&rpi(&["run", &net, "--cell", &binary]));
    assert!(
        cell.contains("binary.trace") && cell.contains("UTF-16"),
        "{cell}"
    );
}

/// Rule M1.1.
#[test]
fn the_period_matters() {
    let dir = folder();
    let args = [
        "replay",
        &path(&dir, "small.rpinet"),
        "--trace",
        &path(&dir, "small.trace"),
        "--period",
        "1ms",
    ];
    assert_eq!(rpi(&args).status.code(), Some(1));
}

#[test]
fn bad_input_ends_with_2_and_a_way_out() {
    let dir = folder();
    let trace = path(&dir, "small.trace");
    let output = rpi(&["replay", &path(&dir, "smal.rpinet"), "--trace", &trace]);
    assert_eq!(output.status.code(), Some(2));
    assert!(err(&output).contains("small.rpinet"), "{}", err(&output));
    std::fs::write(dir.path().join("bad.trace"), "1 a b").unwrap();
    let output = rpi(&[
        "replay",
        &path(&dir, "small.rpinet"),
        "--trace",
        &path(&dir, "bad.trace"),
    ]);
    assert_eq!(output.status.code(), Some(2));
    assert!(err(&output).contains("bad.trace:1"), "{}", err(&output));
    std::fs::write(dir.path().join("bad.rpinet"), "{a=Core::Clok()}").unwrap();
    let output = rpi(&["replay", &path(&dir, "bad.rpinet"), "--trace", &trace]);
    assert_eq!(output.status.code(), Some(2));
    assert!(err(&output).contains("Core::Clock"), "{}", err(&output));
    assert_eq!(rpi(&["replay"]).status.code(), Some(2));
}

#[test]
fn completions_and_manual_pages_are_made() {
    let bash = rpi(&["completions", "bash"]);
    assert!(out(&bash).contains("replay"));
    let dir = folder();
    let pages = path(&dir, "man");
    assert_eq!(rpi(&["man", &pages]).status.code(), Some(0));
    assert!(Path::new(&pages).join("rpi-replay.1").is_file());
}

#[test]
fn a_bad_period_is_told() {
    let output = rpi(&["replay", "x.rpinet", "--trace", "y", "--period", "5"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(err(&output).contains("units"), "{}", err(&output));
}

#[test]
fn a_reader_that_closes_the_pipe_early_is_no_fault() {
    let dir = folder();
    let mut child = Command::new(env!("CARGO_BIN_EXE_rpi"))
        .args(["replay", &path(&dir, "small.rpinet"), "--trace"])
        .arg(path(&dir, "small.trace"))
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", err(&output));
    assert_eq!(err(&output), "");
}

fn refuses_its_input(args: &[&str]) {
    let output = rpi(args);
    let stderr = err(&output);
    assert_eq!(output.status.code(), Some(2), "{stderr}");
    assert!(stderr.contains("overwrite the input"), "{stderr}");
}

#[test]
fn results_never_replace_the_program() {
    let dir = folder();
    let net = path(&dir, "small.rpinet");
    for option in ["--record", "--plot"] {
        refuses_its_input(&["run", &net, option, &net]);
        assert_eq!(std::fs::read_to_string(&net).unwrap(), NET);
    }
}

#[test]
fn results_never_replace_the_cell_or_the_text_of_a_node() {
    let dir = folder();
    let (program, cell) = (path(&dir, "wait.rpi"), path(&dir, "cell.toml"));
    let text = "command Wait () let finish done when time > 2[ms]; tel\nnode n (x: int) returns (y: int) let y = x; tel\n";
    std::fs::write(&program, text).unwrap();
    std::fs::write(&cell, "name = \"c\"\n").unwrap();
    let of_node = ["--node", "n", "--random", "1", "--cycles", "2", "--outputs"];
    let of_node = [&["run", &program][..], &of_node, &[&program]].concat();
    let plot = ["run", &program, "--plot", &cell];
    let record = ["run", &program, "--record", &cell];
    for args in [&of_node[..], &plot, &record] {
        refuses_its_input(args);
    }
    assert_eq!(std::fs::read_to_string(&program).unwrap(), text);
    assert_eq!(std::fs::read_to_string(&cell).unwrap(), "name = \"c\"\n");
}

#[test]
fn a_file_that_cannot_be_written_is_named() {
    let dir = folder();
    let target = path(&dir, "nowhere/rows.csv");
    let output = rpi(&["run", &path(&dir, "small.rpinet"), "--record", &target]);
    assert_eq!(output.status.code(), Some(2), "{}", err(&output));
    assert!(err(&output).contains(&target), "{}", err(&output));
}

/// A takeover with a jump is refused with the figures. If it is allowed, the arm decides.
#[test]
fn a_leap_at_a_switch_is_refused_with_its_figures() {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let program = here.join("tests/programs/jump.rpi").display().to_string();
    let cell = here.join("../../examples/blending/cell.toml");
    let cell = cell.display().to_string();
    let leap = "velocity of arm[0] would be 500.0000/s where 1.9635/s is the limit";
    let refused = rpi(&["run", &program, "--cell", &cell]);
    assert_eq!(refused.status.code(), Some(3));
    assert!(out(&refused).contains(leap), "{}", out(&refused));
    let allowed = rpi(&["run", &program, "--cell", &cell, "--on-jump", "allow"]);
    let lost = "the device refuses its set-point";
    assert!(out(&allowed).contains(leap), "{}", out(&allowed));
    assert!(out(&allowed).contains(lost), "{}", out(&allowed));
}

/// A run in real time reports which of the requested settings the system granted.
#[test]
fn real_time_tells_what_it_got() {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let program = here
        .join("../../examples/first/first.rpi")
        .display()
        .to_string();
    let output = rpi(&["run", &program, "--real-time", "--cycles", "20"]);
    for wish in ["memory locked", "priority 80 of SCHED_FIFO"] {
        assert!(out(&output).contains(wish), "{}", out(&output));
    }
    let wrong = rpi(&["run", &program, "--real-time", "--on-overrun", "stop:5/3"]);
    assert_eq!(wrong.status.code(), Some(2));
    assert!(err(&wrong).contains("stop:N/M"), "{}", err(&wrong));
}

/// Commands of another module, computed arguments, and tasks with parameters.
#[test]
fn a_task_runs_commands_of_another_module() {
    let dir = tempfile::tempdir().unwrap();
    let library = "--| Waits so many milliseconds.\ncommand Wait (n: int; more: int = 1)\nlet finish over when time >= (real (n + more)) * 1[ms]; tel\n";
    let cell = "use waits;\nconst five: int = 5;\n\
        task Inner (n: int)\nlet repeat n times let Wait(n * 10); tel tel\n\
        task Main ()\nlet Inner(2); Inner(n: 1); Wait(five, more: five); tel\n";
    std::fs::write(dir.path().join("waits.rpi"), library).unwrap();
    std::fs::write(dir.path().join("cell.rpi"), cell).unwrap();
    let output = rpi(&["run", &path(&dir, "cell.rpi"), "--command", "Main"]);
    let rows = out(&output);
    let rows: Vec<Vec<&str>> = rows
        .lines()
        .filter(|line| line.contains("finished"))
        .map(|line| line.split("finished with over; ").collect())
        .map(|parts: Vec<&str>| vec![parts[0].trim(), parts[1].split(" from").next().unwrap()])
        .collect();
    let expected = [
        ["waits.Wait(n * 10)", "22 cycles"],
        ["waits.Wait(n * 10)", "22 cycles"],
        ["waits.Wait(n * 10) #2", "12 cycles"],
        ["waits.Wait(five, five)", "11 cycles"],
    ];
    assert_eq!(rows, expected, "{}", err(&output));
}

/// A command, and a task that runs two of it in parallel.
const WAIT: &str = "command Wait () let x = cos(real(n)); n = 1 -> pre n + 1; finish done when n >= 3; fail odd when x > 2.0; tel
task Both () let parallel let Wait(); tel let Wait(); tel tel
";

/// The bound applies to a single command and to all parallel ones together; on simulated time there is none.
#[test]
fn what_may_take_too_long_is_refused_on_real_time() {
    let dir = tempfile::tempdir().unwrap();
    let file = path(&dir, "wait.rpi");
    std::fs::write(&file, WAIT).unwrap();
    let run = |command: &str, args: &[&str]| {
        rpi(&[&["run", file.as_str(), "--command", command], args].concat())
    };
    let refused = run("Wait", &["--real-time", "--period", "20ns"]);
    assert_eq!(refused.status.code(), Some(2));
    let stderr = err(&refused);
    assert!(stderr.contains("RPI7003: Wait may take"), "{stderr}");
    for way_out in ["--cycle-share", "--machine", "--period", "RPI7003"] {
        assert!(stderr.contains(way_out), "{stderr}");
    }
    // One command fits such a tick, two do not.
    let figures = stderr.split("may take ").nth(1).unwrap();
    let ns: f64 = figures.split(' ').next().unwrap().parse().unwrap();
    let tick = format!("{:.0}ns", ns * 2.0);
    assert!(!err(&run("Wait", &["--real-time", "--period", &tick])).contains("RPI7003"));
    let both = run("Both", &["--real-time", "--period", &tick]);
    assert!(err(&both).contains("parallel commands"), "{}", err(&both));
    for args in [
        &["--period", "20ns"][..],
        &["--real-time", "--period", "20ns", "--cycle-share", "off"],
    ] {
        let done = run("Wait", args);
        assert_eq!(done.status.code(), Some(0), "{}", err(&done));
    }
    let idle = run("Wait", &["--cycle-share", "50"]);
    assert!(err(&idle).contains("require --real-time"), "{}", err(&idle));
}

#[test]
fn the_machine_beside_the_program_tells_how_fast_it_is() {
    let dir = tempfile::tempdir().unwrap();
    let file = path(&dir, "wait.rpi");
    std::fs::write(&file, WAIT).unwrap();
    std::fs::write(path(&dir, "machine.toml"), "ns-per-operation = 1000000\n").unwrap();
    let refused = rpi(&["run", &file, "--command", "Wait", "--real-time"]);
    assert!(err(&refused).contains("RPI7003"), "{}", err(&refused));
    // The warning depends on the actual period.
    let slow = ["run", &file, "--command", "Wait", "--period", "10s"];
    assert_eq!(err(&rpi(&slow)), "");
}

/// A test is a node that is never called, but not a candidate for the node to run.
#[test]
fn a_node_is_chosen_and_no_test_or_command() {
    let dir = tempfile::tempdir().unwrap();
    let file = path(&dir, "program.rpi");
    let node = "node Twice (x: int) returns (y: int) let y = 2 * x; tel\n";
    let test =
        "test \"it is twice\" let t = Twice(x: 2); assert t = 4; finish done when true; tel\n";
    std::fs::write(&file, format!("{node}{test}{WAIT}")).unwrap();
    let inputs = path(&dir, "in.csv");
    std::fs::write(&inputs, "x\n3\n").unwrap();
    let ran = rpi(&["run", &file, "--inputs", &inputs]);
    assert_eq!(out(&ran), "y\n6\n", "{}", err(&ran));
    std::fs::write(&file, WAIT).unwrap();
    let none = rpi(&["run", &file, "--inputs", &inputs]);
    assert!(
        err(&none).contains("its commands run without"),
        "{}",
        err(&none)
    );
}

#[cfg(target_os = "linux")]
#[test]
fn a_picture_on_a_full_disk_is_named_after_what_happened() {
    let dir = tempfile::tempdir().unwrap();
    let file = path(&dir, "wait.rpi");
    std::fs::write(&file, WAIT).unwrap();
    let ran = rpi(&["run", &file, "--command", "Wait", "--plot", "/dev/full"]);
    assert!(out(&ran).contains("finished with done"), "{}", out(&ran));
    assert!(
        err(&ran).contains("/dev/full: No space left"),
        "{}",
        err(&ran)
    );
    assert_eq!(ran.status.code(), Some(2));
}

#[test]
fn a_command_that_lacks_a_constant_is_told_which() {
    let dir = tempfile::tempdir().unwrap();
    let go = "command Go (to: real[m]; n: int) let finish done when time > 1[s] or to > 1[m] or n > 1; tel\n";
    let other = "command Other () let finish done when time > 1[s]; tel\n";
    for (text, args) in [
        (format!("{go}{other}"), &["--command", "Go"][..]),
        (go.to_owned(), &[]),
    ] {
        std::fs::write(dir.path().join("go.rpi"), text).unwrap();
        let output = rpi(&[&["run", &path(&dir, "go.rpi")], args].concat());
        assert_eq!(output.status.code(), Some(2), "{}", err(&output));
        let stderr = err(&output);
        assert!(stderr.contains("Go cannot run alone"), "{stderr}");
        assert!(
            stderr.contains("`to: real[m]`") && stderr.contains("`n: int`"),
            "{stderr}"
        );
        assert!(stderr.contains("const to: real[m] = ...;"), "{stderr}");
        assert!(!stderr.contains("has no command"), "{stderr}");
    }
}

#[test]
fn the_template_of_a_new_project_runs() {
    let template = Path::new(env!("CARGO_MANIFEST_DIR")).join("../rpic/template/main.rpi");
    let output = rpi(&["run", template.to_str().unwrap()]);
    assert!(output.status.success(), "{output:?}");
}
