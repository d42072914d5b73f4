//! The core and an independent model of the manual's rules, on random histories: loads, starts, rules, cancels, aborts,
//! device faults, lost clients. After each step they must agree on every state, resource and cycle number.

mod cell;
mod expr;
mod history;
mod model;
mod steps;

use history::CoreAndModel;
use proptest::prelude::*;
use steps::{Step, step};

rpi_testkit::trap_allocations!();

/// Number of histories. `cargo xtask soak` sets a larger one.
fn histories() -> u32 {
    let requested = std::env::var("RPI_HISTORIES").ok();
    requested.and_then(|n| n.parse().ok()).unwrap_or(1000)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: histories(), max_shrink_iters: 20_000, ..ProptestConfig::default() })]

    #[test]
    fn core_and_model_agree(steps in prop::collection::vec(step(), 1..120)) {
        let mut pair = CoreAndModel::new();
        for step in &steps {
            pair.carry_out(step);
            pair.agree().map_err(|what| TestCaseError::fail(format!("after {step:?}: {what}")))?;
        }
    }
}

/// Checks that the random histories contain enough events to be a useful test.
#[test]
fn histories_are_eventful() {
    use proptest::strategy::ValueTree;
    let mut runner = proptest::test_runner::TestRunner::deterministic();
    let mut tally = history::EventCounts::default();
    for _ in 0..200 {
        let steps: Vec<Step> = prop::collection::vec(step(), 100)
            .new_tree(&mut runner)
            .expect("it can be made")
            .current();
        let mut pair = CoreAndModel::new();
        steps.iter().for_each(|step| pair.carry_out(step));
        tally.add(&pair.tally);
    }
    assert!(tally.is_eventful(), "{tally:?}");
}
