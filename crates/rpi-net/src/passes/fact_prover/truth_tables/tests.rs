//! Compares the truth tables of gates with the code of the primitives.

use super::bench::{Bench, all_inputs, node};
use super::*;
use rpi_image::StateSize;
use rpi_prims::PrimId;

#[test]
fn gates_give_what_the_code_gives() {
    for (name, gate) in GATES {
        let prim = PrimId::from_name(name).unwrap_or_else(|| panic!("{name} is no primitive"));
        for direction in [true, false] {
            let params = vec![Value::bool(direction); prim.desc().params.len()];
            let node = node(prim, params.clone());
            let has_state = !matches!(prim.desc().state, StateSize::None);
            let inputs = all_inputs(prim.desc().inputs.len());
            let mut bench = Bench::new(prim.prim(), &params);
            // Every pair of successive inputs, so that every state is reached.
            for second in inputs
                .iter()
                .flat_map(|a| inputs.iter().flat_map(move |b| [a, b]))
            {
                let (actual, expected) = (bench.run(second), gate(&node, second));
                assert!(
                    actual.is_subset(expected),
                    "{name} {second:?}: {actual:?} not in {expected:?}"
                );
                assert!(
                    has_state || actual == expected,
                    "{name} {second:?}: {actual:?}"
                );
            }
        }
    }
}
