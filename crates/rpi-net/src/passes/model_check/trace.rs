//! Runs with given or random inputs: they find possible events and provide samples of the registers.

use super::concrete::{
    BoundaryValues, ConcreteDomain, ConcreteValue, InputScript, LONG_RUN_HOLD, Random,
};
use super::cycle::{Cycle, State, first_state};
use super::domain::{Flow, Source};
use super::query::Problem;
use crate::net::{Input, Net, NodeId, PortRef};
use rpi_image::{Role, Scalar, Type, Value};
use rustc_hash::FxHashMap;

/// Maximum number of cycles of a random run.
const RUN_LENGTH: usize = 24;
/// Maximum number of cycles of a long random run, which can reach events that a counter delays.
const LONG_RUN_LENGTH: usize = 5_000;
/// Number of long runs, each with its own seed of the random numbers.
const LONG_RUNS: u64 = 3;
/// Maximum number of states that random runs record as samples for invariants.
const SAMPLES: usize = 400;
/// Maximum number of random variations that are tried of a run proposed by the solver.
const VARIATIONS: u64 = 64;
/// Maximum number of inputs of an example run whose values are replaced by round numbers.
const ROUNDED: usize = 12;
/// Maximum number of constants per type from which random inputs are derived.
const MAX_BOUNDARY_VALUES: usize = 64;

/// Run that satisfies a query in its last cycle: its inputs, and the index of the last cycle, from 0.
#[derive(Clone, Debug)]
pub(super) struct Trace {
    pub(super) script: InputScript,
    pub(super) last: usize,
}

/// Results of random runs: example runs for queries, and samples of the states.
#[derive(Default)]
pub(super) struct Exploration {
    /// For each query, a run that satisfies it in its last cycle; `None` if none was found.
    pub(super) witnesses: Vec<Option<Trace>>,
    /// Contents of all registers (state elements) at the start of visited cycles.
    pub(super) samples: Vec<State<ConcreteDomain<'static>>>,
}

/// Returns the constants of these nodes, by type and without repetition. Small numbers such as 0 and 1 are always
/// included.
pub(super) fn boundary_values(net: &Net, nodes: &[NodeId]) -> BoundaryValues {
    let mut pool = BoundaryValues {
        integers: vec![0, 1, 2],
        reals: vec![0.0, 1.0],
    };
    for id in nodes {
        let node = net.node(*id);
        let constants = node.inputs.iter().filter_map(|input| match input {
            Input::Const(value) => Some(&**value),
            _ => None,
        });
        let own = node
            .params
            .iter()
            .filter(|_| node.desc().role == Role::Constant);
        constants.chain(own).for_each(|value| add(&mut pool, value));
    }
    pool
}

fn add(pool: &mut BoundaryValues, value: &Value) {
    match value.ty() {
        Some(Type::Scalar(Scalar::Int)) => {
            let new = value.as_int().filter(|v| !pool.integers.contains(v));
            pool.integers
                .extend(new.filter(|_| pool.integers.len() < MAX_BOUNDARY_VALUES));
        }
        Some(Type::Scalar(Scalar::Real)) => {
            let new = value
                .as_real()
                .filter(|v| !v.is_nan() && !pool.reals.contains(v));
            pool.reals
                .extend(new.filter(|_| pool.reals.len() < MAX_BOUNDARY_VALUES));
        }
        _ => {}
    }
}

/// Performs random runs until each query with an index in `pairs` is satisfied, or `steps` is exhausted. Subtracts one
/// step per node evaluation.
pub(super) fn explore(
    question: &Problem<'_>,
    pool: &BoundaryValues,
    pairs: &[usize],
    steps: &mut u64,
) -> Exploration {
    let mut seen = Exploration {
        witnesses: vec![None; question.events.len()],
        samples: Vec::new(),
    };
    let size = (question.cone.nodes.len() + question.events.len()) as u64 + 1;
    let mut seed = 0;
    while *steps > size && pairs.iter().any(|pair| seen.witnesses[*pair].is_none()) {
        let mut domain = ConcreteDomain::new(InputScript::new(), seed, pool);
        domain.use_neutral_inputs = seed == 0;
        domain.hold_probability = usize::try_from(seed % 8).unwrap_or(0);
        run(
            question,
            &mut domain,
            RUN_LENGTH,
            |cycle, state, together| {
                *steps = steps.saturating_sub(size);
                if seen.samples.len() < SAMPLES {
                    seen.samples.push(state.to_vec());
                }
                for pair in pairs.iter().filter(|pair| together[**pair]) {
                    seen.witnesses[*pair].get_or_insert_with(|| Trace {
                        script: InputScript::new(),
                        last: cycle,
                    });
                }
                *steps > size
            },
        );
        let found = seen.witnesses.iter_mut().flatten();
        found
            .filter(|trace| trace.script.is_empty())
            .for_each(|trace| {
                trace.script.clone_from(&domain.script);
            });
        seed += 1;
    }
    seen
}

/// Performs some long runs, for events that a counter delays.
///
/// Returns the index of the first query in `pairs` that a run satisfies, with the run; `None` if there is none.
/// Subtracts one step from `steps` per node evaluation.
pub(super) fn explore_long_runs(
    question: &Problem<'_>,
    pool: &BoundaryValues,
    pairs: &[usize],
    steps: &mut u64,
) -> Option<(usize, Trace)> {
    let size = (question.cone.nodes.len() + question.events.len()) as u64 + 1;
    let share = *steps / LONG_RUNS;
    (0..LONG_RUNS).find_map(|seed| {
        let mut domain = ConcreteDomain::new(InputScript::new(), seed, pool);
        domain.use_neutral_inputs = seed == 0;
        domain.hold_probability = LONG_RUN_HOLD;
        let (mut left, mut found) = (share, None);
        run(
            question,
            &mut domain,
            LONG_RUN_LENGTH,
            |cycle, _, together| {
                left = left.saturating_sub(size);
                found = pairs
                    .iter()
                    .find(|pair| together[**pair])
                    .map(|pair| (*pair, cycle));
                found.is_none() && left > size
            },
        );
        *steps = steps.saturating_sub(share - left);
        let (pair, last) = found?;
        let script = domain.script;
        Some((pair, Trace { script, last }))
    })
}

/// Runs at most `cycles` cycles, until one has a fault or ends the command.
///
/// After each cycle, calls `see` with the index of the cycle, the registers at its start, and for each query whether
/// the cycle certainly satisfies it. The run stops if `see` returns false.
fn run(
    question: &Problem<'_>,
    domain: &mut ConcreteDomain<'_>,
    cycles: usize,
    mut see: impl FnMut(usize, &[Flow<ConcreteDomain<'static>>], &[bool]) -> bool,
) {
    let mut state = first_state(domain, &question.cone);
    for number in 0..cycles {
        domain.cycle = number;
        let mut cycle = Cycle::new(domain, &question.cone, &state);
        let events = question.events.iter();
        let together: Vec<bool> = events
            .map(|event| {
                let is = event.is_satisfied(&mut cycle);
                is.value && is.exact
            })
            .collect();
        let ends = question.ends_at_once
            || question.ends.iter().any(|port| {
                let end = cycle.is_true(*port);
                end.value && end.exact
            });
        let next = cycle.next_state();
        if domain.is_faulty || !see(number, &to_static(&state), &together) || ends {
            return;
        }
        state = next;
    }
}

/// Returns a copy of a state that does not borrow from its run.
fn to_static(state: &[Flow<ConcreteDomain<'_>>]) -> State<ConcreteDomain<'static>> {
    let flows = state.iter();
    flows
        .map(|flow| Flow {
            present: flow.present,
            value: flow.value.clone(),
        })
        .collect()
}

/// Returns whether a run with the inputs of `trace` satisfies the query with the index `pair` in its last cycle.
pub(super) fn satisfies(
    question: &Problem<'_>,
    pool: &BoundaryValues,
    pair: usize,
    trace: &Trace,
) -> bool {
    let mut domain = ConcreteDomain::new(trace.script.clone(), 0, pool);
    domain.use_neutral_inputs = true;
    ends_with(question, &mut domain, pair, trace.last) && !domain.is_faulty
}

/// Returns whether the cycle with the index `last` is reached and satisfies the query with the index `pair`.
fn ends_with(
    question: &Problem<'_>,
    domain: &mut ConcreteDomain<'_>,
    pair: usize,
    last: usize,
) -> bool {
    let mut found = false;
    run(question, domain, last + 1, |number, _, together| {
        found = number == last && together[pair];
        true
    });
    found
}

/// Varies some inputs of a run at random until it satisfies the query with the index `pair` in its last cycle; `None`
/// if that fails.
///
/// The solver approximates real arithmetic, so that the inputs that it proposes need not be consistent.
pub(super) fn vary(
    question: &Problem<'_>,
    pool: &BoundaryValues,
    pair: usize,
    trace: &Trace,
    steps: &mut u64,
) -> Option<Trace> {
    let size = question.cone.nodes.len() as u64 + 1;
    (1..=VARIATIONS).find_map(|seed| {
        *steps = steps.checked_sub(size * (trace.last as u64 + 1))?;
        let mut random = Random(seed);
        let mut script = trace.script.clone();
        script.retain(|(source, _), value| {
            let is_real = value
                .as_ref()
                .is_some_and(|v| v.ty() == Some(Type::Scalar(Scalar::Real)));
            let dropped = random.below(8) < if is_real { 4 } else { 1 };
            matches!(source, Source::Core(_)) || !dropped
        });
        let mut domain = ConcreteDomain::new(script, seed, pool);
        let last = trace.last;
        let found = ends_with(question, &mut domain, pair, last);
        let script = domain.script;
        found.then_some(Trace { script, last })
    })
}

/// Returns a simpler run that satisfies the same query: it starts as late as possible, and its real inputs are rounded.
/// The inputs of a long run are not rounded.
pub(super) fn simplify(
    question: &Problem<'_>,
    pool: &BoundaryValues,
    pair: usize,
    trace: Trace,
) -> Trace {
    let mut best = trace.clone();
    for start in (1..=trace.last).rev().take(RUN_LENGTH) {
        let kept = trace
            .script
            .iter()
            .filter(|((_, cycle), _)| *cycle >= start);
        let moved =
            kept.map(|((source, cycle), value)| ((source.clone(), cycle - start), value.clone()));
        let shorter = Trace {
            script: moved.collect(),
            last: trace.last - start,
        };
        if satisfies(question, pool, pair, &shorter) {
            best = shorter;
            break;
        }
    }
    let rounded = if best.last > RUN_LENGTH { 0 } else { ROUNDED };
    let keys: Vec<_> = best.script.keys().take(rounded).cloned().collect();
    for key in keys {
        let value = best.script.get(&key).cloned().flatten();
        let Some(real) = value.filter(|v| v.ty() == Some(Type::Scalar(Scalar::Real))) else {
            continue;
        };
        let real = real.as_real().unwrap_or_default();
        for round in [
            0.0,
            1.0,
            real.round(),
            real.floor(),
            real.ceil(),
            (real * 10.0).round() / 10.0,
        ] {
            let mut rounded = best.clone();
            rounded.script.insert(key.clone(), Some(Value::real(round)));
            if satisfies(question, pool, pair, &rounded) {
                best = rounded;
                break;
            }
        }
    }
    best
}

/// Returns the values of `ports` in the last cycle of a run. Flows that are absent, or whose values are only guesses,
/// are left out.
pub(super) fn values(
    question: &Problem<'_>,
    pool: &BoundaryValues,
    trace: &Trace,
    ports: &[PortRef],
) -> FxHashMap<PortRef, ConcreteValue> {
    let mut domain = ConcreteDomain::new(trace.script.clone(), 0, pool);
    domain.use_neutral_inputs = true;
    let mut state = first_state(&mut domain, &question.cone);
    let mut values = FxHashMap::default();
    for number in 0..=trace.last {
        domain.cycle = number;
        let mut cycle = Cycle::new(&mut domain, &question.cone, &state);
        if number == trace.last {
            for port in ports {
                let flow = cycle.flow(*port);
                if flow.present.value && flow.value.exact {
                    values.insert(*port, flow.value);
                }
            }
        }
        let next = cycle.next_state();
        state = next;
    }
    values
}
