//! Which primitives are written as operators: those that the compiler makes of the operator, operand by operand.

/// Infix operators, by primitive: in-ports left and right.
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

/// Prefix operators, by primitive.
const PREFIX: &[(&str, &str)] = &[("Core::BooleanNot", "not")];

/// Calls of predeclared operators, by primitive.
const CALLS: &[(&str, &str)] = &[("Core::DoubleSquareRoot", "sqrt")];

/// Tests for absence of single values; what they are of arrays is another primitive.
const ABSENT: &[&str] = &[
    "Core::BooleanIsNull",
    "Core::IntIsNull",
    "Core::DoubleIsNull",
    "World::VectorIsNull",
    "World::RotationIsNull",
    "World::FrameIsNull",
    "World::TwistIsNull",
];

/// Choices, by primitive: in-ports condition, yes, no.
const CHOICE: &[&str] = &[
    "Core::BooleanConditional",
    "Core::IntConditional",
    "Core::DoubleConditional",
    "World::VectorConditional",
    "World::RotationConditional",
    "World::FrameConditional",
    "World::TwistConditional",
];

/// The primitive with these operands as an operator, if it is one.
pub(super) fn written(prim: &str, operands: &[String]) -> Option<String> {
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

/// A minus binds less than some operators do.
fn operand(text: &str) -> String {
    match text.starts_with('-') {
        true => format!("({text})"),
        false => text.to_owned(),
    }
}
