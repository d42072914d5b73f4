//! Devices with `kind = "base"`, `"gripper"` and `"force-torque"`.

use super::quantity::Dimension::{
    Acceleration, Angle, AngularAcceleration, AngularVelocity, Force, Length, Time, Torque,
    Velocity,
};
use super::reader::TableReader;
use nalgebra::Vector6;

/// Description of a mobile base with two driven wheels.
#[derive(Clone, Debug, PartialEq)]
pub struct BaseSpec {
    /// Initial pose in the cell: x, y (m), heading (rad).
    pub position: [f64; 3],
    /// Distance between the wheels, in m.
    pub track: f64,
    /// Radius of the wheels, in m.
    pub wheel_radius: f64,
    /// Limits of forward velocity (m/s) and angular velocity (rad/s).
    pub velocity: [f64; 2],
    /// Limits of forward acceleration (m/s²) and angular acceleration (rad/s²).
    pub acceleration: [f64; 2],
}

/// Description of a gripper with two fingers.
#[derive(Clone, Debug, PartialEq)]
pub struct GripperSpec {
    /// Initial opening, in m.
    pub width: f64,
    /// Smallest opening, in m.
    pub lower: f64,
    /// Largest opening, in m.
    pub upper: f64,
    /// Speed of opening and closing, in m/s.
    pub speed: f64,
    /// Grip force, in N.
    pub force: f64,
    /// Width of an object between the fingers, in m; `None` without an object.
    pub object: Option<f64>,
}

/// Description of a force/torque sensor.
#[derive(Clone, Debug, PartialEq)]
pub struct ForceSpec {
    /// Readings with their start times (s): force (N), then torque (N m).
    pub script: Vec<(f64, Vector6<f64>)>,
    /// Period of the script, in s; infinity if it does not repeat.
    pub repeat: f64,
    /// Standard deviation of each component of a reading, in N or N m.
    pub noise: f64,
}

pub(super) fn read_base(reader: &mut TableReader<'_>) -> Option<BaseSpec> {
    let position = reader
        .reals("position", Length, 2)
        .unwrap_or_else(|| vec![0.0; 2]);
    let heading = reader.real("heading", Angle).unwrap_or(0.0);
    Some(BaseSpec {
        position: [position[0], position[1], heading],
        track: reader.positive("track", Length).unwrap_or(0.4),
        wheel_radius: reader.positive("wheel_radius", Length).unwrap_or(0.1),
        velocity: [
            reader.positive("velocity", Velocity).unwrap_or(1.0),
            reader
                .positive("turning_velocity", AngularVelocity)
                .unwrap_or(1.5),
        ],
        acceleration: [
            reader.positive("acceleration", Acceleration).unwrap_or(1.0),
            reader
                .positive("turning_acceleration", AngularAcceleration)
                .unwrap_or(3.0),
        ],
    })
}

pub(super) fn read_gripper(reader: &mut TableReader<'_>) -> Option<GripperSpec> {
    let lower = reader.magnitude("lower", Length).unwrap_or(0.0);
    let upper = reader.positive("upper", Length).unwrap_or(0.1);
    let width = reader.magnitude("width", Length).unwrap_or(upper);
    if lower >= upper {
        reader.error_at(
            "upper",
            "`upper` must be greater than `lower`".to_owned(),
            None,
        );
    }
    if !(lower..=upper).contains(&width) {
        let help = Some(format!("the range is {lower} to {upper} m"));
        reader.error_at("width", format!("`width` is {width}, out of range"), help);
    }
    Some(GripperSpec {
        width,
        lower,
        upper,
        speed: reader.positive("speed", Velocity).unwrap_or(0.1),
        force: reader.magnitude("force", Force).unwrap_or(20.0),
        object: reader.magnitude("object", Length),
    })
}

pub(super) fn read_force(reader: &mut TableReader<'_>) -> Option<ForceSpec> {
    let changes = reader.tables("script").into_iter();
    let mut script: Vec<(f64, Vector6<f64>)> = changes.map(read_wrench).collect();
    script.sort_by(|one, other| one.0.total_cmp(&other.0));
    Some(ForceSpec {
        script,
        repeat: reader.magnitude("repeat", Time).unwrap_or(f64::INFINITY),
        noise: reader.magnitude("noise", Force).unwrap_or(0.0),
    })
}

/// Reads `{ at = time, force = [x, y, z], torque = [x, y, z] }`. Missing keys are 0.
fn read_wrench(mut reader: TableReader<'_>) -> (f64, Vector6<f64>) {
    let at = reader.magnitude("at", Time).unwrap_or(0.0);
    let force = reader
        .reals("force", Force, 3)
        .unwrap_or_else(|| vec![0.0; 3]);
    let torque = reader
        .reals("torque", Torque, 3)
        .unwrap_or_else(|| vec![0.0; 3]);
    reader.finish();
    (at, Vector6::from_iterator(force.into_iter().chain(torque)))
}
