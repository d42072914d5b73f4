//! Values as Lustre writes them.

use rpi_image::{Scalar, Value};

/// The literal of a value; none if Lustre has none, as for a pose or what is no number.
pub(super) fn literal(value: &Value) -> Option<String> {
    if let Some(truth) = value.as_bool() {
        return Some(truth.to_string());
    }
    if let Some(number) = value.as_int() {
        return Some(integer(number));
    }
    value.as_real().filter(|x| x.is_finite()).map(real)
}

/// The neutral value of a type.
pub(super) fn neutral(scalar: Scalar) -> Option<&'static str> {
    match scalar {
        Scalar::Bool => Some("false"),
        Scalar::Int => Some("0"),
        Scalar::Real => Some("0.0"),
        _ => None,
    }
}

/// How Lustre calls a type.
pub(super) fn type_name(scalar: Scalar) -> Option<&'static str> {
    match scalar {
        Scalar::Bool => Some("bool"),
        Scalar::Int => Some("int"),
        Scalar::Real => Some("real"),
        _ => None,
    }
}

fn integer(value: i64) -> String {
    match value {
        i64::MIN => format!("({} - 1)", i64::MIN + 1),
        v if v < 0 => format!("({v})"),
        v => v.to_string(),
    }
}

/// So many digits that it reads back as the same bits, and always a point, without which Kind 2 reads an integer.
fn real(value: f64) -> String {
    let digits = format!("{:?}", value.abs());
    let digits = match digits.split_once('e') {
        Some((mantissa, power)) if !mantissa.contains('.') => format!("{mantissa}.0e{power}"),
        _ => digits,
    };
    match value.is_sign_negative() {
        true => format!("(-{digits})"),
        false => digits,
    }
}
