//! Programs on an arm of Universal Robots, with a controller in a process of its own: `fake/controller.py` shares no code with
//! the driver. It speaks RTDE at 500 Hz, and executes the URScript program of the driver.
#![cfg(feature = "rtde")]

use std::io::{Read, Write};
use std::net::TcpStream;
use std::process::Stdio;
use std::thread;
use std::time::{Duration, Instant};

mod fake;
mod project;
#[path = "../support/mod.rs"]
mod support;

use fake::{CYCLE, Fake};
use project::{Project, Server};
use support::{output_text, rpi};

/// Acceleration limit of the arm, in rad/s², with a reserve for the watchdog of the program, which brakes at this limit.
const BRAKING: f64 = 9.6;
/// Deceleration of the stops of the controller itself, in rad/s².
const SAFE_STOP: f64 = 20.1;

#[test]
fn the_blending_example_ends_where_the_simulation_ends_in_spite_of_losses() {
    let Some(mut controller) = Fake::start("the example by RTDE") else {
        return;
    };
    let project = Project::new(controller.ports);
    let table = project.path("out.csv");
    let recorded = ["--record", table.to_str().unwrap()];
    let simulated = project.command("cell.toml", &recorded).output().unwrap();
    assert!(simulated.status.success(), "{}", output_text(&simulated));
    controller.command("loss 0.01");
    let (code, text) = project.run_real();
    let trace = controller.end();
    assert_eq!(code, Some(0), "{text}\n{}", trace.log);
    assert!(
        text.contains("taken over at at_b") && text.contains("arm: ok, at rest"),
        "{text}"
    );
    trace.check(BRAKING);
    let last = trace.positions.last().unwrap();
    let expected = last_commanded(&std::fs::read_to_string(table).unwrap());
    for (axis, (at, expected)) in last.iter().zip(expected).enumerate() {
        assert!((at - expected).abs() < 1e-3, "{axis}: {at} {expected}");
    }
    println!("{:?}", trace.extremes());
}

/// Returns the last commanded positions of the joints in a recording.
fn last_commanded(table: &str) -> Vec<f64> {
    let lines = table.lines().rev();
    let lines = lines.filter(|line| line.contains("joint.commanded_position["));
    let values = lines.map(|line| line.split(',').nth(2).unwrap().parse().unwrap());
    let mut last: Vec<f64> = values.take(6).collect();
    last.reverse();
    last
}

/// A failure: the command for the controller, the error of the device, and the command of the operator afterwards.
type FailureCase = (&'static str, &'static str, &'static str);

const FAILURES: &[FailureCase] = &[
    ("drop", "connection-lost", ""),
    ("protective", "protective-stop", "unlock"),
    ("stall 1500", "connection-lost", ""),
    ("stop", "controller-stopped", ""),
    ("pause", "protective-stop", "unlock"),
    ("deaf 500", "controller-stopped", ""),
    ("estop", "emergency-stop", "unlock"),
];

/// Lets a failure happen while the task moves the arm. Checks that it is reported once, that the task ends, and that the error
/// ends.
fn fail(controller: &mut Fake, server: &Server<'_>, failure: &FailureCase) {
    let (cause, error, remedy) = failure;
    let before = server.errors().len();
    controller.command(&format!("when-moving {cause}"));
    let client = server.start_task();
    controller.wait_for(&format!("DONE {cause}"));
    let text = output_text(&client.wait_with_output().unwrap());
    assert!(text.contains("arm_error"), "{cause}: {text}");
    if !remedy.is_empty() {
        // Without the operator, the driver never starts its program again.
        let known = controller.log.len();
        thread::sleep(Duration::from_millis(800));
        controller.command(remedy);
        controller.wait_for(&format!("DONE {remedy}"));
        let events = &controller.log[known..];
        let is_start = |event: &String| event.starts_with("PROGRAM rpi");
        assert!(!events.iter().any(is_start), "{events:?}");
    }
    server.wait_for_recovery();
    let errors = server.errors();
    assert_eq!(errors[before..], [*error, "ok"], "{cause}");
}

#[test]
fn each_failure_is_reported_and_ends_at_rest_and_the_next_command_runs() {
    let Some(mut controller) = Fake::start("failures by RTDE") else {
        return;
    };
    let project = Project::new(controller.ports);
    let server = project.serve();
    for failure in FAILURES {
        fail(&mut controller, &server, failure);
    }
    let text = server.run_task();
    server.kill();
    let trace = controller.end();
    assert!(text.contains("done"), "{text}\n{}", trace.log);
    trace.check(SAFE_STOP);
    println!("{:?}\n{}", trace.extremes(), trace.log);
}

/// Stops that the driver causes brake within the limits of the arm.
#[test]
fn a_killed_program_leaves_the_arm_at_rest_and_the_next_run_succeeds() {
    let Some(mut controller) = Fake::start("a killed program by RTDE") else {
        return;
    };
    let project = Project::new(controller.ports);
    let mut real = project
        .command("real.toml", &["--real-time"])
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    // Without an effect, but its answer shows that the arm moves.
    controller.command("when-moving loss 0");
    controller.wait_for("DONE loss");
    real.kill().unwrap();
    real.wait().unwrap();
    controller.wait_for("MESSAGE RPI: set-points are missing");
    let (code, text) = project.run_real();
    let trace = controller.end();
    assert_eq!(code, Some(0), "{text}\n{}", trace.log);
    trace.check(BRAKING);
}

#[test]
fn a_controller_that_cannot_follow_is_reported_with_a_way_out() {
    let absent = Project::new([1, 1]);
    let (code, text) = absent.run_real();
    assert_eq!(code, Some(2), "{text}");
    assert!(text.contains("cannot connect to 127.0.0.1:1"), "{text}");
    let simulated = absent.command("real.toml", &[]).output().unwrap();
    let text = output_text(&simulated);
    assert!(text.contains("--real-time"), "{text}");
    let cell = absent.path("real.toml");
    let checked = rpi(&["cell", "check", cell.to_str().unwrap()]);
    assert!(checked.status.success(), "{}", output_text(&checked));

    let Some(mut controller) = Fake::start("errors of a controller by RTDE") else {
        return;
    };
    let project = Project::new(controller.ports);
    controller.command("protective");
    let (code, text) = project.run_real();
    assert_eq!(code, Some(2), "{text}");
    assert!(text.contains("unlock it at the pendant"), "{text}");
    controller.command("unlock");
    let other = claim_register(controller.ports[0]);
    let (code, text) = project.run_real();
    assert_eq!(code, Some(2), "{text}");
    assert!(
        text.contains("another client of the controller writes `input_int_register_24`"),
        "{text}"
    );
    drop(other);
    assert!(controller.end().rests);
}

/// Connects as another client that writes a register of the driver.
fn claim_register(port: u16) -> TcpStream {
    let mut stream = TcpStream::connect(("127.0.0.1", port)).unwrap();
    let name = b"input_int_register_24";
    let mut package = vec![0, 3 + name.len() as u8, b'I'];
    package.extend(name);
    stream.write_all(&package).unwrap();
    let mut answer = [0; 9];
    stream.read_exact(&mut answer).unwrap();
    assert_eq!(&answer, b"\0\x09I\x01INT32");
    stream
}

/// Interruptions at 2.8 rad/s: no states, and no set-points. After the longest, the set-points are too far away to rejoin them.
const INTERRUPTIONS: &[(&str, bool)] =
    &[("stall 150", true), ("deaf 80", true), ("deaf 190", false)];

#[test]
fn interruptions_of_a_fast_motion_leave_the_arm_within_its_limits() {
    for (interruption, is_bridged) in INTERRUPTIONS {
        let Some(mut controller) = Fake::start("interruptions by RTDE") else {
            return;
        };
        let project = Project::fast(controller.ports);
        controller.command(&format!("when-faster 2.7 {interruption}"));
        let (code, text) = project.run_real();
        let trace = controller.end();
        let succeeded = code == Some(0);
        assert_eq!(
            succeeded, *is_bridged,
            "{interruption}: {text}\n{}",
            trace.log
        );
        trace.check(BRAKING);
        println!("{interruption}: {:?}", trace.extremes());
    }
}

/// Program of an operator, which uses no registers.
const FOREIGN: &str = "def operators_program():\n  while True:\n    sync()\n  end\nend\n";

#[test]
fn a_foreign_program_is_left_alone_though_the_registers_are_those_of_a_program_of_the_driver() {
    let Some(mut controller) = Fake::start("a foreign program by RTDE") else {
        return;
    };
    let project = Project::fast(controller.ports);
    let (code, text) = project.run_real();
    assert_eq!(code, Some(0), "{text}");
    let mut pendant = TcpStream::connect(("127.0.0.1", controller.ports[1])).unwrap();
    pendant.write_all(FOREIGN.as_bytes()).unwrap();
    controller.wait_for("PROGRAM operators_program");
    let known = controller.log.len();
    let (code, text) = project.run_real();
    assert_eq!(code, Some(2), "{text}");
    assert!(text.contains("another program runs"), "{text}");
    let log = controller.end().log;
    let later: Vec<&str> = log.lines().skip(known).collect();
    assert!(!later.iter().any(|l| l.contains("PROGRAM")), "{later:?}");
}

#[test]
fn a_program_that_was_paused_does_not_move_the_arm_to_an_old_set_point() {
    let Some(mut controller) = Fake::start("a pause by RTDE") else {
        return;
    };
    let project = Project::fast(controller.ports);
    // Without the end of the epoch by the driver, only the program itself can know of the pause.
    controller.command("when-faster 2.7 deaf 5000");
    controller.command("when-faster 2.0 pause");
    let (code, text) = project.run_real();
    assert_ne!(code, Some(0), "{text}");
    assert!(text.contains("protective-stop"), "{text}");
    thread::sleep(Duration::from_millis(300));
    controller.command("unlock");
    let line = controller.wait_for("DONE unlock at ");
    let time: f64 = line.split(' ').nth(3).unwrap().parse().unwrap();
    let trace = controller.end();
    let after = &trace.positions[(time / CYCLE) as usize..];
    let moved = after.iter().map(|at| (at[0] - after[0][0]).abs());
    let moved = moved.fold(0.0, f64::max);
    assert!(moved < 1e-3 && after.len() > 100, "{moved}\n{}", trace.log);
}

#[test]
fn a_reduced_speed_ends_a_motion() {
    let Some(mut controller) = Fake::start("a reduced speed by RTDE") else {
        return;
    };
    let project = Project::fast(controller.ports);
    controller.command("when-faster 2.7 scale 0.5");
    let (code, text) = project.run_real();
    let trace = controller.end();
    assert_ne!(code, Some(0), "{text}");
    assert!(text.contains("controller-stopped"), "{text}");
    trace.check(BRAKING);
}

/// 60 s at the rate of the controller with losses, in which all failures happen in turn: the acceptance test of the driver.
///
/// `cargo test -p rpi --test rtde -- --ignored --nocapture` prints its figures.
#[test]
#[ignore = "takes a minute"]
fn a_minute_with_losses_and_failures() {
    let Some(mut controller) = Fake::start("a minute by RTDE") else {
        return;
    };
    let project = Project::new(controller.ports);
    controller.command("loss 0.01");
    let server = project.serve();
    let begin = Instant::now();
    let (mut done, mut failed) = (0, 0);
    for failure in FAILURES.iter().cycle() {
        fail(&mut controller, &server, failure);
        failed += 1;
        if begin.elapsed() > Duration::from_secs(55) {
            break;
        }
        if failed % 2 == 0 {
            let text = server.run_task();
            assert!(text.contains("done"), "{text}\n{:#?}", controller.log);
            done += 1;
        }
    }
    let text = server.run_task();
    assert!(text.contains("done"), "{text}\n{:#?}", controller.log);
    server.kill();
    let elapsed = begin.elapsed().as_secs_f64();
    let trace = controller.end();
    trace.check(SAFE_STOP);
    let cycles = trace.positions.len();
    println!(
        "{elapsed:.1} s, {cycles} cycles of the controller ({:.1} s), {failed} failures, {} tasks done, {:?}",
        cycles as f64 * CYCLE,
        done + 1,
        trace.extremes()
    );
}
