//! Numbers, units and clocks.

use super::{Ident, Name};
use rpi_diag::Span;

/// A number as it was written; the text is kept, so that printing changes nothing.
#[derive(Clone, PartialEq, Debug)]
pub struct Number {
    /// The digits, `250`, `0x1F`, `2.5e-3`, `0x1.8p3`.
    pub text: Name,
}

impl Number {
    /// Whether it is written as an integer, decimal or hexadecimal.
    pub fn is_int(&self) -> bool {
        match self.hex() {
            Some(digits) => digits.bytes().all(|b| b.is_ascii_hexdigit()),
            None => self.text.bytes().all(|b| b.is_ascii_digit()),
        }
    }

    /// The value of an integer. [`None`] for a real and beyond 2^63, which the parser has reported.
    pub fn int(&self) -> Option<u64> {
        self.bits().filter(|value| *value <= 1 << 63)
    }

    /// The value of an integer of 64 bits without sign, as a machine integer of Kind 2 takes it.
    pub fn bits(&self) -> Option<u64> {
        match self.hex() {
            Some(digits) => u64::from_str_radix(digits, 16).ok(),
            None => self.text.parse().ok(),
        }
    }

    /// The value as a real; of an integer the nearest one.
    pub fn real(&self) -> f64 {
        match self.hex() {
            Some(digits) => hex_real(digits),
            None => self.text.parse().unwrap_or(f64::NAN),
        }
    }

    fn hex(&self) -> Option<&str> {
        self.text
            .strip_prefix("0x")
            .or_else(|| self.text.strip_prefix("0X"))
    }
}

/// The value of hexadecimal digits, maybe with some behind a dot, times a power of two: `1.8p3` is 12. It is the nearest real.
fn hex_real(text: &str) -> f64 {
    let (digits, power) = text.split_once(['p', 'P']).unwrap_or((text, "0"));
    let beyond = if power.starts_with('-') {
        i64::MIN
    } else {
        i64::MAX
    };
    let mut power: i64 = power.parse().unwrap_or(beyond);
    let mut value = 0u64;
    let mut is_behind = false;
    for digit in digits.chars() {
        let Some(digit) = digit.to_digit(16) else {
            is_behind = true;
            continue;
        };
        let has_room = value >> 60 == 0;
        value = match has_room {
            true => value << 4 | u64::from(digit),
            // What is left out only says whether the value lies above what is kept.
            false => value | u64::from(digit != 0),
        };
        power = match (has_room, is_behind) {
            (true, true) => power.saturating_sub(4),
            (false, false) => power.saturating_add(4),
            _ => power,
        };
    }
    nearest(value, power)
}

/// The real that is nearest to a number times a power of two; of two the even one.
fn nearest(value: u64, power: i64) -> f64 {
    if value == 0 {
        return 0.0;
    }
    let zeros = value.leading_zeros();
    let value = value << zeros;
    // The power of two of the first digit.
    let first = power.saturating_add(63 - i64::from(zeros));
    if first > 1023 {
        return f64::INFINITY;
    }
    let is_normal = first >= -1022;
    let dropped = match is_normal {
        true => 11,
        false => 11 - 1022 - first.max(-2000),
    };
    if dropped > 64 {
        return 0.0;
    }
    let wide = u128::from(value);
    let kept = wide >> dropped;
    let rest = wide - (kept << dropped);
    let half = 1u128 << (dropped - 1);
    let is_up = rest > half || rest == half && kept & 1 == 1;
    let digits = kept as u64 + u64::from(is_up);
    // One digit more by rounding up goes over into the exponent, which is what it means.
    let exponent = if is_normal { (first + 1022) as u64 } else { 0 };
    f64::from_bits((exponent << 52) + digits)
}

/// A unit of measure as a product of powers: `m/s^2` is m to the 1 and s to the -2; `1` is empty.
#[derive(Clone, PartialEq, Debug)]
pub struct Unit {
    /// The factors in text order.
    pub factors: Vec<UnitFactor>,
    /// All of it, without brackets.
    pub span: Span,
}

impl Unit {
    /// Whether it is `%` alone, which is written without brackets: `60%`.
    pub fn is_percent(&self) -> bool {
        matches!(&self.factors[..], [f] if f.unit.name == "%" && f.power == 1)
    }
}

/// One factor of a [`Unit`].
#[derive(Clone, PartialEq, Debug)]
pub struct UnitFactor {
    /// `m`, `deg`, `%`.
    pub unit: Ident,
    /// Its power, negative after a `/`.
    pub power: i32,
}

/// The clock of `x when c`.
#[derive(Clone, PartialEq, Debug)]
pub struct Clock {
    /// When the clock ticks.
    pub tick: Tick,
    /// The flow that decides.
    pub flow: Ident,
    /// All of it, after `when`.
    pub span: Span,
}

/// For which values of its flow a clock ticks.
#[derive(Clone, PartialEq, Debug)]
pub enum Tick {
    /// `when c`
    True,
    /// `when not c`
    False,
    /// `when A(c)`, an enum's value
    Value(Ident),
}
