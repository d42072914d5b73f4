//! Checks the commanded joint positions against the limits of the arms, cycle by cycle.

use rpi_device::{DeviceBank, PortId, PortKind, PortQuery};
use rpi_image::{Scalar, Type};
use rpi_sim::cell::DeviceKind;
use rpi_sim::{Cell, SimBank};

use crate::cell::{AXES, TICK_NS};

/// Commanded joints of the arms with their latest motion.
pub(crate) struct LimitChecker {
    axes: Vec<Axis>,
}

struct Axis {
    name: String,
    port: PortId,
    /// Limits of velocity, acceleration and jerk.
    limits: [f64; 3],
    /// Position and its backward differences up to the second.
    last: [f64; 3],
}

impl LimitChecker {
    pub(crate) fn new(cell: &Cell, bank: &mut SimBank) -> LimitChecker {
        let mut axes = Vec::new();
        for device in &cell.devices {
            let DeviceKind::Arm(arm) = &device.kind else {
                continue;
            };
            for (index, limits) in (0..).zip(&arm.limits) {
                let port = bank.resolve(&PortQuery {
                    device: &device.name,
                    port: "joint.commanded_position",
                    index,
                    kind: PortKind::Sensor,
                    ty: Type::Scalar(Scalar::Real),
                });
                axes.push(Axis {
                    name: format!("{}[{index}]", device.name),
                    port: port.expect("an arm has joints"),
                    limits: [limits.velocity, limits.acceleration, limits.jerk],
                    last: [arm.joints[index as usize], 0.0, 0.0],
                });
            }
        }
        assert_eq!(axes.len(), 2 * AXES);
        LimitChecker { axes }
    }

    /// Checks after a tick that every derivative is within its limit.
    pub(crate) fn look(&mut self, bank: &mut SimBank, tick: u64) {
        let dt = TICK_NS as f64 * 1e-9;
        for axis in &mut self.axes {
            let mut cells = [0];
            bank.read(axis.port, &mut cells);
            let position = f64::from_bits(cells[0]);
            let velocity = (position - axis.last[0]) / dt;
            let acceleration = (velocity - axis.last[1]) / dt;
            let jerk = (acceleration - axis.last[2]) / dt;
            for (value, limit) in [velocity, acceleration, jerk].iter().zip(axis.limits) {
                assert!(
                    value.abs() <= limit * (1.0 + 1e-5),
                    "{} in tick {tick}: velocity {velocity}, acceleration {acceleration}, jerk {jerk}, limits {:?}",
                    axis.name,
                    axis.limits
                );
            }
            axis.last = [position, velocity, acceleration];
        }
    }
}
