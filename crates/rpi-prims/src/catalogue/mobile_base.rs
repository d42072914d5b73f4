//! Mobile platforms, wheels and satellite navigation.

use super::devices::{actuator, sensor};
use crate::macros::interface;
use crate::operand::Text;
use crate::registry::Prim;
use crate::value_types::{Pose, Twist};
use rpi_image::DeviceResponse;

pub(super) const ALL: &[Prim] = &[
    BASE_MONITOR,
    BASE_VELOCITY,
    WHEEL_MONITOR,
    SATELLITE_MONITOR,
];

interface! {
    /// Pose of a platform in the world frame and its velocity (m/s, rad/s) as measured and as commanded. `outError` is
    /// the error code of the platform, 0 if there is no error.
    BASE_MONITOR = "RobotBase::BaseMonitor";
    in {}
    param { Robot: Text = Str("") }
    out { outPos: Pose; outVel: Twist; outCmdVel: Twist; outError: i64 }
    presence always work 20;
    role sensor("Robot", None, &[
        "base.position", "base.measured_velocity", "base.commanded_velocity", "base.error",
    ])
}

interface! {
    /// Sets the velocity of a platform (m/s, rad/s). The out-ports are the response of the device in this cycle; they
    /// are absent if there is no set-point.
    BASE_VELOCITY = "RobotBase::BaseVelocity";
    in { inVel: Twist }
    param { Robot: Text = Str("") }
    out {
        outError: i64;
        outErrorConcurrentAccess: bool;
        outErrorBaseFailed: bool;
        outErrorIllegalVelocity: bool
    }
    presence strict work 12 faults;
    role actuator("Robot", None, &["base.velocity"], &[
        DeviceResponse::ErrorCode,
        DeviceResponse::ConcurrentAccess,
        DeviceResponse::DeviceFailed,
        DeviceResponse::IllegalValue,
    ])
}

interface! {
    /// Position (rad) and velocity (rad/s) of one wheel.
    WHEEL_MONITOR = "RobotBase::WheelMonitor";
    in {}
    param { Robot: Text = Str(""); Wheel: i64 = Int(0) }
    out { outPos: f64; outVel: f64 }
    presence always work 2;
    role sensor("Robot", Some("Wheel"), &["wheel.position", "wheel.velocity"])
}

interface! {
    /// Satellite navigation: position (deg, altitude in m), dilutions of precision and number of satellites in use. The
    /// spelling of `outAlitutde` is that of the reference system.
    SATELLITE_MONITOR = "GNSS::SatelliteMonitor";
    in {}
    param { Device: Text = Str("") }
    out {
        outLongitude: f64;
        outLatitude: f64;
        outAlitutde: f64;
        outHDOP: f64;
        outVDOP: f64;
        outNumSatellites: i64
    }
    presence always work 6;
    role sensor("Device", None, &[
        "gnss.longitude", "gnss.latitude", "gnss.altitude", "gnss.hdop", "gnss.vdop", "gnss.satellites",
    ])
}
