//! Simulated faults of an arm: those scheduled, and their effects in the present tick.

use crate::cell::{ArmSpec, Surface};
use crate::error_code::ErrorCode;
use crate::fault::{FaultKind, ScheduledFault};
use nalgebra::Vector6;
use rpi_kin::MAX_AXES;

/// Effects of the simulated faults that are active in this tick.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct FaultEffects {
    pub(super) samples_lost: bool,
    pub(super) set_points_lost: bool,
    /// Additional latency of the samples of sensors, in s.
    pub(super) delay: f64,
    /// Additional standard deviation of measured positions, in rad.
    pub(super) deviation: f64,
    /// Contact at the tool, in the base frame: force (N), then torque (N m).
    pub(super) contact: Vector6<f64>,
}

/// Simulated failures of an arm as a whole and of its single axes.
pub(super) struct Failures {
    /// Error code of the arm as a whole; 0 for none.
    pub(super) whole: ErrorCode,
    pub(super) axes: [bool; MAX_AXES],
}

/// Scheduled faults of an arm and the surface under its tool, with their effects in this tick.
#[derive(Clone, Debug)]
pub(super) struct FaultState {
    scheduled: Vec<ScheduledFault>,
    /// Failure of the controller of a real arm; 0 for none.
    pub(super) external: ErrorCode,
    pub(super) surface: Option<Surface>,
    pub(super) effects: FaultEffects,
}

impl FaultState {
    pub(super) fn new(spec: &ArmSpec) -> Self {
        Self {
            scheduled: spec.faults.clone(),
            external: ErrorCode::OK,
            surface: spec.surface,
            effects: FaultEffects::default(),
        }
    }

    /// Schedules a fault, and removes those that ended before `time` (s, simulated).
    pub(super) fn inject(&mut self, fault: ScheduledFault, time: f64) {
        self.scheduled.retain(|fault| fault.until > time);
        self.scheduled.push(fault);
    }

    /// Returns the largest delay of samples that the scheduled faults may cause together, in s.
    pub(super) fn largest_delay(&self) -> f64 {
        let delays = self.scheduled.iter().map(|fault| match fault.kind {
            FaultKind::Latency(delay) => delay,
            _ => 0.0,
        });
        delays.sum::<f64>()
    }

    /// Computes the effects of the faults that are active at `time` (s, simulated). `surface_force` is the upward force
    /// (N) of the surface under the tool; `None` without a surface. Returns the failures.
    pub(super) fn update(&mut self, time: f64, surface_force: Option<f64>) -> Failures {
        self.effects = FaultEffects::default();
        let mut failures = Failures {
            whole: self.external,
            axes: [false; MAX_AXES],
        };
        for fault in self.scheduled.iter().filter(|fault| fault.is_active(time)) {
            match fault.kind {
                FaultKind::JointFailure(axis) => failures
                    .axes
                    .get_mut(axis)
                    .into_iter()
                    .for_each(|axis| *axis = true),
                FaultKind::EmergencyStop => failures.whole = ErrorCode::EMERGENCY_STOP,
                FaultKind::LostSamples => self.effects.samples_lost = true,
                FaultKind::LostSetPoints => self.effects.set_points_lost = true,
                FaultKind::Latency(delay) => self.effects.delay += delay,
                FaultKind::Noise(deviation) => self.effects.deviation += deviation,
                FaultKind::Contact(wrench) => self.effects.contact += wrench,
            }
        }
        if let Some(force) = surface_force {
            // Component 2 is the force along z.
            self.effects.contact[2] += force;
        }
        failures
    }
}
