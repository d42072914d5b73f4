//! Takeovers at random moments between motions of all kinds keep every limit of every axis, and every motion arrives.
//!
//! `RPI_TAKEOVERS` sets the number of chains for each arm, `RPI_SEED` the first seed (defaults: a smoke for CI), `RPI_ARM`
//! a part of the name of the only arms to be tested.

mod brute_force;
mod controls;
mod dropped;
mod duration;
mod places;
mod random;
mod range_ends;
mod refusals;
mod states;
mod tilted;
mod watch;

use nalgebra::Vector3;
use random::{KINDS, Kind, Random};
use rpi_kin::state_to_rest::Bounds;
use rpi_kin::{ArmModel, Pose, models};
use rpi_motion::{Arm, Controls, JointState, Joints, MotionCore, Path, check_path, path_start};
use rpi_testkit::no_alloc;
use watch::{PERIOD, ToolWatch, Watch};

rpi_testkit::trap_allocations!();

pub(crate) const ARMS: [&ArmModel; 4] = [
    &models::kuka_lbr::LWR_4_PLUS,
    &models::kuka_kr::KR_6_R900,
    &models::universal_robots::UR5E,
    &models::kuka_lbr::IIWA_7,
];

/// Takeovers of one chain, and of one with a new motion every few cycles.
const CHAIN: usize = 10;
const QUICK_CHAIN: usize = 60;

/// Rule for the number of cycles between two takeovers of a chain.
type Cycles = fn(&mut Random) -> usize;

/// Rule for the tool of the next motion, as a pose in the flange frame.
type Tools = fn(&mut Random) -> Pose;

fn no_tool(_: &mut Random) -> Pose {
    Pose::identity()
}

/// One of a few tools, so that some motions have the tool of the motion before.
fn some_tool(random: &mut Random) -> Pose {
    let tip = |x: f64, z: f64, turn: f64| {
        Pose::new(Vector3::new(x, 0.0, z), Vector3::new(0.0, turn, 0.0))
    };
    [Pose::identity(), tip(0.0, 0.15, 0.0), tip(0.08, 0.12, 0.6)][random.below(3)]
}

fn any(random: &mut Random) -> usize {
    match random.unit() < 0.4 {
        true => 1 + random.below(20),
        false => 1 + random.below(800),
    }
}

fn few(random: &mut Random) -> usize {
    1 + random.below(50)
}

pub(crate) fn number(name: &str, default: u64) -> u64 {
    std::env::var(name).map_or(default, |text| text.parse().expect("a number"))
}

#[derive(Default, Debug)]
struct Counts {
    takeovers: usize,
    refused_by_check: usize,
    checked: usize,
    over_limits: usize,
    not_arrived: usize,
    /// Takeovers on to a path of the tool in motion, and those of them within the bounds of the tool.
    entered: usize,
    within_tool_bounds: usize,
    worst: [f64; 3],
    deviation: f64,
    /// Largest speed, acceleration and jerk of the tool on a path, as shares of the requested ones.
    tool: [f64; 3],
}

/// A motion that is to take over: its path, the joints at its start, and the bounds of the tool.
struct Motion {
    path: Path,
    start: Joints,
    requested: Bounds,
}

/// A motion that the check accepts, from where the arm is or, in half of the tries, from where it can stop.
fn motion(
    model: &ArmModel,
    arm: &Arm,
    state: &JointState,
    random: &mut Random,
    counts: &mut Counts,
) -> Option<Motion> {
    for _ in 0..200 {
        let kind = KINDS[random.below(KINDS.len())];
        let same = random.clone();
        let Some(mut path) = random::path(model, arm, kind, &state.position, random) else {
            continue;
        };
        let mut start = state.position;
        if random.unit() < 0.5 {
            start = path_start(arm, state, &path);
            // The same way, from another start.
            let Some(moved) = random::path(model, arm, kind, &start, &mut same.clone()) else {
                continue;
            };
            path = moved;
        }
        let default = random.unit() < 0.3;
        let requested = random::requested(kind, random, default);
        counts.checked += usize::from(kind == Kind::Line);
        if check_path(arm, path, &start, requested).is_ok() {
            return Some(Motion {
                path,
                start,
                requested,
            });
        }
        counts.refused_by_check += usize::from(kind == Kind::Line);
    }
    None
}

fn chain(
    model: &'static ArmModel,
    seed: u64,
    (length, wait, tools): (usize, Cycles, Tools),
    counts: &mut Counts,
) {
    let mut arm = Arm::new(model, Pose::identity(), &[]);
    let mut random = Random::new(seed);
    let mut watch = Watch::standing(&random::joints(model, &mut random));
    let mut core = MotionCore::new(arm, PERIOD);
    let mut state = watch.state();
    for number in 0..length {
        arm.set_tool(tools(&mut random));
        let Some(Motion {
            path,
            start,
            requested,
        }) = motion(model, &arm, &state, &mut random, counts)
        else {
            return;
        };
        no_alloc(|| {
            core.set_tool(arm.tool());
            core.begin_at(path, &start, &state, requested)
        })
        .expect("the check accepted it");
        counts.takeovers += 1;
        let cycles = match number + 1 == length {
            true => 60_000,
            false => wait(&mut random),
        };
        let goal = (&path, requested);
        let arrived = run(&mut core, &arm, goal, &mut watch, cycles, counts);
        state = no_alloc(|| core.state());
        if number + 1 == length && !arrived {
            counts.not_arrived += 1;
            println!(
                "not arrived: {} seed {seed}: {:?}",
                model.id,
                core.path_error()
            );
        }
        if !watch.is_within() {
            println!(
                "over: {} seed {seed} motion {number} {:?} {}",
                model.id, watch.worst, watch.out_of_range
            );
            break;
        }
    }
    counts.over_limits += usize::from(!watch.is_within());
    for (most, worst) in counts.worst.iter_mut().zip(watch.worst) {
        *most = most.max(worst);
    }
}

fn run(
    core: &mut MotionCore,
    arm: &Arm,
    (path, requested): (&Path, Bounds),
    watch: &mut Watch,
    cycles: usize,
    counts: &mut Counts,
) -> bool {
    let mut was_on_path = false;
    let mut tool = ToolWatch::default();
    for time in 0..cycles {
        let at =
            no_alloc(|| core.next_set_point(Controls::default())).expect("the path was checked");
        watch.push(arm, &at.joints);
        if at.on_path
            && let Path::Tool(path) = path
        {
            let off = arm.forward(&at.joints).translation.vector
                - path.pose(at.path.s).translation.vector;
            counts.deviation = counts.deviation.max(off.norm());
            tool.push(arm.forward(&at.joints).translation.vector);
            for (worst, share) in counts.tool.iter_mut().zip(tool.shares(requested)) {
                *worst = worst.max(share);
            }
        }
        if at.on_path && !was_on_path {
            was_on_path = true;
            if time > 1 && matches!(path, Path::Tool(_)) {
                counts.entered += 1;
                let shares = core.tool_shares_on_entry();
                counts.within_tool_bounds += usize::from(shares.iter().all(|share| *share < 1.01));
            }
        }
        if at.done {
            return true;
        }
    }
    false
}

fn run_chains(chains: u64, length: usize, wait: Cycles, tools: Tools) {
    let first = number("RPI_SEED", 1);
    let arm = std::env::var("RPI_ARM").unwrap_or_default();
    for model in ARMS.into_iter().filter(|model| model.id.contains(&arm)) {
        let mut counts = Counts::default();
        let kind = (length, wait, tools);
        (first..first + chains).for_each(|seed| chain(model, seed, kind, &mut counts));
        println!("{}: {counts:?}", model.id);
        assert_eq!(
            (counts.over_limits, counts.not_arrived),
            (0, 0),
            "{}: {counts:?}",
            model.id
        );
        assert!(counts.deviation < 1e-9, "{}: {counts:?}", model.id);
        // A part of a millionth is noise of the third differences of the positions.
        let is_within = counts.tool.iter().all(|share| *share < 1.0 + 2e-6);
        assert!(is_within, "{}: {counts:?}", model.id);
        assert!(counts.takeovers > 0);
    }
}

#[test]
fn takeovers_at_random_moments_keep_every_limit() {
    run_chains(number("RPI_TAKEOVERS", 50), CHAIN, any, no_tool);
}

/// Another tool moves along the path of the next motion, from any state of the arm.
#[test]
fn takeovers_between_tools_keep_every_limit() {
    run_chains(number("RPI_TAKEOVERS", 50) / 2, CHAIN, any, some_tool);
}

/// A motion of a tool is that of an arm with this tool of its own, to the last bit.
#[test]
fn a_tool_of_the_motion_is_as_a_tool_of_the_arm() {
    for model in ARMS {
        let mut random = Random::new(5);
        let tool = Pose::new(Vector3::new(0.05, 0.0, 0.1), Vector3::new(0.3, 0.2, 0.0));
        let arm = Arm::new(model, tool, &[]);
        let state = Watch::standing(&random::joints(model, &mut random)).state();
        let mut counts = Counts::default();
        let Some(motion) = motion(model, &arm, &state, &mut random, &mut counts) else {
            continue;
        };
        let mut own = MotionCore::new(arm, PERIOD);
        let mut set = MotionCore::new(Arm::new(model, Pose::identity(), &[]), PERIOD);
        set.set_tool(tool);
        for core in [&mut own, &mut set] {
            let begun = core.begin_at(motion.path, &motion.start, &state, motion.requested);
            begun.expect("the check accepted it");
        }
        for _ in 0..500 {
            let [one, other] =
                [&mut own, &mut set].map(|core| core.next_set_point(Controls::default()));
            assert_eq!(
                one.expect("checked").joints,
                other.expect("checked").joints,
                "{}",
                model.id
            );
        }
    }
}

/// At a point of a spline the third derivatives of the axes jump. Between two nodes beside such a point, the jerk of an axis
/// was once over its limit.
#[test]
fn the_jerk_of_the_axes_is_kept_at_the_points_of_a_spline() {
    let mut counts = Counts::default();
    chain(
        &models::kuka_lbr::IIWA_7,
        1_000_336,
        (CHAIN, any, no_tool),
        &mut counts,
    );
    assert_eq!(
        (counts.over_limits, counts.takeovers),
        (0, CHAIN),
        "{counts:?}"
    );
}

#[test]
fn takeovers_in_quick_succession_keep_every_limit() {
    run_chains(number("RPI_TAKEOVERS", 50) / 25, QUICK_CHAIN, few, no_tool);
}
