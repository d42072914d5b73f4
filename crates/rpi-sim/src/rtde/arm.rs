//! The end of the driver in the cycle: set-points of the arm go to the controller, and measured positions come from it.

use super::UrSpec;
use super::link::{ControllerState, Link, SetPoint};
use super::recipe::Joints;
use crate::arm::driven::ArmController;
use crate::arm::{Arm, external};
use crate::error_code::ErrorCode;
use rpi_kin::{AxisLimits, MAX_AXES};
use std::io;

/// Controller of an arm of Universal Robots.
pub(crate) struct UrController {
    spec: UrSpec,
    limits: Vec<AxisLimits>,
    /// Duration of a tick, in s.
    tick: f64,
    link: Option<Link>,
    /// Newest state of the controller; `None` before the first one.
    state: Option<ControllerState>,
    /// Number of ticks since the newest state arrived.
    state_age: u32,
    /// Number of ticks without a state of the controller after which the connection counts as lost.
    timeout_ticks: u32,
    /// Epoch (sequence of set-points) to which the set-points of the arm belong.
    epoch: i32,
    /// Error code of the connection and the controller; 0 for none.
    failure: ErrorCode,
}

impl UrController {
    /// Creates the controller of an arm with these limits, which is not connected yet. `tick` is the duration of a tick in
    /// s.
    pub(crate) fn new(spec: &UrSpec, limits: &[AxisLimits], tick: f64) -> Self {
        Self {
            spec: spec.clone(),
            limits: limits.to_vec(),
            tick,
            link: None,
            state: None,
            state_age: 0,
            timeout_ticks: (spec.timeout / tick).ceil() as u32,
            epoch: 0,
            failure: ErrorCode::OK,
        }
    }

    fn receive(&mut self, arm: &mut Arm) {
        self.state_age = self.state_age.saturating_add(1);
        if let Some(state) = self.link.as_mut().and_then(Link::newest) {
            external::set_measured(arm, &of_arm(&state.positions));
            (self.state, self.state_age) = (Some(state), 0);
        }
    }

    /// Returns the error code of the connection and the controller; 0 for none. An error lasts until the controller
    /// follows again.
    fn next_failure(&self) -> ErrorCode {
        let (Some(state), Some(link)) = (self.state, &self.link) else {
            return ErrorCode::OK;
        };
        match state.failure {
            _ if !link.is_connected() || self.state_age > self.timeout_ticks => {
                ErrorCode::CONNECTION_LOST
            }
            ErrorCode::OK if state.epoch == self.epoch => ErrorCode::OK,
            ErrorCode::OK if self.failure == ErrorCode::OK => ErrorCode::CONTROLLER_STOPPED,
            ErrorCode::OK => self.failure,
            failure => failure,
        }
    }

    /// Continues in the epoch that the driver has begun at the measured position, once the arm has come to rest.
    fn rejoin(&mut self, arm: &mut Arm) {
        let fresh = self.state.filter(|_| self.state_age == 0);
        let begun = fresh.filter(|state| state.epoch != 0 && state.epoch != self.epoch);
        if let Some(state) = begun.filter(|_| !arm.is_moving()) {
            external::place(arm, &of_arm(&state.start));
            self.epoch = state.epoch;
        }
    }
}

impl ArmController for UrController {
    fn open(&mut self, arm: &mut Arm) -> io::Result<()> {
        let (link, state) = Link::open(&self.spec, &self.limits, self.tick)?;
        external::place(arm, &of_arm(&state.start));
        (self.link, self.state, self.state_age) = (Some(link), Some(state), 0);
        self.epoch = state.epoch;
        Ok(())
    }

    fn step(&mut self, arm: &mut Arm, time: f64) {
        self.receive(arm);
        self.failure = self.next_failure();
        external::set_failure(arm, self.failure);
        arm.step(time);
        self.rejoin(arm);
        if let Some(link) = &mut self.link {
            let [positions @ .., _] = external::driven(arm);
            link.send(SetPoint {
                epoch: self.epoch,
                time,
                positions,
            });
        }
    }

    fn clock(&self) -> Option<f64> {
        self.state.map(|state| state.clock)
    }
}

/// Returns positions with a place for each axis that an arm can have.
fn of_arm(joints: &Joints) -> [f64; MAX_AXES] {
    let mut positions = [0.0; MAX_AXES];
    positions[..joints.len()].copy_from_slice(joints);
    positions
}
