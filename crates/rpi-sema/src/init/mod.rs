//! Initialisation (M5): a `pre` of a total flow has no value in the first cycle of its fragment, and nobody may read it
//! there; `current` has none before the first tick of its operand's clock.
//!
//! The first cycles of each fragment are looked at one by one and all later ones together. In each, a flow has a value that
//! is known, some value, or maybe none; what decides by itself (a condition that is known, `false and x`) hides what does
//! not matter. What leaves the net, or decides what is active in it, must have a value in every cycle. The root, the delay
//! itself, is named. After Colaço and Pouzet, Type-based initialization analysis of a synchronous dataflow language
//! (2004), with values and conditions.
//!
//! | file | idea |
//! |---|---|
//! | `claims.rs` | claims of Lustre, which may read what is not there yet |
//! | `glance.rs` | a first look, which most nets pass |
//! | `known.rs` | what is known of a flow in one phase |
//! | `latch.rs` | what has held once: `seen = c or (false -> pre seen)` |
//! | `phases.rs` | the first cycles of a fragment, and those of the one around it |
//! | `rules.rs` | what each kind of primitive makes of it |
//! | `order.rs`, `solve.rs` | the least solution |

mod claims;
mod glance;
mod known;
mod latch;
mod order;
mod phases;
mod rules;
mod solve;

use crate::hash::{Map, Set};
use known::Known;
use phases::PHASES;
use rpi_diag::{Code, Finding, Fix, Span};
use rpi_image::claim::is_for_claim;
use rpi_image::{Role, State};
use rpi_net::passes::Users;
use rpi_net::prim;
use rpi_net::without_calls;
use rpi_net::{Activation, Driver, FragmentId, Input, Net, Node, NodeId, PortRef};
use rpi_prims::PrimId;
use rules::{Rule, rule};
use solve::Solution;

/// What is read before it has a value. What the program claims to hold by its writer's or its caller's word may be
/// relied upon.
#[must_use]
pub fn check(net: &Net) -> Vec<Finding> {
    let rules = rules::rules(net);
    let read = || sinks(net).chain(claims::looked_at(net));
    if !rules.contains(&Rule::Delay) || !glance::doubts(net, &rules, read()) {
        return Vec::new();
    }
    let given: Vec<PortRef> = asserted(net).chain(given(net)).collect();
    let solution = Solution::new(net, rules.clone(), &given);
    let roots = all_roots(&solution, &rules, &given);
    let in_claims = claims::findings(net, &rules, &roots, &given);
    let mut findings: Vec<Finding> = Vec::new();
    let mut by_flow: Vec<(Option<&str>, Vec<NodeId>)> = Vec::new();
    let mut places: Map<&str, usize> = Map::default();
    let users = Users::new(net);
    let mut at_once: Set<NodeId> = Set::default();
    for root in roots {
        let node = reader(net, &users, root).filter(|_| !holds_itself(net, root));
        if is_missing_at_once(&solution, node.unwrap_or(root)) {
            at_once.insert(root);
        }
        let flow = node.and_then(|node| net.node(node).origin.flow.as_deref());
        let new = by_flow.len();
        let place = flow.map_or(new, |flow| *places.entry(flow).or_insert(new));
        if place == new {
            by_flow.push((flow, Vec::new()));
        }
        by_flow[place].1.push(root);
    }
    for (flow, roots) in whole(net, by_flow) {
        let is_first = roots.iter().any(|root| at_once.contains(root));
        findings.push(finding(net, flow.as_deref(), &roots, is_first));
    }
    findings.extend(in_claims);
    findings
}

/// Parts of one value that have no first value for the same reason, by their places in the text, become that value.
fn whole(
    net: &Net,
    by_flow: Vec<(Option<&str>, Vec<NodeId>)>,
) -> Vec<(Option<String>, Vec<NodeId>)> {
    let mut all: Vec<(Option<String>, Vec<NodeId>)> = Vec::new();
    let mut known: Map<(String, Vec<Span>), usize> = Map::default();
    for (flow, roots) in by_flow {
        let flow = flow.map(without_calls);
        let places = roots
            .iter()
            .map(|root| net.node(*root).origin.span)
            .collect();
        let of = flow
            .as_deref()
            .and_then(|flow| flow.split(['[', '.']).next());
        let same = of.map(|of| *known.entry((of.to_owned(), places)).or_insert(all.len()));
        let same = same.filter(|same| *same < all.len());
        match (same.and_then(|same| all[same].0.as_mut()), &flow) {
            (Some(name), Some(flow)) => name.truncate(in_common(name, flow)),
            _ => all.push((flow, roots)),
        }
    }
    all
}

/// How many bytes the names of two parts of one value have in common, as far as these are a name.
fn in_common(a: &str, b: &str) -> usize {
    let starts = a.match_indices(['[', '.']).map(|(at, _)| at);
    let starts = starts.chain([a.len()]);
    let mut both = starts.filter(|at| b.get(..*at) == Some(&a[..*at]));
    both.next_back().unwrap_or(a.len())
}

/// What was found out about a net without findings, in words.
#[must_use]
pub fn told(net: &Net) -> String {
    let delays = net
        .nodes
        .iter()
        .filter(|node| node.desc().role == Role::Delay);
    let claims = net
        .claims
        .iter()
        .filter(|claim| claim.kind.is_given())
        .count();
    format!(
        "{} delays, none read before it has a value; {claims} claims relied upon",
        delays.count()
    )
}

/// What is claimed without being shown.
fn given(net: &Net) -> impl Iterator<Item = PortRef> + '_ {
    let given = net.claims.iter().filter(|claim| claim.kind.is_given());
    let keys: Set<&str> = given.map(|claim| claim.key.as_str()).collect();
    let exports = net.exports.iter();
    let claimed = exports.filter(move |export| keys.contains(export.key.as_str()));
    claimed.map(|export| export.source)
}

/// Looks at most so often for delays that others hide.
const ROUNDS: usize = 20;

/// Looks at so many nodes for them, each time it looks.
const NODES: usize = 400_000;

/// The delays that are read too early, also those that only show when others have a first value.
fn all_roots(solution: &Solution<'_>, rules: &[Rule], claims: &[PortRef]) -> Vec<NodeId> {
    let net = solution.net();
    let mut rules = rules.to_vec();
    let mut roots = Vec::new();
    let mut more = read_early(solution);
    // Of what is hidden in a large net the rest is told when the others have first values.
    let rounds = (NODES / net.nodes.len().max(1)).clamp(1, ROUNDS);
    for _ in 1..rounds {
        if more.is_empty() {
            break;
        }
        for delay in &more {
            rules[delay.index()] = Rule::OptionalDelay;
        }
        roots.append(&mut more);
        more = read_early(&Solution::new(net, rules.clone(), claims));
    }
    roots.append(&mut more);
    roots.sort_unstable();
    roots
}

/// Whether the flow of a node has no value in the first cycle of its fragment.
fn is_missing_at_once(solution: &Solution<'_>, node: NodeId) -> bool {
    let fragment = solution.net().node(node).fragment;
    let port = PortRef { node, port: 0 };
    root_of(&solution.seen(port, fragment, 0).known).is_some()
}

/// Whether the primitive ends the command where a condition does not hold.
fn is_check(prim: PrimId) -> bool {
    [
        prim!("Rpi::Assert"),
        prim!("Rpi::AssertIndex"),
        prim!("Rpi::Assume"),
    ]
    .contains(&prim)
}

/// What ends the command where it does not hold.
fn asserted(net: &Net) -> impl Iterator<Item = PortRef> + '_ {
    let checks = net.nodes.iter();
    let checks = checks.filter(|node| is_check(node.prim));
    checks.filter_map(|node| node.inputs.first().and_then(Input::port))
}

/// The delays that are read too early by what must have a value in every cycle, in the order of the net.
fn read_early(solution: &Solution<'_>) -> Vec<NodeId> {
    let net = solution.net();
    let mut roots = Vec::new();
    for (port, from) in sinks(net) {
        for phase in 0..PHASES {
            roots.extend(root_of(&solution.seen(port, from, phase).known));
        }
    }
    roots.sort_unstable();
    roots.dedup();
    roots
}

fn root_of(known: &Known) -> Option<NodeId> {
    match known {
        Known::Undefined { root, .. } => Some(*root),
        _ => None,
    }
}

/// What leaves the net, or decides what is active in it, each with the fragment that looks at it.
fn sinks(net: &Net) -> impl Iterator<Item = (PortRef, FragmentId)> + '_ {
    let own = |port: PortRef| (port, net.node(port.node).fragment);
    let strict = net.claims.iter().filter(|claim| claim.is_strict);
    let strict: Set<&str> = strict.map(|claim| claim.key.as_str()).collect();
    // What a claim reads is only looked at: whether it holds must be known.
    let counts = move |key: &str| !is_for_claim(key) || strict.contains(key);
    let exports = net.exports.iter().filter(move |export| counts(&export.key));
    let exports = exports.map(move |export| own(export.source));
    let results = match &net.driver {
        Driver::Results(results) => &results[..],
        Driver::Ports { .. } => &[],
    };
    let results = results.iter().filter_map(|result| result.condition.port());
    let results = results.map(|port| (port, FragmentId::ROOT));
    let activations = net
        .fragments
        .iter()
        .filter_map(|fragment| match fragment.activation {
            Activation::When { condition, .. } => Some((condition, fragment.parent?)),
            Activation::Always => None,
        });
    let leaving = net.nodes.iter();
    let leaving = leaving.filter(|n| matches!(n.desc().role, Role::Actuator(_) | Role::Export));
    let leaving = leaving.flat_map(|node| {
        let ports = node.inputs.iter().filter_map(Input::port);
        ports.map(move |port| (port, node.fragment))
    });
    // What remembers a value that is not there yet may give it later.
    let remembers = |n: &&Node| {
        let state = n.desc().state;
        n.desc().role == Role::Compute && !matches!(state, State::None)
    };
    let remembering = net.nodes.iter().filter(remembers);
    let remembering = remembering.flat_map(|node| {
        let ports = node.inputs.iter().filter_map(Input::port);
        ports.map(move |port| (port, node.fragment))
    });
    let sinks = exports.chain(results).chain(activations).chain(leaving);
    sinks.chain(remembering)
}

/// The delays without a first value in the equation of one flow.
fn finding(net: &Net, flow: Option<&str>, roots: &[NodeId], is_first: bool) -> Finding {
    let place = |root: &NodeId| net.node(*root).origin.span;
    if let [one] = roots
        && holds_itself(net, *one)
    {
        return Finding::new(Code::RPI5002, "`current` is read before it has a value")
            .at(place(one), "there may be cycles before the first tick")
            .help("say that its clock ticks in the first cycle, or what it is until then: `if seen then current x else y`");
    }
    let what = flow.map_or_else(|| "a flow".to_owned(), |flow| format!("`{flow}`"));
    let message = match is_first {
        true => format!("{what} has no value in the first cycle"),
        false => format!("{what} has no value in one of the first cycles"),
    };
    let mut finding = Finding::new(Code::RPI5001, message);
    for root in roots {
        finding = finding.at(place(root), "there is no cycle before the first");
    }
    let mut places = roots.iter().map(place);
    if places.any(|place| net.outer_delays.contains(&place)) {
        // Here `->` would start afresh together with the fragment or state.
        return finding.help("say what it is then, outside of the fragment or state: `before = first -> last x;`, and read that");
    }
    let mut fix = Fix::maybe("give it a first value");
    for root in roots {
        let first = first_value(net, *root);
        // The whole equation needs no parentheses.
        fix = match net.node(*root).origin.flow {
            Some(_) => fix.insert_before(place(root), first),
            None => {
                let fix = fix.insert_before(place(root), format!("({first}"));
                fix.insert_after(place(root), ")")
            }
        };
    }
    let finding = finding.help("say what it is then: `first -> pre x`");
    finding.fix(fix)
}

/// The flow whose equation a node is part of: the first with a name that the way from it leads to.
fn reader(net: &Net, users: &Users, root: NodeId) -> Option<NodeId> {
    let mut seen = vec![root];
    let mut next = 0;
    while let Some(id) = seen.get(next).copied() {
        if net.node(id).origin.flow.is_some() {
            return Some(id);
        }
        for user in users.of(id) {
            if !seen.contains(user) {
                seen.push(*user);
            }
        }
        next += 1;
    }
    None
}

/// Whether a delay keeps the value of a sampled flow: what it delays is that flow where it ticks, else the delay itself.
fn holds_itself(net: &Net, delay: NodeId) -> bool {
    let input = net.node(delay).inputs.first().and_then(Input::port);
    input.is_some_and(|port| {
        let source = net.node(port.node);
        let same_place = source.origin.span == net.node(delay).origin.span;
        let otherwise = source.inputs.get(2).and_then(Input::port);
        same_place
            && rule(source) == Rule::Choice
            && otherwise.is_some_and(|port| port.node == delay)
    })
}

/// How the text of a first value begins.
fn first_value(net: &Net, root: NodeId) -> &'static str {
    use rpi_image::{Scalar, Type};
    match net.node(root).outputs.first() {
        Some(Type::One(Scalar::Bool)) => "false -> ",
        Some(Type::One(Scalar::Int)) => "0 -> ",
        _ => "0.0 -> ",
    }
}
