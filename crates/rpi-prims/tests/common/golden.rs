//! Examples of primitives: inputs and expected outputs.

use super::{TestBench, near, reals};
use rpi_image::{Scalar, Type, Value};

/// Example: primitive, inputs, expected outputs.
pub(crate) type Line<'a> = (&'a str, &'a [Value], &'a [Value]);

/// Runs each example on its own test bench.
pub(crate) fn check(lines: &[Line<'_>]) {
    for (name, inputs, outputs) in lines {
        let mut rig = TestBench::new(name, &[]);
        let given = rig.step_present(inputs);
        assert_eq!(rig.fault, None, "{name}");
        same(name, &given, outputs);
    }
}

#[track_caller]
pub(crate) fn same(name: &str, given: &[Value], wanted: &[Value]) {
    assert_eq!(given.len(), wanted.len(), "{name}");
    for (given, wanted) in given.iter().zip(wanted) {
        assert_eq!(given.ty(), wanted.ty(), "{name}");
        match wanted.ty() {
            Some(
                Type::Scalar(Scalar::Bool | Scalar::Int | Scalar::Time)
                | Type::Array(Scalar::Bool, _),
            ) => {
                assert_eq!(given, wanted, "{name}");
            }
            _ => near(&reals(given), &reals(wanted)),
        }
    }
}
