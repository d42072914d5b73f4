//! Promises of the paper that need a whole run: set-points at precise intervals, fixed parameters and kept states,
//! propagation through the net within a cycle, and many small commands instead of a big one.

mod support;

use std::path::{Path, PathBuf};
use std::process::Output;

use rpi_driver::{Input, InputKind, compile, lower_for_execution};
use rpi_image::Image;
use support::{output_text, rpi};

const TICK_NS: u64 = 1_000_000;

fn run(program: &Path, options: &[&str]) -> Output {
    rpi(&[&["run", program.to_str().unwrap()], options].concat())
}

fn example(path: &str) -> PathBuf {
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    examples.join(path)
}

/// Creates a folder with a program and, if given, a cell.
fn folder(program: &str, cell: Option<&str>) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("program.rpi");
    std::fs::write(&path, program).unwrap();
    if let Some(cell) = cell {
        std::fs::write(folder.path().join("cell.toml"), cell).unwrap();
    }
    (folder, path)
}

/// Returns the messages of a topic: time in ns and content.
fn messages(recording: &Path, topic: &str) -> Vec<(u64, serde_json::Value)> {
    let bytes = std::fs::read(recording).unwrap();
    let messages = mcap::MessageStream::new(&bytes)
        .unwrap()
        .map(Result::unwrap);
    let wanted = messages.filter(|message| message.channel.topic == topic);
    let read = wanted.map(|m| (m.log_time, serde_json::from_slice(&m.data).unwrap()));
    read.collect()
}

/// Row 3: in real time there is a set-point in every millisecond. The histogram shows the lateness; the mean is zero
/// whatever else the machine does, as deadlines are absolute.
#[test]
fn set_points_come_at_precise_intervals() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("out.mcap");
    let options = [
        "--real-time",
        "--time",
        "1500ms",
        "--json",
        "--record",
        file.to_str().unwrap(),
    ];
    let mut intervals = Vec::new();
    // Other processes may use the machine, so there are several attempts.
    for _ in 0..5 {
        let output = run(&example("blending/blending.rpi"), &options);
        let outcome: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        let late = outcome["figures"]["lateness"].clone();
        let points = messages(&file, "/set_points/arm");
        let cycles: Vec<u64> = points
            .iter()
            .map(|p| p.1["cycle"].as_u64().unwrap())
            .collect();
        assert!(cycles.len() > 1000, "{} set-points", cycles.len());
        assert!(
            cycles.windows(2).all(|c| c[1] == c[0] + 1),
            "one is missing"
        );
        let mut apart: Vec<u64> = points.windows(2).map(|p| p[1].0 - p[0].0).collect();
        let mean = apart.iter().sum::<u64>() as f64 / apart.len() as f64;
        apart.sort_unstable();
        let median = apart[apart.len() / 2] as f64;
        let near = |apart: f64, share: f64| (apart / 1e6 - 1.0).abs() < share;
        if near(mean, 0.01) && near(median, 0.05) && late["p50"].as_u64() < Some(500_000) {
            assert!(late["p99"].as_u64() >= late["p50"].as_u64(), "{late}");
            return;
        }
        intervals.push(format!("mean {mean} ns, median {median} ns, late {late}"));
    }
    panic!("set-points at odd intervals:\n{}", intervals.join("\n"));
}

const COUNTS: &str = "
command Count (step: int)
let
  n = step -> pre n + step;
  export n;
  finish done when n = 4 * step;
tel

task Both
let
  Count(2);
  Count(5);
tel
";

/// Row 9: a parameter is constant for all cycles of a command and cannot be set any more; a counter keeps its value
/// between cycles and belongs to one command.
#[test]
fn parameters_are_fixed_and_states_are_kept() {
    let (folder, program) = folder(COUNTS, None);
    let record = folder.path().join("out.csv");
    let output = run(&program, &["--record", record.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(0), "{}", output_text(&output));
    let rows = std::fs::read_to_string(&record).unwrap();
    let values = |of: &str| -> Vec<String> {
        let own = rows.lines().filter(|row| row.contains(of));
        own.map(|row| row.rsplit(',').next().unwrap().to_owned())
            .collect()
    };
    assert_eq!(values("Count(2).n"), ["2", "4", "6", "8"], "{rows}");
    assert_eq!(values("Count(5).n"), ["5", "10", "15", "20"], "{rows}");
    let set = run(&program, &["--set", "step=9"]);
    assert_eq!(set.status.code(), Some(2), "{}", output_text(&set));
    assert!(output_text(&set).contains("step"), "{}", output_text(&set));
}

/// Number of additions between the counter and the output, in reverse order of the text.
const CHAIN: usize = 200;

/// Row 15: each cycle computes everything once and in order of dependency: the output has this cycle's count from the
/// first cycle on.
#[test]
fn values_are_through_the_whole_net_in_their_cycle() {
    let mut text = "use io;\ncommand Chain (io: AnalogueIo)\nlet\n".to_owned();
    text += &format!("  io.set = [x{CHAIN}, n, 0.0, 0.0];\n");
    for k in (1..=CHAIN).rev() {
        text += &format!("  x{k} = x{} + 1.0;\n", k - 1);
    }
    text += "  x0 = n;\n  n = 1.0 -> pre n + 1.0;\n  finish done when n >= 10.0;\ntel\n";
    let cell = "[devices.io]\nkind = \"analogue-io\"\noutputs = 4\n";
    let (folder, program) = folder(&text, Some(cell));
    let file = folder.path().join("out.mcap");
    let output = run(&program, &["--record", file.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(0), "{}", output_text(&output));
    let points = messages(&file, "/set_points/io");
    let values: Vec<serde_json::Value> = points.into_iter().map(|p| p.1).collect();
    assert_eq!(values.len(), 10, "{values:?}");
    for (k, point) in values.iter().enumerate() {
        let n = k as f64 + 1.0;
        let text = point.to_string();
        assert_eq!(point["cycle"], k, "{text}");
        let numbers = numbers(point);
        assert!(
            numbers.contains(&n) && numbers.contains(&(n + CHAIN as f64)),
            "{text}"
        );
    }
}

/// Returns all numbers in a message.
fn numbers(value: &serde_json::Value) -> Vec<f64> {
    match value {
        serde_json::Value::Array(list) => list.iter().flat_map(numbers).collect(),
        serde_json::Value::Object(fields) => fields.values().flat_map(numbers).collect(),
        other => other.as_f64().into_iter().collect(),
    }
}

/// Returns the goal of the k-th motion.
fn place(k: usize) -> String {
    let side = if k.is_multiple_of(2) { 40 } else { -40 };
    format!("pose(400[mm], {side}[mm], 450[mm], 0[deg], 180[deg], 0[deg])")
}

/// Returns one command with this many motions, each a fragment that starts when the previous one is done.
fn one_big(motions: usize) -> String {
    let mut text = "use motion;\ncommand All (arm: Arm)\nlet\n".to_owned();
    for k in 0..motions {
        let when = match k {
            0 => "true".to_owned(),
            k => format!("S{}.way.done ?? false", k - 1),
        };
        let to = place(k);
        text += &format!("  fragment S{k} when {when}\n  let way = Line(arm, {to}); tel\n");
    }
    let ways: Vec<String> = (0..motions)
        .rev()
        .map(|k| format!("S{k}.way.pose"))
        .collect();
    let last = motions - 1;
    text += &format!("  arm.tcp = {};\n", ways.join(" ?? "));
    text + &format!(
        "  finish done when S{last}.way.done ?? false;\n  fail arm_error when arm.error;\ntel\n"
    )
}

/// Returns the same motions as separate commands of a task.
fn many_small(motions: usize) -> String {
    let mut text = "use motion;\ncommand Move (arm: Arm; to: Pose = pose(400[mm], 0[mm], 450[mm], 0[deg], 180[deg], 0[deg]))\nlet\n  way = Line(arm, to);\n  arm.tcp = way.pose;\n  finish done when way.done;\n  fail arm_error when arm.error;\ntel\n\ntask All (arm: Arm)\nlet\n".to_owned();
    for k in 0..motions {
        text += &format!("  Move(arm, {});\n", place(k));
    }
    text + "tel\n"
}

fn images(text: &str) -> Vec<Image> {
    let input = Input {
        path: "t.rpi".into(),
        kind: InputKind::Rpi,
        bytes: text.into(),
    };
    let compiled = compile(&input).unwrap();
    assert!(!compiled.has_errors(), "{:?}", compiled.diagnostics);
    let nets = compiled.nets().iter();
    nets.map(|net| lower_for_execution(net, TICK_NS).unwrap())
        .collect()
}

/// Returns the size in bytes of the largest image that must be loaded at once.
fn largest(text: &str) -> usize {
    let sizes = images(text).iter().map(|i| i.to_bytes().len()).max();
    sizes.unwrap()
}

/// Row 22: the size of one command grows with the number of motions; separate commands stay small, and the arm reaches
/// the same goal.
#[test]
fn many_small_commands_scale_where_one_big_one_does_not() {
    let big = [2, 8, 16].map(|n| largest(&one_big(n)));
    let small = [2, 8, 16].map(|n| largest(&many_small(n)));
    assert_eq!(small, [small[0]; 3]);
    assert!(
        big[1] > 5 * big[0] / 2 && big[2] > 7 * big[1] / 4,
        "{big:?}"
    );
    assert!(big[2] > 7 * small[2], "{big:?} {small:?}");
    let cell = std::fs::read_to_string(example("blending/cell.toml")).unwrap();
    let ends = [one_big(4), many_small(4)].map(|text| {
        let (folder, program) = folder(&text, Some(&cell));
        let file = folder.path().join("out.mcap");
        let output = run(&program, &["--record", file.to_str().unwrap()]);
        assert_eq!(output.status.code(), Some(0), "{}", output_text(&output));
        let last = messages(&file, "/set_points/arm").pop().unwrap().1;
        numbers(&last["tcp"])
    });
    let [one, many] = &ends;
    assert!(one.len() >= 7 && one.len() == many.len(), "{ends:?}");
    let apart = one.iter().zip(many).map(|(a, b)| (a - b).abs());
    assert!(apart.fold(0.0, f64::max) < 1e-6, "{ends:?}");
}
