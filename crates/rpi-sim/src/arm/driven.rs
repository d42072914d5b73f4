//! Arm behind a real controller: the device, whatever the protocol.
//!
//! Kinematics, limits and motions are those of the simulated arm, so that the set-points of a program have the same bits
//! as in simulation.

use super::Arm;
use super::limit_usage::AxisUsage;
use crate::bank::CellDevice;
use crate::device::{Device, PortIndex, Report};
use crate::error_code::ErrorCode;
use core::ops::Range;
use rpi_device::{Discontinuity, PortQuery, Rejection, ResolveError};
use std::io;

/// Connection of an arm to its controller.
pub(crate) trait ArmController: Send {
    /// Connects to the controller, waits for it, and moves the arm of the model to its position.
    ///
    /// # Errors
    /// Returns the error of the connection.
    fn open(&mut self, arm: &mut Arm) -> io::Result<()>;

    /// Ends a tick at the time `time` (s, of the cell): sets measured positions and failures in the arm, simulates its tick,
    /// and sends its set-points. Neither waits nor allocates. Without a connection, it only simulates the tick.
    fn step(&mut self, arm: &mut Arm, time: f64);

    /// Returns the time of the controller's clock, in s; `None` before its first state.
    fn clock(&self) -> Option<f64>;
}

/// Arm whose set-points go to a controller, and whose measured positions come from it. Until it is opened, it behaves like a
/// simulated arm: banks that only resolve names never open it.
pub(crate) struct DrivenArm<C> {
    arm: Arm,
    controller: C,
}

impl<C: ArmController> DrivenArm<C> {
    pub(crate) fn new(arm: Arm, controller: C) -> Self {
        Self { arm, controller }
    }
}

impl<C: ArmController> CellDevice for DrivenArm<C> {
    fn has_driver(&self) -> bool {
        true
    }

    fn open(&mut self) -> io::Result<()> {
        self.controller.open(&mut self.arm)
    }

    fn limit_usage(&self, each: &mut dyn FnMut(AxisUsage<'_>)) {
        self.arm.limit_usage(each);
    }

    fn finish(&mut self) {
        CellDevice::finish(&mut self.arm);
    }
}

impl<C: ArmController> Device for DrivenArm<C> {
    fn step(&mut self, time: f64) {
        self.controller.step(&mut self.arm, time);
    }

    fn clock(&self) -> Option<f64> {
        self.controller.clock()
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
