//! Lustre literals and type names.

use rpi_image::{Scalar, Value};

/// Returns the Lustre literal of a value; `None` if there is none, as for a pose or a NaN.
pub(super) fn literal(value: &Value) -> Option<String> {
    if let Some(truth) = value.as_bool() {
        return Some(truth.to_string());
    }
    if let Some(number) = value.as_int() {
        return Some(integer(number));
    }
    value.as_real().filter(|x| x.is_finite()).map(real)
}

/// Returns the Lustre literal of the neutral value (false or 0) of a type; `None` for a type without Lustre equivalent.
pub(super) fn neutral(scalar: Scalar) -> Option<&'static str> {
    match scalar {
        Scalar::Bool => Some("false"),
        Scalar::Int => Some("0"),
        Scalar::Real => Some("0.0"),
        _ => None,
    }
}

/// Returns the Lustre name of a type; `None` for a type without Lustre equivalent.
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
        // The literal of `i64::MIN` would overflow: its digits are read before the sign is applied.
        i64::MIN => format!("({} - 1)", i64::MIN + 1),
        v if v < 0 => format!("({v})"),
        v => v.to_string(),
    }
}

/// Returns a real as text, with enough digits to parse to the same bits. The text always contains a point, since Kind 2
/// reads a number without one as an integer.
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
