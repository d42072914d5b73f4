//! Conversion of values in the text form of the reference system to slots.

use rpi_image::{Scalar, Type};
use rpi_prims::geometry;

/// Returns the slots of a value; `None` if the text has another form. A matrix is recorded as the identity of an
/// object, and an array of the reference may contain absent elements.
pub(crate) fn cells(ty: Type, text: &str) -> Option<Vec<u64>> {
    let (scalar, count) = match ty {
        Type::Scalar(s) => (s, 1),
        Type::Array(s, n) => (s, n as usize),
        Type::Matrix(..) => return None,
    };
    let words = words(text);
    if words.contains(&"null") {
        return None;
    }
    let each = words_of(scalar);
    if words.len() != each * count {
        return None;
    }
    Some(words.chunks(each).flat_map(|w| one(scalar, w)).collect())
}

fn words_of(scalar: Scalar) -> usize {
    match scalar {
        Scalar::Bool | Scalar::Int | Scalar::Real | Scalar::Time => 1,
        Scalar::Vector | Scalar::Rotation => 3,
        Scalar::Pose | Scalar::Twist | Scalar::Wrench => 6,
    }
}

/// Returns the number of values in the text of an array.
pub(crate) fn array_len(text: &str) -> u32 {
    let inner = text.trim_start_matches('[').trim_end_matches(']');
    let mut depth = 0;
    let commas = inner.bytes().filter(|b| {
        depth += i32::from(*b == b'{') - i32::from(*b == b'}');
        depth == 0 && *b == b','
    });
    let commas = commas.count() as u32;
    commas + u32::from(!inner.is_empty())
}

/// Splits `[{pos:{x:1.0,y:2.0},...}]` into numbers without brackets and labels.
fn words(text: &str) -> Vec<&str> {
    text.split(['{', '}', '[', ']', ','])
        .filter_map(|word| word.rsplit(':').next())
        .filter(|word| !word.is_empty())
        .collect()
}

fn one(scalar: Scalar, words: &[&str]) -> Vec<u64> {
    match scalar {
        Scalar::Bool => vec![u64::from(words[0] == "true")],
        Scalar::Int => vec![words[0].parse::<i64>().expect("an integer").cast_unsigned()],
        Scalar::Time => vec![(words[0].parse::<i64>().expect("ms") * 1_000_000).cast_unsigned()],
        _ => spatial(scalar, &words.iter().map(|w| real(w)).collect::<Vec<_>>()),
    }
}

fn spatial(scalar: Scalar, reals: &[f64]) -> Vec<u64> {
    let rotation = |abc: &[f64]| {
        let r = geometry::from_abc(abc[0], abc[1], abc[2]);
        [r.i, r.j, r.k, r.w]
    };
    let reals = match scalar {
        Scalar::Rotation => rotation(reals).to_vec(),
        Scalar::Pose => [&reals[..3], &rotation(&reals[3..])].concat(),
        _ => reals.to_vec(),
    };
    reals.iter().map(|r| r.to_bits()).collect()
}

fn real(word: &str) -> f64 {
    match word {
        "nan" | "NaN" => f64::NAN,
        "+inf" | "Infinity" => f64::INFINITY,
        "-inf" | "-Infinity" => f64::NEG_INFINITY,
        _ => word.parse().unwrap_or_else(|_| panic!("a real: {word}")),
    }
}
