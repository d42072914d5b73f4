//! The end of the driver in the cycle: set-points of the arm go to the controller, and measured positions come from it.

use super::UdpSpec;
use super::link::{Link, SetPoint};
use super::protocol::{ControllerMode, StatePacket};
use crate::arm::driven::ArmController;
use crate::arm::{Arm, external};
use crate::error_code::ErrorCode;
use std::io;

/// Controller of an arm, connected by UDP.
pub(crate) struct UdpController {
    spec: UdpSpec,
    link: Option<Link>,
    /// Newest state of the controller; `None` before the first one.
    state: Option<StatePacket>,
    /// Number of ticks since the newest state arrived.
    state_age: u32,
    /// Number of ticks without a state of the controller after which the connection counts as lost.
    timeout_ticks: u32,
    /// Number of the present sequence of set-points (epoch); a new one begins after each stop of the controller.
    epoch: u32,
    /// Number of the last set-point in its epoch.
    number: u64,
}

impl UdpController {
    /// Creates a controller that is not connected yet. `tick` is the duration of a tick in s.
    pub(crate) fn new(spec: UdpSpec, tick: f64) -> Self {
        Self {
            spec,
            link: None,
            state: None,
            state_age: 0,
            timeout_ticks: (spec.timeout / tick).ceil() as u32,
            epoch: 0,
            number: 0,
        }
    }

    /// Returns the error code of the connection and the controller; 0 for none.
    fn failure(&self) -> ErrorCode {
        match self.state {
            Some(_) if self.state_age > self.timeout_ticks => ErrorCode::CONNECTION_LOST,
            Some(state) if state.epoch == self.epoch && state.mode != ControllerMode::Ready => {
                ErrorCode::CONTROLLER_STOPPED
            }
            _ => ErrorCode::OK,
        }
    }

    fn receive(&mut self, arm: &mut Arm) {
        self.state_age = self.state_age.saturating_add(1);
        if let Some(state) = self.link.as_mut().and_then(Link::newest) {
            external::set_measured(arm, &state.positions);
            (self.state, self.state_age) = (Some(state), 0);
        }
    }

    /// Begins a new epoch (sequence of set-points) at the measured position, once arm and controller rest after the
    /// controller has stopped by itself.
    fn rejoin(&mut self, arm: &mut Arm) {
        let fresh = self.state.filter(|_| self.state_age == 0);
        let stopped = fresh
            .filter(|state| state.epoch == self.epoch && state.mode == ControllerMode::Stopped);
        if let Some(state) = stopped.filter(|_| !arm.is_moving()) {
            self.begin_epoch(arm, &state);
        }
    }

    fn begin_epoch(&mut self, arm: &mut Arm, state: &StatePacket) {
        external::place(arm, &state.positions);
        self.epoch = state.epoch.wrapping_add(1);
        self.number = 0;
    }

    fn send(&mut self, arm: &Arm) {
        if let Some(link) = &mut self.link {
            self.number += 1;
            link.send(SetPoint {
                epoch: self.epoch,
                number: self.number,
                positions: external::driven(arm),
            });
        }
    }
}

impl ArmController for UdpController {
    fn open(&mut self, arm: &mut Arm) -> io::Result<()> {
        let (link, state) = Link::open(self.spec.address, arm.axes())?;
        self.link = Some(link);
        self.state = Some(state);
        self.state_age = 0;
        self.begin_epoch(arm, &state);
        Ok(())
    }

    fn step(&mut self, arm: &mut Arm, time: f64) {
        self.receive(arm);
        external::set_failure(arm, self.failure());
        arm.step(time);
        self.rejoin(arm);
        self.send(arm);
    }

    fn clock(&self) -> Option<f64> {
        self.state.map(|state| state.clock)
    }
}
