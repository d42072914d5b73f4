//! Predeclared names: flows, operators with call syntax, and components of spatial values.

use crate::check;
use rpi_image::Scalar;
use rpi_prims::PrimId;

/// Predeclared name of the language, with its documentation for editors.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Builtin {
    /// Name by which programs use the predeclared item.
    pub name: &'static str,
    /// Syntax of a use, such as `time: real[s]` or `hold(x, init)`.
    pub usage: String,
    /// Description of what the name means, for editors.
    pub doc: String,
    /// Whether the name is used in call syntax, like a function.
    pub is_call: bool,
}

/// Predeclared operators in call syntax: name, syntax of a use, and description.
const CALL_OPERATORS: &[(&str, &str, &str)] = &[
    (
        "present",
        "present(x)",
        "Whether a flow is present in this cycle.",
    ),
    (
        "hold",
        "hold(x, init)",
        "The latest value of `x`; `init` before the first.",
    ),
    (
        "condact",
        "condact<<f, d>>(c, x)",
        "`f(x)` in cycles in which `c` is true, else its last result; `d` before the first.",
    ),
    (
        "sqrt",
        "sqrt(x)",
        "Square root; its unit is the root of the unit of `x`.",
    ),
    (
        "time",
        "time(x)",
        "Converts seconds to a time in whole ticks, rounded up.",
    ),
    (
        "vector",
        "vector(x, y, z)",
        "Vector of three reals with the same unit.",
    ),
    (
        "dot",
        "dot(a, b)",
        "Dot product of two vectors; units multiply.",
    ),
    (
        "cross",
        "cross(a, b)",
        "Cross product of two vectors; units multiply.",
    ),
    ("norm", "norm(v)", "Length of a vector, in its unit."),
    (
        "inverse",
        "inverse(p)",
        "Inverse of a pose or rotation: `(a in b)` from `(b in a)`.",
    ),
    ("any", "any<<T>>()", "Arbitrary value of a type (Lustre)."),
    (
        "choose",
        "choose { x: T | condition }",
        "Arbitrary value that satisfies a condition (Lustre).",
    ),
    (
        "map",
        "map<<f; n>>(a, b)",
        "Applies `f` to each element; returns the array of results.",
    ),
    (
        "red",
        "red<<f; n>>(init, a)",
        "Applies `f` to the accumulator and each element in turn; returns the last accumulator.",
    ),
    ("fold", "fold<<f; n>>(init, a)", "Same as `red`."),
    (
        "fill",
        "fill<<f; n>>(init)",
        "Applies `f` to the accumulator `n` times; returns the last accumulator and an array of results.",
    ),
    (
        "fillred",
        "fillred<<f; n>>(init, a)",
        "Applies `f` to the accumulator and each element; returns the last accumulator and arrays of results.",
    ),
    (
        "mapfold",
        "mapfold<<n, f>>(init, a)",
        "Same as `fillred`, with the size first.",
    ),
    (
        "boolred",
        "boolred<<least, most, n>>(a)",
        "Whether at least `least` and at most `most` elements are true.",
    ),
];

/// Conversions to machine integers in Lustre: name, and syntax of a use.
const MACHINE_CONVERSIONS: [(&str, &str); 10] = [
    ("int8", "(int8 x)"),
    ("int16", "(int16 x)"),
    ("int32", "(int32 x)"),
    ("int64", "(int64 x)"),
    ("uint8", "(uint8 x)"),
    ("uint16", "(uint16 x)"),
    ("uint32", "(uint32 x)"),
    ("uint64", "(uint64 x)"),
    ("sint", "(sint@<n> x)"),
    ("uint", "(uint@<n> x)"),
];

/// Returns all predeclared names of a program, in a fixed order.
pub fn builtins() -> impl Iterator<Item = Builtin> {
    let none = Builtin {
        name: "none",
        usage: "none".to_owned(),
        doc: "The absent value.".to_owned(),
        is_call: false,
    };
    let machine = MACHINE_CONVERSIONS.iter().map(|(name, form)| Builtin {
        name,
        usage: (*form).to_owned(),
        doc: "Machine integer of Kind 2 with the lowest bits of `x`.".to_owned(),
        is_call: true,
    });
    let calls = CALL_OPERATORS.iter().map(|(name, form, doc)| Builtin {
        name,
        usage: (*form).to_owned(),
        doc: (*doc).to_owned(),
        is_call: true,
    });
    flows().chain([none]).chain(calls).chain(machine)
}

/// Returns the predeclared item with this name; `None` if there is none.
#[must_use]
pub fn builtin(name: &str) -> Option<Builtin> {
    let mut all = builtins().chain(constraints());
    all.find(|builtin| builtin.name == name)
}

/// Returns the constraints of type parameters, such as `number`, as predeclared items. They are allowed only after the
/// name of a type parameter.
fn constraints() -> impl Iterator<Item = Builtin> {
    check::constraints().map(|(name, admitted)| Builtin {
        name,
        usage: format!("type T: {name}"),
        doc: format!("Constraint of a type parameter: {admitted}."),
        is_call: false,
    })
}

fn flows() -> impl Iterator<Item = Builtin> {
    check::resolve_predeclared().map(|(name, prim, ty)| Builtin {
        name,
        usage: format!("{name}: {ty}"),
        doc: PrimId::from_name(prim).map_or_else(String::new, |prim| prim.desc().doc.to_owned()),
        is_call: false,
    })
}

/// Returns the names of the parts of a spatial type (vector, pose and the like) that can be read by name.
pub fn spatial_parts(scalar: Scalar) -> impl Iterator<Item = &'static str> {
    check::spatial_parts(scalar)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_operator_that_the_checker_knows_is_told() {
        for name in check::intrinsic_names() {
            // `time` is also a flow.
            let is_listed = builtins().any(|b| b.name == name && b.is_call);
            assert!(is_listed, "{name}");
        }
        assert!(builtins().all(|builtin| !builtin.doc.is_empty()));
    }

    #[test]
    fn predeclared_flows_have_types() {
        assert_eq!(builtin("time").unwrap().usage, "time: time");
        assert_eq!(
            spatial_parts(Scalar::Vector).collect::<Vec<_>>(),
            ["x", "y", "z"]
        );
    }
}
