//! `rpi teach`: keys move an arm, and its points are written to a file.

mod support;

use std::io::Write as _;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use support::output_text;
use support::tools::{CELL, folder, run};

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
    let text = output_text(&done);
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
    assert_eq!(done.status.code(), Some(0), "{}", output_text(&done));
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
    assert_eq!(done.status.code(), Some(0), "{}", output_text(&done));
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
    assert!(
        output_text(&done).contains("no frame `desk`"),
        "{}",
        output_text(&done)
    );
}

/// At the end of the reach the arm stops with an error, and the next key moves it back.
#[test]
fn the_arm_moves_on_after_it_has_stopped_at_the_end_of_its_reach() {
    let folder = folder(&[]);
    let done = run("rpi", &["teach", "--hold", "3s"], folder.path(), ">>wwtst");
    let text = output_text(&done);
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

/// Flows and words of the program that moves the arm; the arm may have any of these names.
#[test]
fn the_arm_may_have_any_name() {
    for name in ["left", "a", "axis", "key", "way", "motion", "velocity"] {
        let cell = CELL.replace("devices.arm", &format!("devices.{name}"));
        let folder = folder(&[("cell.toml", &cell)]);
        let done = run("rpi", &["teach"], folder.path(), "w1+t");
        assert_eq!(
            done.status.code(),
            Some(0),
            "{name}: {}",
            output_text(&done)
        );
        assert!(
            output_text(&done).contains("took p1"),
            "{name}: {}",
            output_text(&done)
        );
    }
}

#[test]
fn names_that_others_have_are_not_taken_and_words_are_refused() {
    let points = "[tools.p1]\nposition = [0, 0, 0.1]\n";
    let folder = folder(&[("points.toml", points)]);
    let done = run("rpi", &["teach"], folder.path(), "tnif\nnpose\nnp2\n");
    let text = output_text(&done);
    for part in [
        "took p2",
        "`if` is a word",
        "`pose` is a name",
        "not taken: duplicate key",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
}

/// Keys that arrive one after the other, while others edit the file.
#[test]
fn edits_by_others_meanwhile_are_kept() {
    let folder = folder(&[]);
    let file = folder.path().join("points.toml");
    let mut teach = Teach::start(folder.path(), &["teach"]);
    teach.press("t");
    let text = wait_for(&file, "[points.p1]");
    std::fs::write(&file, text.replace("points.p1", "points.pick") + "# mine\n").expect("written");
    teach.press("wt");
    let text = wait_for(&file, "[points.p1]");
    assert!(
        text.contains("[points.pick]") && text.contains("# mine"),
        "{text}"
    );
    teach.press("z");
    assert_eq!(teach.end(), Some(0));
    let text = std::fs::read_to_string(&file).expect("there");
    assert!(
        !text.contains("[points.p1]") && text.contains("# mine"),
        "{text}"
    );
}

/// The arm of a server, one of two with different numbers of axes.
#[test]
fn an_arm_of_a_server_is_taught() {
    let cell = "[devices.one]\nkind = \"arm\"\nmodel = \"ur5e\"\njoints = \"home\"\n\n[devices.two]\nkind = \"arm\"\nmodel = \"kuka-lwr4+\"\njoints = \"home\"\n";
    let folder = folder(&[("cell.toml", cell)]);
    let port = std::net::TcpListener::bind("127.0.0.1:0").and_then(|l| l.local_addr());
    let address = port.expect("a free port").to_string();
    let server = Teach::start(
        folder.path(),
        &["serve", "--cell", "cell.toml", "--listen", &address],
    );
    let connects = || std::net::TcpStream::connect(&address).is_ok();
    assert!((0..200).any(|_| connects() || {
        std::thread::sleep(Duration::from_millis(50));
        false
    }));
    let teach = |more: &[&str]| {
        let arguments = [&["teach", "--connect", &address], more].concat();
        run("rpi", &arguments, folder.path(), "wwt")
    };
    let done = teach(&["--arm", "one"]);
    assert_eq!(done.status.code(), Some(0), "{}", output_text(&done));
    let done = teach(&[]);
    assert!(
        output_text(&done).contains("choose one by --arm: one, two"),
        "{}",
        output_text(&done)
    );
    drop(server);
    let text = std::fs::read_to_string(folder.path().join("points.toml")).expect("there");
    let joints = text
        .lines()
        .find(|line| line.starts_with("joints"))
        .expect("joints");
    assert_eq!(joints.matches(',').count(), 5, "{text}");
}

/// A running tool that reads keys.
struct Teach(Child);

impl Teach {
    fn start(folder: &Path, arguments: &[&str]) -> Self {
        let mut command = Command::new(env!("CARGO_BIN_EXE_rpi"));
        command
            .args(arguments)
            .current_dir(folder)
            .stdin(Stdio::piped());
        command.stdout(Stdio::null()).stderr(Stdio::null());
        Self(command.spawn().expect("the tool starts"))
    }

    fn press(&mut self, keys: &str) {
        let input = self.0.stdin.as_mut().expect("a pipe");
        input
            .write_all(keys.as_bytes())
            .and_then(|()| input.flush())
            .expect("it reads");
    }

    fn end(mut self) -> Option<i32> {
        drop(self.0.stdin.take());
        self.0.wait().expect("it ends").code()
    }
}

impl Drop for Teach {
    fn drop(&mut self) {
        // It may have ended already.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Waits until the file contains a text, and returns all of it.
fn wait_for(file: &Path, part: &str) -> String {
    for _ in 0..200 {
        let text = std::fs::read_to_string(file).unwrap_or_default();
        if text.contains(part) {
            return text;
        }
        std::thread::sleep(Duration::from_millis(50));
    }
    panic!("no {part} in {}", file.display());
}
