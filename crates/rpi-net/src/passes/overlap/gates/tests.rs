//! Compares the models of primitives with their code.

use super::super::concrete::{Concrete, Plain, Pool, Script};
use super::*;
use crate::passes::proof::truth::Set;
use crate::passes::proof::truth::bench::{Bench, all_inputs, node};
use rpi_prims::PrimId;

/// Primitives with a model; of those that exist for all types, the Boolean one.
const PRIMITIVES: [&str; 10] = [
    "Core::BooleanAnd",
    "Core::BooleanOr",
    "Core::BooleanConditional",
    "Core::BooleanSetNull",
    "Core::BooleanSnapshot",
    "Core::EdgeDetection",
    "Core::Trigger",
    "Rpi::BooleanImplies",
    "Rpi::BooleanCoalesce",
    "Rpi::BooleanHold",
];

fn flow<'a>(domain: &mut Concrete<'a>, set: Set) -> Flow<Concrete<'a>> {
    Flow {
        present: domain.bit(set != Set::ABSENT),
        value: domain.constant(&Value::bool(set == Set::TRUE)),
    }
}

fn set(flow: &Flow<Concrete<'_>>) -> Set {
    assert!(flow.present.exact && (flow.value.exact || !flow.present.value));
    match flow.present.value {
        true => Set::of(flow.value.value.as_bool() == Some(true)),
        false => Set::ABSENT,
    }
}

#[test]
fn primitives_are_known_as_they_are() {
    let pool = Pool::default();
    for name in PRIMITIVES {
        let prim = PrimId::of(name).unwrap_or_else(|| panic!("{name} is no primitive"));
        for direction in [true, false] {
            let params = vec![Value::bool(direction); prim.desc().params.len()];
            let node = node(prim, params.clone());
            let gate = Gate::of(&node).unwrap_or_else(|| panic!("{name} is not known"));
            let mut domain = Concrete::new(Script::new(), 0, &pool);
            let mut memory: Vec<Plain> = Vec::new();
            for cell in gate.memory(&node) {
                memory.push(domain.constant(&cell));
            }
            let mut bench = Bench::new(prim.prim(), &params);
            let all = all_inputs(prim.desc().inputs.len());
            // Every pair of successive inputs, so that every state is reached.
            for inputs in all
                .iter()
                .flat_map(|a| all.iter().flat_map(move |b| [a, b]))
            {
                let flows: Vec<_> = inputs.iter().map(|i| flow(&mut domain, *i)).collect();
                let output = gate.output(&mut domain, &flows).unwrap_or_else(|| {
                    let step = gate.step(&mut domain, &node, &flows, &memory);
                    let (output, after) = step.unwrap_or_else(|| panic!("{name} gives nothing"));
                    memory = after;
                    output
                });
                assert_eq!(
                    set(&output),
                    bench.run(inputs),
                    "{name} {direction} {inputs:?}"
                );
            }
        }
    }
}
