//! A simulated robot arm: takes set-points as a real controller does, or refuses them; follows them; brakes on its own when
//! it is left alone.
//!
//! It is a kinematic model: the drives go where they are told, and what is measured follows with a first-order lag. A
//! set-point of a command that runs every n ticks is approached evenly over these n ticks.

mod axis;
mod brake;
pub mod guard;
mod kinematics;
mod port;
mod sample;
mod simulate;
mod table;

use crate::cell::{ArmSpec, Enforced, Surface};
use crate::code::Code;
use crate::device::Report;
use crate::fault::Fault;
use crate::noise::Noise;
use axis::Axis;
use brake::Brake;
use nalgebra::Vector6;
use rpi_kin::{ArmModel, AxisLimits, MAX_AXES, Pose};
use sample::History;

/// An arm of a simulated cell.
#[derive(Clone, Debug)]
pub struct Arm {
    model: &'static ArmModel,
    tool: Pose,
    axes: Vec<Axis>,
    /// The axes' limits once more, side by side, as kinematics wants them.
    limits: [AxisLimits; MAX_AXES],
    enforced: Enforced,
    /// Length of a tick, in s.
    tick: f64,
    /// The time, in s.
    time: f64,
    /// Ticks from one set-point to the next.
    pace: u32,
    /// Ticks until the drives are where they were told to be.
    left: u32,
    /// On its way to rest by itself.
    brake: Option<Brake>,
    /// Somebody asked it to stop.
    told_to_stop: bool,
    /// What is wrong with the arm as a whole.
    code: Code,
    /// What it has against the last pose that it was asked to take.
    pose_code: Code,
    surface: Option<Surface>,
    faults: Vec<Fault>,
    state: Troubles,
    history: History,
    /// The share of the way that a measured position makes up in a tick.
    share: f64,
    latency: f64,
    deviation: f64,
    noise: Noise,
    parameters: [[f64; LARGEST_PARAMETER]; PARAMETERS],
    strategy: i64,
    reports: Vec<Report>,
    reports_lost: u64,
}

/// What is wrong with the arm in this tick.
#[derive(Clone, Copy, Debug, Default)]
struct Troubles {
    samples_lost: bool,
    set_points_lost: bool,
    delay: f64,
    deviation: f64,
    contact: Vector6<f64>,
}

/// Tool, impedances of the joints, impedance and sine at the tool.
const PARAMETERS: usize = 3 + MAX_AXES;
const LARGEST_PARAMETER: usize = 18;

/// So many reports are kept until somebody fetches them.
const REPORTS: usize = 64;

/// The LWR's number for position control; 20 and 30 are Cartesian and joint impedance.
const POSITION_CONTROL: i64 = 10;

impl Arm {
    /// An arm at rest. `tick` is the length of a tick in s, `device` its number in the cell, which chooses its noise.
    #[must_use]
    pub fn new(spec: &ArmSpec, tick: f64, seed: u64, device: usize) -> Self {
        let axes: Vec<Axis> = spec
            .joints
            .iter()
            .zip(&spec.limits)
            .map(|(at, limits)| Axis::new(*at, *limits))
            .collect();
        let mut limits = [AxisLimits::radians(0.0, 0.0, 0.0); MAX_AXES];
        limits
            .iter_mut()
            .zip(&spec.limits)
            .for_each(|(slot, own)| *slot = *own);
        let mut arm = Self {
            model: spec.model,
            tool: spec.tool,
            limits,
            enforced: spec.enforced,
            tick,
            time: 0.0,
            pace: 1,
            left: 0,
            brake: None,
            told_to_stop: false,
            code: Code::OK,
            pose_code: Code::OK,
            surface: spec.surface,
            faults: spec.faults.clone(),
            state: Troubles::default(),
            history: History::new(sample_of(&axes), 0),
            share: if spec.lag > 0.0 {
                -libm::expm1(-tick / spec.lag)
            } else {
                1.0
            },
            latency: spec.latency,
            deviation: spec.noise,
            noise: Noise::new(seed, device),
            parameters: [[0.0; LARGEST_PARAMETER]; PARAMETERS],
            strategy: POSITION_CONTROL,
            reports: Vec::with_capacity(REPORTS),
            reports_lost: 0,
            axes,
        };
        arm.make_room();
        arm.weather();
        arm
    }

    /// Adds a fault to those that are planned. Not for the cycle: it may allocate.
    pub fn inject(&mut self, fault: Fault) {
        self.faults.retain(|fault| fault.until > self.time);
        self.faults.push(fault);
        self.make_room();
    }

    /// The number of axes.
    #[must_use]
    pub fn axes(&self) -> usize {
        self.axes.len()
    }

    /// What is wrong with the arm: as a whole, or with the first axis that is not well.
    #[must_use]
    pub fn code(&self) -> Code {
        let axes = self.axes.iter().map(|axis| axis.code);
        core::iter::once(self.code)
            .chain(axes)
            .find(|code| *code != Code::OK)
            .unwrap_or(Code::OK)
    }
}

/// The ports of an arm, for people.
pub(crate) fn ports() -> impl Iterator<Item = crate::device::PortInfo> {
    table::PORTS.iter().map(|line| line.head.info())
}

fn sample_of(axes: &[Axis]) -> sample::Sample {
    let mut sample = sample::Sample::default();
    sample
        .iter_mut()
        .zip(axes)
        .for_each(|(slot, axis)| *slot = axis.measured);
    sample
}
