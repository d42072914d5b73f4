//! A gripper with two fingers.
//!
//! A set-point is an opening width. The gripper moves to it on its own, so that set-points need not be repeated in
//! every cycle. An object between the fingers blocks them while closing, and the gripper holds it.

use super::{BuildContext, Key, KeyDefault, KeyType, Settings, SmallDevice, check_range};
use crate::arm::limits::Violation;
use crate::cell::quantity::Dimension::{Force, Length, Velocity};
use crate::device::{PortRow, SlotWriter};
use crate::error_code::ErrorCode;
use rpi_image::Scalar::{Bool, Real};

/// Gripper of a simulated cell. It does not stop by itself: a gripper that loses its command must not drop the object.
#[derive(Clone, Debug)]
pub(super) struct Gripper {
    /// Smallest and largest opening, in m.
    range: [f64; 2],
    /// Maximum speed of the opening, in m/s.
    fastest: f64,
    /// Grip force while the gripper holds an object, in N.
    grip: f64,
    /// Width of the object between the fingers, in m; `None` without an object.
    object: Option<f64>,
    /// Times (s) at which the object comes between the fingers (true) or is taken or lost (false).
    script: Vec<(f64, bool)>,
    /// True while the object is between the fingers.
    is_object_there: bool,
    tick: f64,
    /// Present opening of the fingers, in m.
    width: f64,
    /// Opening to which the fingers move, in m.
    target: f64,
    /// Velocity of the opening in m/s, negative while closing.
    speed: f64,
}

impl SmallDevice for Gripper {
    const KIND: &'static str = "gripper";
    const TITLE: &'static str = "gripper";
    const DEVICE_TYPE: &'static str = "Gripper";
    const DESCRIPTION: &'static str = "It moves by itself to its last set-point. It stops when its fingers meet an object while closing.";
    const KEYS: &'static [Key] = &[
        Key::new(
            "lower",
            KeyType::NotNegative(Length),
            KeyDefault::Number(0.0),
            "smallest opening",
        ),
        Key::positive("upper", Length, 0.1, "largest opening"),
        Key::new(
            "width",
            KeyType::NotNegative(Length),
            KeyDefault::SameAs("upper"),
            "initial opening",
        ),
        Key::positive("speed", Velocity, 0.1, "speed of the opening"),
        Key::new(
            "force",
            KeyType::NotNegative(Force),
            KeyDefault::Number(20.0),
            "gripping force",
        ),
        Key::new(
            "object",
            KeyType::NotNegative(Length),
            KeyDefault::Absent("no object"),
            "width of the object between the fingers",
        ),
        Key::new(
            "script",
            KeyType::Switches,
            KeyDefault::Absent("the object is always there"),
            "a list of `{ at = time, value = object is there }`",
        ),
    ];
    const PORTS: &'static [PortRow<Self>] = &[
        PortRow::<Self>::sensor("gripper.width", Real, Self::put_width).means("opening, m"),
        PortRow::<Self>::sensor("gripper.speed", Real, Self::put_speed)
            .means("m/s, negative while it closes"),
        PortRow::<Self>::sensor("gripper.force", Real, Self::put_force).means("gripping force, N"),
        PortRow::<Self>::sensor("gripper.holding", Bool, Self::put_holding)
            .means("true if it presses on an object"),
        PortRow::<Self>::sensor("gripper.moving", Bool, Self::put_moving)
            .means("true while its fingers move"),
        PortRow::<Self>::actuator("gripper.width", Real).means("set-point of the opening, m"),
        // Ports of the device type `Gripper` of `.rpi`.
        PortRow::<Self>::sensor("opening", Real, Self::put_width).means("opening, m"),
        PortRow::<Self>::sensor("speed", Real, Self::put_speed)
            .means("m/s, negative while it closes"),
        PortRow::<Self>::sensor("force", Real, Self::put_force).means("gripping force, N"),
        PortRow::<Self>::sensor("holding", Bool, Self::put_holding)
            .means("true if it presses on an object"),
        PortRow::<Self>::sensor("moving", Bool, Self::put_moving)
            .means("true while its fingers move"),
        PortRow::<Self>::actuator("width", Real).means("set-point of the opening, m"),
    ];

    fn check_settings(settings: &Settings) -> Result<(), (&'static str, String)> {
        let [lower, upper, width] = ["lower", "upper", "width"].map(|key| settings.number(key));
        match () {
            () if lower >= upper => {
                let message =
                    format!("`upper` is {upper} m, expected more than `lower`, {lower} m");
                Err(("upper", message))
            }
            () if !(lower..=upper).contains(&width) => Err((
                "width",
                format!("`width` is {width} m, out of the range {lower} to {upper} m"),
            )),
            () => Ok(()),
        }
    }

    fn new(settings: &Settings, context: &BuildContext) -> Self {
        let width = settings.number("width");
        Self {
            range: ["lower", "upper"].map(|key| settings.number(key)),
            fastest: settings.number("speed"),
            grip: settings.number("force"),
            object: settings.optional("object"),
            script: settings.switches("script").to_vec(),
            is_object_there: true,
            tick: context.tick,
            width,
            target: width,
            speed: 0.0,
        }
    }

    fn check(&self, set_point: f64) -> Result<(), Violation> {
        check_range(set_point, self.range, ErrorCode::POSITION)
    }

    fn set(&mut self, set_point: f64) {
        self.target = set_point;
    }

    fn step(&mut self, time: f64) {
        let past = self.script.iter().take_while(|(at, _)| *at <= time);
        self.is_object_there = past.last().is_none_or(|(_, value)| *value);
        let most = self.fastest * self.tick;
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
}

impl Gripper {
    /// Returns the width (m) of the object that is between the fingers now; `None` without one.
    fn object(&self) -> Option<f64> {
        self.object.filter(|_| self.is_object_there)
    }

    /// Returns the smallest opening (m) to which the fingers can close, given the object between them.
    fn min_width(&self) -> f64 {
        let [lower, _] = self.range;
        self.object().map_or(lower, |object| object.max(lower))
    }

    /// True if the fingers press on an object.
    fn is_holding(&self) -> bool {
        self.object().is_some() && self.target < self.width && self.width <= self.min_width()
    }

    fn put_width(&self, _: usize, out: &mut SlotWriter<'_>) {
        out.put_real(self.width);
    }

    fn put_speed(&self, _: usize, out: &mut SlotWriter<'_>) {
        out.put_real(self.speed);
    }

    fn put_force(&self, _: usize, out: &mut SlotWriter<'_>) {
        out.put_real(if self.is_holding() { self.grip } else { 0.0 });
    }

    fn put_holding(&self, _: usize, out: &mut SlotWriter<'_>) {
        out.put_bits(u64::from(self.is_holding()));
    }

    fn put_moving(&self, _: usize, out: &mut SlotWriter<'_>) {
        out.put_bits(u64::from(self.speed != 0.0));
    }
}
