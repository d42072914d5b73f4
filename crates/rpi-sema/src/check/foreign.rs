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
    ("int", "int"),
    ("integer", "int"),
    ("dint", "int"),
    ("lint", "int"),
    ("uint", "int"),
    ("long", "int"),
    ("short", "int"),
    ("i32", "int"),
    ("i64", "int"),
    ("u32", "int"),
    ("u64", "int"),
    ("int32", "int"),
    ("int64", "int"),
    ("bool", "bool"),
    ("boolean", "bool"),
    ("logical", "bool"),
    ("vec3", "Vector"),
    ("vector3", "Vector"),
    ("quaternion", "Rotation"),
    ("quat", "Rotation"),
    ("orientation", "Rotation"),
    ("transform", "Pose"),
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
    ("pi", "pi"),
    ("m_pi", "pi"),
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
];

/// Whether all that differs is the name.
pub(super) fn differs_by_name(here: &str) -> bool {
    !OTHERWISE.contains(&here)
}

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
