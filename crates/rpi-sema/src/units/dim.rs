//! Dimensions: products of rational powers of the base dimensions.

use crate::units::Ratio;
use std::fmt;

/// Base dimension, named after its quantity.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum Base {
    /// Mass, `kg`.
    Mass,
    /// Length, `m`.
    Length,
    /// Time, `s`.
    Time,
    /// Electric current, `A`.
    Current,
    /// Thermodynamic temperature, `K`.
    Temperature,
    /// Amount of substance, `mol`.
    Amount,
    /// Luminous intensity, `cd`.
    Luminosity,
    /// Plane angle, `rad`.
    Angle,
}

/// Number of base dimensions in [`Base`].
const KNOWN: usize = 8;

/// Number of free dimensions: those of type parameters while a generic declaration is checked. Three do not enlarge
/// [`crate::ty::Ty`]. A declaration with more of them is checked in several rounds.
pub const FREE: usize = 3;

const BASES: usize = KNOWN + FREE;

/// Units of the base dimensions, in the order of [`Base`], in which they are printed. Free dimensions have private-use
/// characters, which the checker replaces by the names of the parameters.
const BASE_UNITS: [&str; BASES] = [
    "kg", "m", "s", "A", "K", "mol", "cd", "rad", "\u{E000}", "\u{E001}", "\u{E002}",
];

/// Dimensions that are printed with a name of their own.
const NAMED: [(&str, [i32; KNOWN]); 8] = [
    ("N", [1, 1, -2, 0, 0, 0, 0, 0]),
    ("N*m", [1, 2, -2, 0, 0, 0, 0, 0]),
    ("W", [1, 2, -3, 0, 0, 0, 0, 0]),
    ("Pa", [1, -1, -2, 0, 0, 0, 0, 0]),
    ("C", [0, 0, 1, 1, 0, 0, 0, 0]),
    ("V", [1, 2, -3, -1, 0, 0, 0, 0]),
    ("Ohm", [1, 2, -3, -2, 0, 0, 0, 0]),
    ("T", [1, 0, -2, -1, 0, 0, 0, 0]),
];

/// Common names of quantities, with an article.
const QUANTITIES: [(&str, [i32; KNOWN]); 20] = [
    ("a mass", [1, 0, 0, 0, 0, 0, 0, 0]),
    ("a length", [0, 1, 0, 0, 0, 0, 0, 0]),
    ("an area", [0, 2, 0, 0, 0, 0, 0, 0]),
    ("a volume", [0, 3, 0, 0, 0, 0, 0, 0]),
    ("a time", [0, 0, 1, 0, 0, 0, 0, 0]),
    ("a frequency", [0, 0, -1, 0, 0, 0, 0, 0]),
    ("a speed", [0, 1, -1, 0, 0, 0, 0, 0]),
    ("an acceleration", [0, 1, -2, 0, 0, 0, 0, 0]),
    ("a jerk", [0, 1, -3, 0, 0, 0, 0, 0]),
    ("an angle", [0, 0, 0, 0, 0, 0, 0, 1]),
    ("an angular speed", [0, 0, -1, 0, 0, 0, 0, 1]),
    ("an angular acceleration", [0, 0, -2, 0, 0, 0, 0, 1]),
    ("a force", [1, 1, -2, 0, 0, 0, 0, 0]),
    ("a torque or energy", [1, 2, -2, 0, 0, 0, 0, 0]),
    ("a power", [1, 2, -3, 0, 0, 0, 0, 0]),
    ("a pressure", [1, -1, -2, 0, 0, 0, 0, 0]),
    ("a current", [0, 0, 0, 1, 0, 0, 0, 0]),
    ("a charge", [0, 0, 1, 1, 0, 0, 0, 0]),
    ("a voltage", [1, 2, -3, -1, 0, 0, 0, 0]),
    ("a temperature", [0, 0, 0, 0, 1, 0, 0, 0]),
];

/// Dimension: exponents of the base dimensions.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct Dim([Ratio; BASES]);

impl Dim {
    /// Dimensionless.
    pub const ONE: Dim = Dim([Ratio::ZERO; BASES]);
    /// Length, m.
    pub const LENGTH: Dim = Dim::base(Base::Length);
    /// Time, s.
    pub const TIME: Dim = Dim::base(Base::Time);
    /// Plane angle, rad.
    pub const ANGLE: Dim = Dim::base(Base::Angle);

    /// Dimension of a base quantity.
    #[must_use]
    pub const fn base(base: Base) -> Dim {
        let mut exponents = [Ratio::ZERO; BASES];
        exponents[base as usize] = Ratio::ONE;
        Dim(exponents)
    }

    /// Free dimension number `place`, below [`FREE`]. It equals only itself.
    #[must_use]
    pub fn free(place: usize) -> Dim {
        let mut exponents = [Ratio::ZERO; BASES];
        exponents[KNOWN + place % FREE] = Ratio::ONE;
        Dim(exponents)
    }

    /// Returns whether a free dimension is a factor.
    #[must_use]
    pub fn has_free(self) -> bool {
        self.0[KNOWN..].iter().any(|exponent| !exponent.is_zero())
    }

    /// Returns the character that represents a free dimension in texts.
    #[must_use]
    pub fn free_sign(place: usize) -> &'static str {
        BASE_UNITS[KNOWN + place % FREE]
    }

    /// Creates a dimension from integer exponents in the order of [`Base`]; none if one is out of range.
    #[must_use]
    pub fn whole(exponents: [i32; KNOWN]) -> Option<Dim> {
        let mut dim = Dim::ONE;
        for (to, from) in dim.0.iter_mut().zip(exponents) {
            *to = Ratio::whole(from)?;
        }
        Some(dim)
    }

    /// Exponent of a base dimension.
    #[must_use]
    pub fn exponent(self, base: Base) -> Ratio {
        self.0[base as usize]
    }

    /// Product; none if an exponent is out of range.
    #[must_use]
    pub fn times(self, other: Dim) -> Option<Dim> {
        let mut dim = self;
        for (to, with) in dim.0.iter_mut().zip(other.0) {
            *to = to.plus(with)?;
        }
        Some(dim)
    }

    /// Power; none if an exponent is out of range.
    #[must_use]
    pub fn power(self, exponent: Ratio) -> Option<Dim> {
        let mut dim = self;
        for to in &mut dim.0 {
            *to = to.times(exponent)?;
        }
        Some(dim)
    }

    /// Quotient; none if an exponent is out of range.
    #[must_use]
    pub fn over(self, other: Dim) -> Option<Dim> {
        self.times(other.inverse())
    }

    /// Reciprocal.
    #[must_use]
    pub fn inverse(self) -> Dim {
        Dim(self.0.map(Ratio::opposite))
    }

    /// Returns whether values of both dimensions may be added and compared: equal except for the angle (see
    /// [`crate::units`]).
    #[must_use]
    pub fn meets(self, other: Dim) -> bool {
        self.without_angle() == other.without_angle()
    }

    /// Returns whether the dimension is that of a plain number or an angle.
    #[must_use]
    pub fn is_plain(self) -> bool {
        self.meets(Dim::ONE)
    }

    /// Common name of a quantity of this dimension, with an article: `a speed`.
    #[must_use]
    pub fn quantity(self) -> Option<&'static str> {
        named(&QUANTITIES, self)
    }

    /// Returns whether this is a pure reciprocal: no exponent is positive and at least one is negative.
    #[must_use]
    pub fn is_inverse(self) -> bool {
        let signed = |e: &&Ratio| !e.is_zero();
        let mut exponents = self.0.iter().filter(signed).peekable();
        exponents.peek().is_some() && exponents.all(|e| e.is_negative())
    }

    fn without_angle(self) -> Dim {
        let mut dim = self;
        dim.0[Base::Angle as usize] = Ratio::ZERO;
        dim
    }

    /// Factors with exponents of one sign, printed without the sign.
    fn product(self, negative: bool) -> Vec<String> {
        let signed = |e: Ratio| !e.is_zero() && e.is_negative() == negative;
        let factor = |(unit, e): (&str, Ratio)| {
            let e = if negative { e.opposite() } else { e };
            match e == Ratio::ONE {
                true => unit.to_owned(),
                false => format!("{unit}^{e}"),
            }
        };
        let all = BASE_UNITS.into_iter().zip(self.0);
        all.filter(|(_, e)| signed(*e)).map(factor).collect()
    }
}

/// Looks up a dimension in a table of names.
fn named(table: &[(&'static str, [i32; KNOWN])], dim: Dim) -> Option<&'static str> {
    let is = |row: &&(&str, [i32; KNOWN])| Dim::whole(row.1) == Some(dim);
    table.iter().find(is).map(|row| row.0)
}

/// Formats the dimension as between brackets: `m/s^2`, `N`, `1/s`, `1`.
impl fmt::Display for Dim {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(name) = named(&NAMED, *self) {
            return f.write_str(name);
        }
        let (above, below) = (self.product(false), self.product(true));
        let above = match above.is_empty() {
            true => "1".to_owned(),
            false => above.join("*"),
        };
        f.write_str(&above)?;
        below.iter().try_for_each(|factor| write!(f, "/{factor}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn speed() -> Dim {
        Dim::LENGTH.over(Dim::TIME).unwrap()
    }

    #[test]
    fn printing() {
        assert_eq!(Dim::ONE.to_string(), "1");
        assert_eq!(speed().to_string(), "m/s");
        assert_eq!(speed().over(Dim::TIME).unwrap().to_string(), "m/s^2");
        assert_eq!(Dim::TIME.inverse().to_string(), "1/s");
        let newton = Dim::whole([1, 1, -2, 0, 0, 0, 0, 0]).unwrap();
        assert_eq!(newton.to_string(), "N");
        let damping = newton.over(speed()).unwrap();
        assert_eq!(damping.to_string(), "kg/s");
        let root = Dim::LENGTH.power(Ratio::HALF).unwrap();
        assert_eq!(root.to_string(), "m^(1/2)");
    }

    #[test]
    fn angles_meet_plain_numbers_and_nothing_else_does() {
        assert!(Dim::ANGLE.meets(Dim::ONE) && Dim::ANGLE.is_plain());
        assert_ne!(Dim::ANGLE, Dim::ONE);
        assert!(!Dim::LENGTH.meets(Dim::ONE));
        assert!(!speed().meets(Dim::LENGTH));
    }

    #[test]
    fn exponents_that_do_not_fit_are_refused() {
        let big = Dim::LENGTH.power(Ratio::whole(100).unwrap()).unwrap();
        assert_eq!(big.times(big), None);
        assert_eq!(big.over(big), Some(Dim::ONE));
    }
}
