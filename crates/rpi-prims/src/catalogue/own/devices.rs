//! Ports of any device by name: what `arm.pose` and `arm.tcp = ...` of a program become.

use rpi_image::{Answer, DevicePorts, DeviceUse};

/// The device of a port by its parameters.
pub(super) const fn named(answers: &'static [Answer]) -> DeviceUse {
    DeviceUse {
        device: "Device",
        index: Some("Index"),
        ports: DevicePorts::Param("Port"),
        answers,
    }
}

/// What a device answers to a set-point, in the order of the out-ports of `Write`.
pub(super) const ANSWERS: &[Answer] = &[
    Answer::ErrorCode,
    Answer::ConcurrentAccess,
    Answer::DeviceFailed,
    Answer::IllegalValue,
];

/// `Read` (total), `Sample` (may be missing) and `Write` of one type.
macro_rules! ports {
    ($name:literal, $t:ty) => {
        interface! {
            /// A sensor port of a device. A missing sample is a device fault.
            READ = concat!("Rpi::Read", $name);
            in {}
            param { Device: Text = Str(""); Port: Text = Str(""); Index: i64 = Int(0) }
            out { outValue: $t }
            presence always work 2;
            role Role::Sensor(crate::catalogue::own::devices::named(&[]))
        }

        interface! {
            /// A sensor port of a device that has not a sample in every cycle.
            SAMPLE = concat!("Rpi::Sample", $name);
            in {}
            param { Device: Text = Str(""); Port: Text = Str(""); Index: i64 = Int(0) }
            out { outValue: $t }
            presence maybe work 2;
            role Role::Sensor(crate::catalogue::own::devices::named(&[]))
        }

        interface! {
            /// Hands a set-point to a port of a device; while it is absent the device gets none from here.
            WRITE = concat!("Rpi::Write", $name);
            in { inValue: $t }
            param { Device: Text = Str(""); Port: Text = Str(""); Index: i64 = Int(0) }
            out { outError: i64; outErrorConcurrentAccess: bool; outErrorDeviceFailed: bool; outErrorIllegalValue: bool }
            presence strict work 8 faults;
            role Role::Actuator(crate::catalogue::own::devices::named(crate::catalogue::own::devices::ANSWERS))
        }
    };
}

pub(super) use ports;
