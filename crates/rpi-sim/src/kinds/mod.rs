//! Kinds of small devices: sensors with at most one actuator, a real number.
//!
//! A kind is one file here that implements [`SmallDevice`], and its row in [`SMALL_KINDS`]. The cell reader, the ports, the
//! manual and the schema of cells come from the constants of the trait.

mod conveyor;
mod documentation;
mod force;
mod gripper;
mod key;
mod light_barrier;
mod ramp;
mod small;
mod spindle;

pub use documentation::KeyInfo;
pub use key::Settings;
pub(crate) use key::{Key, KeyDefault, KeyType, Setting};

use crate::arm::limits::Violation;
use crate::bank::CellDevice;
use crate::device::{PortInfo, PortRow};
use crate::error_code::ErrorCode;
use small::Small;

/// Table of all kinds of small devices: sensors, and devices with one actuator.
pub(crate) const SMALL_KINDS: &[SmallKind] = &[
    SmallKind::of::<gripper::Gripper>(),
    SmallKind::of::<force::ForceSensor>(),
    SmallKind::of::<light_barrier::LightBarrier>(),
    SmallKind::of::<conveyor::Conveyor>(),
    SmallKind::of::<spindle::Spindle>(),
];

/// Device of a simulated cell that is a sensor or has one actuator, with all facts about its kind for the cell and the
/// manual.
pub(crate) trait SmallDevice: Send + Sized + 'static {
    /// Value of the key `kind` for such devices in a cell, such as `light-barrier`.
    const KIND: &'static str;
    /// Name of the kind in words, such as "light barrier".
    const TITLE: &'static str;
    /// Device type of the standard library that a program uses for such devices.
    const DEVICE_TYPE: &'static str;
    /// Behaviour of the device, for the manual.
    const DESCRIPTION: &'static str;
    /// Keys that a cell may give to such devices, besides `kind`.
    const KEYS: &'static [Key];
    /// Ports of the device, except `error` and `code`, which every device with an actuator has.
    const PORTS: &'static [PortRow<Self>];
    /// True if the device brakes when set-points are missing. Such a device has the key `watchdog`, see [`WATCHDOG`].
    const IS_WATCHED: bool = false;

    /// Checks that the settings agree with each other.
    ///
    /// # Errors
    /// Returns the key of a wrong setting, with a message.
    fn check_settings(settings: &Settings) -> Result<(), (&'static str, String)> {
        let _ = settings;
        Ok(())
    }

    /// Creates the device at rest.
    fn new(settings: &Settings, context: &BuildContext) -> Self;

    /// Checks a set-point, which is finite, against the limits of the device.
    ///
    /// # Errors
    /// Returns the violated limit.
    fn check(&self, set_point: f64) -> Result<(), Violation> {
        let _ = set_point;
        Err(Violation::from_code(ErrorCode::INVALID_PARAMETER))
    }

    /// Passes a checked set-point to the device.
    fn set(&mut self, set_point: f64) {
        let _ = set_point;
    }

    /// Simulates one tick, which ends at the simulated time `time` (s).
    fn step(&mut self, time: f64);

    /// Returns true if the device moves and needs set-points.
    fn is_moving(&self) -> bool {
        false
    }

    /// Makes the device brake.
    fn stop(&mut self) {}
}

/// Values from which a small device is built, besides its settings.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BuildContext {
    /// Duration of a tick, in s.
    pub(crate) tick: f64,
    /// Seed of the noise of the cell.
    pub(crate) seed: u64,
    /// Index of the device in the cell, which determines its noise together with the seed.
    pub(crate) place: usize,
}

/// Key `watchdog` of all devices that brake when set-points are missing.
pub(crate) const WATCHDOG: Key = Key {
    name: "watchdog",
    ty: KeyType::Periods,
    default: KeyDefault::Number(1.0),
    meaning: "number of periods without set-points, from 1 to 1000, after which the moving device brakes",
};

/// Kind of small devices (sensors, or devices with one actuator), with its tables of keys and ports.
#[derive(Clone, Copy)]
pub struct SmallKind {
    /// Value of the key `kind` in a cell, such as `light-barrier`.
    pub name: &'static str,
    /// Name of the kind in words, such as "light barrier".
    pub title: &'static str,
    /// Device type of the standard library that a program uses for such devices.
    pub device_type: &'static str,
    /// Behaviour of the devices, for the manual.
    pub description: &'static str,
    keys: &'static [Key],
    is_watched: bool,
    pub(crate) ports: fn() -> Vec<PortInfo>,
    pub(crate) check_settings: fn(&Settings) -> Result<(), (&'static str, String)>,
    build: fn(&Settings, &BuildContext) -> Box<dyn CellDevice>,
}

impl SmallKind {
    const fn of<D: SmallDevice>() -> Self {
        Self {
            name: D::KIND,
            title: D::TITLE,
            device_type: D::DEVICE_TYPE,
            description: D::DESCRIPTION,
            keys: D::KEYS,
            is_watched: D::IS_WATCHED,
            ports: small::ports::<D>,
            check_settings: D::check_settings,
            build: |settings, context| Box::new(Small::<D>::new(settings, context)),
        }
    }

    /// Returns all keys that a cell may give to devices of this kind, besides `kind`.
    pub(crate) fn keys(&self) -> impl Iterator<Item = &'static Key> {
        let watchdog = self.is_watched.then_some(&WATCHDOG);
        self.keys.iter().chain(watchdog)
    }
}

impl PartialEq for SmallKind {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl core::fmt::Debug for SmallKind {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(self.name)
    }
}

/// Description of a small device (a sensor, or a device with one actuator) of a cell.
#[derive(Clone, Debug, PartialEq)]
pub struct SmallSpec {
    /// Kind of the device.
    pub kind: &'static SmallKind,
    /// Values of the keys of the device.
    pub settings: Settings,
}

impl SmallSpec {
    pub(crate) fn build(&self, context: &BuildContext) -> Box<dyn CellDevice> {
        (self.kind.build)(&self.settings, context)
    }
}

/// Checks that a set-point lies in a range, with a tolerance for rounding. `code` is the error code of a violation.
fn check_range(value: f64, [lower, upper]: [f64; 2], code: ErrorCode) -> Result<(), Violation> {
    let tolerance = 1e-9 * lower.abs().max(upper.abs()).max(1.0);
    let limit = if value > upper { upper } else { lower };
    match (lower - tolerance..=upper + tolerance).contains(&value) {
        true => Ok(()),
        false => Err(Violation { code, value, limit }),
    }
}

/// Returns the time (s) in a script that repeats every `repeat` seconds, at the simulated time `time` (s). `repeat` is
/// infinite for a script without repetition.
fn script_time(time: f64, repeat: f64) -> f64 {
    match repeat.is_finite() && repeat > 0.0 {
        true => time % repeat,
        false => time,
    }
}
