//! Runs every entry point within its budget on all seeds, all inputs found by fuzzers, and mutated seeds. A single
//! test, because tests in one process would share the memory counter.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};

use rpi_fuzz::{ENTRIES, Entry, Mutator, Seed, run, saved_inputs};
use rpi_testkit::{files_below, workspace_root};

/// Number of mutated seeds per entry point, and the time limit for them. `RPI_MUTATIONS=100000` makes a longer run.
const MUTATIONS: usize = 400;
const TIME: Duration = Duration::from_secs(2);

#[test]
fn no_input_makes_an_entry_panic_hang_or_take_memory_without_end() {
    for entry in ENTRIES {
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
    let requested = std::env::var("RPI_MUTATIONS")
        .ok()
        .and_then(|n| n.parse().ok());
    let (mut mutator, began) = (Mutator::new(1), Instant::now());
    for k in 0..requested.unwrap_or(MUTATIONS) {
        let input = mutator.next(seeds);
        stands(entry, &format!("mutation {k}"), &input);
        if requested.is_none() && began.elapsed() > TIME {
            break;
        }
    }
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
