//! Simulated devices that clients add: their types, models and parameters.

use std::collections::BTreeMap;

use rpi_image::Scalar;
use rpi_kin::AxisLimits;
use rpi_sim::cell::{ArmSpec, DeviceKind, DeviceSpec, EnforcedLimits};

use super::types::{ApiError, DeviceInfo};
use crate::peer::Peer;

/// Parameters of a simulated device that are used. Clients of the reference system send further ones.
pub(crate) const PARAMETERS: [&str; 5] = [
    "link_lengths",
    "min_joint",
    "max_joint",
    "max_vel",
    "max_acc",
];

/// Request of a client to add a device.
#[derive(Debug)]
pub(crate) struct NewDevice<'a> {
    /// Peer of the client.
    pub(crate) peer: Peer,
    pub(crate) name: &'a str,
    pub(crate) kind: &'a str,
    pub(crate) parameters: &'a BTreeMap<String, String>,
}

/// Returns the name of the type of a device of the cell.
pub(super) fn kind_name(kind: &DeviceKind) -> &'static str {
    match kind {
        DeviceKind::Arm(_) => "arm",
        DeviceKind::Io(_) => "io",
        DeviceKind::Base(_) => "base",
        DeviceKind::Gripper(_) => "gripper",
        DeviceKind::Force(_) => "force-torque",
    }
}

/// Returns the description of a device, with the interface names of the DirectIO protocol.
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
        DeviceKind::Gripper(_) | DeviceKind::Force(_) => Vec::new(),
    };
    DeviceInfo {
        name: spec.name.clone(),
        kind: kind.to_owned(),
        code: 0,
        moving: false,
        interfaces,
    }
}

/// Device types that clients may add, with the arm models that they can stand for.
pub(crate) const KINDS: &[(&str, &[&str])] = &[
    ("kuka_lwr_sim", &["kuka-lwr4+"]),
    ("kuka_iiwa_sim", &["kuka-iiwa-7", "kuka-iiwa-14"]),
];

/// Creates the specification of a simulated device. `tick` is in seconds.
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
            faults: Vec::new(),
        }),
    })
}

/// Returns the distance of the flange from the base of the stretched arm in m.
fn stretched_length(model: &rpi_kin::ArmModel) -> f64 {
    let zero = vec![0.0; model.axes()];
    model.forward(&zero).translation.vector.norm()
}

/// Returns the limits of the model, overridden by those of the client. The client's motions end with full deceleration.
/// An arm with a low jerk limit would swing back after the last set-point, so the limit allows full acceleration within
/// one tick.
fn limits(new: &NewDevice<'_>, own: &[AxisLimits], tick: f64) -> Result<Vec<AxisLimits>, ApiError> {
    let mut limits = own.to_vec();
    let mut set = |key: &str, place: fn(&mut AxisLimits) -> &mut f64| {
        let given = parse_reals(new, key)?.unwrap_or_default();
        let axes = limits.iter_mut().zip(given);
        axes.filter(|(_, value)| value.is_finite())
            .for_each(|(axis, value)| *place(axis) = value);
        Ok::<(), ApiError>(())
    };
    set("min_joint", |axis| &mut axis.position.lower)?;
    set("max_joint", |axis| &mut axis.position.upper)?;
    set("max_vel", |axis| &mut axis.velocity)?;
    set("max_acc", |axis| &mut axis.acceleration)?;
    for axis in &mut limits {
        axis.jerk = axis.jerk.max(axis.acceleration / tick);
    }
    let sound = |l: &AxisLimits| {
        l.position.lower < l.position.upper && l.velocity > 0.0 && l.acceleration > 0.0
    };
    match limits.iter().all(sound) {
        true => Ok(limits),
        false => Err(ApiError::Invalid(
            "limits must be positive and their ranges not empty".to_owned(),
        )),
    }
}

fn parse_reals(new: &NewDevice<'_>, key: &str) -> Result<Option<Vec<f64>>, ApiError> {
    let Some(text) = new.parameters.get(key) else {
        return Ok(None);
    };
    let bad = || ApiError::Invalid(format!("{key} must be a list of reals"));
    let values = rpi_literal::parse_array(text, Scalar::Real).map_err(|_| bad())?;
    let values: Option<Vec<_>> = values.ok_or_else(bad)?.into_iter().collect();
    let reals = values
        .ok_or_else(bad)?
        .iter()
        .map(rpi_image::Value::as_real)
        .collect();
    Ok(reals)
}
