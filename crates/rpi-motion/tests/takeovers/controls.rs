//! Override, pause and cancel at random moments: on the undisturbed path, within all limits, and to the end or to rest.

use crate::random::{self, KINDS, Kind, Random};
use crate::watch::{PERIOD, Watch};
use crate::{ARMS, number};
use rpi_kin::state_to_rest::Bounds;
use rpi_kin::{ArmModel, Pose};
use rpi_motion::{Arm, Controls, Joints, MotionCore, Path, SetPoint, check_path};
use rpi_testkit::no_alloc;

/// Random controls, and the cycle until which they hold.
fn changed(cycle: usize, random: &mut Random) -> (usize, Controls) {
    // Every few cycles: as if most plans came too late.
    let often = random.unit() < 0.5;
    let until = cycle + 1 + random.below(if often { 4 } else { 300 });
    // Undisturbed after 10 s, so that each motion ends.
    let calm = cycle > 10_000;
    let share = random.between(-0.1, 1.1).clamp(0.0, 1.0);
    let controls = Controls {
        speed_share: if calm { 1.0 } else { share },
        paused: !calm && random.unit() < 0.3,
    };
    (until, controls)
}

/// What happens to a motion besides random controls.
#[derive(Clone, Copy, Debug, PartialEq)]
enum End {
    /// It arrives at the end of its path.
    Arrives,
    /// It is cancelled in a cycle: the arm comes to rest on the path.
    CancelledIn(usize),
}

/// A random motion from rest that the check accepts; `None` if this try makes none.
fn checked_motion(
    model: &'static ArmModel,
    arm: &Arm,
    random: &mut Random,
) -> Option<(Path, Joints, Bounds)> {
    let start = random::joints(model, random);
    let kind = KINDS[random.below(KINDS.len())];
    let path = random::path(model, arm, kind, &start, random)?;
    let requested = random::requested(kind, random, false);
    check_path(arm, path, &start, requested).ok()?;
    Some((path, start, requested))
}

/// Positions along the path of an undisturbed motion with the joint positions there, by cycle.
fn undisturbed(mut core: MotionCore) -> Vec<(f64, Joints)> {
    let mut places = Vec::new();
    loop {
        let at = core
            .next_set_point(Controls::default())
            .expect("the path was checked");
        places.push((at.path.s, at.joints));
        assert!(places.len() < 200_000, "the undisturbed motion arrives");
        if at.done {
            return places;
        }
    }
}

/// Largest distance of `joints` from those of the undisturbed motion at the position `s` along the path, rad: from the
/// cubic through the four places around it.
fn distance(places: &[(f64, Joints)], s: f64, joints: &Joints) -> f64 {
    let behind = places.partition_point(|place| place.0 <= s);
    let first = behind.saturating_sub(2).min(places.len() - 4);
    let four = &places[first..first + 4];
    let weight = |k: usize| {
        let others = four.iter().enumerate().filter(|(other, _)| *other != k);
        others
            .map(|(_, other)| (s - other.0) / (four[k].0 - other.0))
            .product::<f64>()
    };
    let weights: [f64; 4] = core::array::from_fn(weight);
    let off = |axis: usize| {
        let there: f64 = (0..4).map(|k| weights[k] * four[k].1[axis]).sum();
        (there - joints[axis]).abs()
    };
    (0..joints.len()).map(off).fold(0.0, f64::max)
}

/// True if the four places around `s` lie as far apart as in motion: near to rest, rounding makes them useless.
fn is_in_motion(places: &[(f64, Joints)], s: f64) -> bool {
    /// Distance of two places of a slow motion, m or rad.
    const SLOW: f64 = 1e-5;
    let behind = places.partition_point(|place| place.0 <= s);
    let around = places.get(behind.wrapping_sub(2)..behind + 2);
    around.is_some_and(|four| four.windows(2).all(|two| two[1].0 - two[0].0 > SLOW))
}

/// One motion from rest under random controls, beside the same motion without any.
fn disturbed(model: &'static ArmModel, random: &mut Random) -> Option<()> {
    let arm = Arm::new(model, Pose::identity(), &[]);
    let (path, start, requested) = checked_motion(model, &arm, random)?;
    let mut watch = Watch::standing(&start);
    let mut core = MotionCore::new(arm, PERIOD);
    core.begin(path, &watch.state(), requested)
        .expect("the check accepted it");
    let places = undisturbed(core.clone());
    let end = match random.unit() < 0.3 {
        true => End::CancelledIn(random.below(places.len())),
        false => End::Arrives,
    };
    let mut controls = Controls::default();
    let (mut until, mut last) = (0, 0.0);
    for cycle in 0..200_000 {
        let is_cancelled = matches!(end, End::CancelledIn(from) if cycle >= from);
        if cycle >= until {
            (until, controls) = changed(cycle, random);
        }
        controls.paused |= is_cancelled;
        let at = no_alloc(|| core.next_set_point(controls)).expect("the path was checked");
        watch.push(&arm, &at.joints);
        assert!(watch.is_within(), "{} {path:?} {:?}", model.id, watch.worst);
        assert!(at.path.s >= last - 1e-12, "backwards: {last} {}", at.path.s);
        last = at.path.s;
        assert!(off_path(&arm, &path, &at) < 1e-9, "{} {path:?}", model.id);
        if is_in_motion(&places, at.path.s) {
            let off = distance(&places, at.path.s, &at.joints);
            assert!(off < 1e-6, "{} {path:?}: {off} rad at {last}", model.id);
        }
        if at.done || is_cancelled && at.path.velocity == 0.0 {
            return Some(());
        }
    }
    panic!("{} did not come to rest on {path:?}: {end:?}", model.id);
}

/// Distance of the tool from the path, m.
fn off_path(arm: &Arm, path: &Path, at: &SetPoint) -> f64 {
    let Path::Tool(tool) = path else { return 0.0 };
    let place = tool.pose(at.path.s).translation.vector;
    (arm.forward(&at.joints).translation.vector - place).norm()
}

#[test]
fn override_pause_and_cancel_keep_the_undisturbed_path_and_every_limit() {
    let count = number("RPI_DISTURBED", 125);
    let mut random = Random::new(number("RPI_SEED", 1));
    for model in ARMS {
        let mut done = 0;
        while done < count {
            done += u64::from(disturbed(model, &mut random).is_some());
        }
    }
}

#[test]
fn a_pause_ends_at_rest_and_stays_there() {
    let model = ARMS[1];
    let arm = Arm::new(model, Pose::identity(), &[]);
    let start = [0.1, -1.6, 1.9, 0.2, 0.6, 0.1, 0.0];
    let from = arm.forward(&start);
    let mut to = from;
    to.translation.vector.y += 0.2;
    let requested = random::requested(Kind::Line, &mut Random::new(1), true);
    let mut core = MotionCore::new(arm, PERIOD);
    core.begin(
        Path::line(&from, &to),
        &rpi_motion::JointState::at_rest(start),
        requested,
    )
    .expect("reachable");
    let mut cycles = |count: usize, paused: bool| {
        let controls = Controls {
            paused,
            ..Controls::default()
        };
        (0..count)
            .map(|_| core.next_set_point(controls).expect("on the path"))
            .last()
            .expect("a cycle")
    };
    let moving = cycles(500, false);
    assert!(moving.path.velocity > 0.1);
    let resting = cycles(2000, true);
    assert_eq!(
        (resting.path.velocity, resting.path.acceleration),
        (0.0, 0.0)
    );
    assert_eq!(cycles(100, true).joints, resting.joints);
    assert!(!resting.done && cycles(5000, false).done);
}
