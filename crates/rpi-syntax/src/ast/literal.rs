//! Number literals, units and clocks.

use super::{Ident, Name};
use rpi_diag::Span;

/// Number literal, stored as its source text so that printing reproduces it.
#[derive(Clone, PartialEq, Debug)]
pub struct Number {
    /// Source text of the number: `250`, `0x1F`, `2.5e-3`, `0x1.8p3`.
    pub text: Name,
}

impl Number {
    /// Returns whether the literal is an integer, decimal or hexadecimal.
    pub fn is_int(&self) -> bool {
        match self.hex() {
            Some(digits) => digits.bytes().all(|b| b.is_ascii_hexdigit()),
            None => self.text.bytes().all(|b| b.is_ascii_digit()),
        }
    }

    /// Returns the value of an integer literal. [`None`] for a real, and for values above 2^63. The parser has reported
    /// such values.
    pub fn int_value(&self) -> Option<u64> {
        self.u64_value().filter(|value| *value <= 1 << 63)
    }

    /// Returns the value of an integer literal up to 2^64 - 1, as the unsigned machine integers of Kind 2 need it.
    /// [`None`] for a real or a larger value.
    pub fn u64_value(&self) -> Option<u64> {
        match self.hex() {
            Some(digits) => u64::from_str_radix(digits, 16).ok(),
            None => self.text.parse().ok(),
        }
    }

    /// Returns the value of an integer or real literal as a real, rounded to the nearest.
    pub fn real_value(&self) -> f64 {
        match self.hex() {
            Some(digits) => parse_hex_real(digits),
            None => self.text.parse().unwrap_or(f64::NAN),
        }
    }

    fn hex(&self) -> Option<&str> {
        self.text
            .strip_prefix("0x")
            .or_else(|| self.text.strip_prefix("0X"))
    }
}

/// Returns the value of the exponent in a decimal literal, limited to the range of `i64`.
fn parse_exponent(text: &str) -> i64 {
    let nearest = match text.starts_with('-') {
        true => i64::MIN,
        false => i64::MAX,
    };
    text.parse().unwrap_or(nearest)
}

/// Returns the real that is nearest to a hexadecimal literal with optional fraction and binary exponent: `1.8p3` is 12.
fn parse_hex_real(text: &str) -> f64 {
    let (digits, power) = text.split_once(['p', 'P']).unwrap_or((text, "0"));
    let mut power = parse_exponent(power);
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
            // Sticky bit: further digits only matter for whether the value is above the kept bits.
            false => value | u64::from(digit != 0),
        };
        power = match (has_room, is_behind) {
            (true, true) => power.saturating_sub(4),
            (false, false) => power.saturating_add(4),
            _ => power,
        };
    }
    round_to_f64(value, power)
}

/// Returns `value * 2^power` rounded to the nearest real, ties to even (IEEE 754).
fn round_to_f64(value: u64, power: i64) -> f64 {
    if value == 0 {
        return 0.0;
    }
    let zeros = value.leading_zeros();
    let value = value << zeros;
    // Exponent of the leading bit.
    let first = power.saturating_add(63 - i64::from(zeros));
    if first > 1023 {
        return f64::INFINITY;
    }
    let is_normal = first >= -1022;
    let dropped = match is_normal {
        true => 11,
        // The bound only prevents an overflow: such a small number is 0 in any case.
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
    // A carry out of the digits increments the exponent, which is the correct result.
    let exponent = if is_normal { (first + 1022) as u64 } else { 0 };
    f64::from_bits((exponent << 52) + digits)
}

/// Unit of measure as a product of powers: `m/s^2` is m^1 * s^-2. The unit `1` has no factors.
#[derive(Clone, PartialEq, Debug)]
pub struct Unit {
    /// Factors of the unit in text order, such as `m` and `s^-2`.
    pub factors: Vec<UnitFactor>,
    /// Source range of the unit, without brackets.
    pub span: Span,
}

impl Unit {
    /// Returns whether the unit is `%` alone, which is written without brackets: `60%`.
    pub fn is_percent(&self) -> bool {
        matches!(&self.factors[..], [f] if f.unit.name == "%" && f.power == 1)
    }
}

/// One factor of a unit: a name with its exponent, such as `s^-2` in `m*s^-2`.
#[derive(Clone, PartialEq, Debug)]
pub struct UnitFactor {
    /// Name of the base unit: `m`, `deg`, `%`.
    pub unit: Ident,
    /// Exponent of the base unit; negative after a `/`.
    pub power: i32,
}

/// Clock in `x when c`: the condition under which the flow has a value.
#[derive(Clone, PartialEq, Debug)]
pub struct Clock {
    /// Value of the flow at which the clock ticks.
    pub value: ClockValue,
    /// Flow that determines the clock.
    pub flow: Ident,
    /// Source range of the clock, without `when`.
    pub span: Span,
}

/// Value of its flow at which a clock ticks.
#[derive(Clone, PartialEq, Debug)]
pub enum ClockValue {
    /// The clock ticks when its flow is true: `when c`
    True,
    /// The clock ticks when its flow is false: `when not c`
    False,
    /// The clock ticks when its flow has this enum value: `when A(c)`
    Value(Ident),
}
