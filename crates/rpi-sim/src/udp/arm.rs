//! The device of the driver: an arm whose set-points go to a controller, and whose measured positions come from it.
//!
//! Kinematics, limits and motions are those of the simulated arm, so that the set-points of a program have the same bits
//! as in simulation.

use super::UdpSpec;
use super::link::{Link, SetPoint};
use super::protocol::{ControllerMode, StatePacket};
use crate::arm::{Arm, external};
use crate::bank::CellDevice;
use crate::cell::ArmSpec;
use crate::device::{Device, PortIndex, Report};
use crate::error_code::ErrorCode;
use core::ops::Range;
use rpi_device::{Discontinuity, PortQuery, Rejection, ResolveError};
use std::io;

/// Arm behind a real controller, connected by UDP. Until it is opened, it behaves like a simulated arm: banks that only
/// resolve names never open it.
pub(crate) struct UdpArm {
    arm: Arm,
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

impl UdpArm {
    pub(crate) fn new(spec: &ArmSpec, udp: UdpSpec, tick: f64, seed: u64, place: usize) -> Self {
        Self {
            arm: Arm::new(spec, tick, seed, place),
            spec: udp,
            link: None,
            state: None,
            state_age: 0,
            timeout_ticks: (udp.timeout / tick).ceil() as u32,
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

    fn receive(&mut self) {
        self.state_age = self.state_age.saturating_add(1);
        if let Some(state) = self.link.as_mut().and_then(Link::newest) {
            external::set_measured(&mut self.arm, &state.positions);
            (self.state, self.state_age) = (Some(state), 0);
        }
    }

    /// Begins a new epoch (sequence of set-points) at the measured position, once arm and controller rest after the
    /// controller has stopped by itself.
    fn rejoin(&mut self) {
        let fresh = self.state.filter(|_| self.state_age == 0);
        let stopped = fresh
            .filter(|state| state.epoch == self.epoch && state.mode == ControllerMode::Stopped);
        if let Some(state) = stopped.filter(|_| !Device::is_moving(&self.arm, 0)) {
            self.begin_epoch(&state);
        }
    }

    fn begin_epoch(&mut self, state: &StatePacket) {
        external::place(&mut self.arm, &state.positions);
        self.epoch = state.epoch.wrapping_add(1);
        self.number = 0;
    }

    fn send(&mut self) {
        if let Some(link) = &mut self.link {
            self.number += 1;
            link.send(SetPoint {
                epoch: self.epoch,
                number: self.number,
                positions: external::driven(&self.arm),
            });
        }
    }
}

impl CellDevice for UdpArm {
    fn has_driver(&self) -> bool {
        true
    }

    fn open(&mut self) -> io::Result<()> {
        let (link, state) = Link::open(self.spec.address, self.arm.axes())?;
        self.link = Some(link);
        self.state = Some(state);
        self.state_age = 0;
        self.begin_epoch(&state);
        Ok(())
    }
}

impl Device for UdpArm {
    fn step(&mut self, time: f64) {
        self.receive();
        let failure = self.failure();
        external::set_failure(&mut self.arm, failure);
        self.arm.step(time);
        self.rejoin();
        self.send();
    }

    fn clock(&self) -> Option<f64> {
        self.state.map(|state| state.clock)
    }

    // The rest is the arm's.

    fn resolve(&self, name: &PortQuery<'_>) -> Result<PortIndex, ResolveError> {
        self.arm.resolve(name)
    }

    fn has_port(&self, port: PortIndex) -> bool {
        self.arm.has_port(port)
    }

    fn resources(&self, port: PortIndex) -> Range<u32> {
        self.arm.resources(port)
    }

    fn read(&self, port: PortIndex, value: &mut [u64]) -> bool {
        self.arm.read(port, value)
    }

    fn check(&mut self, port: PortIndex, value: &[u64]) -> Rejection {
        self.arm.check(port, value)
    }

    fn discontinuity(&self, port: PortIndex, value: &[u64]) -> Option<Discontinuity> {
        self.arm.discontinuity(port, value)
    }

    fn port_code(&self, port: PortIndex) -> ErrorCode {
        self.arm.port_code(port)
    }

    fn write(&mut self, port: PortIndex, value: &[u64]) {
        self.arm.write(port, value);
    }

    fn call(&mut self, port: PortIndex, arguments: &[u64], result: &mut [u64]) -> bool {
        self.arm.call(port, arguments, result)
    }

    fn is_moving(&self, resource: u32) -> bool {
        Device::is_moving(&self.arm, resource)
    }

    fn stop(&mut self, resource: u32) {
        self.arm.stop(resource);
    }

    fn begin_command(&mut self, resource: u32, ticks: u32) {
        self.arm.begin_command(resource, ticks);
    }

    fn code(&self) -> ErrorCode {
        Device::code(&self.arm)
    }

    fn reports(&mut self, each: &mut dyn FnMut(Report)) -> u64 {
        self.arm.reports(each)
    }
}
