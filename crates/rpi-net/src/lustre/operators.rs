//! Primitives that are Lustre expressions: their result depends only on their in-ports and is present if these are.

/// Returns the Lustre expression of a primitive, with placeholders such as `{0}` for its in-ports; `None` for other
/// primitives.
pub(super) fn operator(prim: &str) -> Option<&'static str> {
    let row = OPERATORS.iter().find(|row| row.0 == prim);
    row.map(|row| row.1)
}

/// Returns the Lustre expression of a primitive that is computed only while a guard is true, and the value of its
/// output otherwise. `None` for other primitives.
///
/// In-port 0 is the guard; the expression has the placeholders `{1}` and `{2}` for the operands.
pub(super) fn guarded(prim: &str) -> Option<(&'static str, &'static str)> {
    let row = GUARDED.iter().find(|row| row.0 == prim);
    row.map(|row| (row.1, row.2))
}

/// Returns whether a primitive has no result for some operands, such as a division by 0, in Lustre as well as in the
/// control core.
pub(super) fn is_partial(prim: &str) -> bool {
    let ends = ["IntDivide", "IntModulo", "IntFromDouble"];
    ends.iter().any(|end| prim.ends_with(end))
}

/// Role, for a model checker, of a condition that a program asserts.
#[derive(Clone, Copy)]
pub(super) enum Check {
    /// The model checker assumes the condition.
    Assume,
    /// The model checker must prove the condition.
    Property,
}

/// Returns the role, for a model checker, of the condition of a primitive that ends the command when the condition is
/// false; `None` for other primitives.
pub(super) fn check(prim: &str) -> Option<Check> {
    let row = CHECKS.iter().find(|row| row.0 == prim);
    row.map(|row| row.1)
}

#[rustfmt::skip]
const CHECKS: &[(&str, Check)] = &[
    ("Rpi::Assert",      Check::Property),
    ("Rpi::AssertIndex", Check::Property),
    ("Rpi::Assume",      Check::Assume),
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

/// Returns the template with its placeholders `{0}`, `{1}`, ... replaced by the operands.
pub(super) fn fill(template: &str, operands: &[String]) -> String {
    let mut text = template.to_owned();
    for (k, operand) in operands.iter().enumerate() {
        text = text.replace(&format!("{{{k}}}"), operand);
    }
    text
}
