//! The primitives that are expressions of Lustre: they depend on their in-ports alone, and are there where these are.

/// The expression of a primitive; `{0}`, `{1}` stand for its in-ports.
pub(super) fn operator(prim: &str) -> Option<&'static str> {
    let row = OPERATORS.iter().find(|row| row.0 == prim);
    row.map(|row| row.1)
}

/// The primitive that a twin with a condition stands for: `{0}` is the condition, the others follow.
pub(super) fn guarded(prim: &str) -> Option<(&'static str, &'static str)> {
    let row = GUARDED.iter().find(|row| row.0 == prim);
    row.map(|row| (row.1, row.2))
}

/// Whether a primitive has no value for some operands, in Lustre as here.
pub(super) fn is_partial(prim: &str) -> bool {
    let ends = ["IntDivide", "IntModulo", "IntFromDouble"];
    ends.iter().any(|end| prim.ends_with(end))
}

/// What a model checker makes of a check.
#[derive(Clone, Copy)]
pub(super) enum Check {
    /// It holds by the writer's word.
    Given,
    /// It is to be proved.
    ToProve,
}

/// What becomes of a primitive that ends the command where a condition does not hold.
pub(super) fn check(prim: &str) -> Option<Check> {
    let row = CHECKS.iter().find(|row| row.0 == prim);
    row.map(|row| row.1)
}

#[rustfmt::skip]
const CHECKS: &[(&str, Check)] = &[
    ("Rpi::Assert",      Check::ToProve),
    ("Rpi::AssertIndex", Check::ToProve),
    ("Rpi::Assume",      Check::Given),
];

#[rustfmt::skip]
const OPERATORS: &[(&str, &str)] = &[
    ("Core::BooleanNot",          "not {0}"),
    ("Rpi::BooleanXor",           "{0} xor {1}"),
    ("Rpi::BooleanEquals",        "{0} = {1}"),
    ("Core::IntAdd",              "{0} + {1}"),
    ("Rpi::IntSubtract",          "{0} - {1}"),
    ("Core::IntMultiply",         "{0} * {1}"),
    ("Core::IntDivide",           "{0} div {1}"),
    ("Rpi::IntModulo",            "{0} mod {1}"),
    ("Rpi::IntNegate",            "-{0}"),
    ("Rpi::IntAbsolute",          "if {0} < 0 then -{0} else {0}"),
    ("Rpi::IntWithin",            "{1}"),
    ("Rpi::IntMinimum",           "if {1} < {0} then {1} else {0}"),
    ("Rpi::IntMaximum",           "if {0} < {1} then {1} else {0}"),
    ("Core::IntGreater",          "{0} > {1}"),
    ("Rpi::IntGreaterOrEqual",    "{0} >= {1}"),
    ("Core::DoubleAdd",           "{0} + {1}"),
    ("Rpi::DoubleSubtract",       "{0} - {1}"),
    ("Core::DoubleMultiply",      "{0} * {1}"),
    ("Core::DoubleDivide",        "{0} / {1}"),
    ("Rpi::DoubleNegate",         "-{0}"),
    ("Core::DoubleGreater",       "{0} > {1}"),
    ("Rpi::DoubleGreaterOrEqual", "{0} >= {1}"),
    ("Core::DoubleFromInt",       "real {0}"),
    ("Core::IntFromDouble",       "int {0}"),
];

#[rustfmt::skip]
const GUARDED: &[(&str, &str, &str)] = &[
    ("Rpi::GuardedIntAdd",        "{1} + {2}",                       "0"),
    ("Rpi::GuardedIntSubtract",   "{1} - {2}",                       "0"),
    ("Rpi::GuardedIntMultiply",   "{1} * {2}",                       "0"),
    ("Rpi::GuardedIntDivide",     "{1} div {2}",                     "0"),
    ("Rpi::GuardedIntModulo",     "{1} mod {2}",                     "0"),
    ("Rpi::GuardedIntNegate",     "-{1}",                            "0"),
    ("Rpi::GuardedIntAbsolute",   "(if {1} < 0 then -{1} else {1})", "0"),
    ("Rpi::GuardedIntFromDouble", "int {1}",                         "0"),
];

/// An expression with its operands in place.
pub(super) fn filled(template: &str, operands: &[String]) -> String {
    let mut text = template.to_owned();
    for (k, operand) in operands.iter().enumerate() {
        text = text.replace(&format!("{{{k}}}"), operand);
    }
    text
}
