//! Compares the models of primitives with their code.

use super::super::concrete::{BoundaryValues, ConcreteDomain, ConcreteValue, InputScript};
use super::*;
use crate::passes::fact_prover::truth_tables::ValueSet;
use crate::passes::fact_prover::truth_tables::bench::{Bench, all_inputs, node};
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

fn flow<'a>(domain: &mut ConcreteDomain<'a>, set: ValueSet) -> Flow<ConcreteDomain<'a>> {
    Flow {
        present: domain.bit(set != ValueSet::ABSENT),
        value: domain.constant(&Value::bool(set == ValueSet::TRUE)),
    }
}

fn set(flow: &Flow<ConcreteDomain<'_>>) -> ValueSet {
    assert!(flow.present.exact && (flow.value.exact || !flow.present.value));
    match flow.present.value {
        true => ValueSet::from_bool(flow.value.value.as_bool() == Some(true)),
        false => ValueSet::ABSENT,
    }
}

#[test]
fn primitives_are_known_as_they_are() {
    let pool = BoundaryValues::default();
    for name in PRIMITIVES {
        let prim = PrimId::from_name(name).unwrap_or_else(|| panic!("{name} is no primitive"));
        for direction in [true, false] {
            let params = vec![Value::bool(direction); prim.desc().params.len()];
            let node = node(prim, params.clone());
            let gate = Gate::from_node(&node).unwrap_or_else(|| panic!("{name} is not known"));
            let mut domain = ConcreteDomain::new(InputScript::new(), 0, &pool);
            let mut memory: Vec<ConcreteValue> = Vec::new();
            for cell in gate.initial_state(&node) {
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
