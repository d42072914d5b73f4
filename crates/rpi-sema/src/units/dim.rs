//! Dimensions: products of rational powers of the base dimensions.

use crate::units::Ratio;
use std::fmt;

/// Base dimension of the system of units, named after its quantity.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum BaseDim {
    /// Mass, with the unit `kg`.
    Mass,
    /// Length, with the unit `m`.
    Length,
    /// Time, with the unit `s`.
    Time,
    /// Electric current, with the unit `A`.
    Current,
    /// Thermodynamic temperature, with the unit `K`.
    Temperature,
    /// Amount of substance, with the unit `mol`.
    Amount,
    /// Luminous intensity, with the unit `cd`.
    Luminosity,
    /// Plane angle, with the unit `rad`. It is a dimension here to detect missing angle units.
    Angle,
}

/// Number of base dimensions, that is, of variants of [`BaseDim`].
const BASE_COUNT: usize = 8;

/// Number of free dimensions. They stand for the unknown units of type parameters while a generic declaration is
/// checked. Three free dimensions do not enlarge [`crate::ty::Ty`]; a declaration with more such parameters is checked
/// in several rounds.
pub const FREE_COUNT: usize = 3;

const EXPONENT_COUNT: usize = BASE_COUNT + FREE_COUNT;

/// Units of the base dimensions and signs of the free dimensions, in the order of the exponents, in which they are
/// printed. The signs are private-use characters, which the checker replaces by the names of type parameters.
const BASE_UNITS: [&str; EXPONENT_COUNT] = [
    "kg", "m", "s", "A", "K", "mol", "cd", "rad", "\u{E000}", "\u{E001}", "\u{E002}",
];

/// Dimensions that are printed by the name of a derived unit, with their exponents of the base dimensions.
const NAMED_DIMS: [(&str, [i32; BASE_COUNT]); 8] = [
    ("N", [1, 1, -2, 0, 0, 0, 0, 0]),
    ("N*m", [1, 2, -2, 0, 0, 0, 0, 0]),
    ("W", [1, 2, -3, 0, 0, 0, 0, 0]),
    ("Pa", [1, -1, -2, 0, 0, 0, 0, 0]),
    ("C", [0, 0, 1, 1, 0, 0, 0, 0]),
    ("V", [1, 2, -3, -1, 0, 0, 0, 0]),
    ("Ohm", [1, 2, -3, -2, 0, 0, 0, 0]),
    ("T", [1, 0, -2, -1, 0, 0, 0, 0]),
];

/// Common names of quantities, with an article, and the exponents of their base dimensions.
const QUANTITIES: [(&str, [i32; BASE_COUNT]); 20] = [
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

/// Physical dimension: the exponents of the base dimensions and of the free dimensions, which stand for unknown units
/// of type parameters.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct Dimension([Ratio; EXPONENT_COUNT]);

impl Dimension {
    /// Dimension of a plain number: all exponents are 0.
    pub const ONE: Dimension = Dimension([Ratio::ZERO; EXPONENT_COUNT]);
    /// Dimension of a length, m.
    pub const LENGTH: Dimension = Dimension::base(BaseDim::Length);
    /// Dimension of a time, s.
    pub const TIME: Dimension = Dimension::base(BaseDim::Time);
    /// Dimension of a plane angle, rad.
    pub const ANGLE: Dimension = Dimension::base(BaseDim::Angle);

    /// Returns the dimension of a quantity that is measured in the unit of one base dimension.
    #[must_use]
    pub const fn base(base: BaseDim) -> Dimension {
        let mut exponents = [Ratio::ZERO; EXPONENT_COUNT];
        exponents[base as usize] = Ratio::ONE;
        Dimension(exponents)
    }

    /// Returns the free dimension with the index `place`, which is below [`FREE_COUNT`]. It stands for the unknown unit
    /// of a type parameter and is equal to itself only.
    #[must_use]
    pub fn free(place: usize) -> Dimension {
        let mut exponents = [Ratio::ZERO; EXPONENT_COUNT];
        exponents[BASE_COUNT + place % FREE_COUNT] = Ratio::ONE;
        Dimension(exponents)
    }

    /// Returns whether the dimension contains a free dimension, which stands for the unknown unit of a type parameter.
    #[must_use]
    pub fn has_free(self) -> bool {
        self.0[BASE_COUNT..]
            .iter()
            .any(|exponent| !exponent.is_zero())
    }

    /// Returns the character that represents the free dimension with the index `place` in texts.
    #[must_use]
    pub fn free_sign(place: usize) -> &'static str {
        BASE_UNITS[BASE_COUNT + place % FREE_COUNT]
    }

    /// Creates a dimension from integer exponents in the order of [`BaseDim`]; `None` if an exponent is out of range.
    #[must_use]
    pub fn from_exponents(exponents: [i32; BASE_COUNT]) -> Option<Dimension> {
        let mut dim = Dimension::ONE;
        for (to, from) in dim.0.iter_mut().zip(exponents) {
            *to = Ratio::from_int(from)?;
        }
        Some(dim)
    }

    /// Returns the exponent of a base dimension.
    #[must_use]
    pub fn exponent(self, base: BaseDim) -> Ratio {
        self.0[base as usize]
    }

    /// Returns the dimension of a product; `None` if an exponent is out of range.
    #[must_use]
    pub fn times(self, other: Dimension) -> Option<Dimension> {
        let mut dim = self;
        for (to, with) in dim.0.iter_mut().zip(other.0) {
            *to = to.plus(with)?;
        }
        Some(dim)
    }

    /// Returns the dimension of a power with this exponent; `None` if a resulting exponent is out of range.
    #[must_use]
    pub fn power(self, exponent: Ratio) -> Option<Dimension> {
        let mut dim = self;
        for to in &mut dim.0 {
            *to = to.times(exponent)?;
        }
        Some(dim)
    }

    /// Returns the dimension of a quotient; `None` if an exponent is out of range.
    #[must_use]
    pub fn divided_by(self, other: Dimension) -> Option<Dimension> {
        self.times(other.inverse())
    }

    /// Returns the dimension of the reciprocal of a quantity: all exponents change their sign.
    #[must_use]
    pub fn inverse(self) -> Dimension {
        Dimension(self.0.map(Ratio::negate))
    }

    /// Returns whether values of the two dimensions may be added and compared: their exponents are equal except for
    /// those of the angle (see [`crate::units`]).
    #[must_use]
    pub fn is_compatible(self, other: Dimension) -> bool {
        self.without_angle() == other.without_angle()
    }

    /// Returns whether the dimension is that of a plain number or an angle.
    #[must_use]
    pub fn is_dimensionless(self) -> bool {
        self.is_compatible(Dimension::ONE)
    }

    /// Returns the common name of a quantity of this dimension, with an article, such as `a speed`; `None` if it has
    /// none.
    #[must_use]
    pub fn quantity_literal(self) -> Option<&'static str> {
        find_name(&QUANTITIES, self)
    }

    /// Returns whether the dimension is a pure reciprocal such as `1/s`: no exponent is positive, and at least one is
    /// negative.
    #[must_use]
    pub fn is_reciprocal(self) -> bool {
        let signed = |e: &&Ratio| !e.is_zero();
        let mut exponents = self.0.iter().filter(signed).peekable();
        exponents.peek().is_some() && exponents.all(|e| e.is_negative())
    }

    fn without_angle(self) -> Dimension {
        let mut dim = self;
        dim.0[BaseDim::Angle as usize] = Ratio::ZERO;
        dim
    }

    /// Returns the factors of the dimension as text: those with positive exponents, or, if `negative`, those with
    /// negative exponents without the sign.
    fn vector_product(self, negative: bool) -> Vec<String> {
        let all = BASE_UNITS.into_iter().zip(self.0);
        all.filter_map(|(unit, e)| signed_factor(unit, e, negative))
            .collect()
    }
}

/// Returns the power of a unit as text, as a factor of the numerator or, if `negative`, of the denominator. `None` if
/// the exponent `e` belongs to the other part or is 0.
fn signed_factor(unit: &str, e: Ratio, negative: bool) -> Option<String> {
    let belongs = !e.is_zero() && e.is_negative() == negative;
    let e = if negative { e.negate() } else { e };
    belongs.then(|| match e == Ratio::ONE {
        true => unit.to_owned(),
        false => format!("{unit}^{e}"),
    })
}

/// Returns the dimension of a force.
fn force() -> Option<Dimension> {
    Dimension::from_exponents([1, 1, -2, 0, 0, 0, 0, 0])
}

/// Separates a power of a force from a dimension so that no mass and time remain, as in `N/m` for `kg/s^2`. Returns the
/// exponent of the force and the remaining dimension; `None` if this is not possible, as for `kg/m^3`.
fn split_force(dim: Dimension) -> Option<(Ratio, Dimension)> {
    let exponent = dim.exponent(BaseDim::Mass);
    let is_force = !exponent.is_zero()
        && dim.exponent(BaseDim::Time) == exponent.times(Ratio::from_int(-2)?)?;
    let rest = dim.divided_by(force()?.power(exponent)?)?;
    is_force.then_some((exponent, rest))
}

/// Returns the name of a dimension in a table of names and exponents; `None` if it is not in the table.
fn find_name(table: &[(&'static str, [i32; BASE_COUNT])], dim: Dimension) -> Option<&'static str> {
    let is = |row: &&(&str, [i32; BASE_COUNT])| Dimension::from_exponents(row.1) == Some(dim);
    table.iter().find(is).map(|row| row.0)
}

/// Formats the dimension as a unit between brackets, such as `m/s^2`, `N`, `1/s` or `1`. Products that contain a force
/// are written with `N`, as is common in engineering tables: `N/m`, not `kg/s^2`.
impl fmt::Display for Dimension {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(name) = find_name(&NAMED_DIMS, *self) {
            return f.write_str(name);
        }
        let (force, rest) = split_force(*self).unwrap_or((Ratio::ZERO, *self));
        let factors = |negative| {
            let newtons = signed_factor("N", force, negative);
            newtons
                .into_iter()
                .chain(rest.vector_product(negative))
                .collect::<Vec<_>>()
        };
        let (above, below) = (factors(false), factors(true));
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

    fn speed() -> Dimension {
        Dimension::LENGTH.divided_by(Dimension::TIME).unwrap()
    }

    #[test]
    fn printing() {
        assert_eq!(Dimension::ONE.to_string(), "1");
        assert_eq!(speed().to_string(), "m/s");
        assert_eq!(
            speed().divided_by(Dimension::TIME).unwrap().to_string(),
            "m/s^2"
        );
        assert_eq!(Dimension::TIME.inverse().to_string(), "1/s");
        let newton = Dimension::from_exponents([1, 1, -2, 0, 0, 0, 0, 0]).unwrap();
        assert_eq!(newton.to_string(), "N");
        let damping = newton.divided_by(speed()).unwrap();
        assert_eq!(damping.to_string(), "kg/s");
        let stiffness = newton.divided_by(Dimension::LENGTH).unwrap();
        assert_eq!(stiffness.to_string(), "N/m");
        assert_eq!(stiffness.inverse().to_string(), "m/N");
        let squared = newton.times(newton).unwrap();
        assert_eq!(squared.to_string(), "N^2");
        let root = Dimension::LENGTH.power(Ratio::HALF).unwrap();
        assert_eq!(root.to_string(), "m^(1/2)");
    }

    #[test]
    fn angles_meet_plain_numbers_and_nothing_else_does() {
        assert!(
            Dimension::ANGLE.is_compatible(Dimension::ONE) && Dimension::ANGLE.is_dimensionless()
        );
        assert_ne!(Dimension::ANGLE, Dimension::ONE);
        assert!(!Dimension::LENGTH.is_compatible(Dimension::ONE));
        assert!(!speed().is_compatible(Dimension::LENGTH));
    }

    #[test]
    fn exponents_that_do_not_fit_are_refused() {
        let big = Dimension::LENGTH
            .power(Ratio::from_int(100).unwrap())
            .unwrap();
        assert_eq!(big.times(big), None);
        assert_eq!(big.divided_by(big), Some(Dimension::ONE));
    }
}
