//! Simulated devices that clients add: their types, models and parameters.

use std::collections::BTreeMap;

use rpi_image::Scalar;
use rpi_kin::AxisLimits;
use rpi_sim::cell::{ArmSpec, DeviceKind, DeviceSpec, EnforcedLimits};

use super::types::{ApiError, DeviceInfo};
use crate::peer::Peer;

/// Keys of the parameters that the server uses when a client adds a simulated device. Clients of the reference system
/// (the control core of the Robotics API) send further ones.
pub(crate) const PARAMETERS: [&str; 5] = [
    "link_lengths",
    "min_joint",
    "max_joint",
    "max_vel",
    "max_acc",
];

/// Maximum number of values of a parameter; an arm has fewer links and axes. A list with few more values is rejected by
/// its length.
const MAX_VALUES: usize = 32;

/// Request of a client to add a simulated device.
#[derive(Debug)]
pub(crate) struct NewDevice<'a> {
    /// Peer (network origin) of the client that adds the device.
    pub(crate) peer: Peer,
    pub(crate) name: &'a str,
    pub(crate) kind: &'a str,
    pub(crate) parameters: &'a BTreeMap<String, String>,
}

/// Returns the name of the type of a device, such as `arm` or `io`.
pub(super) fn kind_name(kind: &DeviceKind) -> &'static str {
    match kind {
        DeviceKind::Arm(_) => "arm",
        DeviceKind::Io(_) => "io",
        DeviceKind::Base(_) => "base",
        DeviceKind::Small(small) => small.kind.name,
    }
}

/// Returns the description of a device for clients, with the interface names of the DirectIO protocol. `kind` is the
/// name of the device type.
pub(super) fn device_info(spec: &DeviceSpec, kind: &str) -> DeviceInfo {
    let plain = |name| (name, Vec::new());
    let interfaces = match &spec.kind {
        DeviceKind::Arm(arm) => {
            let joints = arm.model.axes().to_string();
            vec![
                ("robotarm", vec![("jointcount".to_owned(), joints)]),
                plain("armkinematics"),
                plain("cartesianposition"),
            ]
        }
        DeviceKind::Io(_) => vec![plain("io")],
        DeviceKind::Base(_) => vec![plain("robotbase"), plain("cartesianposition")],
        DeviceKind::Small(_) => Vec::new(),
    };
    DeviceInfo {
        name: spec.name.clone(),
        kind: kind.to_owned(),
        code: 0,
        moving: false,
        interfaces,
    }
}

/// Device types that clients may add, each with the ids of the arm models that a device of the type can have.
pub(crate) const KINDS: &[(&str, &[&str])] = &[
    ("kuka_lwr_sim", &["kuka-lwr4+"]),
    ("kuka_iiwa_sim", &["kuka-iiwa-7", "kuka-iiwa-14"]),
];

/// Creates the specification of a simulated device from a client's request. The model is the one of the type whose
/// reach is nearest to the sum of the requested link lengths. `tick` is the length of a tick in seconds.
pub(super) fn device_spec(new: &NewDevice<'_>, tick: f64) -> Result<DeviceSpec, ApiError> {
    let known = KINDS.iter().find(|(kind, _)| *kind == new.kind);
    let unknown = || {
        let known: Vec<&str> = KINDS.iter().map(|(kind, _)| *kind).collect();
        let known = known.join(", ");
        ApiError::Unknown(format!("device type {}; known types: {known}", new.kind))
    };
    let (_, models) = known.ok_or_else(unknown)?;
    let models = models.iter().filter_map(|id| rpi_kin::models::by_id(id));
    let lengths = parse_reals(new, "link_lengths")?.unwrap_or_default();
    if let Some(at) = lengths.iter().position(|length| !length.is_finite()) {
        let length = lengths[at];
        return Err(ApiError::Invalid(format!(
            "link_lengths[{at}] is {length}, expected a length in m"
        )));
    }
    let reach: f64 = lengths.iter().sum();
    let farness = |model: &&rpi_kin::ArmModel| (stretched_length(model) - reach).abs();
    let model = models.min_by(|a, b| farness(a).total_cmp(&farness(b)));
    let model = model.ok_or_else(unknown)?;
    let limits = limits(new, model.limits, tick)?;
    Ok(DeviceSpec {
        name: new.name.to_owned(),
        kind: DeviceKind::Arm(ArmSpec {
            model,
            joints: limits
                .iter()
                .map(|l| 0.0_f64.clamp(l.position.lower, l.position.upper))
                .collect(),
            base: Default::default(),
            tool: Default::default(),
            surface: None,
            limits,
            tool_limits: ArmSpec::UNLIMITED_TOOL,
            enforced: EnforcedLimits {
                // As in the reference system's simulation: its clients plan paths without regard to joint velocities.
                position: true,
                velocity: false,
                acceleration: false,
                jerk: false,
            },
            lag: 0.0,
            latency: 0.0,
            noise: 0.0,
            watchdog: 1,
            driver: None,
            faults: Vec::new(),
        }),
    })
}

/// Returns the distance in m from the base to the flange when all joints of the arm are at zero.
fn stretched_length(model: &rpi_kin::ArmModel) -> f64 {
    let zero = vec![0.0; model.axes()];
    model.forward(&zero).translation.vector.norm()
}

/// Returns the axis limits of a simulated arm: those of its model (`own`), overridden by those in the request. The jerk
/// limit is raised so that full acceleration is possible within one tick of `tick` seconds; with a lower one, the arm
/// would swing back after motions of clients, which end with full deceleration.
fn limits(new: &NewDevice<'_>, own: &[AxisLimits], tick: f64) -> Result<Vec<AxisLimits>, ApiError> {
    let mut limits = own.to_vec();
    let mut set = |key: &str, lowest: f64, unit, place: fn(&mut AxisLimits) -> &mut f64| {
        let given = parse_reals(new, key)?;
        let check = |all| per_axis(key, all, own.len(), lowest, unit);
        let given = given.map_or(Ok(Vec::new()), check)?;
        let axes = limits.iter_mut().zip(given);
        axes.filter(|(_, value)| value.is_finite())
            .for_each(|(axis, value)| *place(axis) = value);
        Ok::<(), ApiError>(())
    };
    set("min_joint", f64::NEG_INFINITY, "rad", |axis| {
        &mut axis.position.lower
    })?;
    set("max_joint", f64::NEG_INFINITY, "rad", |axis| {
        &mut axis.position.upper
    })?;
    set("max_vel", 0.0, "rad/s", |axis| &mut axis.velocity)?;
    set("max_acc", 0.0, "rad/s^2", |axis| &mut axis.acceleration)?;
    for axis in &mut limits {
        axis.jerk = axis.jerk.max(axis.acceleration / tick);
    }
    match limits
        .iter()
        .position(|l| l.position.lower >= l.position.upper)
    {
        None => Ok(limits),
        Some(axis) => Err(empty_range(axis, &limits[axis])),
    }
}

/// Returns the error for the axis with this index, from 0, whose lower position limit is not less than the upper one.
fn empty_range(axis: usize, limits: &AxisLimits) -> ApiError {
    let (lower, upper) = (limits.position.lower, limits.position.upper);
    ApiError::Invalid(format!(
        "min_joint[{axis}], max_joint[{axis}]: the range from {lower} to {upper} rad is empty: the lower end must be less than the upper one"
    ))
}

/// Checks the values of a parameter with one value for each axis: `axes` values that are numbers and greater than
/// `lowest`. An infinite value stands for the limit of the model. `unit` is the unit of the values for messages. Returns
/// the values unchanged.
fn per_axis(
    key: &str,
    given: Vec<f64>,
    axes: usize,
    lowest: f64,
    unit: &str,
) -> Result<Vec<f64>, ApiError> {
    if given.len() != axes {
        let count = given.len();
        return Err(ApiError::Invalid(format!(
            "{key} has {count} values, expected {axes}, one for each axis, in {unit}"
        )));
    }
    let is_wrong = |value: &f64| value.is_nan() || (lowest.is_finite() && *value <= lowest);
    match given.iter().position(is_wrong) {
        None => Ok(given),
        Some(axis) => Err(ApiError::Invalid(out_of_bounds(
            key,
            axis,
            given[axis],
            lowest,
            unit,
        ))),
    }
}

/// Returns the message for a value of an axis that is not a number or not greater than `lowest`, in `unit`.
fn out_of_bounds(key: &str, axis: usize, value: f64, lowest: f64, unit: &str) -> String {
    let expected = match lowest.is_finite() {
        true => format!("a number greater than {lowest}"),
        false => "a number".to_owned(),
    };
    format!("{key}[{axis}] is {value}, expected {expected}, in {unit}")
}

/// Parses the parameter `key` of a new device as a list of reals; `None` if the parameter is missing.
fn parse_reals(new: &NewDevice<'_>, key: &str) -> Result<Option<Vec<f64>>, ApiError> {
    let Some(text) = new.parameters.get(key) else {
        return Ok(None);
    };
    let bad = |why: &str| {
        ApiError::Invalid(format!(
            "{key}: {why}; expected a list of numbers, as in [1.5, 2]"
        ))
    };
    let values = rpi_literal::parse_array(text, Scalar::Real, MAX_VALUES);
    let values = values.map_err(|e| bad(&e.to_string()))?;
    let values = values.ok_or_else(|| bad("the list is null"))?;
    let missing = |at| bad(&format!("value {at} is null"));
    let numbered = values.iter().enumerate();
    let reals = numbered.map(|(at, value)| {
        let value = value.as_ref().and_then(rpi_image::Value::as_real);
        value.ok_or_else(|| missing(at))
    });
    reals.collect::<Result<_, _>>().map(Some)
}
