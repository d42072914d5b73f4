//! Names of other languages for what has a name here, too.

/// A name elsewhere, and here.
type Row = (&'static str, &'static str);

/// Types; looked up in lower case.
const TYPES: &[Row] = &[
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

/// Values; looked up in lower case.
const VALUES: &[Row] = &[
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

/// What is called; looked up in lower case.
const CALLS: &[Row] = &[
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

/// Those that take their arguments otherwise than what they are called elsewhere, or are asked for where others are just there.
const OTHERWISE: &[&str] = &[
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

/// Whether a value of another language is hardly meant where something declared has nearly its name.
pub(super) fn is_loose(name: &str) -> bool {
    const LOOSE: [&str; 6] = ["on", "off", "yes", "now", "absent", "cycle_time"];
    LOOSE.contains(&&*name.to_lowercase())
}

/// Whether all that differs from the name `there` is the name.
pub(super) fn differs_by_name(there: &str, here: &str) -> bool {
    !OTHERWISE.contains(&here) || there.eq_ignore_ascii_case(here)
}

/// What is written in place of a name that stands for an object or a module elsewhere.
pub(super) fn no_value(name: &str) -> Option<&'static str> {
    match &*name.to_lowercase() {
        "self" | "this" | "me" => Some("flows and ports are read by their names alone: `x`"),
        "math" | "np" | "numpy" | "std" | "cmath" => {
            Some("what a module declares is read by its name alone: `pi`, `sin(x)`")
        }
        _ => None,
    }
}

/// What is written in place of a type for texts, lists or nothing: such types have no name here.
pub(super) fn no_type(name: &str) -> Option<&'static str> {
    let lower = name.to_lowercase();
    let found = NO_TYPES.iter().find(|(names, _)| names.contains(&&*lower));
    found.map(|(_, help)| *help)
}

/// Names of types that do not exist here, with what is written instead.
const NO_TYPES: &[(&[&str], &str)] = &[
    (
        &["string", "str", "text", "wstring"],
        "flows hold no texts; a choice among names is an enum: `type Mode = enum { Off, On };`",
    ),
    (
        &[
            "array", "list", "vec", "slice", "vector", "tuple", "set", "deque", "queue", "matrix",
            "ndarray",
        ],
        "an array has its size behind its type: `int^3`; a matrix is `real^3^2`",
    ),
    (
        &["dict", "map", "hashmap", "object", "record", "any"],
        "named parts are a struct: `type Part = struct { place: real; count: int };`",
    ),
    (&["void", "unit"], "a node without outputs has `returns ()`"),
    (
        &["auto", "var", "let"],
        "a local flow without `var` has the type of its value: `x = 0 -> pre x + 1;`",
    ),
    (
        &["optional", "option", "maybe", "nullable"],
        "a value that may be absent has a type with `?`: `int?`",
    ),
    (
        &["jointtarget", "e6axis", "axis", "jointpos"],
        "joints are an array of angles: `real[rad]^6`",
    ),
];

/// What a type is called here.
pub(super) fn type_here(name: &str) -> Option<&'static str> {
    here(TYPES, name)
}

/// What a value is called here.
pub(super) fn value_here(name: &str) -> Option<&'static str> {
    here(VALUES, name)
}

/// What something to call is called here.
pub(super) fn call_here(name: &str) -> Option<&'static str> {
    here(CALLS, name)
}

fn here(table: &[Row], name: &str) -> Option<&'static str> {
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
        assert_eq!(type_here("Float"), Some("real"));
        assert_eq!(value_here("True"), Some("true"));
        assert_eq!(call_here("fabs"), Some("abs"));
        assert_eq!(type_here("real"), None);
        assert_eq!(type_here("Speed"), None);
    }
}
