//! The debugger shows the same bits wherever it comes from: forwards, backwards, or from far away.

mod support;

use std::collections::hash_map::DefaultHasher;
use std::hash::{Hash, Hasher};
use std::path::Path;

use rpi_debug::{Debugger, RecordedProgram, Stop};
use rpi_record::mcap::Recording;
use support::rpi_texts;

/// Records a run of a program and opens it in the debugger twice.
fn opened(program: &Path, folder: &Path) -> [Debugger; 2] {
    let file = folder.join("run.mcap");
    let (name, path) = (program.to_str().unwrap(), file.to_str().unwrap());
    let (status, _, message) = rpi_texts(&["run", name, "--record", path]);
    assert_eq!(status, 0, "{message}");
    [(); 2].map(|()| {
        let recording = Recording::open(&file).unwrap();
        let program = RecordedProgram::new(&recording, None).unwrap();
        Debugger::new(recording, program).unwrap()
    })
}

/// Returns a number that depends on every bit of the values at a stop.
fn digest(stop: &Stop) -> u64 {
    let mut hasher = DefaultHasher::new();
    stop.tick.hash(&mut hasher);
    for command in &stop.commands {
        (command.id.to_number(), command.cycle).hash(&mut hasher);
        (&command.values, &command.active).hash(&mut hasher);
    }
    hasher.finish()
}

#[test]
fn each_cycle_has_the_same_values_from_everywhere() {
    let folder = tempfile::tempdir().unwrap();
    let program = rpi_testkit::workspace_root().join("examples/lifting/lifting.rpi");
    let [mut forwards, mut jumping] = opened(&program, folder.path());
    let first = forwards.stop().tick;
    let mut digests = vec![digest(forwards.stop())];
    while forwards.go_to(forwards.stop().tick + 1).unwrap() {
        digests.push(digest(forwards.stop()));
    }
    let count = digests.len() as u64;
    assert!(count > 2500, "there are checkpoints on the way: {count}");
    let mut random = 0x9e37_79b9_7f4a_7c15_u64;
    for _ in 0..60 {
        random ^= random << 13;
        random ^= random >> 7;
        random ^= random << 17;
        let tick = first + random % count;
        assert!(jumping.go_to(tick).unwrap());
        assert_eq!(jumping.stop().tick, tick);
        assert_eq!(
            digest(jumping.stop()),
            digests[(tick - first) as usize],
            "tick {tick}"
        );
    }
    assert!(!jumping.go_to(u64::MAX).unwrap(), "there is an end");
    assert_eq!(digest(jumping.stop()), *digests.last().unwrap());
}
