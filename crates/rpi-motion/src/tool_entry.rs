//! Takeover on to a path within the bounds of the tool: planned ahead, and verified before it begins.
//!
//! While the verification runs, the arm follows its old motion. The joints of the whole connecting piece are computed
//! from the residual of the tool and the path, some in each cycle; their differences must keep the limits of the axes,
//! and those of the tool its bounds.

use crate::entry::along_path;
use crate::node_table::NodeTable;
use crate::path::Path;
use crate::plan::{Demand, allowed};
use crate::residual::Residual;
use crate::stop_margin::stopping_distances;
use crate::time_law::{HeldBrake, PathState};
use crate::tool_residual::{Difference, ToolResidual};
use crate::verify::Verifier;
use crate::{Arm, JointState, Joints};
use nalgebra::Vector3;
use rpi_kin::angle::nearest_turn;
use rpi_kin::rotation::rotation_vector;
use rpi_kin::state_to_rest::{Bounds, StateToRestProfile};
use rpi_kin::{MAX_AXES, Range};

/// Share of the requested acceleration and jerk of the tool that the motion along the path uses until the tool is on
/// the path.
const LAW: f64 = 0.5;

/// Share of the limits of the axes that the set-points of a takeover may use.
const USED: f64 = 0.98;

/// Maximum speed, acceleration and jerk of the tool during a takeover, as shares of the requested ones; the 0.2 %
/// beyond 1 are for rounding.
const TOOL: f64 = 1.002;

/// Time step of the finite differences that give velocity and acceleration of the difference between tool and path at
/// the start of a takeover, s.
const STEP: f64 = 1e-4;

/// Takeover on to a path within the requested bounds of the tool, which is verified over several cycles.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ToolEntry {
    pub residual: ToolResidual,
    pub law: HeldBrake,
    start_time: f64,
    /// Period of the set-points, s.
    period: f64,
    /// Number of set-points until the tool is on the path.
    count: usize,
    done: usize,
    last: [Joints; 4],
    places: [Vector3<f64>; 4],
}

/// Result of one cycle of the verification of a takeover.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verification {
    Running,
    Accepted,
    Rejected,
}

/// Situation in which a takeover is planned: arm, path, ranges of the axes, limits of the request, and period (s).
#[derive(Clone, Copy)]
pub(crate) struct Situation<'a> {
    pub arm: &'a Arm,
    pub table: &'a NodeTable,
    pub ranges: &'a [Range; MAX_AXES],
    pub demand: Demand,
    pub period: f64,
    /// Maximum number of set-points that are verified in a cycle.
    pub set_points: usize,
}

impl ToolEntry {
    /// Plans the takeover that begins at the time `time` of the motion (s), from the state of the arm and the last four
    /// set-points then. `None` if there is none.
    pub(crate) fn plan(
        of: &Situation<'_>,
        time: f64,
        state: &JointState,
        last: [Joints; 4],
    ) -> Option<Self> {
        let requested = of.table.requested();
        let most = allowed(of.table, 0.0, 0.0, of.demand);
        let mut start = along_path(
            of.arm,
            of.table.first_node(),
            state,
            most,
            of.demand,
            requested,
        );
        start.velocity = start.velocity.min(0.95 * requested.speed);
        let most = LAW * requested.acceleration;
        start.acceleration = start.acceleration.clamp(-most, most);
        let decay = 0.5 * start.acceleration * start.acceleration / (LAW * requested.jerk);
        if start.acceleration < 0.0 && start.velocity < decay {
            // The path parameter would go backwards.
            start.acceleration = 0.0;
        }
        let differences = differences(of, state, start)?;
        let residual = ToolResidual::new(&differences, STEP, time, requested)?;
        let periods = libm::ceil((residual.end() - time) / of.period) as usize + 4;
        let law = law(of, start, &residual, time)?;
        Some(Self {
            residual,
            law,
            start_time: time,
            period: of.period,
            count: periods,
            done: 0,
            places: last.map(|joints| of.arm.forward(&joints).translation.vector),
            last,
        })
    }

    /// Returns the number of cycles that the whole verification takes.
    pub(crate) fn cycles(&self, of: &Situation<'_>) -> u64 {
        self.count.div_ceil(of.set_points.max(1)) as u64
    }

    /// Verifies the next set-points of the takeover, at most as many as one cycle may verify.
    pub(crate) fn verify(&mut self, of: &Situation<'_>) -> Verification {
        for _ in 0..of.set_points {
            if self.done == self.count {
                return Verification::Accepted;
            }
            self.done += 1;
            if self.next_set_point(of).is_none() {
                return Verification::Rejected;
            }
        }
        Verification::Running
    }

    /// Verifies the next set-point; `None` if it has no inverse kinematics or exceeds a limit.
    fn next_set_point(&mut self, of: &Situation<'_>) -> Option<()> {
        let time = self.start_time + self.done as f64 * self.period;
        let (joint_path, Path::Tool(path)) = (of.table.joint_path(), of.table.path()) else {
            return None;
        };
        let PathState { s, velocity, .. } = self.law.state_at(time);
        if velocity < -1e-9 || !joint_path.has_free_arm_angle(s) {
            return None;
        }
        let on_path = path.pose(s);
        let pose = self.residual.displaced(&on_path, time, 0.0);
        let angle = self.residual.arm_angle_at(time, 0.0);
        let place = (s, &on_path);
        let joints = joint_path.displaced_joints(of.arm, place, &pose, angle, &self.last[3])?;
        self.last.rotate_left(1);
        self.last[3] = joints;
        self.places.rotate_left(1);
        self.places[3] = pose.translation.vector;
        (self.axes_are_within(of) && self.tool_is_within(of.table.requested())).then_some(())
    }

    fn axes_are_within(&self, of: &Situation<'_>) -> bool {
        let [a, b, c, d] = &self.last;
        let width = self.period;
        let mut limits = of.arm.limits().iter().enumerate();
        limits.all(|(axis, limits)| {
            let velocity = (d[axis] - c[axis]) / width;
            let acceleration = (d[axis] - 2.0 * c[axis] + b[axis]) / (width * width);
            let jerk = (d[axis] - 3.0 * (c[axis] - b[axis]) - a[axis]) / (width * width * width);
            let (below, above) = stopping_distances(velocity, acceleration, limits);
            let range = &of.ranges[axis];
            velocity.abs() <= USED * limits.velocity
                && acceleration.abs() <= USED * limits.acceleration
                && jerk.abs() <= USED * limits.jerk
                && range.contains(d[axis] - below)
                && range.contains(d[axis] + above)
        })
    }

    fn tool_is_within(&self, requested: Bounds) -> bool {
        tool_shares(&self.places, self.period, requested)
            .iter()
            .all(|share| *share <= TOOL)
    }
}

/// Returns speed, acceleration and jerk of the tool, as shares of the requested ones, from its last four positions (m),
/// which are `width` seconds apart.
pub(crate) fn tool_shares(places: &[Vector3<f64>; 4], width: f64, requested: Bounds) -> [f64; 3] {
    let [a, b, c, d] = places;
    let length = |way: Vector3<f64>| libm::sqrt(way.norm_squared());
    [
        length(d - c) / (width * requested.speed),
        length(d - c * 2.0 + b) / (width * width * requested.acceleration),
        length(d - (c - b) * 3.0 - a) / (width * width * width * requested.jerk),
    ]
}

/// Returns the differences between tool and path one time step before the beginning of the takeover, at it, and one
/// step after it. `None` if the path is not a path of the tool.
fn differences(
    of: &Situation<'_>,
    state: &JointState,
    start: PathState,
) -> Option<[Difference; 3]> {
    let Path::Tool(path) = of.table.path() else {
        return None;
    };
    let node = of.table.first_node();
    let at = |time: f64| {
        let joints = core::array::from_fn(|axis| {
            let half = state.acceleration[axis] * time / 2.0;
            state.position[axis] + time * (state.velocity[axis] + half)
        });
        let s = time * (start.velocity + start.acceleration * time / 2.0);
        let (tool, place) = (of.arm.forward(&joints), path.pose(s));
        let own = of.arm.arm_angle(&joints).unwrap_or(0.0);
        let of_path = of
            .table
            .joint_path()
            .arm_angle_of_path(of.arm, s, &node.joints);
        Difference {
            way: tool.translation.vector - place.translation.vector,
            turn: rotation_vector(&(tool.rotation * place.rotation.inverse())),
            arm_angle: nearest_turn(own, of_path) - of_path,
        }
    };
    Some([at(-STEP), at(0.0), at(STEP)])
}

/// Plans the time law along the path until the tool is on the path, with a verified stop after it. It may use the part
/// of the requested speed that the decaying displacement does not need. The law ends at the end of the known part of
/// the path; it is planned again as soon as the tool is on the path. `None` if no stop passes the verification.
fn law(
    of: &Situation<'_>,
    start: PathState,
    residual: &ToolResidual,
    time: f64,
) -> Option<HeldBrake> {
    /// Shares of the available speed with which the time law is tried, in this order.
    const SPEEDS: [f64; 4] = [1.0, 0.6, 0.3, 0.1];
    /// Number of times at which the speed of the decaying displacement is computed.
    const SAMPLES: u32 = 32;
    let requested = of.table.requested();
    let aside = residual.greatest_speed(SAMPLES);
    let left = requested.speed * requested.speed - aside * aside;
    let duration = residual.end() - time + 4.0 * of.period;
    let mut samples = of.demand.samples;
    let verifier = Verifier {
        arm: of.arm,
        table: of.table,
        residual: &Residual::default(),
        ranges: of.ranges,
    };
    SPEEDS.iter().find_map(|share| {
        let speed = (share * libm::sqrt(left.max(0.0))).min(of.demand.speed);
        let reach = (speed.max(start.velocity) * duration).min(of.table.known_end());
        let most = allowed(of.table, 0.0, reach, of.demand);
        let bounds = Bounds {
            speed: speed.min(most.velocity).max(1e-3 * requested.speed),
            acceleration: LAW * most.acceleration,
            jerk: LAW * most.jerk,
        };
        let plan = StateToRestProfile::new(start.into(), of.table.known_end(), bounds)?;
        let law = HeldBrake::lasting(plan, time, duration, (bounds.acceleration, bounds.jerk))?;
        let stop = law.behind_piece()?;
        verifier.accepts(&stop, &mut samples).then_some(law)
    })
}
