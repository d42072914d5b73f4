//! Formats values as texts that parse to the same bits (rotations: to the same rotation).

use rpi_image::{Scalar, Type};
use rpi_prims::geometry;
use rpi_prims::value_types::{FlowType, Rotation};

/// Returns the literal of a value of a flow type. `cells` are the memory slots of the value.
#[must_use]
pub fn write(cells: &[u64], ty: Type) -> String {
    match ty {
        Type::Scalar(scalar) => scalar_text(cells, scalar),
        Type::Array(scalar, _) => array(cells, scalar),
        Type::Matrix(..) => array(cells, Scalar::Real),
    }
}

fn array(cells: &[u64], scalar: Scalar) -> String {
    let values = cells.chunks_exact(scalar.slots() as usize);
    let texts: Vec<String> = values.map(|v| scalar_text(v, scalar)).collect();
    format!("[{}]", texts.join(","))
}

fn scalar_text(cells: &[u64], scalar: Scalar) -> String {
    let part = |from: usize, scalar| scalar_text(cells.get(from..).unwrap_or(&[]), scalar);
    match scalar {
        Scalar::Bool => (first_slot(cells) != 0).to_string(),
        Scalar::Int => first_slot(cells).cast_signed().to_string(),
        Scalar::Real => real(first_slot(cells)),
        Scalar::Time => millis(first_slot(cells).cast_signed()),
        Scalar::Vector => object(["x", "y", "z"], cells),
        Scalar::Rotation => rotation(cells),
        Scalar::Pose => format!(
            "{{pos:{},rot:{}}}",
            part(0, Scalar::Vector),
            part(3, Scalar::Rotation)
        ),
        Scalar::Twist => format!(
            "{{vel:{},rot:{}}}",
            part(0, Scalar::Vector),
            part(3, Scalar::Vector)
        ),
        Scalar::Wrench => format!(
            "{{force:{},torque:{}}}",
            part(0, Scalar::Vector),
            part(3, Scalar::Vector)
        ),
    }
}

fn first_slot(cells: &[u64]) -> u64 {
    cells.first().copied().unwrap_or(0)
}

fn object(names: [&str; 3], cells: &[u64]) -> String {
    let fields: Vec<String> = names
        .iter()
        .zip(cells)
        .map(|(name, &cell)| format!("{name}:{}", real(cell)))
        .collect();
    format!("{{{}}}", fields.join(","))
}

/// Returns the Euler angles of a rotation in radians: about z, then y, then x of the turned frame. `cells` are the
/// memory slots of the rotation (a unit quaternion); too few slots give zeros.
///
/// Angles computed from a quaternion are exact only up to rounding. The angles rounded to 15 digits, as people write
/// them, are returned instead if they reproduce the rotation at least as well.
#[must_use]
pub fn euler_angles(cells: &[u64]) -> [f64; 3] {
    if cells.len() < Rotation::SLOTS {
        return [0.0; 3];
    }
    let wanted = Rotation::load(cells, 0);
    let far = |[a, b, c]: [f64; 3]| (geometry::from_abc(a, b, c).coords - wanted.coords).amax();
    let (a, b, c) = geometry::to_abc(wanted);
    let found = [a, b, c];
    let short = found.map(|angle| format!("{angle:.14e}").parse().unwrap_or(angle));
    if far(short) <= far(found) {
        short
    } else {
        found
    }
}

fn rotation(cells: &[u64]) -> String {
    object(["a", "b", "c"], &euler_angles(cells).map(f64::to_bits))
}

/// Returns the shortest literal that parses to the same real number. `bits` are those of the number.
fn real(bits: u64) -> String {
    let value = f64::from_bits(bits);
    if value.is_nan() {
        "nan".into()
    } else if value.is_infinite() {
        if value > 0.0 { "+inf" } else { "-inf" }.into()
    } else {
        finite(value)
    }
}

/// Returns the text of a finite real in the notation of Java: with an exponent from 10^7 on and below 10^-3, as in
/// `1.0E-5` and `2.5E7`.
fn finite(value: f64) -> String {
    if value == 0.0 || (1e-3..1e7).contains(&value.abs()) {
        return format!("{value:?}");
    }
    let text = format!("{value:e}");
    match text.split_once('e') {
        Some((digits, power)) if digits.contains('.') => format!("{digits}E{power}"),
        Some((digits, power)) => format!("{digits}.0E{power}"),
        None => text,
    }
}

/// Returns the text of a time in milliseconds, with at most six digits after the point. `ns` is the time in
/// nanoseconds.
fn millis(ns: i64) -> String {
    let (whole, part) = (ns / 1_000_000, (ns % 1_000_000).unsigned_abs());
    if part == 0 {
        return whole.to_string();
    }
    let sign = if ns < 0 { "-" } else { "" };
    let digits = format!("{part:06}");
    format!(
        "{sign}{}.{}",
        whole.unsigned_abs(),
        digits.trim_end_matches('0')
    )
}
