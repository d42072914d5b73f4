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
        let value = match self.hex() {
            Some(digits) => u64::from_str_radix(digits, 16).ok()?,
            None => self.text.parse().ok()?,
        };
        (value <= 1 << 63).then_some(value)
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

/// The value of hexadecimal digits, maybe with some behind a dot, times a power of two: `1.8p3` is 12.
fn hex_real(text: &str) -> f64 {
    let (digits, power) = text.split_once(['p', 'P']).unwrap_or((text, "0"));
    let (whole, part) = digits.split_once('.').unwrap_or((digits, ""));
    let all = whole.chars().chain(part.chars());
    let value = all.fold(0.0, |value, digit| {
        value * 16.0 + f64::from(digit.to_digit(16).unwrap_or(0))
    });
    let behind = i32::try_from(part.len()).unwrap_or(i32::MAX);
    // Beyond this any number has become infinite or 0.
    let power = power.parse().unwrap_or(i32::MAX).clamp(-5000, 5000);
    scaled(value, power.saturating_sub(behind.saturating_mul(4)))
}

/// A number times a power of two, in steps that hold each by itself.
fn scaled(mut value: f64, mut power: i32) -> f64 {
    while power != 0 && value != 0.0 && value.is_finite() {
        let step = power.clamp(-500, 500);
        value *= f64::from_bits(u64::from((1023 + step).unsigned_abs()) << 52);
        power -= step;
    }
    value
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
