//! Table of units and prefixes.

use crate::units::Dimension;

/// Factor from a unit to the coherent SI unit, as a fraction. Powers of ten are exact, so that `9[mm]` is the real
/// number nearest to 0.009.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Factor {
    /// Numerator of the factor.
    pub num: f64,
    /// Denominator of the factor, which is not 0.
    pub den: f64,
}

impl Factor {
    /// Factor of a coherent SI unit, which is 1.
    pub const ONE: Factor = Factor { num: 1.0, den: 1.0 };

    /// Returns the product of two factors.
    #[must_use]
    pub fn times(self, other: Factor) -> Factor {
        Factor {
            num: self.num * other.num,
            den: self.den * other.den,
        }
    }

    /// Returns an integer power of the factor.
    #[must_use]
    pub fn power(self, exponent: i32) -> Factor {
        let (num, den) = match exponent < 0 {
            true => (self.den, self.num),
            false => (self.num, self.den),
        };
        (0..exponent.unsigned_abs()).fold(Factor::ONE, |whole, _| whole.times(Factor { num, den }))
    }

    /// Returns a number in this unit as a number in the coherent SI unit.
    #[must_use]
    pub fn apply(self, value: f64) -> f64 {
        value * self.num / self.den
    }
}

/// Unit of measure in the table of units, without a prefix.
#[derive(Debug)]
pub struct UnitDef {
    /// Symbol of the unit in the source, without a prefix, such as `m`.
    pub name: &'static str,
    /// Name of the unit in words, such as "metre".
    pub doc: &'static str,
    /// Factor from the unit to the coherent SI unit.
    pub factor: Factor,
    /// Whether the unit may have an SI prefix, as in `mm`.
    pub takes_prefix: bool,
    /// Exponents of the base units kg, m, s, A, K, mol, cd and rad, in this order.
    exponents: [i32; 8],
}

impl UnitDef {
    /// Returns the physical dimension of the unit.
    #[must_use]
    pub fn dim(&self) -> Dimension {
        Dimension::from_exponents(self.exponents).unwrap_or(Dimension::ONE)
    }
}

const fn row(
    name: &'static str,
    doc: &'static str,
    (num, den): (f64, f64),
    prefixes: bool,
    exponents: [i32; 8],
) -> UnitDef {
    UnitDef {
        name,
        doc,
        factor: Factor { num, den },
        takes_prefix: prefixes,
        exponents,
    }
}

use std::f64::consts::PI;

/// All units without prefixes. Source: BIPM, The International System of Units, 9th edition, tables 2, 4 and 8. Units
/// that are common for machines are added.
#[rustfmt::skip]
pub const UNITS: &[UnitDef] = &[
    row("m",      "metre",              (1.0, 1.0),            true,  [0, 1, 0, 0, 0, 0, 0, 0]),
    row("g",      "gram",               (1.0, 1e3),            true,  [1, 0, 0, 0, 0, 0, 0, 0]),
    row("s",      "second",             (1.0, 1.0),            true,  [0, 0, 1, 0, 0, 0, 0, 0]),
    row("A",      "ampere",             (1.0, 1.0),            true,  [0, 0, 0, 1, 0, 0, 0, 0]),
    row("K",      "kelvin",             (1.0, 1.0),            true,  [0, 0, 0, 0, 1, 0, 0, 0]),
    row("mol",    "mole",               (1.0, 1.0),            true,  [0, 0, 0, 0, 0, 1, 0, 0]),
    row("cd",     "candela",            (1.0, 1.0),            true,  [0, 0, 0, 0, 0, 0, 1, 0]),
    row("rad",    "radian",             (1.0, 1.0),            true,  [0, 0, 0, 0, 0, 0, 0, 1]),
    row("deg",    "degree of arc",      (PI, 180.0),           false, [0, 0, 0, 0, 0, 0, 0, 1]),
    row("arcmin", "minute of arc",      (PI, 10_800.0),        false, [0, 0, 0, 0, 0, 0, 0, 1]),
    row("arcsec", "second of arc",      (PI, 648_000.0),       false, [0, 0, 0, 0, 0, 0, 0, 1]),
    row("rev",    "revolution",         (2.0 * PI, 1.0),       false, [0, 0, 0, 0, 0, 0, 0, 1]),
    row("rpm",    "revolution per minute", (2.0 * PI, 60.0),   false, [0, 0, -1, 0, 0, 0, 0, 1]),
    row("Hz",     "hertz",              (1.0, 1.0),            true,  [0, 0, -1, 0, 0, 0, 0, 0]),
    row("N",      "newton",             (1.0, 1.0),            true,  [1, 1, -2, 0, 0, 0, 0, 0]),
    row("Nm",     "newton metre",       (1.0, 1.0),            true,  [1, 2, -2, 0, 0, 0, 0, 0]),
    row("Pa",     "pascal",             (1.0, 1.0),            true,  [1, -1, -2, 0, 0, 0, 0, 0]),
    row("bar",    "bar",                (1e5, 1.0),            true,  [1, -1, -2, 0, 0, 0, 0, 0]),
    row("J",      "joule",              (1.0, 1.0),            true,  [1, 2, -2, 0, 0, 0, 0, 0]),
    row("W",      "watt",               (1.0, 1.0),            true,  [1, 2, -3, 0, 0, 0, 0, 0]),
    row("Wh",     "watt hour",          (3600.0, 1.0),         true,  [1, 2, -2, 0, 0, 0, 0, 0]),
    row("C",      "coulomb",            (1.0, 1.0),            true,  [0, 0, 1, 1, 0, 0, 0, 0]),
    row("V",      "volt",               (1.0, 1.0),            true,  [1, 2, -3, -1, 0, 0, 0, 0]),
    row("F",      "farad",              (1.0, 1.0),            true,  [-1, -2, 4, 2, 0, 0, 0, 0]),
    row("Ohm",    "ohm",                (1.0, 1.0),            true,  [1, 2, -3, -2, 0, 0, 0, 0]),
    row("S",      "siemens",            (1.0, 1.0),            true,  [-1, -2, 3, 2, 0, 0, 0, 0]),
    row("Wb",     "weber",              (1.0, 1.0),            true,  [1, 2, -2, -1, 0, 0, 0, 0]),
    row("T",      "tesla",              (1.0, 1.0),            true,  [1, 0, -2, -1, 0, 0, 0, 0]),
    row("H",      "henry",              (1.0, 1.0),            true,  [1, 2, -2, -2, 0, 0, 0, 0]),
    row("min",    "minute",             (60.0, 1.0),           false, [0, 0, 1, 0, 0, 0, 0, 0]),
    row("h",      "hour",               (3600.0, 1.0),         false, [0, 0, 1, 0, 0, 0, 0, 0]),
    row("d",      "day",                (86_400.0, 1.0),       false, [0, 0, 1, 0, 0, 0, 0, 0]),
    row("l",      "litre",              (1.0, 1e3),            true,  [0, 3, 0, 0, 0, 0, 0, 0]),
    row("L",      "litre",              (1.0, 1e3),            true,  [0, 3, 0, 0, 0, 0, 0, 0]),
    row("t",      "tonne",              (1e3, 1.0),            true,  [1, 0, 0, 0, 0, 0, 0, 0]),
    row("inch",   "inch",               (254.0, 1e4),          false, [0, 1, 0, 0, 0, 0, 0, 0]),
    row("lbf",    "pound of force",     (4.448_221_615_260_5, 1.0), false, [1, 1, -2, 0, 0, 0, 0, 0]),
    row("%",      "per cent",           (1.0, 100.0),          false, [0; 8]),
    row("ppm",    "part per million",   (1.0, 1e6),            false, [0; 8]),
];

/// Other names and spellings of units that users may try, each with the unit that is suggested instead.
pub(super) const ALIASES: &[(&str, &str)] = &[
    ("meter", "m"),
    ("metre", "m"),
    ("meters", "m"),
    ("metres", "m"),
    ("millimeter", "mm"),
    ("millimetre", "mm"),
    ("micron", "um"),
    ("sec", "s"),
    ("second", "s"),
    ("seconds", "s"),
    ("msec", "ms"),
    ("secs", "s"),
    ("millisecond", "ms"),
    ("milliseconds", "ms"),
    ("msecs", "ms"),
    ("microsecond", "us"),
    ("microseconds", "us"),
    ("millimeters", "mm"),
    ("millimetres", "mm"),
    ("centimeter", "cm"),
    ("centimetre", "cm"),
    ("kilometer", "km"),
    ("minutes", "min"),
    ("hours", "h"),
    ("minute", "min"),
    ("hour", "h"),
    ("hr", "h"),
    ("degree", "deg"),
    ("degrees", "deg"),
    ("grad", "deg"),
    ("radian", "rad"),
    ("radians", "rad"),
    ("turn", "rev"),
    ("kilogram", "kg"),
    ("gram", "g"),
    ("newton", "N"),
    ("pascal", "Pa"),
    ("volt", "V"),
    ("ampere", "A"),
    ("amp", "A"),
    ("watt", "W"),
    ("joule", "J"),
    ("hertz", "Hz"),
    ("percent", "%"),
    ("mps", "m/s"),
    ("mms", "mm/s"),
    ("kmh", "km/h"),
    ("kph", "km/h"),
    ("mps2", "m/s^2"),
    ("mmps", "mm/s"),
    ("radps", "rad/s"),
    ("degps", "deg/s"),
    ("rps", "rev/s"),
    ("in", "inch"),
];

/// SI prefixes of units with their factors.
#[rustfmt::skip]
pub(super) const PREFIXES: &[(&str, Factor)] = &[
    ("da", Factor { num: 10.0, den: 1.0 }),
    ("h", Factor { num: 1e2, den: 1.0 }),
    ("k", Factor { num: 1e3, den: 1.0 }),
    ("M", Factor { num: 1e6, den: 1.0 }),
    ("G", Factor { num: 1e9, den: 1.0 }),
    ("T", Factor { num: 1e12, den: 1.0 }),
    ("P", Factor { num: 1e15, den: 1.0 }),
    ("E", Factor { num: 1e18, den: 1.0 }),
    ("d", Factor { num: 1.0, den: 10.0 }),
    ("c", Factor { num: 1.0, den: 1e2 }),
    ("m", Factor { num: 1.0, den: 1e3 }),
    ("u", Factor { num: 1.0, den: 1e6 }),
    ("n", Factor { num: 1.0, den: 1e9 }),
    ("p", Factor { num: 1.0, den: 1e12 }),
    ("f", Factor { num: 1.0, den: 1e15 }),
    ("a", Factor { num: 1.0, den: 1e18 }),
];
