//! Values.

use rpi_image::Value as Constant;
use std::fmt;

/// Value of one leaf in a cycle. The value of an enum is its index.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Value {
    /// Boolean.
    Bool(bool),
    /// 64-bit integer, or the index of an enum value.
    Int(i64),
    /// IEEE 754 double.
    Real(f64),
}

/// Leaf in a cycle: its value, or `None` if it is absent (M4.1).
pub type Leaf = Option<Value>;

/// Reason why a cycle has no values.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum EvalError {
    /// Fault: overflow, division by zero, a conversion that loses the value, an index out of bounds (M2.2).
    Fault(&'static str),
    /// Dependency of a flow on itself within the cycle, which the checker rejects (M5.4).
    DependencyCycle,
    /// Construct that this interpreter does not support; the text names it.
    Unsupported(String),
}

impl fmt::Display for EvalError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            EvalError::Fault(what) => write!(f, "fault: {what}"),
            EvalError::DependencyCycle => f.write_str("a flow depends on itself in the same cycle"),
            EvalError::Unsupported(what) => write!(f, "unsupported: {what}"),
        }
    }
}

impl std::error::Error for EvalError {}

impl Value {
    /// Converts a constant.
    pub(crate) fn from_constant(constant: &Constant) -> Option<Value> {
        let truth = constant.as_bool().map(Value::Bool);
        let integer = || constant.as_int().map(Value::Int);
        let real = || constant.as_real().map(Value::Real);
        truth.or_else(integer).or_else(real)
    }

    /// Returns the bits of the value as stored in a memory slot of an image.
    #[must_use]
    pub fn bits(self) -> u64 {
        match self {
            Value::Bool(truth) => u64::from(truth),
            Value::Int(number) => number.cast_unsigned(),
            Value::Real(real) => real.to_bits(),
        }
    }
}
