//! A force/torque sensor whose readings follow a script.

use super::{BuildContext, Key, KeyDefault, KeyType, Settings, SmallDevice, script_time};
use crate::cell::quantity::Dimension::{Force, Time};
use crate::device::PortRow;
use crate::noise::Noise;
use nalgebra::Vector6;
use rpi_image::Scalar::{Real, Wrench};

/// Force/torque sensor of a simulated cell.
#[derive(Clone, Debug)]
pub(super) struct ForceSensor {
    /// Scripted readings with the times (s) at which they begin: force (N), then torque (N m).
    script: Vec<(f64, Vector6<f64>)>,
    /// Period of the script, in s; infinity if it does not repeat.
    repeat: f64,
    /// Standard deviation of each component of a reading, in N or N m.
    deviation: f64,
    reading: Vector6<f64>,
    noise: Noise,
}

impl SmallDevice for ForceSensor {
    const KIND: &'static str = "force-torque";
    const TITLE: &'static str = "force/torque sensor";
    const DEVICE_TYPE: &'static str = "ForceSensor";
    const DESCRIPTION: &'static str = "It measures the values of its script. (The ports of an arm report the contacts of the arm.)";
    const KEYS: &'static [Key] = &[
        Key::new(
            "script",
            KeyType::Wrenches,
            KeyDefault::Absent("all zero"),
            "a list of `{ at = time, force = [x, y, z], torque = [x, y, z] }`, N and N m",
        ),
        Key::new(
            "repeat",
            KeyType::NotNegative(Time),
            KeyDefault::Absent("never"),
            "time after which the script restarts",
        ),
        Key::new(
            "noise",
            KeyType::NotNegative(Force),
            KeyDefault::Number(0.0),
            "standard deviation of each reading, N m for torques",
        ),
    ];
    const PORTS: &'static [PortRow<Self>] = &[
        PortRow::<Self>::sensor("wrench", Wrench, |sensor, _, out| {
            out.put_reals(sensor.reading.iter().copied())
        })
        .means("force and torque"),
        PortRow::<Self>::sensor("tcp.force_x", Real, |sensor, _, out| {
            out.put_real(sensor.reading[0])
        })
        .means("N"),
        PortRow::<Self>::sensor("tcp.force_y", Real, |sensor, _, out| {
            out.put_real(sensor.reading[1])
        })
        .means("N"),
        PortRow::<Self>::sensor("tcp.force_z", Real, |sensor, _, out| {
            out.put_real(sensor.reading[2])
        })
        .means("N"),
        PortRow::<Self>::sensor("tcp.torque_x", Real, |sensor, _, out| {
            out.put_real(sensor.reading[3])
        })
        .means("N m"),
        PortRow::<Self>::sensor("tcp.torque_y", Real, |sensor, _, out| {
            out.put_real(sensor.reading[4])
        })
        .means("N m"),
        PortRow::<Self>::sensor("tcp.torque_z", Real, |sensor, _, out| {
            out.put_real(sensor.reading[5])
        })
        .means("N m"),
    ];

    fn new(settings: &Settings, context: &BuildContext) -> Self {
        let mut sensor = Self {
            script: settings.wrenches("script").to_vec(),
            repeat: settings.optional("repeat").unwrap_or(f64::INFINITY),
            deviation: settings.number("noise"),
            reading: Vector6::zeros(),
            noise: Noise::new(context.seed, context.place),
        };
        sensor.step(0.0);
        sensor
    }

    fn step(&mut self, time: f64) {
        let since = script_time(time, self.repeat);
        let past = self.script.iter().take_while(|(at, _)| *at <= since);
        let now = past.last();
        self.reading = now.map_or_else(Vector6::zeros, |(_, wrench)| *wrench);
        for part in self.reading.iter_mut() {
            *part += self.noise.normal(self.deviation);
        }
    }
}
