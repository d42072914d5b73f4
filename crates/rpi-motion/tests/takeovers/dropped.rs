//! Takeovers of which plans are dropped, nodes come late and the work of a cycle ends at any number: every limit is kept
//! all the same, and every motion arrives once the core may work again.

use crate::random::{self, Random};
use crate::watch::{PERIOD, Watch};
use crate::{ARMS, Counts, Motion, any, motion, number};
use rpi_kin::{ArmModel, Pose};
use rpi_motion::{Arm, Controls, MotionCore, WorkBudget};
use rpi_testkit::no_alloc;

/// Share of the cycles that make no plan.
const DROPPED: f64 = 0.6;

/// A budget of random size: often nothing, or only a part of what a plan needs.
fn budget(random: &mut Random) -> WorkBudget {
    let full = WorkBudget::default();
    let mut part = |most: usize| match random.unit() {
        u if u < 0.4 => 0,
        u if u < 0.8 => random.below(most + 1),
        _ => most,
    };
    WorkBudget {
        nodes: part(full.nodes),
        nodes_at_takeover: part(full.nodes_at_takeover),
        samples: part(full.samples),
        set_points: part(full.set_points),
    }
}

/// One cycle with a random budget; in most of the cycles no plan is made.
fn starved_cycle(core: &mut MotionCore, random: &mut Random) -> rpi_motion::SetPoint {
    core.set_work_budget(budget(random));
    let controls = Controls {
        paused: random.unit() < DROPPED,
        ..Controls::default()
    };
    no_alloc(|| core.next_set_point(controls)).expect("the path was checked")
}

fn chain(model: &'static ArmModel, seed: u64) {
    let arm = Arm::new(model, Pose::identity(), &[]);
    let mut random = Random::new(seed);
    let mut watch = Watch::standing(&random::joints(model, &mut random));
    let mut core = MotionCore::new(arm, PERIOD);
    let mut state = watch.state();
    for _ in 0..8 {
        let next = motion(model, &arm, &state, &mut random, &mut Counts::default());
        let Some(Motion {
            path,
            start,
            requested,
        }) = next
        else {
            return;
        };
        no_alloc(|| core.begin_at(path, &start, &state, requested)).expect("the check accepted it");
        for _ in 0..any(&mut random) {
            let at = starved_cycle(&mut core, &mut random);
            watch.push(&arm, &at.joints);
        }
        state = core.state();
        assert!(
            watch.is_within(),
            "{} seed {seed}: {:?}",
            model.id,
            watch.worst
        );
    }
    core.set_work_budget(WorkBudget::default());
    let arrives = (0..60_000).any(|_| {
        let at = core
            .next_set_point(Controls::default())
            .expect("the path was checked");
        watch.push(&arm, &at.joints);
        at.done
    });
    assert!(arrives, "{} seed {seed}: {:?}", model.id, core.path_error());
    assert!(
        watch.is_within(),
        "{} seed {seed}: {:?}",
        model.id,
        watch.worst
    );
}

#[test]
fn dropped_plans_and_late_nodes_break_no_limit() {
    let (chains, first) = (number("RPI_TAKEOVERS", 50) / 5, number("RPI_SEED", 1));
    for model in ARMS {
        (first..first + chains).for_each(|seed| chain(model, seed));
    }
}
