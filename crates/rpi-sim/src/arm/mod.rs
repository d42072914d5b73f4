//! A simulated robot arm. It accepts or rejects set-points as a real controller does, follows them, and brakes on its
//! own when set-points are missing.
//!
//! The model is kinematic: drives reach their commanded positions exactly, and measured positions follow with a
//! first-order lag. Set-points of a command with a period of n ticks are interpolated linearly over these n ticks.

mod axis;
mod brake;
mod kinematics;
pub mod limits;
mod motion;
mod path_fault;
mod port;
mod port_table;
mod sample;
mod simulate;

use crate::cell::{ArmSpec, EnforcedLimits, Surface};
use crate::device::Report;
use crate::error_code::ErrorCode;
use crate::fault::ScheduledFault;
use crate::noise::Noise;
use axis::Axis;
use brake::Brake;
use motion::Motion;
use nalgebra::Vector6;
use rpi_kin::{ArmModel, AxisLimits, MAX_AXES, Pose};
use sample::History;

/// An arm of a simulated cell.
#[derive(Clone, Debug)]
pub struct Arm {
    model: &'static ArmModel,
    tool: Pose,
    axes: Vec<Axis>,
    /// Limits of the axes as an array, for the inverse kinematics.
    limits: [AxisLimits; MAX_AXES],
    /// Motion along a path, planned by the arm.
    motion: Box<Motion>,
    enforced: EnforcedLimits,
    /// Length of a tick, in s.
    tick: f64,
    /// Simulated time, in s.
    time: f64,
    /// Ticks between set-points.
    set_point_ticks: u32,
    /// Ticks until the drives reach their commanded positions.
    ticks_left: u32,
    /// The stop in progress, while the arm brakes on its own.
    brake: Option<Brake>,
    /// A stop was requested in this tick.
    stop_requested: bool,
    /// Error code of the arm as a whole.
    code: ErrorCode,
    /// Error code of the last pose set-point.
    pose_code: ErrorCode,
    surface: Option<Surface>,
    faults: Vec<ScheduledFault>,
    fault_effects: FaultEffects,
    history: History,
    /// Fraction of the difference by which a measured position follows in a tick.
    lag_fraction: f64,
    latency: f64,
    deviation: f64,
    noise: Noise,
    parameters: [[f64; LARGEST_PARAMETER]; PARAMETERS],
    strategy: i64,
    reports: Vec<Report>,
    reports_lost: u64,
}

/// Effects of the active faults in this tick.
#[derive(Clone, Copy, Debug, Default)]
struct FaultEffects {
    samples_lost: bool,
    set_points_lost: bool,
    delay: f64,
    deviation: f64,
    contact: Vector6<f64>,
}

/// Number of parameters with several values: tool, impedance and sine at the tool, impedance of each joint.
const PARAMETERS: usize = 3 + MAX_AXES;
const LARGEST_PARAMETER: usize = 18;

/// Capacity for pending reports.
const REPORT_CAPACITY: usize = 64;

/// Position control in the numbering of the KUKA LWR; 20 and 30 are Cartesian and joint impedance.
const POSITION_CONTROL: i64 = 10;

impl Arm {
    /// An arm at rest. `tick` is the tick in s; `device` is its index in the cell, which selects its noise.
    #[must_use]
    pub fn new(spec: &ArmSpec, tick: f64, seed: u64, device: usize) -> Self {
        let axes: Vec<Axis> = spec
            .joints
            .iter()
            .zip(&spec.limits)
            .map(|(at, limits)| Axis::new(*at, *limits))
            .collect();
        let mut limits = [AxisLimits::from_radians(0.0, 0.0, 0.0); MAX_AXES];
        limits
            .iter_mut()
            .zip(&spec.limits)
            .for_each(|(slot, own)| *slot = *own);
        let mut arm = Self {
            model: spec.model,
            tool: spec.tool,
            limits,
            motion: Box::new(Motion::new(spec.model, spec.tool, &spec.limits, tick)),
            enforced: spec.enforced,
            tick,
            time: 0.0,
            set_point_ticks: 1,
            ticks_left: 0,
            brake: None,
            stop_requested: false,
            code: ErrorCode::OK,
            pose_code: ErrorCode::OK,
            surface: spec.surface,
            faults: spec.faults.clone(),
            fault_effects: FaultEffects::default(),
            history: History::new(measured_sample(&axes), 0),
            lag_fraction: if spec.lag > 0.0 {
                -libm::expm1(-tick / spec.lag)
            } else {
                1.0
            },
            latency: spec.latency,
            deviation: spec.noise,
            noise: Noise::new(seed, device),
            parameters: [[0.0; LARGEST_PARAMETER]; PARAMETERS],
            strategy: POSITION_CONTROL,
            reports: Vec::with_capacity(REPORT_CAPACITY),
            reports_lost: 0,
            axes,
        };
        arm.reserve_history();
        arm.update_faults();
        arm
    }

    /// Schedules a fault. Allocates, so not for the cycle.
    pub fn inject(&mut self, fault: ScheduledFault) {
        self.faults.retain(|fault| fault.until > self.time);
        self.faults.push(fault);
        self.reserve_history();
    }

    /// Number of axes.
    #[must_use]
    pub fn axes(&self) -> usize {
        self.axes.len()
    }

    /// Error code of the arm as a whole, or of the first axis with an error.
    #[must_use]
    pub fn code(&self) -> ErrorCode {
        let axes = self.axes.iter().map(|axis| axis.code);
        core::iter::once(self.code)
            .chain(axes)
            .find(|code| *code != ErrorCode::OK)
            .unwrap_or(ErrorCode::OK)
    }
}

/// Descriptions of an arm's ports, for the manual.
pub(crate) fn ports() -> impl Iterator<Item = crate::device::PortInfo> {
    port_table::PORTS.iter().map(|line| line.spec.info())
}

fn measured_sample(axes: &[Axis]) -> sample::Sample {
    let mut sample = sample::Sample::default();
    sample
        .iter_mut()
        .zip(axes)
        .for_each(|(slot, axis)| *slot = axis.measured);
    sample
}
