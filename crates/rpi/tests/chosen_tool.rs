//! Motions of a tool that the program chooses.

mod support;

use support::output_text;
use support::tools::{folder, run, run_recorded};

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
    let (text, rows) = run_recorded(folder.path());
    assert!(
        text.contains("taken over at half") && text.contains("finished with there"),
        "{text}"
    );
    let at = vectors(&rows, ").at\"");
    let planned = vectors(&rows, ").planned\"");
    assert!(at.len() > 500 && planned.len() > 500);
    for tip in at.iter().chain(&planned) {
        let off = [tip[0] - at[0][0], tip[2] - at[0][2]];
        let is_on_line = off.iter().all(|off| off.abs() < 1e-9);
        assert!(is_on_line, "the tip is {off:?} m off the line");
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
        let text = output_text(&done).replace("\n  │ ", " ");
        match part {
            Some(part) => assert!(text.contains(part), "{text}"),
            None => assert!(!text.contains("error"), "{text}"),
        }
    }
}

/// Motions that are refused, and a jog whose tool changes.
const ODD: &str = "use motion;
const torch: Pose = pose(0[m],0[m],180[mm],0[deg],0[deg],0[deg]);
command First (arm: Arm)
let
  way = Line<<speed: 100[mm/s]>>(arm, pose(537[mm],100[mm],200[mm],0[deg],180[deg],0[deg]), tool: torch);
  arm.joints = way.joints;
  finish there when way.done;
  yield half when way.travelled > 20[mm];
  fail stopped when way.stopped;
  fail arm_error when arm.error;
tel
command Refused (arm: Arm)
let
  way = Line(arm, pose(5000[mm],100[mm],200[mm],0[deg],180[deg],0[deg]));
  arm.joints = way.joints;
  off = distance(way.pose, arm.pose);
  n = 1 -> pre n + 1;
  finish differs when off > 100[mm] and n > 1;
  finish same when n > 5;
  fail stopped when way.stopped;
tel
command RefusedNan (arm: Arm; x: real)
let
  way = Line(arm, pose(500[mm],100[mm],200[mm],0[deg],180[deg],0[deg]), tool: pose(0[m]/x,0[m],0[m],0[rad],0[rad],0[rad]));
  arm.joints = way.joints;
  off = distance(way.pose, arm.pose);
  n = 1 -> pre n + 1;
  finish differs when off > 100[mm] and n > 1;
  finish same when n > 5;
  fail stopped when way.stopped;
tel
command JogChange (arm: Arm)
let
  n = 0 -> pre n + 1;
  x = if n < 300 then 0.0[m] else 0.1[m];
  way = ToolVelocity(arm, linear: vector(if n < 400 then 20[mm/s] else 0[mm/s], 0[m/s], if n >= 400 and n < 600 then 20[mm/s] else 0[m/s]), angular: vector(0[rad/s],0[rad/s],0[rad/s]), tool: pose(x, 0[m], 0[m], 0[rad],0[deg],0[rad]));
  arm.joints = way.joints;
  p = way.pose.position.x;
  jump = (p - (p -> pre p));
  finish jumped when abs(jump) > 50[mm];
  finish there when n > 900 ;
  fail stopped when way.stopped;
  fail arm_error when arm.error;
tel
task T1 (arm: Arm) let First(arm); Refused(arm); tel
task T2 (arm: Arm) let First(arm); RefusedNan(arm, 0.0); tel
task T3 (arm: Arm) let JogChange(arm); tel
";

/// The pose of a motion is that of the tool that its command has chosen, also while the arm follows another motion.
#[test]
fn the_pose_of_a_motion_is_that_of_its_own_tool() {
    let folder = folder(&[("program.rpi", ODD)]);
    for (task, result) in [
        ("T1", "with same"),
        ("T2", "with same"),
        ("T3", "with there"),
    ] {
        let done = run(
            "rpi",
            &["run", "program.rpi", "--command", task],
            folder.path(),
            "",
        );
        let text = output_text(&done);
        assert!(text.contains(result), "{task}: {text}");
    }
}

/// A default binds a frame only if it is the identity in a frame of a device.
#[test]
fn other_defaults_leave_the_frames_free() {
    let program = "use motion;
frame base, part, torch;
const ten: Pose = pose(100[mm], 0[m], 0[m], 0[rad], 0[rad], 0[rad]);
const origin: Pose = pose(0[m], 0[m], 0[m], 0[rad], 0[rad], 0[rad]);

fragment Weld <<n: int>> (arm: Arm<<n>>; to: Pose(tcp in arm.base); tool: Pose(tcp in arm.tool) = ten)
  returns (joints: real[rad]^n; done, stopped: bool)
let
  way = Line(arm, to, tool: tool);
  joints = way.joints; done = way.done; stopped = way.stopped;
tel

command Right (arm: Arm; to: Pose(torch in arm.base))
let
  way = Weld(arm, to);
  arm.joints = way.joints;
  finish there when way.done;
  fail   stopped when way.stopped;
  fail   arm_error when arm.error;
tel

node Filter (seen: Pose(p in base); start: Pose(p in base) = origin) returns (q: Pose(p in base))
let q = start -> seen; tel

node Use (seen: Pose(part in base)) returns (q: Pose(part in base))
let q = Filter(seen); tel
";
    let folder = folder(&[("program.rpi", program)]);
    let done = run("rpic", &["check", "program.rpi"], folder.path(), "");
    assert!(
        !output_text(&done).contains("error"),
        "{}",
        output_text(&done)
    );
}

/// `rpi trace` compiles a program for the cell that it is given, as `rpi run` does.
#[test]
fn the_cell_of_an_option_decides_the_axes() {
    let cell = "[devices.arm]\nkind = \"arm\"\nmodel = \"ur5e\"\njoints = \"home\"\n";
    let program = "use motion;
command Hold_still (arm: Arm)
let
  way = Hold(arm);
  arm.joints = way.joints;
  finish rests when way.done;
  fail   stopped when way.stopped;
tel
";
    let folder = folder(&[("six.toml", cell), ("program.rpi", program)]);
    for tool in ["run", "trace"] {
        let done = run(
            "rpi",
            &[tool, "program.rpi", "--cell", "six.toml"],
            folder.path(),
            "",
        );
        assert_eq!(
            done.status.code(),
            Some(0),
            "{tool}: {}",
            output_text(&done)
        );
    }
}
