//! Values.

use rpi_image::Value as Constant;

/// A value of one leaf. An enum's value is its place in the enum.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Value {
    /// Truth value.
    Bool(bool),
    /// 64-bit integer, or a value of an enum.
    Int(i64),
    /// IEEE double.
    Real(f64),
}

/// A leaf in a cycle: its value, or none where it is absent (M4.1).
pub type Leaf = Option<Value>;

/// Why a cycle has no values.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Stop {
    /// A fault: overflow, division by zero, a conversion that loses the value, an index outside of its array (M2.2).
    Fault(&'static str),
    /// A flow depends on itself within the cycle, which the checker refuses (M5.4).
    Ring,
    /// Something that this interpreter does not cover.
    Beyond(String),
}

impl Value {
    /// A constant as a value.
    pub(crate) fn of(constant: &Constant) -> Option<Value> {
        let truth = constant.as_bool().map(Value::Bool);
        let integer = || constant.as_int().map(Value::Int);
        let real = || constant.as_real().map(Value::Real);
        truth.or_else(integer).or_else(real)
    }

    /// The value as an image keeps it in a cell.
    #[must_use]
    pub fn bits(self) -> u64 {
        match self {
            Value::Bool(truth) => u64::from(truth),
            Value::Int(number) => number.cast_unsigned(),
            Value::Real(real) => real.to_bits(),
        }
    }
}
