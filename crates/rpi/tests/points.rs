//! Taught points and tools: `use points;` in programs.

mod support;

use support::output_text;
use support::tools::{folder, run, run_recorded};

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

#[test]
fn programs_name_points_and_frames() {
    let folder = folder(&[("program.rpi", PROGRAM), ("points.toml", POINTS)]);
    let (text, rows) = run_recorded(folder.path());
    assert_eq!(text.matches("finished with there").count(), 3, "{text}");
    // 50 mm and 20 mm in the axes of the table, turned by 30 degrees; then in those of the shelf.
    let [c, s] = [0.75_f64.sqrt(), 0.5];
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
    ("[points.park]", "[points.if]", 2, "`if_joints`"),
    (
        "[points.pick]",
        "[points.if]",
        2,
        "RPI1018: `if` is a word of the language",
    ),
    (
        "[points.pick]",
        "[points.pose]",
        2,
        "RPI1018: `pose` is a name of the standard library",
    ),
    (
        "[points.place]",
        "[points.park_joints]",
        2,
        "RPI1018: `park_joints` gives the name `park_joints` as well",
    ),
    (
        "joints = [",
        "joints = []\n#",
        2,
        "RPI1018: `joints` has no entries",
    ),
    ("[points.pick]", "[points.pock]", 2, "did you mean `pock`?"),
    (
        "rpy = [0, 0, \"30 deg\"]",
        "rpy = [0, \"30 deg\"]",
        2,
        "RPI1018: `rpy` has 2 entries, expected 3",
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
        let text = output_text(&done);
        assert_eq!(done.status.code(), Some(*status), "{to}: {text}");
        assert!(text.replace("\n  │ ", " ").contains(part), "{to}: {text}");
    }
}
