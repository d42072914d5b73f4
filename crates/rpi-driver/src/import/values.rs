//! Constants as expressions of the same value (for rotations: up to rounding).

use rpi_image::{Scalar, Type, Value};

/// Returns the expression for a constant in the language RPI.
pub(super) fn value(value: &Value) -> String {
    match value {
        Value::Str(text) => quoted(text),
        Value::Slots { ty, cells } => typed(*ty, cells),
    }
}

fn typed(ty: Type, cells: &[u64]) -> String {
    match ty {
        Type::Scalar(scalar) => scalar_value(scalar, cells),
        Type::Array(scalar, _) => list(cells.chunks(scalar.slots() as usize), Type::Scalar(scalar)),
        Type::Matrix(_, cols) => list(cells.chunks(cols as usize), Type::Array(Scalar::Real, cols)),
    }
}

fn list<'c>(parts: impl Iterator<Item = &'c [u64]>, ty: Type) -> String {
    let parts: Vec<String> = parts.map(|cells| typed(ty, cells)).collect();
    format!("[{}]", parts.join(", "))
}

fn scalar_value(scalar: Scalar, cells: &[u64]) -> String {
    let first = cells.first().copied().unwrap_or(0);
    let (linear, rest) = cells.split_at(cells.len().min(3));
    match scalar {
        Scalar::Bool => (first != 0).to_string(),
        Scalar::Int => first.cast_signed().to_string(),
        Scalar::Real => real(f64::from_bits(first)),
        Scalar::Time => time(first.cast_signed()),
        Scalar::Vector => {
            constructor_call("World::VectorFromXYZ", ["inX", "inY", "inZ"], reals(cells))
        }
        Scalar::Rotation => rotation(cells),
        Scalar::Pose => constructor_call(
            "World::FrameFromPosRot",
            ["inPos", "inRot"],
            [scalar_value(Scalar::Vector, linear), rotation(rest)],
        ),
        Scalar::Twist => parts("World::TwistFromVelocities", linear, rest),
        Scalar::Wrench => parts("Rpi::WrenchFromParts", linear, rest),
    }
}

/// Returns a call of the function `make` with two vectors as arguments, which makes a twist or a wrench from its linear
/// and its angular part. `linear` and `angular` hold memory words.
fn parts(make: &str, linear: &[u64], angular: &[u64]) -> String {
    let [linear, angular] = [linear, angular].map(|cells| scalar_value(Scalar::Vector, cells));
    format!("{make}({linear}, {angular})")
}

fn rotation(cells: &[u64]) -> String {
    let angles = rpi_literal::euler_angles(cells).map(real);
    constructor_call("World::RotationFromABC", ["inA", "inB", "inC"], angles)
}

fn constructor_call<const N: usize>(make: &str, ports: [&str; N], values: [String; N]) -> String {
    let given: Vec<String> = ports
        .iter()
        .zip(values)
        .map(|(port, value)| format!("{port}: {value}"))
        .collect();
    format!("{make}({})", given.join(", "))
}

fn reals(cells: &[u64]) -> [String; 3] {
    std::array::from_fn(|k| real(f64::from_bits(cells.get(k).copied().unwrap_or(0))))
}

/// Returns the shortest literal that denotes the same double. The language has no literals for NaN and infinities, so
/// they are written as divisions by 0.
fn real(value: f64) -> String {
    if value.is_nan() {
        return "(0.0 / 0.0)".to_owned();
    }
    if value.is_infinite() {
        return format!("({:?} / 0.0)", value.signum());
    }
    let text = format!("{value:?}");
    match text.split_once('e') {
        Some((digits, power)) if !digits.contains('.') => format!("{digits}.0e{power}"),
        _ => text,
    }
}

/// Returns the expression for a point in time, given in nanoseconds since the Unix epoch.
fn time(ns: i64) -> String {
    let seconds = ns as f64 / 1e9;
    format!("Core::TimeAdd(inDelta: {})", real(seconds))
}

fn quoted(text: &str) -> String {
    let escaped = text.replace('\\', "\\\\").replace('"', "\\\"");
    format!("\"{escaped}\"")
}
