//! Taught points: `use points;` in programs, and `rpi teach`, which writes them.

use std::io::Write as _;
use std::path::Path;
use std::process::{Command, Output, Stdio};

const CELL: &str = "[devices.arm]\nkind = \"arm\"\nmodel = \"kuka-lwr4+\"\njoints = \"home\"\n";

/// Program that goes to a point in space, to one in a frame of the file and to one in a frame of the program.
const PROGRAM: &str = "use motion, points;

frame shelf = pose(400[mm], 100[mm], 450[mm], 0[deg], 0[deg], 0[deg]);

command Park (arm: Arm)
let
  way = PointToPoint(arm, park_joints);
  arm.joints = way.joints;
  finish there when way.done;
  fail stopped when way.stopped;
  fail arm_error when arm.error;
tel

command Go (arm: Arm; to: Pose)
let
  way = Line(arm, to);
  arm.joints = way.joints;
  position = arm.pose.position;
  export position;
  finish there when way.done;
  fail stopped when way.stopped;
  fail arm_error when arm.error;
tel

task Main (arm: Arm)
let
  Park(arm);
  Go(arm, table * pick);
  Go(arm, shelf * place);
tel
";

const POINTS: &str = "# Taught by hand.
[frames.table]
position = [0.4, 0.0, 0.45]
rpy = [0, 0, \"30 deg\"]

[points.pick]
in = \"table\"
position = [\"50 mm\", \"20 mm\", 0.0]
rpy = [0, \"180 deg\", 0]

[points.place]
in = \"shelf\"
position = [0.05, 0.02, 0]
quaternion = [0, 1, 0, 0]

[points.park]
joints = [\"10 deg\", \"-30 deg\", 0, \"90 deg\", 0, \"-60 deg\", 0]
";

fn run(program: &str, arguments: &[&str], folder: &Path, input: &str) -> Output {
    let tool = match program {
        "rpi" => env!("CARGO_BIN_EXE_rpi").into(),
        _ => Path::new(env!("CARGO_BIN_EXE_rpi")).with_file_name(program),
    };
    let mut command = Command::new(tool);
    command
        .args(arguments)
        .current_dir(folder)
        .stdin(Stdio::piped());
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().expect("the tool starts");
    let mut keys = child.stdin.take().expect("a pipe");
    // A tool that ends early reads no keys.
    let _ = keys.write_all(input.as_bytes());
    drop(keys);
    child.wait_with_output().expect("the tool ends")
}

fn shown(output: &Output) -> String {
    let [out, err] = [&output.stdout, &output.stderr].map(|bytes| String::from_utf8_lossy(bytes));
    format!("{out}{err}")
}

/// Returns a folder with the cell, and the files with these texts.
fn folder(files: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, text) in [("cell.toml", CELL)].iter().chain(files) {
        std::fs::write(folder.path().join(name), text).expect("written");
    }
    folder
}

#[test]
fn programs_name_points_and_frames() {
    let folder = folder(&[("program.rpi", PROGRAM), ("points.toml", POINTS)]);
    let done = run(
        "rpi",
        &["run", "program.rpi", "--record", "out.csv"],
        folder.path(),
        "",
    );
    assert_eq!(done.status.code(), Some(0), "{}", shown(&done));
    assert_eq!(
        shown(&done).matches("finished with there").count(),
        3,
        "{}",
        shown(&done)
    );
    let rows = std::fs::read_to_string(folder.path().join("out.csv")).expect("recorded");
    // 50 mm and 20 mm in the axes of the table, turned by 30 degrees; then in those of the shelf.
    let [c, s] = [30_f64.to_radians().cos(), 30_f64.to_radians().sin()];
    for (x, y) in [
        (0.4 + 0.05 * c - 0.02 * s, 0.05 * s + 0.02 * c),
        (0.45, 0.12),
    ] {
        let is_there = |row: &str| {
            let numbers: Vec<f64> = row
                .split([',', ':', '{', '}', '"'])
                .filter_map(|v| v.parse().ok())
                .collect();
            let near = |value: f64| numbers.iter().any(|n| (n - value).abs() < 1e-6);
            near(x) && near(y)
        };
        assert!(rows.lines().any(is_there), "no row has {x}, {y}");
    }
}

/// Changes of the points, the exit status of `rpi run`, and a part of its output.
const CHANGES: &[(&str, &str, i32, &str)] = &[
    ("[points.pick]", "[points.pock]", 2, "did you mean `pock`?"),
    (
        "rpy = [0, 0, \"30 deg\"]",
        "rpy = [0, \"30 deg\"]",
        2,
        "points.toml: line 4: `rpy` has 2 entries, expected 3",
    ),
    (
        "[points.park]",
        "[points.\"2nd\"]",
        2,
        "`2nd` is not a name that a program can write",
    ),
    (
        "[points.park]",
        "[points.table]",
        2,
        "`table` is the name of two entries",
    ),
    (
        "in = \"shelf\"",
        "in = \"shelve\"",
        2,
        "undefined frame `shelve`",
    ),
    (
        "in = \"table\"",
        "in = \"shelf\"",
        2,
        "insert the pose of `shelf` in `table`",
    ),
    (
        "\"-60 deg\", 0]",
        "\"-60 deg\"]",
        2,
        "expected 7 elements, found 6",
    ),
    (
        "in = \"table\"\nposition = [\"50 mm\", \"20 mm\", 0.0]\nrpy = [0, \"180 deg\", 0]",
        "in = \"table\"",
        2,
        "the point `pick` has no place",
    ),
    (
        "# Taught by hand.",
        "[points.spare]\nposition = [0, 0, 1]",
        0,
        "`spare` of points.toml is never used",
    ),
    (
        "in = \"shelf\"",
        "in = \"shelf\"\ncolour = \"red\"",
        2,
        "unknown key `colour`",
    ),
];

#[test]
fn missing_unused_and_wrong_points_are_reported() {
    for (from, to, status, part) in CHANGES {
        let points = POINTS.replace(from, to);
        assert_ne!(points, POINTS, "{from}");
        let folder = folder(&[("program.rpi", PROGRAM), ("points.toml", &points)]);
        let done = run("rpi", &["run", "program.rpi"], folder.path(), "");
        let text = shown(&done);
        assert_eq!(done.status.code(), Some(*status), "{to}: {text}");
        assert!(text.replace("\n  │ ", " ").contains(part), "{to}: {text}");
    }
}

/// A program of the points that were taught: through all of them, back to the first.
const TAUGHT: &str = "use motion, points;

command Go (arm: Arm; to: real[rad]^7)
let
  way = PointToPoint(arm, to);
  arm.joints = way.joints;
  finish there when way.done;
  fail stopped when way.stopped;
  fail arm_error when arm.error;
tel

task Main (arm: Arm)
let
  Go(arm, p1_joints);
  Go(arm, above_joints);
  Go(arm, p1_joints);
tel
";

#[test]
fn keys_move_the_arm_and_take_points() {
    let folder = folder(&[("program.rpi", TAUGHT)]);
    // The tool forwards and up, axis 2 to and fro, an axis that the arm lacks, a wrong name, one point too many.
    let keys = "wwrrt2++--sd>on1x\nnabove\ntz<q";
    let done = run("rpi", &["teach"], folder.path(), keys);
    let text = shown(&done);
    assert_eq!(done.status.code(), Some(0), "{text}");
    for part in [
        "took p1:",
        "axis 2",
        "not taken: `1x` is not a name",
        "took above:",
        "took p2:",
        "removed p2",
        "points.toml: 2 points taken",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    let done = run("rpi", &["run", "program.rpi"], folder.path(), "");
    assert_eq!(done.status.code(), Some(0), "{}", shown(&done));
}

#[test]
fn points_are_taken_in_a_frame_and_the_file_stays_as_it_is() {
    let frame = "# The table stands turned.\n[frames.table]\nposition = [0.4, 0, 0.3]\nrpy = [0, 0, \"90 deg\"]\n";
    let folder = folder(&[("places.toml", frame)]);
    let done = run(
        "rpi",
        &["teach", "places.toml", "--frame", "table"],
        folder.path(),
        "t",
    );
    assert_eq!(done.status.code(), Some(0), "{}", shown(&done));
    let text = std::fs::read_to_string(folder.path().join("places.toml")).expect("written");
    assert!(text.starts_with(frame), "{text}");
    assert!(text.contains("[points.p1]\nin = \"table\"\n"), "{text}");
    let done = run(
        "rpi",
        &["teach", "places.toml", "--frame", "desk"],
        folder.path(),
        "t",
    );
    assert_eq!(done.status.code(), Some(2));
    assert!(shown(&done).contains("no frame `desk`"), "{}", shown(&done));
}

/// At the end of the reach the arm stops with an error, and the next key moves it back.
#[test]
fn the_arm_moves_on_after_it_has_stopped_at_the_end_of_its_reach() {
    let folder = folder(&[]);
    let done = run("rpi", &["teach", "--hold", "3s"], folder.path(), ">>wwtst");
    let text = shown(&done);
    assert_eq!(done.status.code(), Some(0), "{text}");
    assert!(text.contains("the arm stopped"), "{text}");
    let place = |name: &str| -> f64 {
        let line = text
            .lines()
            .find(|line| line.starts_with(name))
            .expect(name);
        let x = line
            .split("x ")
            .nth(1)
            .and_then(|rest| rest.split(' ').next());
        x.and_then(|x| x.parse().ok()).expect("a number")
    };
    let [out, back] = ["took p1", "took p2"].map(place);
    assert!(out > 700.0 && back < out - 50.0, "{out} {back}");
}

/// A line that turns a tool: its tip moves on the line, and the arm takes over to its own tool in motion.
const WELDING: &str = "use motion, points;

command Weld (arm: Arm; tip: Pose)
let
  start = arm.pose * tip -> pre start;
  turned = start * pose(0[m], 0[m], 0[m], 40[deg], 20[deg], 0[deg]);
  way = Line<<speed: 100[mm/s]>>(
    arm,
    Pose{position = start.position + vector(0[m], 150[mm], 0[m]); rotation = turned.rotation},
    tool: tip
  );
  arm.joints = way.joints;
  at = (arm.pose * tip).position;
  planned = way.pose.position;
  export at, planned;

  fragment AtHalf when takeover
  let yes = crosses(way.travelled, 75[mm]); tel

  finish there when way.done;
  yield  half when AtHalf.yes ?? false;
  fail   stopped when way.stopped;
  fail   arm_error when arm.error;
tel

command Back (arm: Arm)
let
  way = Line<<speed: 100[mm/s]>>(arm, pose(450[mm], 0[m], 400[mm], 0[deg], 180[deg], 0[deg]));
  arm.joints = way.joints;
  finish there when way.done;
  fail   stopped when way.stopped;
  fail   arm_error when arm.error;
tel

task Main (arm: Arm)
let
  Weld(arm, torch);
  Back(arm);
tel
";

const TORCH: &str = "[tools.torch]
position = [\"50 mm\", 0, \"200 mm\"]
rpy = [0, \"30 deg\", 0]
mass = \"900 g\"
centre = [0, 0, \"60 mm\"]
";

/// Returns the vectors that the rows of a recording have for a flow.
fn vectors(rows: &str, flow: &str) -> Vec<[f64; 3]> {
    let rows = rows.lines().filter(|row| row.contains(flow));
    let vector = |row: &str| {
        let inner = row.split(['{', '}']).nth(1).expect("a vector");
        let numbers = inner
            .split(',')
            .map(|part| part.rsplit(':').next().and_then(|n| n.parse().ok()));
        numbers
            .collect::<Option<Vec<f64>>>()
            .and_then(|numbers| numbers.try_into().ok())
    };
    rows.map(|row| vector(row).expect("three numbers"))
        .collect()
}

#[test]
fn the_tip_of_a_chosen_tool_moves_on_the_line() {
    let folder = folder(&[("program.rpi", WELDING), ("points.toml", TORCH)]);
    let done = run(
        "rpi",
        &["run", "program.rpi", "--record", "out.csv"],
        folder.path(),
        "",
    );
    let text = shown(&done);
    assert_eq!(done.status.code(), Some(0), "{text}");
    assert!(
        text.contains("taken over at half") && text.contains("finished with there"),
        "{text}"
    );
    let rows = std::fs::read_to_string(folder.path().join("out.csv")).expect("recorded");
    let at = vectors(&rows, "Weld.at,");
    let planned = vectors(&rows, "Weld.planned,");
    assert!(at.len() > 500 && at.len() == planned.len());
    for tip in at.iter().chain(&planned) {
        let off = (tip[0] - at[0][0]).hypot(tip[2] - at[0][2]);
        assert!(off < 1e-9, "the tip is {off} m off the line");
    }
}

#[test]
fn frames_of_tool_and_goal_must_agree() {
    let program = "use motion;
frame torch;
command Weld (arm: Arm; to: Pose(torch in arm.base); tip: Pose(torch in arm.tool))
let
  way = Line(arm, to, tool: tip);
  arm.joints = way.joints;
  finish there when way.done;
  fail   stopped when way.stopped;
  fail   arm_error when arm.error;
tel
";
    for (program, part) in [
        (program.to_owned(), None),
        (
            program.replace(", tool: tip", ""),
            Some("expected `Pose(arm.tool in arm.base)`, found `Pose(torch in arm.base)`"),
        ),
        (
            program.replace("to: Pose(torch", "to: Pose(arm.tool"),
            Some("expected `Pose(arm.tool in arm.tool)`, found `Pose(torch in arm.tool)`"),
        ),
    ] {
        let folder = folder(&[("program.rpi", &program)]);
        let done = run("rpic", &["check", "program.rpi"], folder.path(), "");
        let text = shown(&done).replace("\n  │ ", " ");
        match part {
            Some(part) => assert!(text.contains(part), "{text}"),
            None => assert!(!text.contains("error"), "{text}"),
        }
    }
}
