//! JSON encoding of flow values, and the JSON schema of each type.
//!
//! Structured values use the field names and nesting that viewers of robot data expect: `position` and `orientation`,
//! `linear` and `angular`, `force` and `torque`. A real number that JSON cannot represent is a string: `nan`, `inf`,
//! `-inf`.

use std::fmt::Write;

use rpi_image::{Scalar, Type};
use serde_json::{Value, json};

const VECTOR: &[&str] = &["x", "y", "z"];
const QUATERNION: &[&str] = &["x", "y", "z", "w"];

/// Part of a structured value in JSON, such as the position of a pose: its name, and the names of its real components.
pub(super) type Part = (&'static str, &'static [&'static str]);

/// Returns the parts of a scalar type in JSON, such as position and orientation of a pose. A single part without a name
/// is the value itself; types without components have no parts.
pub(super) fn scalar_parts(scalar: Scalar) -> &'static [Part] {
    match scalar {
        Scalar::Bool | Scalar::Int | Scalar::Real | Scalar::Time => &[],
        Scalar::Vector => &[("", VECTOR)],
        Scalar::Rotation => &[("", QUATERNION)],
        Scalar::Pose => &[("position", VECTOR), ("orientation", QUATERNION)],
        Scalar::Twist => &[("linear", VECTOR), ("angular", VECTOR)],
        Scalar::Wrench => &[("force", VECTOR), ("torque", VECTOR)],
    }
}

/// Appends the JSON of a value of this type to `out`. `value` holds its memory words; `None`, an absent value, is
/// `null`.
pub(super) fn write(out: &mut String, value: Option<&[u64]>, ty: Type) {
    match (value, ty) {
        (Some(cells), Type::Scalar(scalar)) => write_scalar(out, cells, scalar),
        (Some(cells), Type::Array(scalar, _)) => {
            let each = cells.chunks(scalar.slots() as usize);
            write_list(out, each, |out, cells| write_scalar(out, cells, scalar));
        }
        (Some(cells), Type::Matrix(_, columns)) => {
            let rows = cells.chunks((columns as usize).max(1));
            write_list(out, rows, |out, row| {
                write_list(out, row.chunks(1), |out, cell| {
                    write_scalar(out, cell, Scalar::Real)
                });
            });
        }
        (None, _) => out.push_str("null"),
    }
}

fn write_list<'a>(
    out: &mut String,
    items: impl Iterator<Item = &'a [u64]>,
    mut item: impl FnMut(&mut String, &'a [u64]),
) {
    out.push('[');
    for (k, cells) in items.enumerate() {
        out.push_str(if k > 0 { "," } else { "" });
        item(out, cells);
    }
    out.push(']');
}

fn write_scalar(out: &mut String, cells: &[u64], scalar: Scalar) {
    let first = cells.first().copied().unwrap_or(0);
    // Writing to a string cannot fail.
    let _ = match scalar {
        Scalar::Bool => write!(out, "{}", first != 0),
        Scalar::Int | Scalar::Time => write!(out, "{}", first.cast_signed()),
        Scalar::Real => {
            write_real(out, f64::from_bits(first));
            Ok(())
        }
        _ => {
            write_structured(out, cells, scalar_parts(scalar));
            Ok(())
        }
    };
}

fn write_real(out: &mut String, value: f64) {
    let _ = match value {
        v if v.is_finite() => write!(out, "{v:?}"),
        v if v.is_nan() => write!(out, "\"nan\""),
        v => write!(out, "\"{v}\""),
    };
}

fn write_structured(out: &mut String, mut cells: &[u64], parts: &[Part]) {
    let nested = parts.len() > 1;
    out.push_str(if nested { "{" } else { "" });
    for (k, (name, reals)) in parts.iter().enumerate() {
        if nested {
            let comma = if k > 0 { "," } else { "" };
            let _ = write!(out, "{comma}\"{name}\":");
        }
        let (own, rest) = cells.split_at_checked(reals.len()).unwrap_or((cells, &[]));
        cells = rest;
        for (k, (name, cell)) in reals.iter().zip(own).enumerate() {
            let _ = write!(out, "{}\"{name}\":", if k > 0 { ',' } else { '{' });
            write_real(out, f64::from_bits(*cell));
        }
        out.push('}');
    }
    out.push_str(if nested { "}" } else { "" });
}

/// Returns the JSON schema for values of a type.
pub(super) fn schema(ty: Type) -> Value {
    let array = |items: Value| json!({ "type": "array", "items": items });
    match ty {
        Type::Scalar(scalar) => scalar_schema(scalar),
        Type::Array(scalar, _) => array(scalar_schema(scalar)),
        Type::Matrix(..) => array(array(json!({ "type": "number" }))),
    }
}

fn scalar_schema(scalar: Scalar) -> Value {
    let object = |names: &[&str]| {
        let reals = names
            .iter()
            .map(|name| (*name, json!({ "type": "number" })));
        json!({ "type": "object", "properties": reals.collect::<std::collections::BTreeMap<_, _>>() })
    };
    match (scalar, scalar_parts(scalar)) {
        (Scalar::Bool, _) => json!({ "type": "boolean" }),
        (Scalar::Int | Scalar::Time, _) => json!({ "type": "integer" }),
        (Scalar::Real, _) => json!({ "type": "number" }),
        (_, [(_, reals)]) => object(reals),
        (_, parts) => {
            let parts = parts.iter().map(|(name, reals)| (*name, object(reals)));
            json!({ "type": "object", "properties": parts.collect::<std::collections::BTreeMap<_, _>>() })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(cells: &[f64], ty: Type) -> Value {
        let cells: Vec<u64> = cells.iter().map(|c| c.to_bits()).collect();
        let mut text = String::new();
        write(&mut text, Some(&cells), ty);
        serde_json::from_str(&text).unwrap_or_else(|e| panic!("{text}: {e}"))
    }

    /// O6: a recorded value is read back with the same bits.
    #[test]
    fn numbers_come_back_as_they_were() {
        let mut bits = 1_u64;
        for value in std::iter::repeat_with(|| {
            bits = bits.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            f64::from_bits(bits >> 2 | 0x3000_0000_0000_0000)
        })
        .take(10_000)
        .chain([125.205_557_217_261_67])
        {
            assert_eq!(written(&[value], Scalar::Real.into()).as_f64(), Some(value));
        }
    }

    #[test]
    fn values_are_json_that_viewers_know() {
        let pose = written(&[1.0, 2.0, 3.0, 0.0, 0.0, 0.0, 1.0], Scalar::Pose.into());
        assert_eq!(pose["position"]["z"], 3.0);
        assert_eq!(pose["orientation"]["w"], 1.0);
        assert_eq!(written(&[1.0, 2.0, 3.0], Scalar::Vector.into())["y"], 2.0);
        let pairs = written(&[1.0, 2.0, 3.0, 4.0], Type::Matrix(2, 2));
        assert_eq!(pairs, json!([[1.0, 2.0], [3.0, 4.0]]));
        assert_eq!(
            written(&[1.0, 2.0], Type::Array(Scalar::Real, 2)),
            json!([1.0, 2.0])
        );
    }

    #[test]
    fn reals_come_back_as_they_were() {
        for value in [0.1, -0.0, 5e-324, 1.797e308, 1e21] {
            let back = written(&[value], Scalar::Real.into()).as_f64();
            assert_eq!(back.map(f64::to_bits), Some(value.to_bits()));
        }
        for (value, text) in [
            (f64::NAN, "nan"),
            (f64::INFINITY, "inf"),
            (f64::NEG_INFINITY, "-inf"),
        ] {
            assert_eq!(written(&[value], Scalar::Real.into()), text);
        }
    }

    #[test]
    fn schemas_name_the_fields() {
        let schema = schema(Scalar::Wrench.into());
        assert_eq!(
            schema["properties"]["force"]["properties"]["x"]["type"],
            "number"
        );
    }
}
