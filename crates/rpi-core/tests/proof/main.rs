//! Model checking of the switching protocol: three commands, two actuators, every order of requests and every
//! behaviour. The core itself is the transition function; stateright searches the states.
//!
//! A state is the observable state of the core and its devices between two ticks. It is reached again by replaying the
//! actions that led to it, so that the checked code is the code that runs.

#[path = "../model/cell.rs"]
#[allow(dead_code)]
mod cell;
mod core_under_test;

use core_under_test::{Action, CoreUnderTest, Snapshot};
use stateright::{Checker, Model, Property};

/// Bounds of the search: number of ticks and number of rules.
const TICKS: u64 = 2;
const RULES: usize = 2;

struct Switching;

impl Model for Switching {
    type State = Snapshot;
    type Action = Action;

    fn init_states(&self) -> Vec<Snapshot> {
        vec![CoreUnderTest::new().snapshot(Vec::new(), None)]
    }

    fn actions(&self, state: &Snapshot, actions: &mut Vec<Action>) {
        actions.extend(Action::all().filter(|action| state.offers(action)));
    }

    fn next_state(&self, state: &Snapshot, action: Action) -> Option<Snapshot> {
        let mut world = CoreUnderTest::new();
        state
            .path()
            .iter()
            .for_each(|action| world.carry_out(*action));
        let wrong = world.check(action);
        let path = state.path().iter().copied().chain([action]).collect();
        Some(world.snapshot(path, wrong))
    }

    fn properties(&self) -> Vec<Property<Self>> {
        vec![
            Property::always("B1: what moves is held by who runs", |_, s: &Snapshot| {
                s.moving_is_held()
            }),
            Property::always("R1: no resource is held twice", |_, s: &Snapshot| {
                s.is_exclusive()
            }),
            Property::always("S2: no request and no switch is lost", |_, s: &Snapshot| {
                s.wrong().is_none()
            }),
            Property::always("S7: who waits can still be started", |_, s: &Snapshot| {
                s.nobody_waits_in_vain()
            }),
            Property::always(
                "L3: who does not wait or run holds nothing",
                |_, s: &Snapshot| s.idle_hold_nothing(),
            ),
            Property::sometimes("a takeover in motion", |_, s: &Snapshot| s.saw_takeover()),
            Property::sometimes("a device brakes", |_, s: &Snapshot| s.saw_braking()),
            Property::sometimes("a loser is dropped", |_, s: &Snapshot| s.saw_loser()),
        ]
    }

    fn within_boundary(&self, state: &Snapshot) -> bool {
        state.ticks() <= TICKS && state.rules_made() <= RULES
    }
}

/// M11.3.
#[test]
fn the_switching_protocol_holds_in_all_states() {
    let checker = Switching.checker().threads(2).spawn_bfs().join();
    println!(
        "{} states, {} of them different",
        checker.state_count(),
        checker.unique_state_count()
    );
    checker.assert_properties();
    assert!(
        checker.unique_state_count() > 5_000,
        "too few to say anything"
    );
}
