//! Ports of any device, by name. `arm.pose` and `arm.tcp = ...` in a program compile to these primitives.

use rpi_image::{DevicePortNames, DeviceResponse, DeviceUse};

/// Describes the device port that the parameters `Device`, `Index` and `Port` of a primitive select; `answers` are the
/// responses of the device to a set-point, one per out-port.
pub(super) const fn port_by_params(answers: &'static [DeviceResponse]) -> DeviceUse {
    DeviceUse {
        device: "Device",
        index: Some("Index"),
        ports: DevicePortNames::Param("Port"),
        responses: answers,
    }
}

/// Responses of a device to a set-point, in the order of the out-ports of `Write`.
pub(super) const RESPONSES: &[DeviceResponse] = &[
    DeviceResponse::ErrorCode,
    DeviceResponse::ConcurrentAccess,
    DeviceResponse::DeviceFailed,
    DeviceResponse::IllegalValue,
];

/// Defines the primitives `Read` (always present), `Sample` (may be absent) and `Write` for one value type.
macro_rules! ports {
    ($name:literal, $t:ty) => {
        interface! {
            /// Value of the sensor port `Port` of the device `Device`. A missing sample is a fault.
            READ = concat!("Rpi::Read", $name);
            in {}
            param { Device: Text = Str(""); Port: Text = Str(""); Index: i64 = Int(0) }
            out { outValue: $t }
            presence always work 2;
            role Role::Sensor(crate::catalogue::rpi_ops::devices::port_by_params(&[]))
        }

        interface! {
            /// Value of the sensor port `Port` of the device `Device`. Absent in cycles without a sample.
            SAMPLE = concat!("Rpi::Sample", $name);
            in {}
            param { Device: Text = Str(""); Port: Text = Str(""); Index: i64 = Int(0) }
            out { outValue: $t }
            presence maybe work 2;
            role Role::Sensor(crate::catalogue::rpi_ops::devices::port_by_params(&[]))
        }

        interface! {
            /// Writes a set-point to the actuator port `Port` of the device `Device`. No set-point is written while the
            /// input is absent. The out-ports are the response of the device in this cycle.
            WRITE = concat!("Rpi::Write", $name);
            in { inValue: $t }
            param { Device: Text = Str(""); Port: Text = Str(""); Index: i64 = Int(0) }
            out { outError: i64; outErrorConcurrentAccess: bool; outErrorDeviceFailed: bool; outErrorIllegalValue: bool }
            presence strict work 8 faults;
            role Role::Actuator(crate::catalogue::rpi_ops::devices::port_by_params(crate::catalogue::rpi_ops::devices::RESPONSES))
        }
    };
}

pub(super) use ports;
