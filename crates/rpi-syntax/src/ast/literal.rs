//! Numbers, units and clocks.

use super::{Ident, Name};
use rpi_diag::Span;

/// A number as it was written; the text is kept, so that printing changes nothing.
#[derive(Clone, PartialEq, Debug)]
pub struct Number {
    /// The digits, `250`, `0x1F`, `2.5e-3`.
    pub text: Name,
}

impl Number {
    /// Whether it is written as an integer, decimal or hexadecimal.
    pub fn is_int(&self) -> bool {
        self.hex().is_some() || self.text.bytes().all(|b| b.is_ascii_digit())
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
            Some(digits) => u64::from_str_radix(digits, 16).map_or(f64::INFINITY, |v| v as f64),
            None => self.text.parse().unwrap_or(f64::NAN),
        }
    }

    fn hex(&self) -> Option<&str> {
        self.text
            .strip_prefix("0x")
            .or_else(|| self.text.strip_prefix("0X"))
    }
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
