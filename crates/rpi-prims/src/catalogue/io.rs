//! Digital and analogue inputs and outputs.

use super::devices::{actuator, sensor};
use crate::macros::interface;
use crate::operand::Text;
use crate::registry::Prim;

pub(super) const ALL: &[Prim] = &[
    IN_BOOL,
    IN_REAL,
    OUT_BOOL,
    OUT_REAL,
    OUT_BOOL_SENSOR,
    OUT_REAL_SENSOR,
];

interface! {
    /// Value of a digital input.
    IN_BOOL = "IO::InBool";
    in {}
    param { DeviceID: Text = Str(""); Port: i64 = Int(0) }
    out { outIO: bool }
    presence always work 1;
    role sensor("DeviceID", Some("Port"), &["in.bool"])
}

interface! {
    /// Value of an analogue input.
    IN_REAL = "IO::InReal";
    in {}
    param { DeviceID: Text = Str(""); Port: i64 = Int(0) }
    out { outIO: f64 }
    presence always work 1;
    role sensor("DeviceID", Some("Port"), &["in.real"])
}

interface! {
    /// Sets a digital output. The output keeps its value while the input is absent.
    OUT_BOOL = "IO::OutBool";
    in { inIO: bool = IO(Bool(false)) }
    param { DeviceID: Text = Str(""); Port: i64 = Int(0) }
    out {}
    presence strict work 4 faults;
    role actuator("DeviceID", Some("Port"), &["out.bool"], &[])
}

interface! {
    /// Sets an analogue output. The output keeps its value while the input is absent.
    OUT_REAL = "IO::OutReal";
    in { inIO: f64 = IO(Real(0.0)) }
    param { DeviceID: Text = Str(""); Port: i64 = Int(0) }
    out {}
    presence strict work 4 faults;
    role actuator("DeviceID", Some("Port"), &["out.real"], &[])
}

interface! {
    /// Current value of a digital output.
    OUT_BOOL_SENSOR = "IO::OutBoolSensor";
    in {}
    param { DeviceID: Text = Str(""); Port: i64 = Int(0) }
    out { outIO: bool }
    presence always work 1;
    role sensor("DeviceID", Some("Port"), &["out.bool"])
}

interface! {
    /// Current value of an analogue output.
    OUT_REAL_SENSOR = "IO::OutRealSensor";
    in {}
    param { DeviceID: Text = Str(""); Port: i64 = Int(0) }
    out { outIO: f64 }
    presence always work 1;
    role sensor("DeviceID", Some("Port"), &["out.real"])
}
