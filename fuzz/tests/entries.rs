//! Runs every entry point within its budget on all seeds, all inputs found by fuzzers, and mutated seeds. A single
//! test, because tests in one process would share the memory counter.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};

use rpi_fuzz::{ENTRIES, Entry, Mutator, Seed, run, saved_inputs};
use rpi_testkit::{files_below, workspace_root};

/// Maximum number of mutated seeds per entry point, and the time limit for them. `RPI_SECONDS=3600` makes a run of this
/// time instead, `RPI_ENTRY=http` one with a single entry point.
const MUTATIONS: usize = 200;
const TIME: Duration = Duration::from_secs(1);

#[test]
fn no_input_makes_an_entry_panic_hang_or_take_memory_without_end() {
    let only = std::env::var("RPI_ENTRY").ok();
    let is_wanted = |entry: &&Entry| only.as_ref().is_none_or(|only| entry.name == only);
    for entry in ENTRIES.iter().filter(is_wanted) {
        let seeds = (entry.seeds)();
        assert!(seeds.len() > 10, "{}: too few seeds", entry.name);
        let kept = saved_inputs(entry.name);
        for seed in seeds.iter().chain(&kept) {
            stands(entry, &seed.name, &seed.bytes);
        }
        damaged(entry, &seeds);
    }
}

fn damaged(entry: &Entry, seeds: &[Seed]) {
    let seconds = std::env::var("RPI_SECONDS").ok();
    let seconds = seconds.and_then(|seconds| seconds.parse().ok());
    let (most, time) = match seconds {
        Some(seconds) => (usize::MAX, Duration::from_secs(seconds)),
        None => (MUTATIONS, TIME),
    };
    let (mut mutator, began, mut count) = (Mutator::new(1), Instant::now(), 0);
    while count < most && began.elapsed() < time {
        let input = mutator.next(seeds);
        stands(entry, &format!("mutation {count}"), &input);
        count += 1;
    }
    println!("{}: {count} mutations", entry.name);
}

fn stands(entry: &Entry, name: &str, input: &[u8]) {
    if catch_unwind(AssertUnwindSafe(|| run(entry.name, input))).is_err() {
        let path = std::env::temp_dir().join(format!("{}-found", entry.name));
        let kept = std::fs::write(&path, input).is_ok();
        panic!(
            "{} fails on {name}; input saved ({kept}): {}",
            entry.name,
            path.display()
        );
    }
}

#[test]
fn every_entry_has_a_fuzz_target() {
    let manifest =
        std::fs::read_to_string(workspace_root().join("fuzz/targets/Cargo.toml")).unwrap();
    let targets = files_below("fuzz/targets", &[".rs"]);
    assert_eq!(targets.len(), ENTRIES.len());
    for entry in ENTRIES {
        assert!(manifest.contains(&format!("name = \"{}\"", entry.name)));
        let target = workspace_root().join(format!("fuzz/targets/{}.rs", entry.name));
        let text = std::fs::read_to_string(target).unwrap();
        assert!(text.contains(&format!("rpi_fuzz::run(\"{}\"", entry.name)));
    }
}
