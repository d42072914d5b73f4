//! Devices with `kind = "arm"` and `kind = "linear-unit"`.

use super::arm_driver::ArmDriver;
use super::faults;
use super::periods::read_periods;
use super::pose::read_pose_at;
use super::quantity::Dimension::{
    self, Acceleration, Angle, AngularAcceleration, AngularJerk, AngularVelocity, Jerk, Length,
    Number, Time, Velocity,
};
use super::quantity::unit_suffix;
use super::reader::TableReader;
use super::robot::{self, ROBOT_FILES, RobotDescription};
use super::value::Node;
use super::words::WordOrFile;
use crate::fault::ScheduledFault;
use nalgebra::Isometry3;
use rpi_kin::chain::JointType;
use rpi_kin::state_to_rest::Bounds;
use rpi_kin::{ArmModel, AxisLimits, Range, models};

/// Description of an arm, linear unit or positioner of a cell.
#[derive(Clone, Debug, PartialEq)]
pub struct ArmSpec {
    /// Model of the arm: kinematics and limits.
    pub model: &'static ArmModel,
    /// Initial joint positions, in rad (m for a linear unit).
    pub joints: Vec<f64>,
    /// Pose of the base of the arm in the cell.
    pub base: Isometry3<f64>,
    /// Pose of the tool in the flange frame.
    pub tool: Isometry3<f64>,
    /// Limits of the axes: those of the model, except where the cell has its own.
    pub limits: Vec<AxisLimits>,
    /// Maximum speed (m/s), acceleration (m/s²) and jerk (m/s³) of the tool in motions along its paths; infinite
    /// without a limit.
    pub tool_limits: Bounds,
    /// Kinds of limits that set-points are checked against.
    pub enforced: EnforcedLimits,
    /// Time constant of the first-order lag of measured positions, in s; 0 for no lag.
    pub lag: f64,
    /// Latency of the samples of sensors, in s.
    pub latency: f64,
    /// Standard deviation of a measured joint position, in rad.
    pub noise: f64,
    /// Number of periods without set-points after which a moving arm brakes, at least 1.
    pub watchdog: u32,
    /// Driver of a real arm; `None` for a simulated arm.
    pub driver: Option<ArmDriver>,
    /// Elastic surface under the tool; `None` without one.
    pub surface: Option<Surface>,
    /// Faults that the simulation injects, each with its time.
    pub faults: Vec<ScheduledFault>,
}

impl ArmSpec {
    /// Limits of the tool of an arm for which the cell gives none.
    pub const UNLIMITED_TOOL: Bounds = Bounds {
        speed: f64::INFINITY,
        acceleration: f64::INFINITY,
        jerk: f64::INFINITY,
    };
}

/// Simulated horizontal surface that pushes back like a spring.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// Height of the surface in the base frame, m.
    pub height: f64,
    /// Stiffness of the surface, N per m of penetration.
    pub stiffness: f64,
}

impl Surface {
    /// Returns the upward force (N) on a tool whose height in the base frame is `tool` (m).
    pub(crate) fn force(&self, tool: f64) -> f64 {
        self.stiffness * (self.height - tool).max(0.0)
    }
}

/// Kinds of limits that set-points are checked against. Reachability and finiteness are always checked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EnforcedLimits {
    /// True if set-points are checked against the ranges of the joints.
    pub position: bool,
    /// True if set-points are checked against the velocity limits.
    pub velocity: bool,
    /// True if set-points are checked against the acceleration limits.
    pub acceleration: bool,
    /// True if set-points are checked against the jerk limits.
    pub jerk: bool,
}

const ENFORCEABLE: &[&str] = &["position", "velocity", "acceleration", "jerk"];

/// Dimensions of the numbers for one axis: position, velocity, acceleration, jerk.
pub(super) type AxisDimensions = [Dimension; 4];

pub(super) const REVOLUTE: AxisDimensions =
    [Angle, AngularVelocity, AngularAcceleration, AngularJerk];
pub(super) const PRISMATIC: AxisDimensions = [Length, Velocity, Acceleration, Jerk];

/// Value of the key `joints` that stands for the home position of the robot description.
const HOME: &str = "home";

/// Models with the most and the fewest axes, of different types. What they accept together, the schema accepts.
const EXTREMES: [&ArmModel; 2] = [&models::kuka_lbr::LWR_4_PLUS, &models::linear::LINEAR_UNIT];

pub(super) fn read(reader: &mut TableReader<'_>) -> Option<ArmSpec> {
    let Some(robot) = read_model(reader) else {
        // The valid values of the other keys depend on the model. Without a model, the keys only count as known.
        for model in EXTREMES {
            reader.mark_known(|other| drop(read_of(other, model, None)));
        }
        return None;
    };
    let spec = read_of(reader, robot.model, robot.home.as_deref());
    check_start(reader, &spec);
    Some(spec)
}

/// Reads the keys of a kind that stands for the built-in model `model`, such as `kind = "linear-unit"`.
pub(super) fn read_built_in(reader: &mut TableReader<'_>, model: &str) -> Option<ArmSpec> {
    let robot = robot::read_builtin(model)?.ok()?;
    let spec = read_of(reader, robot.model, robot.home.as_deref());
    check_start(reader, &spec);
    Some(spec)
}

/// Returns the dimensions of the numbers for one axis of a model, counted from 0: angles, or lengths for a linear axis.
fn axis_dimensions(model: &ArmModel, axis: usize) -> AxisDimensions {
    let link = model.chain.links.get(axis);
    match link.map(|link| link.joint) {
        Some(JointType::Prismatic) => PRISMATIC,
        _ => REVOLUTE,
    }
}

/// Reads the keys that depend on the model of the arm. `home` are the joint positions for which `joints = "home"` stands.
fn read_of(
    reader: &mut TableReader<'_>,
    model: &'static ArmModel,
    home: Option<&[f64]>,
) -> ArmSpec {
    let axes = model.axes();
    let dimensions: Vec<AxisDimensions> =
        (0..axes).map(|axis| axis_dimensions(model, axis)).collect();
    let joints = read_start(reader, model, home, &dimensions);
    let limits = read_limits(reader, model.limits, &dimensions);
    let nearest_to_zero =
        |axis: &AxisLimits| 0.0_f64.max(axis.position.lower).min(axis.position.upper);
    ArmSpec {
        model,
        joints: joints.unwrap_or_else(|| limits.iter().map(nearest_to_zero).collect()),
        base: read_pose_at(reader, "base"),
        tool: read_pose_at(reader, "tool"),
        limits,
        tool_limits: read_tool_limits(reader),
        enforced: read_enforced(reader),
        lag: reader.magnitude("lag", Time).unwrap_or(0.0),
        latency: reader.magnitude("latency", Time).unwrap_or(0.0),
        noise: reader.magnitude("noise", dimensions[0][0]).unwrap_or(0.0),
        watchdog: read_periods(reader, "watchdog").unwrap_or(1),
        driver: None,
        surface: read_surface(reader),
        faults: faults::read(reader, axes),
    }
}

/// Reads the key `joints`, the positions at the start: a list, or the word `home` for those of the robot description. Returns
/// `None` if it is missing or invalid.
fn read_start(
    reader: &mut TableReader<'_>,
    model: &ArmModel,
    home: Option<&[f64]>,
    dimensions: &[AxisDimensions],
) -> Option<Vec<f64>> {
    let own: Vec<Dimension> = dimensions.iter().map(|axis| axis[0]).collect();
    let at_home = |reader: &mut TableReader<'_>| {
        reader.keyword("joints", &[HOME])?;
        if home.is_none() {
            let message = format!("the description of `{}` has no `home`", model.id);
            let help =
                "write the positions, `joints = [..]`, or add `home = [..]` to the description";
            reader.error_at("joints", message, Some(help.to_owned()));
        }
        home.map(<[f64]>::to_vec)
    };
    let is_word = |node: Node<'_>| node.get_ref().is_str();
    reader.either("joints", is_word, at_home, |reader| {
        reader.list_of("joints", &own)
    })
}

/// Reads the key `surface`, a table `{ height = length, stiffness = N/m }`; `None` if it is missing.
fn read_surface(reader: &mut TableReader<'_>) -> Option<Surface> {
    let mut surface = reader.table("surface")?;
    let read = Surface {
        height: surface.real("height", Length).unwrap_or(0.0),
        stiffness: surface.positive("stiffness", Number).unwrap_or(0.0),
    };
    surface.finish();
    Some(read)
}

/// Reads the key `model`: the name of a built-in model, or the path of a robot description. Reports an error and
/// returns `None` if there is no such robot.
fn read_model(reader: &mut TableReader<'_>) -> Option<RobotDescription> {
    let known = robot::builtin_ids();
    let given = reader.keyword_or_file("model", &known, ROBOT_FILES);
    let help = format!(
        "expected one of {}, or the path of a file",
        known.join(", ")
    );
    reader.require("model", &help);
    match given? {
        WordOrFile::Word(name) => robot::read_builtin(name)?.ok(),
        WordOrFile::File(path) => reader.errors.robot(path).cloned(),
    }
}

fn check_start(reader: &TableReader<'_>, spec: &ArmSpec) {
    for (axis, (joint, limits)) in spec.joints.iter().zip(&spec.limits).enumerate() {
        if spec.enforced.position && !limits.position.contains(*joint) {
            let [dimension, ..] = axis_dimensions(spec.model, axis);
            let message = position_out_of_range("initial position", axis, *joint, dimension);
            let help = range_help(&limits.position, dimension);
            reader.error_at_entry("joints", axis, message, Some(help));
        }
    }
}

/// Returns the message for the position (rad or m) of a joint outside of its range. `what` names the position.
pub(super) fn position_out_of_range(
    what: &str,
    axis: usize,
    position: f64,
    dimension: Dimension,
) -> String {
    let unit = unit_suffix(dimension);
    format!("{what} {position}{unit} of joint {axis} is out of range")
}

/// Returns the help about the range (rad or m) of a joint.
pub(super) fn range_help(range: &Range, dimension: Dimension) -> String {
    let unit = unit_suffix(dimension);
    format!(
        "the range is {:.4} to {:.4}{unit}",
        range.lower, range.upper
    )
}

/// Reads the key `limits`: the limits of an arm are its own, `own`, except where the table has another value, for all
/// axes or for each axis.
fn read_limits(
    reader: &mut TableReader<'_>,
    own: &[AxisLimits],
    dimensions: &[AxisDimensions],
) -> Vec<AxisLimits> {
    let mut limits = own.to_vec();
    let Some(mut table) = reader.table("limits") else {
        return limits;
    };
    let mut set = |key, which: usize, place: fn(&mut AxisLimits) -> &mut f64| {
        let own: Vec<Dimension> = dimensions.iter().map(|axis| axis[which]).collect();
        let given = table.one_or_list_of(key, &own).unwrap_or_default();
        limits
            .iter_mut()
            .zip(given)
            .for_each(|(axis, value)| *place(axis) = value);
    };
    set("lower", 0, |axis| &mut axis.position.lower);
    set("upper", 0, |axis| &mut axis.position.upper);
    set("velocity", 1, |axis| &mut axis.velocity);
    set("acceleration", 2, |axis| &mut axis.acceleration);
    set("jerk", 3, |axis| &mut axis.jerk);
    for (axis, limits) in limits.iter().enumerate() {
        check_limits(&table, axis, limits, &dimensions[axis]);
    }
    table.finish();
    limits
}

/// Reports an empty range of an axis, and limits that are not greater than zero.
fn check_limits(
    table: &TableReader<'_>,
    axis: usize,
    limits: &AxisLimits,
    dimensions: &AxisDimensions,
) {
    let [position, others @ ..] = dimensions.map(unit_suffix);
    let (lower, upper) = (limits.position.lower, limits.position.upper);
    if lower >= upper {
        let key = if table.has("upper") { "upper" } else { "lower" };
        let message = format!("axis {axis} has an empty range: {lower} to {upper}{position}");
        let help = "`lower` must be less than `upper`".to_owned();
        table.error_at_entry(key, axis, message, Some(help));
    }
    let values = [
        ("velocity", limits.velocity),
        ("acceleration", limits.acceleration),
        ("jerk", limits.jerk),
    ];
    for ((key, value), unit) in values.into_iter().zip(others) {
        if value <= 0.0 {
            let message =
                format!("{key} limit of axis {axis} is {value}{unit}, expected more than 0{unit}");
            table.error_at_entry(key, axis, message, None);
        }
    }
}

/// Reads the key `tool_limits`, a table `{ speed = m/s, acceleration = m/s^2, jerk = m/s^3 }`. Missing values are
/// infinite.
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
