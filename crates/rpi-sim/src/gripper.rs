//! A gripper with two fingers.
//!
//! A set-point is an opening width. The gripper moves to it on its own, so that set-points need not be repeated in
//! every cycle. An object between the fingers blocks them while closing, and the gripper holds it.

use crate::cell::GripperSpec;
use crate::device::{Device, PortIndex, PortRow, find_port, is_actuator, is_in_row, read_port};
use crate::error_code::ErrorCode;
use core::ops::Range;
use rpi_device::{PortQuery, Rejection, ResolveError};
use rpi_image::Scalar;

/// A gripper of a simulated cell.
#[derive(Clone, Debug)]
pub(crate) struct Gripper {
    spec: GripperSpec,
    tick: f64,
    /// Present opening of the fingers, followed by the opening that they move to, in m.
    width: f64,
    target: f64,
    /// Velocity of the opening in m/s, negative while closing.
    speed: f64,
    code: ErrorCode,
}

const PORTS: &[PortRow<Gripper>] = &[
    PortRow::sensor("gripper.width", Scalar::Real, |gripper, _, out| {
        out.put_real(gripper.width)
    }),
    PortRow::sensor("gripper.speed", Scalar::Real, |gripper, _, out| {
        out.put_real(gripper.speed)
    }),
    PortRow::sensor("gripper.force", Scalar::Real, |gripper, _, out| {
        out.put_real(gripper.force())
    }),
    PortRow::sensor("gripper.holding", Scalar::Bool, |gripper, _, out| {
        out.put_bits(u64::from(gripper.is_holding()))
    }),
    PortRow::sensor("gripper.moving", Scalar::Bool, |gripper, _, out| {
        out.put_bits(u64::from(gripper.speed != 0.0))
    }),
    PortRow::actuator("gripper.width", Scalar::Real),
];

/// Descriptions of the gripper's ports, for the manual.
pub(crate) fn ports() -> impl Iterator<Item = crate::device::PortInfo> {
    PORTS.iter().map(|line| line.spec.info())
}

impl Gripper {
    pub(crate) fn new(spec: &GripperSpec, tick: f64) -> Self {
        let width = spec.width;
        Self {
            spec: spec.clone(),
            tick,
            width,
            target: width,
            speed: 0.0,
            code: ErrorCode::OK,
        }
    }

    /// Smallest possible opening, in m, given the object.
    fn min_width(&self) -> f64 {
        self.spec
            .object
            .map_or(self.spec.lower, |object| object.max(self.spec.lower))
    }

    /// True if the gripper holds an object.
    fn is_holding(&self) -> bool {
        self.spec.object.is_some() && self.target < self.width && self.width <= self.min_width()
    }

    /// Grip force, in N.
    fn force(&self) -> f64 {
        if self.is_holding() {
            self.spec.force
        } else {
            0.0
        }
    }

    fn check_set_point(&self, slot: PortIndex, value: &[u64]) -> Result<f64, ErrorCode> {
        let width = value.first().map_or(f64::NAN, |bits| f64::from_bits(*bits));
        match () {
            () if !is_actuator(PORTS, slot) => Err(ErrorCode::INVALID_PARAMETER),
            () if !width.is_finite() => Err(ErrorCode::NOT_A_NUMBER),
            () if width < self.spec.lower - 1e-9 || width > self.spec.upper + 1e-9 => {
                Err(ErrorCode::POSITION)
            }
            () => Ok(width),
        }
    }
}

impl Device for Gripper {
    fn resolve(&self, name: &PortQuery<'_>) -> Result<PortIndex, ResolveError> {
        find_port(PORTS.iter().map(|line| &line.spec), name, |_| 1)
    }

    fn has_port(&self, slot: PortIndex) -> bool {
        let line = PORTS.get(usize::from(slot.row));
        is_in_row(line.map(|line| &line.spec), slot, |_| 1)
    }

    fn resources_of(&self, slot: PortIndex) -> Range<u32> {
        0..u32::from(is_actuator(PORTS, slot))
    }

    fn read(&self, slot: PortIndex, value: &mut [u64]) -> bool {
        read_port(PORTS, self, slot, value)
    }

    fn check(&mut self, slot: PortIndex, value: &[u64]) -> Rejection {
        self.code = self
            .check_set_point(slot, value)
            .err()
            .unwrap_or(ErrorCode::OK);
        if self.code == ErrorCode::OK {
            Rejection::NONE
        } else {
            Rejection::ILLEGAL_VALUE
        }
    }

    fn error(&self, _slot: PortIndex) -> i64 {
        self.code.0
    }

    fn write(&mut self, slot: PortIndex, value: &[u64]) {
        self.target = self.check_set_point(slot, value).unwrap_or(self.target);
    }

    fn step(&mut self, _time: f64) {
        let most = self.spec.speed * self.tick;
        let before = self.width;
        let next = self.target.clamp(before - most, before + most);
        // An object blocks closing fingers; it does not push them open.
        self.width = if next < before {
            next.max(self.min_width().min(before))
        } else {
            next
        };
        self.speed = (self.width - before) / self.tick;
    }

    fn code(&self) -> ErrorCode {
        self.code
    }
}
