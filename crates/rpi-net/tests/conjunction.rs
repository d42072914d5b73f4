//! Decomposition of Boolean flows into conjunctions, tested against truth tables of random nets and on the recorded
//! nets.

mod nets;

use std::fmt::Write;

use rpi_net::passes::Conjunction;
use rpi_net::{Input, Net, PortRef};

/// Pseudo-random number generator (Marsaglia 2003, xorshift64).
struct Random(u64);

impl Random {
    fn below(&mut self, most: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % most as u64) as usize
    }
}

/// Gate over earlier flows.
#[derive(Clone, Copy)]
enum Gate {
    Const(bool),
    And(usize, usize),
    Or(usize, usize),
    Not(usize),
}

/// Number of inputs: flow 0 is the cancel request, the others are set from outside. Gates follow.
const OUTSIDE: usize = 5;

fn gates(random: &mut Random) -> Vec<Gate> {
    let count = 1 + random.below(12);
    let gate = |k: usize| {
        let mut earlier = || random.below(OUTSIDE + k);
        let (a, b) = (earlier(), earlier());
        match random.below(10) {
            0 => Gate::Const(random.below(2) == 0),
            1..=4 => Gate::And(a, b),
            5..=6 => Gate::Or(a, b),
            _ => Gate::Not(a),
        }
    };
    (0..count).map(gate).collect()
}

fn port(flow: usize) -> String {
    match flow {
        0 => "f0.outCancel".to_owned(),
        _ => format!("f{flow}.outValue"),
    }
}

/// Text of the net of these gates; node `k` computes flow `k`.
fn text(gates: &[Gate]) -> String {
    let mut text = String::from("{f0=Cancel()");
    for k in 1..OUTSIDE {
        let _ = write!(
            text,
            ",f{k}=Core::BooleanNetcommIn(Key='{k}',Value='false')"
        );
    }
    for (k, gate) in gates.iter().enumerate() {
        let _ = write!(text, ",f{}=Core::Boolean", OUTSIDE + k);
        let both = |a: usize, b: usize| format!("inFirst={},inSecond={}", port(a), port(b));
        let _ = match *gate {
            Gate::Const(value) => write!(text, "Value(Value='{value}')"),
            Gate::And(a, b) => write!(text, "And({})", both(a, b)),
            Gate::Or(a, b) => write!(text, "Or({})", both(a, b)),
            Gate::Not(a) => write!(text, "Not(inValue={})", port(a)),
        };
    }
    text + "}"
}

/// Values of all flows, where the bits of `outside` are the inputs.
fn values(gates: &[Gate], outside: usize) -> Vec<bool> {
    let mut values: Vec<bool> = (0..OUTSIDE).map(|k| outside >> k & 1 == 1).collect();
    for gate in gates {
        values.push(match *gate {
            Gate::Const(value) => value,
            Gate::And(a, b) => values[a] && values[b],
            Gate::Or(a, b) => values[a] || values[b],
            Gate::Not(a) => !values[a],
        });
    }
    values
}

fn flow(net: &Net, name: &str) -> Input {
    let node = net.node_ids().find(|id| net.node(*id).name == name);
    let node = node.expect("a node has this name");
    Input::Port(PortRef { node, port: 0 })
}

#[test]
fn a_conjunction_holds_exactly_if_its_flow_is_true() {
    let mut random = Random(0x9e37_79b9_7f4a_7c15);
    let (mut never, mut parts) = (0, 0);
    for _ in 0..1000 {
        let gates = gates(&mut random);
        let net = nets::net("random", &text(&gates));
        let last = OUTSIDE + gates.len() - 1;
        let found = Conjunction::from_flow(&net, &flow(&net, &format!("f{last}")));
        never += usize::from(found.is_none());
        parts += found.as_ref().map_or(0, |f| f.flows.len());
        for outside in 0..1 << OUTSIDE {
            let values = values(&gates, outside);
            let holds = found.as_ref().is_some_and(|f| {
                let holds = |(port, polarity): &(PortRef, bool)| {
                    let name = &net.node(port.node).name;
                    values[name[1..].parse::<usize>().unwrap()] == *polarity
                };
                f.cancelled.is_none_or(|c| c == values[0]) && f.flows.iter().all(holds)
            });
            assert_eq!(holds, values[last], "{} for {outside:b}", text(&gates));
        }
    }
    // Both outcomes must have occurred.
    assert!(never > 20 && parts > 1000, "{never} {parts}");
}

/// Motions of the reference system report completion and cancellation by results that differ only in the cancel
/// request.
#[test]
fn recorded_motions_have_two_results_that_differ_in_the_cancel() {
    let Some(nets) = nets::nets_in("v2") else {
        return;
    };
    let mut found = 0;
    for (name, text) in &nets {
        let net = nets::net(name, text);
        let exports = net
            .nodes
            .iter()
            .filter(|n| n.desc().name == "Core::BooleanNetcommOut");
        let reasons = exports.filter_map(|n| Conjunction::from_flow(&net, &n.inputs[0]));
        let (mut going, mut cancelled) = (Vec::new(), Vec::new());
        for reason in reasons {
            match reason.cancelled {
                Some(true) => cancelled.push(reason.flows),
                Some(false) => going.push(reason.flows),
                None => {}
            }
        }
        let pairs = going.iter().filter(|flows| cancelled.contains(flows));
        found += usize::from(pairs.count() == 1);
    }
    assert!(found * 10 >= nets.len() * 8, "{found} of {}", nets.len());
}
