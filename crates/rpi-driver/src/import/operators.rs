//! Primitives that are written as operators: those to which the compiler translates the operator, operand by operand.

/// Infix operators by the primitive to which the compiler translates them. The in-ports are the left and right operand.
const INFIX: &[(&str, &str)] = &[
    ("Core::BooleanAnd", "and"),
    ("Core::BooleanOr", "or"),
    ("Core::IntAdd", "+"),
    ("Core::IntMultiply", "*"),
    ("Core::IntGreater", ">"),
    ("Core::DoubleAdd", "+"),
    ("Core::DoubleMultiply", "*"),
    ("Core::DoubleDivide", "/"),
    ("Core::DoubleGreater", ">"),
];

/// Prefix operators by the primitive to which the compiler translates them.
const PREFIX: &[(&str, &str)] = &[("Core::BooleanNot", "not")];

/// Predeclared functions of one argument by the primitive to which the compiler translates them.
const CALLS: &[(&str, &str)] = &[("Core::DoubleSquareRoot", "sqrt")];

/// Primitives that test a scalar value for absence, written as `not present(x)`. The tests for arrays are different
/// primitives.
const ABSENT: &[&str] = &[
    "Core::BooleanIsNull",
    "Core::IntIsNull",
    "Core::DoubleIsNull",
    "World::VectorIsNull",
    "World::RotationIsNull",
    "World::FrameIsNull",
    "World::TwistIsNull",
];

/// Primitives that select one of two values, written as `if`. The in-ports are the condition and the two branches.
const CHOICE: &[&str] = &[
    "Core::BooleanConditional",
    "Core::IntConditional",
    "Core::DoubleConditional",
    "World::VectorConditional",
    "World::RotationConditional",
    "World::FrameConditional",
    "World::TwistConditional",
];

/// Returns the expression for a primitive with these operands as an operator; `None` if the primitive must be written
/// as a call.
pub(super) fn operator_expr(prim: &str, operands: &[String]) -> Option<String> {
    let of =
        |table: &[(&str, &'static str)]| table.iter().find(|row| row.0 == prim).map(|row| row.1);
    match operands {
        [a, b] if prim.ends_with("Coalesce") => Some(format!("{a} ?? {b}")),
        [x] if ABSENT.contains(&prim) => Some(format!("not present({x})")),
        [x] => {
            let call = of(CALLS).map(|name| format!("{name}({x})"));
            call.or_else(|| of(PREFIX).map(|op| format!("{op} {}", operand(x))))
        }
        [a, b] => of(INFIX).map(|op| format!("{} {op} {}", operand(a), operand(b))),
        [c, a, b] if CHOICE.contains(&prim) => Some(format!("if {c} then {a} else {b}")),
        _ => None,
    }
}

/// Returns an operand as text, in parentheses if it is a negative number, because some operators bind more tightly than
/// the sign.
fn operand(text: &str) -> String {
    match text.starts_with('-') {
        true => format!("({text})"),
        false => text.to_owned(),
    }
}
