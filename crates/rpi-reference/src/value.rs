//! Values.

use rpi_image::Value as Constant;
use std::fmt;

/// Value of one leaf (scalar part) of a flow in a cycle.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Value {
    /// Boolean value `true` or `false`.
    Bool(bool),
    /// 64-bit integer, index of an enum value, or exact time in ticks.
    Int(i64),
    /// Real number: an IEEE 754 double, in SI units.
    Real(f64),
}

/// Leaf (scalar part) of a flow in a cycle: its value, or `None` if it is absent (M4.1).
pub type Leaf = Option<Value>;

/// Reason why the interpreter cannot evaluate a cycle.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum EvalError {
    /// Fault of the program: overflow, division by zero, lossy conversion, index out of bounds, or value outside of its
    /// subrange (M2.2). The text names the kind.
    Fault(&'static str),
    /// A flow depends on itself within the cycle. The checker rejects such programs (M5.4).
    DependencyCycle,
    /// The program contains a construct that this interpreter does not support; the text names it.
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
    /// Converts a constant of the type checker to a value; `None` if it is not a Boolean, an integer or a real.
    pub(crate) fn from_constant(constant: &Constant) -> Option<Value> {
        let truth = constant.as_bool().map(Value::Bool);
        let integer = || constant.as_int().map(Value::Int);
        let real = || constant.as_real().map(Value::Real);
        truth.or_else(integer).or_else(real)
    }

    /// Returns the 64 bits of the value as a memory slot of a compiled image holds them.
    #[must_use]
    pub fn bits(self) -> u64 {
        match self {
            Value::Bool(truth) => u64::from(truth),
            Value::Int(number) => number.cast_unsigned(),
            Value::Real(real) => real.to_bits(),
        }
    }
}
