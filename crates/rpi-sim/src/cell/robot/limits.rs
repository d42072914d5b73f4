//! Limits of the axes of a description: those of the file, those beside it, and assumed ones.

use super::kinematics::{Joint, KnownLimits};
use crate::cell::arm::{AxisDimensions, PRISMATIC, REVOLUTE};
use crate::cell::quantity::{Dimension::Number, unit_suffix};
use crate::cell::reader::TableReader;
use rpi_kin::chain::JointType;
use rpi_kin::{AxisLimits, Range};

/// Assumed time in which an axis reaches its maximum velocity, if its maximum acceleration is not published, s.
const TIME_TO_VELOCITY: f64 = 0.3;
/// Assumed time in which an axis reaches its maximum acceleration, if its maximum jerk is not published, s.
const TIME_TO_ACCELERATION: f64 = 0.05;
/// Assumed end of the range, in both directions, of a joint that turns without end: 100 turns, in rad.
const ENDLESS: f64 = 100.0 * core::f64::consts::TAU;

/// Names of the quantities that a description can mark as assumed.
const QUANTITIES: &[&str] = &["range", "velocity", "acceleration", "jerk"];

/// Limits of all axes, and texts about assumed limits in the order of [`QUANTITIES`].
pub(super) struct Limits {
    pub(super) axes: Vec<AxisLimits>,
    pub(super) assumed: Vec<String>,
}

/// Reads the table `limits`, whose values replace those of the kinematics. Reports limits that are missing; then,
/// returns `None`.
pub(super) fn read(reader: &mut TableReader<'_>, joints: &[Joint]) -> Option<Limits> {
    let mut known: Vec<KnownLimits> = joints.iter().map(|joint| joint.limits).collect();
    let mut marked = Vec::new();
    if let Some(mut table) = reader.table("limits") {
        read_table(&mut table, joints, &mut known);
        marked = table.keywords("assumed", QUANTITIES).unwrap_or_default();
        table.finish();
    }
    let mut assumed = Assumptions::new(&marked);
    let axes: Vec<_> = joints
        .iter()
        .zip(&known)
        .map(|(joint, known)| completed(reader, joint, known, &mut assumed))
        .collect();
    let axes: Option<Vec<AxisLimits>> = axes.into_iter().collect();
    Some(Limits {
        axes: axes?,
        assumed: assumed.texts(),
    })
}

fn read_table(table: &mut TableReader<'_>, joints: &[Joint], known: &mut [KnownLimits]) {
    let dimensions: Vec<AxisDimensions> = joints.iter().map(dimensions).collect();
    let mut set = |key, which: usize, place: fn(&mut KnownLimits) -> &mut Option<f64>| {
        let own: Vec<_> = dimensions.iter().map(|axis| axis[which]).collect();
        let given = table.one_or_list_of(key, &own).unwrap_or_default();
        let axes = known.iter_mut().zip(given);
        axes.for_each(|(axis, value)| *place(axis) = Some(value));
    };
    set("lower", 0, |axis| &mut axis.lower);
    set("upper", 0, |axis| &mut axis.upper);
    set("velocity", 1, |axis| &mut axis.velocity);
    set("acceleration", 2, |axis| &mut axis.acceleration);
    set("jerk", 3, |axis| &mut axis.jerk);
    let numbers = vec![Number; joints.len()];
    let by_velocity = |axis: &KnownLimits, factor: f64| axis.velocity.map(|v| factor * v);
    let factors = table.one_or_list_of("acceleration_per_velocity", &numbers);
    for (axis, factor) in known.iter_mut().zip(factors.unwrap_or_default()) {
        axis.acceleration = by_velocity(axis, factor);
    }
    let factors = table.one_or_list_of("jerk_per_velocity", &numbers);
    for (axis, factor) in known.iter_mut().zip(factors.unwrap_or_default()) {
        axis.jerk = by_velocity(axis, factor);
    }
}

/// Returns the dimensions of position, velocity, acceleration and jerk of a joint.
pub(super) fn dimensions(joint: &Joint) -> AxisDimensions {
    match joint.kind {
        JointType::Revolute => REVOLUTE,
        JointType::Prismatic => PRISMATIC,
    }
}

/// Returns the limits of a joint from what is known about them, with assumptions for missing accelerations and jerks.
/// Reports limits that are missing or wrong; then, returns `None`.
fn completed(
    reader: &TableReader<'_>,
    joint: &Joint,
    known: &KnownLimits,
    assumed: &mut Assumptions,
) -> Option<AxisLimits> {
    let name = &joint.name;
    let missing = |what: &str, key: &str| {
        let help = format!("write `{key}` in a table [limits]");
        reader.error_at(
            "limits",
            format!("joint `{name}` has no {what}"),
            Some(help),
        );
    };
    let endless = joint.is_continuous.then_some(ENDLESS);
    if endless.is_some() && (known.lower.is_none() || known.upper.is_none()) {
        assumed.add(
            0,
            &format!("100 turns in each direction for the endless joint {name}"),
        );
    }
    let lower = known.lower.or(endless.map(|bound| -bound));
    let (Some(lower), Some(upper)) = (lower, known.upper.or(endless)) else {
        missing("range", "lower` and `upper");
        return None;
    };
    let Some(velocity) = known.velocity.filter(|velocity| *velocity > 0.0) else {
        missing("velocity limit greater than zero", "velocity");
        return None;
    };
    let acceleration = known
        .acceleration
        .filter(|acceleration| *acceleration > 0.0);
    if acceleration.is_none() {
        assumed.add(2, &format!("velocity / {TIME_TO_VELOCITY} s"));
    }
    let acceleration = acceleration.unwrap_or(velocity / TIME_TO_VELOCITY);
    let jerk = known.jerk.filter(|jerk| *jerk > 0.0);
    if jerk.is_none() {
        assumed.add(3, &format!("acceleration / {TIME_TO_ACCELERATION} s"));
    }
    let jerk = jerk.unwrap_or(acceleration / TIME_TO_ACCELERATION);
    if lower >= upper {
        let help = Some("`lower` must be less than `upper`".to_owned());
        let [position, ..] = dimensions(joint);
        let unit = unit_suffix(position);
        let message = format!("joint `{name}` has an empty range: {lower} to {upper}{unit}");
        reader.error_at("limits", message, help);
        return None;
    }
    Some(AxisLimits {
        position: Range { lower, upper },
        velocity,
        acceleration,
        jerk,
    })
}

/// Assumptions about the limits of a robot: one text for each of [`QUANTITIES`]; `None` if nothing is assumed.
struct Assumptions([Option<String>; 4]);

impl Assumptions {
    fn new(marked: &[&str]) -> Self {
        let text = |quantity: &&str| marked.contains(quantity).then(|| "by the file".to_owned());
        Self(core::array::from_fn(|which| text(&QUANTITIES[which])))
    }

    fn add(&mut self, which: usize, text: &str) {
        self.0[which].get_or_insert_with(|| text.to_owned());
    }

    fn texts(self) -> Vec<String> {
        let all = QUANTITIES.iter().zip(self.0);
        all.filter_map(|(quantity, text)| Some(format!("{quantity} ({})", text?)))
            .collect()
    }
}
