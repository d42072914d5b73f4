//! A simulated robot arm. It accepts or rejects set-points as a real controller does, follows them, and brakes on its
//! own when set-points are missing.
//!
//! The model is kinematic: drives reach their commanded positions exactly, and measured positions follow with a
//! first-order lag. Set-points of a command with a period of n ticks are interpolated linearly over these n ticks.

mod axes_motion;
mod axis;
mod brake;
mod chunks;
pub(crate) mod driven;
pub(crate) mod external;
mod faults;
mod follower;
mod jog;
mod kinematic_functions;
mod kinematics;
pub mod limit_usage;
pub mod limits;
mod motion;
mod motion_path;
mod parameters;
mod path_fault;
mod port;
mod port_table;
mod report_log;
mod sample;
mod sensing;
mod simulate;
mod tool_path;
mod watchdog;

use crate::cell::{ArmSpec, EnforcedLimits};
use crate::error_code::ErrorCode;
use crate::fault::ScheduledFault;
use crate::noise::Noise;
use axis::Axis;
use brake::Brake;
use faults::{FaultEffects, FaultState};
use follower::PoseFollower;
use kinematics::ArmKinematics;
use motion::Motion;
use parameters::Parameters;
use report_log::ReportLog;
use rpi_kin::Pose;
use sensing::Sensing;

/// Robot arm of a simulated cell.
#[derive(Clone, Debug)]
pub struct Arm {
    kinematics: ArmKinematics,
    axes: Vec<Axis>,
    /// Motions that the arm plans itself, along paths or of its axes.
    motion: Box<Motion>,
    follower: Box<PoseFollower>,
    enforced: EnforcedLimits,
    /// Duration of a tick, in s.
    tick: f64,
    /// Simulated time since the start of the cell, in s.
    time: f64,
    /// Number of ticks between two set-points of the running command.
    set_point_ticks: u32,
    /// Number of ticks until the drives reach the commanded positions.
    ticks_left: u32,
    /// Number of successive periods without set-points so far, while the arm bridges them.
    missed_periods: u32,
    /// Number of successive periods without set-points after which the arm brakes.
    watchdog_periods: u32,
    /// Stop in progress while the arm brakes on its own; `None` while it follows set-points or rests.
    brake: Option<Brake>,
    /// True if a stop was requested in this tick.
    stop_requested: bool,
    /// Error code of the arm as a whole; 0 for none.
    code: ErrorCode,
    /// Error code of the last set-point that was a pose of the tool; 0 if it was accepted.
    pose_code: ErrorCode,
    faults: FaultState,
    sensing: Sensing,
    parameters: Parameters,
    reports: ReportLog,
}

impl Arm {
    /// Creates an arm at rest. `tick` is the duration of a tick in s. `seed` and `device`, the index of the arm in the
    /// cell, determine its noise.
    #[must_use]
    pub fn new(spec: &ArmSpec, tick: f64, seed: u64, device: usize) -> Self {
        let axes: Vec<Axis> = spec
            .joints
            .iter()
            .zip(&spec.limits)
            .map(|(at, limits)| Axis::new(*at, *limits))
            .collect();
        let mut arm = Self {
            kinematics: ArmKinematics::new(spec),
            motion: Box::new(Motion::new(
                spec.model,
                spec.tool,
                &spec.limits,
                spec.tool_limits,
                tick,
                device,
            )),
            follower: Box::new(PoseFollower::new(
                rpi_motion::Arm::new(spec.model, spec.tool, &spec.limits),
                tick,
            )),
            enforced: spec.enforced,
            tick,
            time: 0.0,
            set_point_ticks: 1,
            ticks_left: 0,
            missed_periods: 0,
            watchdog_periods: spec.watchdog,
            brake: None,
            stop_requested: false,
            code: ErrorCode::OK,
            pose_code: ErrorCode::OK,
            faults: FaultState::new(spec),
            sensing: Sensing::new(spec, tick, Noise::new(seed, device), &axes),
            parameters: Parameters::new(),
            reports: ReportLog::new(),
            axes,
        };
        arm.sensing.reserve(arm.faults.largest_delay());
        arm.update_faults();
        arm
    }

    /// Schedules a simulated fault. Allocates, so not for the cycle.
    pub fn inject(&mut self, fault: ScheduledFault) {
        self.faults.inject(fault, self.time);
        self.sensing.reserve(self.faults.largest_delay());
    }

    /// Returns the pose of the tool in the base frame for joint positions in rad (forward kinematics).
    #[must_use]
    pub fn forward(&self, joints: &[f64]) -> Pose {
        self.kinematics.forward(joints)
    }

    /// Returns the number of axes of the arm.
    #[must_use]
    pub fn axes(&self) -> usize {
        self.axes.len()
    }

    /// Returns the error code of the arm as a whole, or else of the first axis with an error; 0 for none.
    #[must_use]
    pub fn code(&self) -> ErrorCode {
        let axes = self.axes.iter().map(|axis| axis.code);
        core::iter::once(self.code)
            .chain(axes)
            .find(|code| *code != ErrorCode::OK)
            .unwrap_or(ErrorCode::OK)
    }
}

/// Returns the descriptions of the ports of an arm, for the manual.
pub(crate) fn ports() -> impl Iterator<Item = crate::device::PortInfo> {
    port_table::PORTS.iter().map(|line| line.spec.info())
}
