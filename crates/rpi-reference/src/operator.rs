//! Arithmetic and logical operators, by the names of their primitives.

use crate::value::Value::{Bool, Int, Real};
use crate::value::{EvalError, Leaf, Value};

/// Applies an operator, given by the name of its primitive, to its operands. If the operator would fault, it returns 0
/// in a branch of an `if` that is not selected (`chosen` is false), else an error (M6.6).
pub(crate) fn apply(name: &str, operands: &[Leaf], chosen: bool) -> Result<Leaf, EvalError> {
    if let Some(leaf) = logic(name, operands) {
        return Ok(leaf);
    }
    // Strict operators are absent if an operand is absent (M4.4).
    let Some(present) = operands.iter().copied().collect::<Option<Vec<Value>>>() else {
        return Ok(None);
    };
    match total(name, &present) {
        Some(value) => Ok(Some(value)),
        None => partial(name, &present, chosen).map(Some),
    }
}

/// Applies an operator of Kleene's three-valued logic (M4.4): if one operand decides, the other may be absent. Returns
/// `None` if `name` is not such an operator.
fn logic(name: &str, operands: &[Leaf]) -> Option<Leaf> {
    let truth = |leaf: &Leaf| match leaf {
        Some(Bool(truth)) => Some(*truth),
        _ => None,
    };
    let [a, b] = operands else {
        return None;
    };
    let (a, b) = (truth(a), truth(b));
    Some(match name {
        "Core::BooleanAnd" => and(a, b),
        "Core::BooleanOr" => and(a.map(|a| !a), b.map(|b| !b)).map(negated),
        "Rpi::BooleanImplies" => and(a, b.map(|b| !b)).map(negated),
        _ => return None,
    })
}

/// Returns the conjunction of two Booleans that may be absent (`None`): false if one is false, absent if it is
/// undecided.
pub(crate) fn and(a: Option<bool>, b: Option<bool>) -> Leaf {
    match (a, b) {
        (Some(false), _) | (_, Some(false)) => Some(Bool(false)),
        (Some(true), Some(true)) => Some(Bool(true)),
        _ => None,
    }
}

fn negated(value: Value) -> Value {
    match value {
        Bool(truth) => Bool(!truth),
        other => other,
    }
}

/// Applies an operator that has a result for all operands. Returns `None` if `name` is not such an operator.
fn total(name: &str, operands: &[Value]) -> Option<Value> {
    Some(match (name, operands) {
        ("Core::BooleanNot", &[Bool(a)]) => Bool(!a),
        ("Rpi::BooleanXor", &[Bool(a), Bool(b)]) => Bool(a != b),
        ("Core::IntGreater", &[Int(a), Int(b)]) => Bool(a > b),
        ("Rpi::IntGreaterOrEqual", &[Int(a), Int(b)]) => Bool(a >= b),
        ("Core::DoubleGreater", &[Real(a), Real(b)]) => Bool(a > b),
        ("Rpi::DoubleGreaterOrEqual", &[Real(a), Real(b)]) => Bool(a >= b),
        ("Core::DoubleAdd", &[Real(a), Real(b)]) => Real(a + b),
        ("Rpi::DoubleSubtract", &[Real(a), Real(b)]) => Real(a - b),
        ("Core::DoubleMultiply", &[Real(a), Real(b)]) => Real(a * b),
        ("Core::DoubleDivide", &[Real(a), Real(b)]) => Real(a / b),
        ("Core::DoubleModulo", &[Real(a), Real(b)]) => Real(a % b),
        ("Core::DoubleSquareRoot", &[Real(a)]) => Real(a.sqrt()),
        ("Rpi::DoubleNegate", &[Real(a)]) => Real(-a),
        ("Rpi::DoubleFloor", &[Real(a)]) => Real(a.floor()),
        ("Rpi::DoubleCeiling", &[Real(a)]) => Real(a.ceil()),
        ("Rpi::DoubleRound", &[Real(a)]) => Real(a.round()),
        ("Core::DoubleFromInt", &[Int(a)]) => Real(a as f64),
        _ => return None,
    })
}

/// Applies an operator that faults for some operands, such as a division (M2.2). For such operands it returns an error
/// if the value is needed (`chosen`), else 0.
fn partial(name: &str, operands: &[Value], chosen: bool) -> Result<Value, EvalError> {
    let (result, fault) = match (name, operands) {
        ("Core::IntAdd", &[Int(a), Int(b)]) => (a.checked_add(b), "overflow"),
        ("Rpi::IntSubtract", &[Int(a), Int(b)]) => (a.checked_sub(b), "overflow"),
        ("Core::IntMultiply", &[Int(a), Int(b)]) => (a.checked_mul(b), "overflow"),
        ("Core::IntDivide", &[Int(a), Int(b)]) => (a.checked_div(b), "division"),
        // `i64::MIN % -1` overflows in `checked_rem`, although the remainder is 0.
        ("Rpi::IntModulo", &[Int(_), Int(-1)]) => (Some(0), "division"),
        ("Rpi::IntModulo", &[Int(a), Int(b)]) => (a.checked_rem(b), "division"),
        ("Rpi::IntPower", &[Int(a), Int(b)]) => (power(a, b), "overflow"),
        ("Rpi::IntNegate", &[Int(a)]) => (a.checked_neg(), "overflow"),
        ("Core::IntFromDouble", &[Real(a)]) => (whole(a), "conversion"),
        _ => return Err(EvalError::Unsupported(format!("{name} of {operands:?}"))),
    };
    match result {
        Some(number) => Ok(Int(number)),
        None if chosen => Err(EvalError::Fault(fault)),
        None => Ok(Int(0)),
    }
}

/// Returns `base` to the power `exponent` by repeated multiplication; `None` for a negative exponent or an overflow.
fn power(base: i64, exponent: i64) -> Option<i64> {
    if exponent < 0 {
        return None;
    }
    match base {
        // For these bases the exponent may be large; all others overflow after at most 63 multiplications.
        0 | 1 => Some(if exponent == 0 { 1 } else { base }),
        -1 => Some(if exponent % 2 == 0 { 1 } else { -1 }),
        _ => (0..exponent).try_fold(1_i64, |so_far, _| so_far.checked_mul(base)),
    }
}

/// Returns the integer part of a real; `None` if it does not fit into 64 bits.
fn whole(real: f64) -> Option<i64> {
    const LIMIT: f64 = 9_223_372_036_854_775_808.0;
    (-LIMIT..LIMIT).contains(&real).then_some(real as i64)
}

/// Returns whether two leaves (scalar parts) are equal; `None` if one of them is absent.
pub(crate) fn equal(a: Leaf, b: Leaf) -> Option<bool> {
    Some(a? == b?)
}
