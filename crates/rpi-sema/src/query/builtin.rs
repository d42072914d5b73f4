//! What every program has without a declaration: flows, operators that are written as calls, parts of spatial values.

use crate::check;
use rpi_image::Scalar;
use rpi_prims::PrimId;

/// Something that is there without a declaration.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Builtin {
    /// Its name.
    pub name: &'static str,
    /// How it is used: `time: real[s]`, `hold(x, init)`.
    pub form: String,
    /// What it is.
    pub doc: String,
    /// Whether it is called.
    pub is_call: bool,
}

/// Operators that are written as calls: name, form, what they give.
const CALLS: &[(&str, &str, &str)] = &[
    (
        "present",
        "present(x)",
        "Whether a flow is there in this cycle.",
    ),
    (
        "hold",
        "hold(x, init)",
        "The latest value of `x`; `init` before there was one.",
    ),
    (
        "condact",
        "condact<<f, d>>(c, x)",
        "`f(x)` in the cycles in which `c` holds, else what it gave last; `d` before the first.",
    ),
    (
        "sqrt",
        "sqrt(x)",
        "Square root; the unit takes the root, too.",
    ),
    (
        "time",
        "time(x)",
        "Seconds as a time: whole ticks, rounded up.",
    ),
    (
        "vector",
        "vector(x, y, z)",
        "The vector of three reals of one unit.",
    ),
    (
        "dot",
        "dot(a, b)",
        "The scalar product of two vectors; units multiply.",
    ),
    (
        "cross",
        "cross(a, b)",
        "The vector product of two vectors; units multiply.",
    ),
    ("norm", "norm(v)", "How long a vector is, in its unit."),
    (
        "inverse",
        "inverse(p)",
        "Of a pose or rotation `(b in a)` that of `(a in b)`.",
    ),
    (
        "any",
        "any<<T>>()",
        "A value that a Lustre program leaves open.",
    ),
    (
        "choose",
        "choose { x: T | condition }",
        "A value that a Lustre program leaves open but for a condition.",
    ),
    (
        "map",
        "map<<f; n>>(a, b)",
        "`f` of the elements, one by one: an array of what it gives.",
    ),
    (
        "red",
        "red<<f; n>>(init, a)",
        "`f` of what came out so far and the next element; the last of it.",
    ),
    ("fold", "fold<<f; n>>(init, a)", "The same as `red`."),
    (
        "fill",
        "fill<<f; n>>(init)",
        "`f` of what came out so far, over and over: its last state and an array of its results.",
    ),
    (
        "fillred",
        "fillred<<f; n>>(init, a)",
        "`f` of the state and the next elements: its last state and arrays of its results.",
    ),
    (
        "mapfold",
        "mapfold<<n, f>>(init, a)",
        "The same as `fillred`, with the size first.",
    ),
    (
        "boolred",
        "boolred<<least, most, n>>(a)",
        "Whether at least so many and at most so many elements are true.",
    ),
];

/// Conversions of `.lus` files.
const MACHINE: [(&str, &str); 10] = [
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

/// Everything that is there without a declaration in a `.rpi` file, in a fixed order.
pub fn builtins() -> impl Iterator<Item = Builtin> {
    let none = Builtin {
        name: "none",
        form: "none".to_owned(),
        doc: "The absent value.".to_owned(),
        is_call: false,
    };
    let machine = MACHINE.iter().map(|(name, form)| Builtin {
        name,
        form: (*form).to_owned(),
        doc: "Machine integer of Kind 2 with the lowest bits of x.".to_owned(),
        is_call: true,
    });
    let calls = CALLS.iter().map(|(name, form, doc)| Builtin {
        name,
        form: (*form).to_owned(),
        doc: (*doc).to_owned(),
        is_call: true,
    });
    flows().chain([none]).chain(calls).chain(machine)
}

/// The one of this name.
#[must_use]
pub fn builtin(name: &str) -> Option<Builtin> {
    let mut all = builtins().chain(constraints());
    all.find(|builtin| builtin.name == name)
}

/// The constraints of type parameters, which stand nowhere else.
fn constraints() -> impl Iterator<Item = Builtin> {
    check::constraints().map(|(name, admitted)| Builtin {
        name,
        form: format!("type T: {name}"),
        doc: format!("Constraint of a type parameter: {admitted}."),
        is_call: false,
    })
}

fn flows() -> impl Iterator<Item = Builtin> {
    check::predeclared().map(|(name, prim, ty)| Builtin {
        name,
        form: format!("{name}: {ty}"),
        doc: PrimId::of(prim).map_or_else(String::new, |prim| prim.desc().doc.to_owned()),
        is_call: false,
    })
}

/// The parts of a spatial value that are read by name.
pub fn spatial_parts(scalar: Scalar) -> impl Iterator<Item = &'static str> {
    check::spatial_parts(scalar)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_operator_that_the_checker_knows_is_told() {
        for name in check::operator_names() {
            // `time` is a flow, too.
            let told = builtins().any(|b| b.name == name && b.is_call);
            assert!(told, "{name}");
        }
        assert!(builtins().all(|builtin| !builtin.doc.is_empty()));
    }

    #[test]
    fn predeclared_flows_have_types() {
        assert_eq!(builtin("time").unwrap().form, "time: time");
        assert_eq!(
            spatial_parts(Scalar::Vector).collect::<Vec<_>>(),
            ["x", "y", "z"]
        );
    }
}
