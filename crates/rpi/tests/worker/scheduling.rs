//! Scheduling of workers.

use std::path::Path;
use std::process::Command;

use rpi_testkit::report_skip;

use crate::client::{Scene, assert_loaded};
use crate::long;

/// Program that runs another one with real-time scheduling.
const CHRT: &str = "/usr/bin/chrt";

/// A worker that inherits the real-time scheduling of the server gives it up: it would compete with the cycle.
#[test]
fn a_worker_has_the_lowest_priority_whatever_it_inherits() {
    let is_granted = Command::new(CHRT).args(["-f", "10", "true"]).status();
    if !is_granted.is_ok_and(|status| status.success()) {
        report_skip("no real-time priority is granted, or `chrt` is missing");
        return;
    }
    let scene = Scene::with_workers(|workers| {
        let program = std::mem::replace(&mut workers.program, CHRT.into());
        let program = program.to_str().unwrap().to_owned();
        let inherit = ["-f".to_owned(), "10".to_owned(), program];
        workers.arguments.splice(0..0, inherit.map(Into::into));
    });
    let mut client = scene.client();
    client.begin_load(&long(50_000), "rpinet");
    let worker = scene.wait_for_workers(1)[0];
    let begin = std::time::Instant::now();
    while scheduling(worker) != Some((0, 19)) {
        assert!(begin.elapsed() < crate::client::PATIENCE);
        assert!(
            Path::new(&format!("/proc/{worker}")).exists(),
            "the worker has ended: it never had the lowest priority"
        );
    }
    assert_loaded(&client.receive());
}

/// Returns the scheduling policy (0: `SCHED_OTHER`, 1: `SCHED_FIFO`) and the nice value of a process; `None` if it has ended
/// (proc(5), fields 41 and 19).
fn scheduling(process: u32) -> Option<(u32, i32)> {
    let text = std::fs::read_to_string(format!("/proc/{process}/stat")).ok()?;
    let (_, fields) = text.rsplit_once(") ")?;
    let fields: Vec<&str> = fields.split(' ').collect();
    // The first two fields are before the bracket.
    Some((fields.get(38)?.parse().ok()?, fields.get(16)?.parse().ok()?))
}
