//! Devices with `kind = "arm"` and `kind = "linear-unit"`.

use super::faults;
use super::quantity::Dimension::{
    self, Acceleration, Angle, AngularAcceleration, AngularJerk, AngularVelocity, Jerk, Length,
    Number, Time, Velocity,
};
use super::reader::{TableReader, did_you_mean};
use crate::fault::ScheduledFault;
use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};
use rpi_kin::state_to_rest::Bounds;
use rpi_kin::{ArmModel, AxisLimits, models};

/// Description of an arm in a cell.
#[derive(Clone, Debug, PartialEq)]
pub struct ArmSpec {
    /// Kinematics and limits of the arm, by the key `model`.
    pub model: &'static ArmModel,
    /// Initial joint positions, in rad (m for a linear unit).
    pub joints: Vec<f64>,
    /// Pose of the base in the cell.
    pub base: Isometry3<f64>,
    /// Pose of the tool in the flange frame.
    pub tool: Isometry3<f64>,
    /// Limits of the model with the cell's overrides.
    pub limits: Vec<AxisLimits>,
    /// Greatest speed (m/s), acceleration (m/s²) and jerk (m/s³) of the tool in motions along its paths; infinite
    /// without a limit.
    pub tool_limits: Bounds,
    /// Limits that set-points are checked against.
    pub enforced: EnforcedLimits,
    /// Time constant of the first-order lag of measured positions, in s; 0 for no lag.
    pub lag: f64,
    /// Latency of samples, in s.
    pub latency: f64,
    /// Standard deviation of a measured joint position, in rad.
    pub noise: f64,
    /// An elastic surface under the tool, if any.
    pub surface: Option<Surface>,
    /// Faults that the simulation injects, each with its time.
    pub faults: Vec<ScheduledFault>,
}

impl ArmSpec {
    /// Limits of a tool that the cell does not limit.
    pub const UNLIMITED_TOOL: Bounds = Bounds {
        speed: f64::INFINITY,
        acceleration: f64::INFINITY,
        jerk: f64::INFINITY,
    };
}

/// A horizontal surface that pushes back like a spring.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// Height of the surface in base coordinates, m.
    pub height: f64,
    /// Stiffness, N per m of penetration.
    pub stiffness: f64,
}

impl Surface {
    /// Upward force on a tool at this height, N.
    pub(crate) fn force(&self, tool: f64) -> f64 {
        self.stiffness * (self.height - tool).max(0.0)
    }
}

/// Limits that set-points are checked against. Reachability, finiteness and the distance of the first set-point are
/// always checked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EnforcedLimits {
    /// Whether set-points are checked against the ranges of the joints.
    pub position: bool,
    /// Whether set-points are checked against the velocity limits.
    pub velocity: bool,
    /// Whether set-points are checked against the acceleration limits.
    pub acceleration: bool,
    /// Whether set-points are checked against the jerk limits.
    pub jerk: bool,
}

const ENFORCEABLE: &[&str] = &["position", "velocity", "acceleration", "jerk"];

/// Dimensions of the numbers for an axis: position, velocity, acceleration, jerk.
type AxisDimensions = [Dimension; 4];

const REVOLUTE: AxisDimensions = [Angle, AngularVelocity, AngularAcceleration, AngularJerk];
const PRISMATIC: AxisDimensions = [Length, Velocity, Acceleration, Jerk];

pub(super) fn read(reader: &mut TableReader<'_>) -> Option<ArmSpec> {
    let Some(model) = read_model(reader) else {
        // The valid values of the other keys depend on the model. Without a model, the keys only count as known.
        reader.mark_known(|other| drop(read_of(other, models::ALL[0], REVOLUTE)));
        return None;
    };
    let spec = read_of(reader, model, REVOLUTE);
    check_start(reader, &spec);
    Some(spec)
}

/// Reads `kind = "linear-unit"`: an arm with one prismatic axis.
pub(super) fn read_linear(reader: &mut TableReader<'_>) -> Option<ArmSpec> {
    let spec = read_of(reader, &models::linear::LINEAR_UNIT, PRISMATIC);
    check_start(reader, &spec);
    Some(spec)
}

fn read_of(
    reader: &mut TableReader<'_>,
    model: &'static ArmModel,
    units: AxisDimensions,
) -> ArmSpec {
    let axes = model.axes();
    let joints = reader.reals("joints", units[0], axes);
    let limits = read_limits(reader, model.limits, units);
    let nearest_to_zero =
        |axis: &AxisLimits| 0.0_f64.max(axis.position.lower).min(axis.position.upper);
    ArmSpec {
        model,
        joints: joints.unwrap_or_else(|| limits.iter().map(nearest_to_zero).collect()),
        base: read_pose(reader, "base"),
        tool: read_pose(reader, "tool"),
        limits,
        tool_limits: read_tool_limits(reader),
        enforced: read_enforced(reader),
        lag: reader.magnitude("lag", Time).unwrap_or(0.0),
        latency: reader.magnitude("latency", Time).unwrap_or(0.0),
        noise: reader.magnitude("noise", units[0]).unwrap_or(0.0),
        surface: read_surface(reader),
        faults: faults::read(reader, axes),
    }
}

/// Reads `{ height = length, stiffness = N/m }`.
fn read_surface(reader: &mut TableReader<'_>) -> Option<Surface> {
    let mut surface = reader.table("surface")?;
    let read = Surface {
        height: surface.real("height", Length).unwrap_or(0.0),
        stiffness: surface.positive("stiffness", Number).unwrap_or(0.0),
    };
    surface.finish();
    Some(read)
}

fn read_model(reader: &mut TableReader<'_>) -> Option<&'static ArmModel> {
    let known: Vec<&'static str> = models::ALL.iter().map(|model| model.id).collect();
    let given = reader.keyword("model", &known);
    if given.is_none() && !reader.has("model") {
        let help = did_you_mean("", &known);
        reader.error_at("model", "`model` is missing".to_owned(), Some(help));
    }
    given.and_then(models::by_id)
}

fn check_start(reader: &TableReader<'_>, spec: &ArmSpec) {
    for (axis, (joint, limits)) in spec.joints.iter().zip(&spec.limits).enumerate() {
        if spec.enforced.position && !limits.position.contains(*joint) {
            let (lower, upper) = (limits.position.lower, limits.position.upper);
            reader.error_at(
                "joints",
                format!("initial position {joint} of joint {axis} is out of range"),
                Some(format!("the range is {lower:.4} to {upper:.4}")),
            );
        }
    }
}

/// Reads `{ position = [x, y, z], rpy = [roll, pitch, yaw] }`, or the same with `quaternion = [x, y, z, w]`.
fn read_pose(reader: &mut TableReader<'_>, key: &'static str) -> Isometry3<f64> {
    let Some(mut pose) = reader.table(key) else {
        return Isometry3::identity();
    };
    let position = pose
        .reals("position", Length, 3)
        .unwrap_or_else(|| vec![0.0; 3]);
    let rpy = pose.reals("rpy", Angle, 3);
    let quaternion = pose.reals("quaternion", Number, 4);
    if rpy.is_some() && quaternion.is_some() {
        pose.error_at(
            "rpy",
            "`rpy` and `quaternion` cannot be combined".to_owned(),
            None,
        );
    }
    let rotation = match (rpy.as_deref(), quaternion.as_deref()) {
        (Some([roll, pitch, yaw]), _) => from_rpy(*roll, *pitch, *yaw),
        (_, Some([x, y, z, w])) => checked_unit_quaternion(&pose, Quaternion::new(*w, *x, *y, *z)),
        _ => UnitQuaternion::identity(),
    };
    pose.finish();
    Isometry3::from_parts(
        Translation3::new(position[0], position[1], position[2]),
        rotation,
    )
}

/// Rotation `Rz(yaw) Ry(pitch) Rx(roll)`, with arithmetic that gives the same bits on every machine.
fn from_rpy(roll: f64, pitch: f64, yaw: f64) -> UnitQuaternion<f64> {
    let about = |angle: f64, x: f64, y: f64, z: f64| {
        let (sin, cos) = libm::sincos(angle / 2.0);
        UnitQuaternion::new_unchecked(Quaternion::new(cos, x * sin, y * sin, z * sin))
    };
    about(yaw, 0.0, 0.0, 1.0) * about(pitch, 0.0, 1.0, 0.0) * about(roll, 1.0, 0.0, 0.0)
}

fn checked_unit_quaternion(
    reader: &TableReader<'_>,
    quaternion: Quaternion<f64>,
) -> UnitQuaternion<f64> {
    let length = quaternion.norm();
    if (length - 1.0).abs() > 1e-3 {
        let message = format!("`quaternion` has length {length:.4}, expected 1");
        let help = "the order is x, y, z, w".to_owned();
        reader.error_at("quaternion", message, Some(help));
        return UnitQuaternion::identity();
    }
    UnitQuaternion::new_unchecked(quaternion / length)
}

/// Reads the limits of an arm: those of the model, replaced where the table has another limit, for all axes or for
/// each.
fn read_limits(
    reader: &mut TableReader<'_>,
    own: &[AxisLimits],
    units: AxisDimensions,
) -> Vec<AxisLimits> {
    let mut limits = own.to_vec();
    let Some(mut table) = reader.table("limits") else {
        return limits;
    };
    let mut set = |key, dimension, place: fn(&mut AxisLimits) -> &mut f64| {
        let given = table
            .one_or_list(key, dimension, own.len())
            .unwrap_or_default();
        limits
            .iter_mut()
            .zip(given)
            .for_each(|(axis, value)| *place(axis) = value);
    };
    set("lower", units[0], |axis| &mut axis.position.lower);
    set("upper", units[0], |axis| &mut axis.position.upper);
    set("velocity", units[1], |axis| &mut axis.velocity);
    set("acceleration", units[2], |axis| &mut axis.acceleration);
    set("jerk", units[3], |axis| &mut axis.jerk);
    for (axis, limits) in limits.iter().enumerate() {
        check_limits(&table, axis, limits);
    }
    table.finish();
    limits
}

fn check_limits(table: &TableReader<'_>, axis: usize, limits: &AxisLimits) {
    let checks = [
        (
            "upper",
            "has an empty range",
            limits.position.lower < limits.position.upper,
        ),
        (
            "velocity",
            "has a velocity limit that is not positive",
            limits.velocity > 0.0,
        ),
        (
            "acceleration",
            "has an acceleration limit that is not positive",
            limits.acceleration > 0.0,
        ),
        (
            "jerk",
            "has a jerk limit that is not positive",
            limits.jerk > 0.0,
        ),
    ];
    for (key, what, _) in checks.into_iter().filter(|(_, _, good)| !good) {
        table.error_at(key, format!("axis {axis} {what}"), None);
    }
}

/// Reads `{ speed = m/s, acceleration = m/s^2, jerk = m/s^3 }`, each optional.
fn read_tool_limits(reader: &mut TableReader<'_>) -> Bounds {
    let mut limits = ArmSpec::UNLIMITED_TOOL;
    let Some(mut table) = reader.table("tool_limits") else {
        return limits;
    };
    for (key, dimension, place) in [
        ("speed", Velocity, &mut limits.speed),
        ("acceleration", Acceleration, &mut limits.acceleration),
        ("jerk", Jerk, &mut limits.jerk),
    ] {
        *place = table.positive(key, dimension).unwrap_or(*place);
    }
    table.finish();
    limits
}

fn read_enforced(reader: &mut TableReader<'_>) -> EnforcedLimits {
    let words = reader.keywords("enforce", ENFORCEABLE);
    let has = |word: &str| words.as_ref().is_none_or(|words| words.contains(&word));
    EnforcedLimits {
        position: has("position"),
        velocity: has("velocity"),
        acceleration: has("acceleration"),
        jerk: has("jerk"),
    }
}
