//! Names of types, values and functions in other languages, with their equivalents in RPI, for suggestions.

/// Name in another programming language, and its equivalent in RPI.
type Equivalent = (&'static str, &'static str);

/// Type names of other programming languages, in lower case, each with its equivalent in RPI.
const TYPES: &[Equivalent] = &[
    ("float", "real"),
    ("float32", "real"),
    ("float64", "real"),
    ("double", "real"),
    ("single", "real"),
    ("f32", "real"),
    ("f64", "real"),
    ("real", "real"),
    ("lreal", "real"),
    ("number", "real"),
    ("num", "real"),
    ("decimal", "real"),
    ("float16", "real"),
    ("float_t", "real"),
    ("double_t", "real"),
    ("int", "int"),
    ("integer", "int"),
    ("dint", "int"),
    ("lint", "int"),
    ("uint", "int"),
    ("long", "int"),
    ("short", "int"),
    ("sint", "int"),
    ("usint", "int"),
    ("udint", "int"),
    ("ulint", "int"),
    ("unsigned", "int"),
    ("signed", "int"),
    ("byte", "int"),
    ("word", "int"),
    ("dword", "int"),
    ("lword", "int"),
    ("char", "int"),
    ("natural", "int"),
    ("nat", "int"),
    ("counter", "int"),
    ("i8", "int"),
    ("i16", "int"),
    ("i32", "int"),
    ("i64", "int"),
    ("i128", "int"),
    ("isize", "int"),
    ("u8", "int"),
    ("u16", "int"),
    ("u32", "int"),
    ("u64", "int"),
    ("u128", "int"),
    ("usize", "int"),
    ("size_t", "int"),
    ("int8", "int"),
    ("int16", "int"),
    ("int32", "int"),
    ("int64", "int"),
    ("uint8", "int"),
    ("uint16", "int"),
    ("uint32", "int"),
    ("uint64", "int"),
    ("int8_t", "int"),
    ("int16_t", "int"),
    ("int32_t", "int"),
    ("int64_t", "int"),
    ("uint8_t", "int"),
    ("uint16_t", "int"),
    ("uint32_t", "int"),
    ("uint64_t", "int"),
    ("bool", "bool"),
    ("boolean", "bool"),
    ("logical", "bool"),
    ("bit", "bool"),
    ("bool_t", "bool"),
    ("_bool", "bool"),
    ("vec3", "Vector"),
    ("vector3", "Vector"),
    ("quaternion", "Rotation"),
    ("quat", "Rotation"),
    ("orientation", "Rotation"),
    ("orient", "Rotation"),
    ("vector3d", "Vector"),
    ("position", "Vector"),
    ("pos3", "Vector"),
    ("transform", "Pose"),
    ("robtarget", "Pose"),
    ("e6pos", "Pose"),
    ("cartpos", "Pose"),
    ("se3", "Pose"),
    ("duration", "real[s]"),
];

/// Names of values in other programming languages, in lower case, each with its equivalent in RPI.
const VALUES: &[Equivalent] = &[
    ("true", "true"),
    ("false", "false"),
    ("null", "none"),
    ("nil", "none"),
    ("none", "none"),
    ("nullptr", "none"),
    ("undefined", "none"),
    ("absent", "none"),
    ("on", "true"),
    ("yes", "true"),
    ("off", "false"),
    ("now", "time"),
    ("cycle_time", "dt"),
    ("delta_t", "dt"),
    ("pi", "pi"),
    ("m_pi", "pi"),
    ("math_pi", "pi"),
];

/// Function names of other programming languages, in lower case, each with its equivalent in RPI.
const FUNCTIONS: &[Equivalent] = &[
    ("fabs", "abs"),
    ("abs", "abs"),
    ("fmin", "min"),
    ("fmax", "max"),
    ("log", "ln"),
    ("arcsin", "asin"),
    ("arccos", "acos"),
    ("arctan", "atan"),
    ("arctan2", "atan2"),
    ("sgn", "sign"),
    ("ceiling", "ceil"),
    ("sinus", "sin"),
    ("cosinus", "cos"),
    ("sine", "sin"),
    ("cosine", "cos"),
    ("tangent", "tan"),
    ("squareroot", "sqrt"),
    ("square_root", "sqrt"),
    ("absolute", "abs"),
    ("absval", "abs"),
    ("minimum", "min"),
    ("maximum", "max"),
    ("saturate", "clamp"),
    ("saturation", "clamp"),
    ("constrain", "clamp"),
    ("rising_edge", "rising"),
    ("risingedge", "rising"),
    ("posedge", "rising"),
    ("falling_edge", "falling"),
    ("fallingedge", "falling"),
    ("negedge", "falling"),
    ("isnull", "present"),
    ("r_trig", "rising"),
    ("f_trig", "falling"),
    ("ton", "on_delay"),
    ("tof", "off_delay"),
    ("tp", "pulse"),
    ("ctu", "count_up"),
    ("ctd", "count_down"),
];

/// Equivalents in RPI that cannot simply replace the name of the other language, because they take other arguments or
/// have another meaning.
const INEXACT: &[&str] = &[
    "none",
    "on_delay",
    "off_delay",
    "pulse",
    "count_up",
    "count_down",
    "clamp",
    "true",
    "false",
    "time",
    "dt",
];

/// Calls of functions whose arguments differ from those in other languages.
const USAGES: &[Equivalent] = &[
    ("on_delay", "on_delay(x, 500[ms])"),
    ("off_delay", "off_delay(x, 500[ms])"),
    ("pulse", "pulse(x, 500[ms])"),
    ("count_up", "count_up(x, reset)"),
    ("count_down", "count_down(x, reset, 10)"),
    ("clamp", "clamp(x, low, high)"),
];

/// Returns an example of a call, if the arguments of the function differ from those in other languages.
pub(crate) fn usage(function: &str) -> Option<&'static str> {
    let found = USAGES.iter().find(|(name, _)| *name == function);
    found.map(|(_, usage)| *usage)
}

/// Whether the name of a value in another language is so common a word that a similar declared name is the better
/// suggestion.
pub(crate) fn is_common_word(name: &str) -> bool {
    const LOOSE: [&str; 6] = ["on", "off", "yes", "now", "absent", "cycle_time"];
    LOOSE.contains(&&*name.to_lowercase())
}

/// Whether the name `there` of another language can be replaced by the RPI name `here` without other changes.
pub(crate) fn is_exact_equivalent(there: &str, here: &str) -> bool {
    !INEXACT.contains(&here) || there.eq_ignore_ascii_case(here)
}

/// Returns the help text for a name such as `self` or `math`, which is an object or a module in other languages; `None`
/// for other names.
pub(crate) fn foreign_value_help(name: &str) -> Option<&'static str> {
    match &*name.to_lowercase() {
        "self" | "this" | "me" => Some("flows and ports are named without a prefix: `x`"),
        "math" | "np" | "numpy" | "std" | "cmath" => {
            Some("names of a module need no prefix: `pi`, `sin(x)`")
        }
        _ => None,
    }
}

/// Returns the help text for a type of another language without an equivalent, such as a text, a list or void; `None`
/// for other names.
pub(crate) fn foreign_type_help(name: &str) -> Option<&'static str> {
    let lower = name.to_lowercase();
    let found = UNSUPPORTED_TYPES
        .iter()
        .find(|(names, _)| names.contains(&&*lower));
    found.map(|(_, help)| *help)
}

/// Type names of other programming languages that have no equivalent in RPI, in lower case, each group with a help
/// text.
const UNSUPPORTED_TYPES: &[(&[&str], &str)] = &[
    (
        &["string", "str", "text", "wstring"],
        "flows cannot hold text; use an enum for a set of names: `type Mode = enum { Off, On };`",
    ),
    (
        &[
            "array", "list", "vec", "slice", "vector", "tuple", "set", "deque", "queue", "matrix",
            "ndarray",
        ],
        "an array type is `int^3`, with its size after the type; a matrix is `real^3^2`",
    ),
    (
        &["dict", "map", "hashmap", "object", "record", "any"],
        "use a struct for named parts: `type Part = struct { place: real; count: int };`",
    ),
    (&["void", "unit"], "a node without outputs has `returns ()`"),
    (
        &["auto", "var", "let"],
        "the type of a local flow is inferred: `x = 0 -> pre x + 1;`",
    ),
    (
        &["optional", "option", "maybe", "nullable"],
        "write `?` after the type of a value that may be absent: `int?`",
    ),
    (
        &["jointtarget", "e6axis", "axis", "jointpos"],
        "joint values are an array of angles: `real[rad]^6`",
    ),
];

/// Returns the RPI type that corresponds to a type name of another programming language; `None` if there is no other
/// name to suggest.
pub(crate) fn type_equivalent(name: &str) -> Option<&'static str> {
    lookup(TYPES, name)
}

/// Returns the RPI name of a value, such as `true`, for its name in another programming language; `None` if there is no
/// other name to suggest.
pub(crate) fn value_equivalent(name: &str) -> Option<&'static str> {
    lookup(VALUES, name)
}

/// Returns the RPI function that corresponds to a function name of another programming language; `None` if there is no
/// other name to suggest.
pub(crate) fn function_equivalent(name: &str) -> Option<&'static str> {
    lookup(FUNCTIONS, name)
}

/// Looks up a name in a table, ignoring case, and returns its equivalent. Returns `None` if the table does not contain
/// the name, or if the equivalent is the name itself.
fn lookup(table: &[Equivalent], name: &str) -> Option<&'static str> {
    let lower = name.to_lowercase();
    let found = table
        .iter()
        .find(|(there, here)| *there == lower && *here != name);
    found.map(|(_, here)| *here)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_found_whatever_their_letters() {
        assert_eq!(type_equivalent("Float"), Some("real"));
        assert_eq!(value_equivalent("True"), Some("true"));
        assert_eq!(function_equivalent("fabs"), Some("abs"));
        assert_eq!(type_equivalent("real"), None);
        assert_eq!(type_equivalent("Speed"), None);
    }
}
