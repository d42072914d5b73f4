//! A gripper with two fingers.
//!
//! A set-point is an opening width. The gripper moves to it on its own, so that set-points need not be repeated in
//! every cycle. An object between the fingers blocks them while closing, and the gripper holds it.

use crate::cell::GripperSpec;
use crate::code::Code;
use crate::device::{Device, Line, Slot, find, is_actuator, tell, within};
use core::ops::Range;
use rpi_device::{PortName, Refusal, ResolveError};
use rpi_image::Scalar;

/// A gripper of a simulated cell.
#[derive(Clone, Debug)]
pub(crate) struct Gripper {
    spec: GripperSpec,
    tick: f64,
    /// Present and target opening, in m.
    width: f64,
    target: f64,
    /// Velocity of the opening in m/s, negative while closing.
    speed: f64,
    code: Code,
}

const PORTS: &[Line<Gripper>] = &[
    Line::sensor("gripper.width", Scalar::Real, |gripper, _, out| {
        out.real(gripper.width)
    }),
    Line::sensor("gripper.speed", Scalar::Real, |gripper, _, out| {
        out.real(gripper.speed)
    }),
    Line::sensor("gripper.force", Scalar::Real, |gripper, _, out| {
        out.real(gripper.force())
    }),
    Line::sensor("gripper.holding", Scalar::Bool, |gripper, _, out| {
        out.bits(u64::from(gripper.holds()))
    }),
    Line::sensor("gripper.moving", Scalar::Bool, |gripper, _, out| {
        out.bits(u64::from(gripper.speed != 0.0))
    }),
    Line::actuator("gripper.width", Scalar::Real),
];

/// Descriptions of the gripper's ports, for the manual.
pub(crate) fn ports() -> impl Iterator<Item = crate::device::PortInfo> {
    PORTS.iter().map(|line| line.head.info())
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
            code: Code::OK,
        }
    }

    /// Smallest possible opening, in m, given the object.
    fn narrowest(&self) -> f64 {
        self.spec
            .object
            .map_or(self.spec.lower, |object| object.max(self.spec.lower))
    }

    /// True if the gripper holds an object.
    fn holds(&self) -> bool {
        self.spec.object.is_some() && self.target < self.width && self.width <= self.narrowest()
    }

    /// Grip force, in N.
    fn force(&self) -> f64 {
        if self.holds() { self.spec.force } else { 0.0 }
    }

    fn judge(&self, slot: Slot, value: &[u64]) -> Result<f64, Code> {
        let width = value.first().map_or(f64::NAN, |bits| f64::from_bits(*bits));
        match () {
            () if !is_actuator(PORTS, slot) => Err(Code::BAD_PARAMETER),
            () if !width.is_finite() => Err(Code::NOT_A_NUMBER),
            () if width < self.spec.lower - 1e-9 || width > self.spec.upper + 1e-9 => {
                Err(Code::POSITION)
            }
            () => Ok(width),
        }
    }
}

impl Device for Gripper {
    fn resolve(&self, name: &PortName<'_>) -> Result<Slot, ResolveError> {
        find(PORTS.iter().map(|line| &line.head), name, |_| 1)
    }

    fn has(&self, slot: Slot) -> bool {
        let line = PORTS.get(usize::from(slot.line));
        within(line.map(|line| &line.head), slot, |_| 1)
    }

    fn resources_of(&self, slot: Slot) -> Range<u32> {
        0..u32::from(is_actuator(PORTS, slot))
    }

    fn read(&self, slot: Slot, value: &mut [u64]) -> bool {
        tell(PORTS, self, slot, value)
    }

    fn check(&mut self, slot: Slot, value: &[u64]) -> Refusal {
        self.code = self.judge(slot, value).err().unwrap_or(Code::OK);
        if self.code == Code::OK {
            Refusal::NONE
        } else {
            Refusal::ILLEGAL_VALUE
        }
    }

    fn error(&self, _slot: Slot) -> i64 {
        self.code.0
    }

    fn write(&mut self, slot: Slot, value: &[u64]) {
        self.target = self.judge(slot, value).unwrap_or(self.target);
    }

    fn step(&mut self, _time: f64) {
        let most = self.spec.speed * self.tick;
        let before = self.width;
        let next = self.target.clamp(before - most, before + most);
        // An object blocks closing fingers; it does not push them open.
        self.width = if next < before {
            next.max(self.narrowest().min(before))
        } else {
            next
        };
        self.speed = (self.width - before) / self.tick;
    }

    fn code(&self) -> Code {
        self.code
    }
}
