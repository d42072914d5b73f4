//! The jobs of robot programmers in `examples/jobs`, as a reader runs them, and in the cases that their programs handle. The runs
//! that are expected of `examples/jobs/NAME` are in `tests/jobs/NAME.json`.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use serde_json::Value;

mod support;
use support::expected_runs::{assert_run, elements, expected_runs};
use support::{output_text, rpi};

/// Longest time that a run of an example may take in the tests of every change.
const LONGEST: Duration = Duration::from_secs(30);

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn program(job: &str) -> PathBuf {
    root().join(format!("examples/jobs/{job}/{job}.rpi"))
}

fn runs(job: &str) -> Vec<Value> {
    expected_runs(&root().join(format!("tests/jobs/{job}.json")))
}

/// Returns the names of all jobs.
fn jobs() -> Vec<String> {
    let folders = std::fs::read_dir(root().join("examples/jobs")).unwrap();
    let names = folders.map(|folder| folder.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<String> = names.collect();
    names.sort();
    names
}

/// Runs the job as its cell describes it. Returns the outcome.
fn first_run(job: &str) -> Value {
    assert_run(&program(job), &runs(job)[0])
}

/// Number of runs of a job in the tests of every change, spread over its list. `RPI_JOBS=all` (`cargo xtask soak`) makes all.
const RUNS: usize = 10;

#[test]
fn every_job_ends_as_expected_within_30_s() {
    let jobs = jobs();
    assert!(jobs.len() >= 9, "{jobs:?}");
    let makes_all = std::env::var("RPI_JOBS").is_ok_and(|jobs| jobs == "all");
    for job in jobs {
        let runs = runs(&job);
        let step = if makes_all {
            1
        } else {
            runs.len().div_ceil(RUNS)
        };
        for run in runs.into_iter().step_by(step) {
            let begin = Instant::now();
            assert_run(&program(&job), &run);
            let took = begin.elapsed();
            assert!(took < LONGEST, "{job} takes {took:?}");
        }
    }
}

/// `rpi run` reports the statistics that a programmer asks for: rounds, takeovers in motion, use of the limits.
#[test]
fn the_outcome_has_the_statistics_of_the_task() {
    let outcome = first_run("pick_and_place");
    assert_eq!(outcome["blended"], 11, "{outcome:#}");
    assert_eq!(outcome["missed"], 0, "{outcome:#}");
    let arm = &outcome["devices"][0];
    let axes = elements(&arm["axes"]);
    assert_eq!(axes.len(), 7, "{arm:#}");
    for axis in axes {
        let limits = elements(&axis["limits"]);
        let quantities: Vec<_> = limits.iter().map(|limit| &limit["quantity"]).collect();
        assert_eq!(quantities, ["velocity", "acceleration", "jerk"]);
        let shares = limits
            .iter()
            .map(|limit| limit["largest_share"].as_f64().unwrap());
        assert!(
            shares
                .into_iter()
                .all(|share| (0.0..=1.001).contains(&share)),
            "{axis:#}"
        );
        assert!(axis["distance_to_end"].as_f64().unwrap() > 0.0, "{axis:#}");
    }
    assert_eq!(elements(&outcome["devices"][1]["axes"]).len(), 0);
}

/// Runs a job with these options, which exits with this status. Returns its recorded rows of this flow: cycle and value.
fn recorded(job: &str, options: &[&str], status: i32, flow: &str) -> Vec<(u64, String)> {
    recorded_program(&program(job), options, status, flow)
}

/// As [`recorded`], for a program in another file.
fn recorded_program(
    program: &Path,
    options: &[&str],
    status: i32,
    flow: &str,
) -> Vec<(u64, String)> {
    let folder = tempfile::tempdir().unwrap();
    let record = folder.path().join("run.csv");
    let files = [program, &record].map(|file| file.to_str().unwrap().to_owned());
    let mut arguments = vec!["run", &files[0], "--record", &files[1]];
    arguments.extend(options);
    let output = rpi(&arguments);
    assert_eq!(
        output.status.code(),
        Some(status),
        "{}",
        output_text(&output)
    );
    let rows = std::fs::read_to_string(record).unwrap();
    let mut rows: Vec<(u64, String)> = rows
        .lines()
        .filter_map(|row| {
            let mut cells = row.splitn(3, ',');
            let cycle = cells.next()?.parse().ok()?;
            let is_flow = cells.next()? == flow;
            is_flow.then(|| Some((cycle, cells.next()?.to_owned())))?
        })
        .collect();
    rows.sort_by_key(|row| row.0);
    rows
}

/// Returns a coordinate of a recorded pose, such as `x`, in m.
fn coordinate(pose: &str, axis: &str) -> f64 {
    let (_, rest) = pose.split_once(&format!("{axis}:")).unwrap();
    let end = rest.find([',', '}']).unwrap();
    rest[..end].parse().unwrap()
}

/// The seam runs along y, so the weave of 2 mm is along x; the torch burns from 2 mm behind the start of the seam, but for the 50 ms of
/// its delay, to 2 mm before the end.
#[test]
fn the_weave_goes_across_the_seam_and_the_torch_burns_along_it() {
    let torch = recorded("welding", &[], 0, "torch.out.bool");
    let changes: Vec<u64> = torch
        .windows(2)
        .filter(|pair| pair[0].1 != pair[1].1)
        .map(|pair| pair[1].0)
        .collect();
    let &[on, off] = &changes[..] else {
        panic!("the torch changes at {changes:?}");
    };
    let tool = recorded("welding", &[], 0, "arm.tcp.commanded_position");
    let burning = tool.iter().filter(|(cycle, _)| (on..=off).contains(cycle));
    let places: Vec<[f64; 2]> = burning
        .map(|(_, pose)| ["x", "y"].map(|axis| coordinate(pose, axis)))
        .collect();
    let sides = places.iter().map(|place| place[0] - 0.45);
    let [least, most] = [sides.clone().fold(0.0, f64::min), sides.fold(0.0, f64::max)];
    assert!(
        (most - 0.002).abs() < 2e-5 && (least + 0.002).abs() < 2e-5,
        "{least} to {most} m"
    );
    let [first, last] = [places[0][1] + 0.1, 0.1 - places[places.len() - 1][1]];
    // 50 ms at 12 mm/s are 0.6 mm; the tool is still accelerating there.
    assert!((0.0013..0.002).contains(&first), "on at {first} m");
    assert!(
        (last - 0.002).abs() < 2e-5,
        "off at {last} m before the end"
    );
}

/// The speed of the motion is set to 0 for three seconds in the seam: the arm comes to rest, and the torch must not burn a hole there.
#[test]
fn the_torch_is_off_while_the_tool_rests() {
    let folder = tempfile::tempdir().unwrap();
    let text = std::fs::read_to_string(program("welding")).unwrap();
    let end_of_call = "jerk: 12[m/s^3]";
    assert!(text.contains(end_of_call), "{text}");
    let slowed = "jerk: 12[m/s^3], override: if time > 3[s] and time < 6[s] then 0.0 else 1.0";
    let changed = folder.path().join("changed.rpi");
    std::fs::write(&changed, text.replace(end_of_call, slowed)).unwrap();
    let cell = program("welding").with_file_name("cell.toml");
    let options = ["--cell", cell.to_str().unwrap()];
    let torch = recorded_program(&changed, &options, 0, "torch.out.bool");
    let tool = recorded_program(&changed, &options, 0, "arm.tcp.commanded_position");
    let places: std::collections::BTreeMap<u64, &String> =
        tool.iter().map(|(cycle, place)| (*cycle, place)).collect();
    let mut rested = 0;
    for (cycle, burns) in &torch {
        let [before, now] = [cycle.saturating_sub(10), *cycle].map(|cycle| places.get(&cycle));
        let rests = before == now;
        assert!(!rests || burns == "false", "at rest in cycle {cycle}");
        rested += u32::from(rests && *cycle > 2000);
    }
    assert!(rested > 2000, "the tool rests in {rested} cycles only");
    let changes = torch.windows(2).filter(|pair| pair[0].1 != pair[1].1);
    assert_eq!(changes.count(), 4, "on and off, twice");
}

/// The operator slows the feed by slowing the spindle, which the arm follows: 0.8 mm for each turn, at 40 rad/s.
#[test]
fn the_feed_of_a_screw_has_the_speed_of_the_operator() {
    /// Number of cycles over which the feed is measured.
    const CYCLES: usize = 100;
    let feed = |options: &[&str]| {
        let tool = recorded("screwing", options, 0, "arm.tcp.commanded_position");
        let heights: Vec<f64> = tool.iter().map(|(_, pose)| coordinate(pose, "z")).collect();
        let driven = heights.windows(CYCLES + 1).filter(|part| part[0] < 0.2999);
        let speeds = driven.map(|part| (part[0] - part[CYCLES]) / (CYCLES as f64 * 1e-3));
        speeds.fold(0.0, f64::max)
    };
    let whole = 0.8e-3 * 40.0 / std::f64::consts::TAU;
    for (options, share) in [(&[][..], 1.0), (&["--override", "0.5"], 0.5)] {
        let found = feed(options);
        assert!(
            (found - share * whole).abs() < 1e-5,
            "{options:?}: {found} m/s"
        );
    }
}

/// The torch burns before each of these endings: no arc, a failure of the arm, a fault, the end of the run by `--time`.
#[test]
fn the_torch_is_off_after_every_ending() {
    let folder = tempfile::tempdir().unwrap();
    let with_cell = |name: &str, from: &str, to: &str| {
        let text = std::fs::read_to_string(program("welding").with_file_name("cell.toml")).unwrap();
        assert!(text.contains(from), "{text}");
        let file = folder.path().join(name);
        std::fs::write(&file, text.replace(from, to)).unwrap();
        file.to_str().unwrap().to_owned()
    };
    let dark = "inputs = [true]\nscript = [{ at = \"5 s\", input = 0, value = false }]";
    let dark = with_cell("dark.toml", "inputs = [true]", dark);
    let broken = "faults = [{ at = 5, for = 1, trouble = \"joint-failure\", axis = 3 }]\njoints =";
    let broken = with_cell("broken.toml", "joints =", broken);
    // The arm refuses the weave once the torch burns.
    let slow = with_cell("slow.toml", "joints =", "limits = { jerk = 12 }\njoints =");
    let endings: [(&[&str], i32); 4] = [
        (&["--cell", &dark], 1),
        (&["--cell", &broken], 1),
        (&["--cell", &slow], 3),
        (&["--time", "10s"], 0),
    ];
    for (options, status) in endings {
        let torch = recorded("welding", options, status, "torch.out.bool");
        assert!(
            torch.iter().any(|(_, value)| value == "true"),
            "{options:?}"
        );
        assert_eq!(torch.last().unwrap().1, "false", "{options:?}");
    }
}
