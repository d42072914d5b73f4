//! Numbers of a column as bytes: exact, or rounded and predicted so that a compressor makes them small.
//!
//! Rounded values are integers of 32 bits with a common power of two as unit. Each is predicted from the values before
//! it by a polynomial of order 0 to 4, as in FLAC and other lossless audio codecs (RFC 9639, section 9.2.5), because
//! set-points are smooth. The differences are stored byte by byte: first all low bytes, then the next ones. The high
//! bytes are nearly all 0, and a compressor removes them.

use rpi_record::mcap::{Column, ColumnKind};

use crate::document::Precision;

/// Highest order of the prediction.
const MAX_ORDER: u32 = 4;
/// Number of bits of a rounded value without its sign.
const BITS: i32 = 31;

/// Bytes of a column, with what a reader needs to decode them.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Block {
    /// `f64`: numbers of 64 bits; `i32`: differences of rounded values, byte by byte.
    pub(crate) form: &'static str,
    /// Rounded values are multiples of 2 to this power.
    pub(crate) exponent: i32,
    /// Order of the prediction.
    pub(crate) order: u32,
    pub(crate) bytes: Vec<u8>,
}

/// Encodes the values of a column. Columns with values that are not finite, or integers beyond 32 bits, are always
/// exact.
pub(crate) fn encode(column: &Column, precision: Precision) -> Block {
    let rounded = match precision {
        Precision::Exact => None,
        Precision::Rounded => round(column),
    };
    match rounded {
        Some((exponent, values)) => {
            let (order, differences) = predict(values);
            Block {
                form: "i32",
                exponent,
                order,
                bytes: by_byte(&differences),
            }
        }
        None => Block {
            form: "f64",
            exponent: 0,
            order: 0,
            bytes: column.values.iter().flat_map(|v| v.to_le_bytes()).collect(),
        },
    }
}

/// Returns the values of a column as integers and the exponent of their unit; `None` if they cannot be rounded. A row
/// without a value repeats the row before it.
fn round(column: &Column) -> Option<(i32, Vec<i32>)> {
    let mut absent = vec![false; column.values.len()];
    for rows in &column.absent {
        absent.get_mut(rows.clone())?.fill(true);
    }
    let present = column
        .values
        .iter()
        .zip(&absent)
        .filter(|(_, absent)| !**absent);
    let mut largest = 0.0_f64;
    for (value, _) in present {
        if !value.is_finite() {
            return None;
        }
        largest = largest.max(value.abs());
    }
    let exponent = match column.kind {
        ColumnKind::Bool | ColumnKind::Int => 0,
        // The largest value must not be rounded up beyond 31 bits.
        ColumnKind::Real => binary_exponent(largest * (1.0 + power_of_two(1 - BITS))) + 1 - BITS,
    };
    // Two factors, because one would overflow for the smallest numbers.
    let (half, rest) = (exponent / 2, exponent - exponent / 2);
    let (half, rest) = (power_of_two(-half), power_of_two(-rest));
    let mut last = 0;
    let integer = |(value, absent): (&f64, &bool)| {
        if !*absent {
            let scaled = (value * half * rest).round();
            if scaled.abs() > f64::from(i32::MAX) {
                return None;
            }
            // In range, as checked above.
            last = scaled as i32;
        }
        Some(last)
    };
    let values: Option<Vec<i32>> = column.values.iter().zip(&absent).map(integer).collect();
    Some((exponent, values?))
}

/// Returns the exponent e with 2ᵉ ≤ value < 2ᵉ⁺¹ of a positive value, and at least -900; 0 for 0.
fn binary_exponent(value: f64) -> i32 {
    if value == 0.0 {
        return 0;
    }
    // 11 bits fit.
    let biased = (value.to_bits() >> 52) as i32 & 0x7ff;
    (biased - 1023).max(-900)
}

/// Returns 2 to the power of `exponent`, which must be that of a normal number.
fn power_of_two(exponent: i32) -> f64 {
    f64::from_bits(((1023 + i64::from(exponent)).clamp(1, 2046) as u64) << 52)
}

/// Returns the order of prediction with the smallest differences, and these. Differences wrap, so that every order is
/// exact.
fn predict(mut values: Vec<i32>) -> (u32, Vec<i32>) {
    let cost = |values: &[i32]| -> u64 {
        let bits = values
            .iter()
            .map(|v| u64::from(32 - v.unsigned_abs().leading_zeros()));
        bits.sum()
    };
    let mut best = (0, values.clone(), cost(&values));
    for order in 1..=MAX_ORDER {
        difference(&mut values);
        let own = cost(&values);
        if own < best.2 {
            best = (order, values.clone(), own);
        }
    }
    (best.0, best.1)
}

/// Replaces each value by its difference to the one before it.
fn difference(values: &mut [i32]) {
    let mut before = 0_i32;
    for value in values {
        let own = *value;
        *value = own.wrapping_sub(before);
        before = own;
    }
}

/// Returns the values byte by byte, the low bytes first. The sign is the lowest bit, so that small values have zero
/// high bytes.
fn by_byte(values: &[i32]) -> Vec<u8> {
    let folded: Vec<u32> = values
        .iter()
        .map(|v| (v.wrapping_shl(1) ^ (v >> 31)).cast_unsigned())
        .collect();
    let planes = (0..4).flat_map(|k| folded.iter().map(move |v| v.to_le_bytes()[k]));
    planes.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn column(values: &[f64], kind: ColumnKind) -> Column {
        Column {
            name: String::new(),
            kind,
            unit: String::new(),
            values: values.to_vec(),
            integers: values.iter().map(|value| *value as i64).collect(),
            absent: Vec::new(),
        }
    }

    /// Decodes a block of form `i32` as the page does.
    fn decode(block: &Block) -> Vec<f64> {
        let rows = block.bytes.len() / 4;
        let folded =
            (0..rows).map(|r| u32::from_le_bytes([0, 1, 2, 3].map(|k| block.bytes[k * rows + r])));
        let mut values: Vec<i32> = folded
            .map(|u| (u >> 1).cast_signed() ^ -((u & 1).cast_signed()))
            .collect();
        for _ in 0..block.order {
            let mut sum = 0_i32;
            for value in &mut values {
                sum = sum.wrapping_add(*value);
                *value = sum;
            }
        }
        let unit = power_of_two(block.exponent);
        values.into_iter().map(|v| f64::from(v) * unit).collect()
    }

    #[test]
    fn rounded_values_come_back_within_their_unit() {
        let cases = [
            vec![0.0, 0.0],
            vec![-3.1, 2.0, 0.125, -0.0],
            vec![1e300, -1e300, 1.0],
            vec![4e-13, 3e-13],
            vec![f64::from_bits(0.25_f64.to_bits() - 1), 0.1],
            vec![2.0, -2.0, 2.0, -2.0, 2.0, -2.0],
        ];
        for values in cases {
            let block = encode(&column(&values, ColumnKind::Real), Precision::Rounded);
            assert_eq!(block.form, "i32", "{values:?}");
            let largest = values.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
            for (value, back) in values.iter().zip(decode(&block)) {
                let error = (value - back).abs();
                assert!(error <= largest * power_of_two(-30), "{value} {back}");
            }
        }
    }

    #[test]
    fn whole_numbers_come_back_as_they_were() {
        let values = [0.0, 1.0, -7.0, 2_147_483_647.0, -2_147_483_647.0];
        let block = encode(&column(&values, ColumnKind::Int), Precision::Rounded);
        assert_eq!(decode(&block), values);
    }

    #[test]
    fn a_cubic_motion_takes_one_byte_per_value() {
        let motion: Vec<f64> = (0..1000).map(|k| f64::from(k) / 1000.0).collect();
        let motion: Vec<f64> = motion.iter().map(|t| t * t * (3.0 - 2.0 * t)).collect();
        let block = encode(&column(&motion, ColumnKind::Real), Precision::Rounded);
        assert!(block.order >= 2, "{}", block.order);
        let high = block.bytes[1000..].iter().filter(|b| **b != 0).count();
        assert!(high < 100, "{high}");
    }

    #[test]
    fn what_has_no_rounded_form_is_exact() {
        let infinite = column(&[1.0, f64::INFINITY], ColumnKind::Real);
        assert_eq!(encode(&infinite, Precision::Rounded).form, "f64");
        let large = column(&[1e12], ColumnKind::Int);
        assert_eq!(encode(&large, Precision::Rounded).form, "f64");
        let exact = encode(&column(&[0.1], ColumnKind::Real), Precision::Exact);
        assert_eq!(exact.bytes, 0.1_f64.to_le_bytes());
    }

    #[test]
    fn a_row_without_a_value_repeats_the_row_before() {
        let mut gap = column(&[2.0, f64::NAN, 2.0], ColumnKind::Int);
        gap.absent = std::iter::once(1..2).collect();
        let block = encode(&gap, Precision::Rounded);
        assert_eq!(decode(&block), [2.0, 2.0, 2.0]);
    }
}
