//! The core and an independent model of the manual's rules, on random histories: loads, starts, rules, cancels, aborts,
//! device faults, lost clients. After each step they must agree on every state, resource and cycle number.

mod cell;
mod expr;
mod history;
mod model;

use history::{CoreAndModel, Op, op};
use proptest::prelude::*;

rpi_testkit::trap_allocations!();

/// Number of histories. `cargo xtask soak` sets a larger one.
fn histories() -> u32 {
    let requested = std::env::var("RPI_HISTORIES").ok();
    requested.and_then(|n| n.parse().ok()).unwrap_or(1000)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: histories(), max_shrink_iters: 20_000, ..ProptestConfig::default() })]

    #[test]
    fn core_and_model_agree(ops in prop::collection::vec(op(), 1..120)) {
        let mut pair = CoreAndModel::new();
        for op in &ops {
            pair.carry_out(op);
            pair.agree().map_err(|what| TestCaseError::fail(format!("after {op:?}: {what}")))?;
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
        let ops: Vec<Op> = prop::collection::vec(op(), 100)
            .new_tree(&mut runner)
            .expect("it can be made")
            .current();
        let mut pair = CoreAndModel::new();
        ops.iter().for_each(|op| pair.carry_out(op));
        tally.add(&pair.tally);
    }
    assert!(tally.is_eventful(), "{tally:?}");
}
