//! Speed through corners: as fast as the curvature allows, within the bounds of the tool.

use crate::{Followed, PERIOD, corner, speed_of_formula};
use rpi_kin::state_to_rest::Bounds;
use rpi_kin::{ArmModel, AxisLimits, InverseKinematics, Pose, models};
use rpi_motion::{Arm, Controls, JointState, MotionCore, Path};

#[path = "../support/xorshift.rs"]
mod xorshift;

use xorshift::Random;

/// How much longer the links of the arm are than those of a KR 6: so, wide zones have long sides.
const SCALE: f64 = 12.0;

/// A large arm whose axes are fast enough to leave the limits to the tool.
fn large_arm() -> Arm {
    let small = &models::kuka_kr::KR_6_R900;
    let InverseKinematics::Opw(mut lengths) = small.inverse else {
        unreachable!("a KR 6 has a spherical wrist")
    };
    for length in [
        &mut lengths.a1,
        &mut lengths.a2,
        &mut lengths.b,
        &mut lengths.c1,
        &mut lengths.c2,
        &mut lengths.c3,
        &mut lengths.c4,
    ] {
        *length *= SCALE;
    }
    let mut chain = small.chain;
    let longer = chain.links.iter().map(|link| {
        let mut link = *link;
        (link.a, link.d) = (link.a * SCALE, link.d * SCALE);
        link
    });
    chain.links = Box::leak(longer.collect::<Vec<_>>().into_boxed_slice());
    let limits = small.limits.iter().map(|limits| AxisLimits {
        position: limits.position,
        ..limits.with_acceleration_and_jerk(1e4, 1e6)
    });
    let limits: Vec<_> = limits.collect();
    let model = ArmModel {
        chain,
        inverse: InverseKinematics::Opw(lengths),
        ..*small
    };
    Arm::new(Box::leak(Box::new(model)), Pose::identity(), &limits)
}

/// A corner with sides that are long enough, and the shares of the speed asked before and in it.
#[derive(Debug)]
struct Case {
    turn: f64,
    zone: f64,
    requested: Bounds,
    /// Share of the asked speed at first.
    before: f64,
}

fn case(random: &mut Random) -> Case {
    let zone = 1e-3 * rpi_math::pow(200.0, random.unit());
    // Slow motions through wide zones take minutes, and never bind.
    let slowest = (zone / 4.0).max(1e-3);
    let speed = slowest * rpi_math::pow(2.0 / slowest, random.unit());
    let (acceleration, jerk) = match random.unit() {
        share if share < 0.5 => (0.5, 5.0),
        share if share < 0.75 => (5.0, 100.0),
        _ => (random.between(0.3, 8.0), random.between(3.0, 150.0)),
    };
    Case {
        turn: random.between(30.0, 150.0).to_radians(),
        zone,
        requested: Bounds {
            speed,
            acceleration,
            jerk,
        },
        before: if random.unit() < 0.5 {
            1.0
        } else {
            random.between(0.3, 1.0)
        },
    }
}

/// Distance in which a tool comes to a speed from rest: that of a change of speed with bounded acceleration and jerk.
fn distance_to(speed: f64, bounds: &Bounds) -> f64 {
    let ramp = bounds.acceleration / bounds.jerk;
    let time = if speed > bounds.acceleration * ramp {
        speed / bounds.acceleration + ramp
    } else {
        2.0 * (speed / bounds.jerk).sqrt()
    };
    speed * time / 2.0
}

fn follow(arm: &Arm, case: &Case) -> Followed {
    let joints = [0.1, -1.6, 1.9, 0.2, 0.6, 0.1, 0.0];
    let start = arm.forward(&joints);
    let probe = corner(&start, 3.0 * case.zone, case.turn, case.zone, 0.0);
    let inside = (2.0 * case.zone, probe.length() - 2.0 * case.zone);
    let allowed = speed_of_formula(&Path::Tool(probe), inside, &case.requested);
    let distance = distance_to(allowed, &case.requested);
    let side = 2.0 * case.zone + 2.0 * distance + 0.002;
    let path = corner(&start, side, case.turn, case.zone, (2.0 * side).min(0.1));
    let (low, high) = (side - case.zone, path.length() - (side - case.zone));
    let mut core = MotionCore::new(*arm, PERIOD);
    core.begin(
        Path::Tool(path),
        &JointState::at_rest(joints),
        case.requested,
    )
    .expect("reachable");
    let mut followed = Followed::new(start.translation.vector, allowed);
    let mut at_place = 0.0;
    for _ in 0..100_000 {
        let controls = Controls {
            speed_share: if at_place < distance / 2.0 {
                case.before
            } else {
                1.0
            },
            ..Controls::default()
        };
        let at = core.next_set_point(controls).expect("on the path");
        at_place = at.path.s;
        followed.push(&arm.forward(&at.joints), &case.requested);
        if at.path.s > low && at.path.s < high {
            followed.slowest = followed.slowest.min(at.path.velocity);
        }
        if at.path.s > high + 0.5 * case.zone {
            return followed;
        }
    }
    panic!("not done: {case:?} at {:?}", core.path_error());
}

#[test]
fn corners_are_passed_at_the_speed_that_their_curvature_allows() {
    let count = std::env::var("RPI_CORNERS").map_or(60, |text| text.parse().expect("a number"));
    let arm = large_arm();
    let mut random = Random::new(5);
    let (mut lowest, mut worst, mut sum) = (f64::INFINITY, [0.0f64; 3], 0.0);
    for number in 0..count {
        let case = case(&mut random);
        let followed = follow(&arm, &case);
        let share = followed.slowest / followed.allowed;
        println!("{number} {share:.4} {:.5?} {case:?}", followed.worst);
        lowest = lowest.min(share);
        sum += share;
        for (most, own) in worst.iter_mut().zip(followed.worst) {
            *most = most.max(own);
        }
    }
    println!(
        "lowest {lowest:.4} mean {:.4} worst {worst:?}",
        sum / f64::from(count)
    );
    assert!(lowest >= 0.95, "{lowest}");
    assert!(worst.iter().all(|worst| *worst <= 1.0001), "{worst:?}");
}
