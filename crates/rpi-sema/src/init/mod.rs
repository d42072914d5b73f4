//! Initialisation analysis (M5). A `pre` of a flow that is not optional has no value in the first cycle of its fragment
//! and must not be read there. `current` has no value before the first tick of its operand's clock.
//!
//! The first cycles of each fragment are analysed one by one, and all later cycles together. In each phase a flow has a
//! known value, an unknown value, or possibly no value. An operand that decides the result alone (a known condition,
//! `false and x`) hides the others. Outputs of the net and activations must have a value in every cycle. The error
//! names the root, the delay itself. After Colaço and Pouzet, Type-based initialization analysis of a synchronous
//! dataflow language (2004), extended by values and conditions.
//!
//! | file | idea |
//! |---|---|
//! | `lenient_claims.rs` | claims of Lustre, which may read uninitialised values |
//! | `precheck.rs` | fast pre-check, which most nets pass |
//! | `abstract_value.rs` | abstract value of a flow in one phase |
//! | `latch.rs` | latches: `seen = c or (false -> pre seen)` |
//! | `phases.rs` | phases: the first cycles of a fragment and of its parent |
//! | `rules.rs` | transfer function of each kind of primitive |
//! | `worklist.rs`, `solve.rs` | least solution |

pub(crate) mod abstract_value;
mod latch;
pub(crate) mod lenient_claims;
mod phases;
pub(crate) mod precheck;
mod rules;
mod solve;
pub(crate) mod worklist;

use crate::hash::{FastMap, FastSet};
use crate::init::abstract_value::AbstractValue;
use phases::PHASES;
use rpi_diag::{Code, Diagnostic, Fix, Quote, Span};
use rpi_image::claim::is_claim_key;
use rpi_image::{Role, StateSize};
use rpi_net::passes::Readers;
use rpi_net::prim;
use rpi_net::strip_unnamed_calls;
use rpi_net::{Activation, FragmentId, Input, Net, Node, NodeId, PortRef, Termination};
use rpi_prims::PrimId;
use rules::{TransferRule, rule};
use solve::Solution;

/// Reports flows of a net that are read before they are initialised. Conditions that are asserted or assumed are taken
/// as true.
#[must_use]
pub fn check(net: &Net) -> Vec<Diagnostic> {
    let rules = rules::rules(net);
    let read = || sinks(net).chain(crate::init::lenient_claims::lenient_claims(net));
    if !rules.contains(&TransferRule::Delay)
        || !crate::init::precheck::may_read_uninitialised(net, &rules, read())
    {
        return Vec::new();
    }
    let given: Vec<PortRef> = asserted_conditions(net)
        .chain(assumed_claims(net))
        .collect();
    let solution = Solution::new(net, rules.clone(), &given);
    let roots = uninitialised_delays(&solution, &rules, &given);
    let in_claims = crate::init::lenient_claims::diagnostics(net, &rules, &roots, &given);
    let mut diagnostics: Vec<Diagnostic> = Vec::new();
    let mut by_flow: Vec<(Option<&str>, Vec<NodeId>)> = Vec::new();
    let mut places: FastMap<&str, usize> = FastMap::default();
    let users = Readers::new(net);
    let mut at_once: FastSet<NodeId> = FastSet::default();
    for root in roots {
        let node = enclosing_equation(net, &users, root).filter(|_| !is_current_delay(net, root));
        if is_uninitialised_at_start(&solution, node.unwrap_or(root)) {
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
    for (flow, roots) in merge_parts(net, by_flow) {
        let is_first = roots.iter().any(|root| at_once.contains(root));
        diagnostics.push(uninitialised_error(net, flow.as_deref(), &roots, is_first));
    }
    diagnostics.extend(in_claims);
    diagnostics
}

/// Merges groups of uninitialised delays that belong to parts of one value and have the same locations, so that one
/// diagnostic reports the whole value. Each group has the name of its flow and its delays.
fn merge_parts(
    net: &Net,
    by_flow: Vec<(Option<&str>, Vec<NodeId>)>,
) -> Vec<(Option<String>, Vec<NodeId>)> {
    let mut all: Vec<(Option<String>, Vec<NodeId>)> = Vec::new();
    let mut known: FastMap<(String, Vec<Span>), usize> = FastMap::default();
    for (flow, roots) in by_flow {
        let flow = flow.map(strip_unnamed_calls);
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
            (Some(name), Some(flow)) => name.truncate(common_prefix_len(name, flow)),
            _ => all.push((flow, roots)),
        }
    }
    all
}

/// Returns the length in bytes of the common prefix of the names of two parts, such as `p` for `p.x` and `p.y`. A
/// component of a name is not cut.
fn common_prefix_len(a: &str, b: &str) -> usize {
    let starts = a.match_indices(['[', '.']).map(|(at, _)| at);
    let starts = starts.chain([a.len()]);
    let mut both = starts.filter(|at| b.get(..*at) == Some(&a[..*at]));
    both.next_back().unwrap_or(a.len())
}

/// Returns the summary of the analysis of initialisation for a net without errors.
#[must_use]
pub fn summary(net: &Net) -> String {
    let delays = net
        .nodes
        .iter()
        .filter(|node| node.desc().role == Role::Delay);
    let claims = net
        .claims
        .iter()
        .filter(|claim| claim.kind.is_assumed())
        .count();
    format!(
        "{} delays, none read before it is initialised; {claims} claims taken as true",
        delays.count()
    )
}

/// Returns the ports with the conditions of claims that are taken as true without proof.
fn assumed_claims(net: &Net) -> impl Iterator<Item = PortRef> + '_ {
    let given = net.claims.iter().filter(|claim| claim.kind.is_assumed());
    let keys: FastSet<&str> = given.map(|claim| claim.key.as_str()).collect();
    let exports = net.exports.iter();
    let claimed = exports.filter(move |export| keys.contains(export.key.as_str()));
    claimed.map(|export| export.source)
}

/// Maximum number of rounds of the search for uninitialised delays that are hidden behind other ones.
const MAX_ROUNDS: usize = 20;

/// Maximum number of nodes visited in all rounds of the search for hidden uninitialised delays together.
const MAX_NODES: usize = 400_000;

/// Returns the delays that are read before they are initialised, including those that are read only through other such
/// delays. `claims` are conditions that are taken as true.
fn uninitialised_delays(
    solution: &Solution<'_>,
    rules: &[TransferRule],
    claims: &[PortRef],
) -> Vec<NodeId> {
    let net = solution.net();
    let mut rules = rules.to_vec();
    let mut roots = Vec::new();
    let mut more = read_early(solution);
    // In a large net, delays hidden by others are reported only after those have been fixed.
    let rounds = (MAX_NODES / net.nodes.len().max(1)).clamp(1, MAX_ROUNDS);
    for _ in 1..rounds {
        if more.is_empty() {
            break;
        }
        for delay in &more {
            rules[delay.index()] = TransferRule::OptionalDelay;
        }
        roots.append(&mut more);
        more = read_early(&Solution::new(net, rules.clone(), claims));
    }
    roots.append(&mut more);
    roots.sort_unstable();
    roots
}

/// Returns whether the output of a node is uninitialised in the first cycle of its fragment.
fn is_uninitialised_at_start(solution: &Solution<'_>, node: NodeId) -> bool {
    let fragment = solution.net().node(node).fragment;
    let port = PortRef { node, port: 0 };
    uninitialised_root(&solution.value_for(port, fragment, 0).value).is_some()
}

/// Returns whether a primitive ends the command if its condition is false.
fn is_check(prim: PrimId) -> bool {
    [
        prim!("Rpi::Assert"),
        prim!("Rpi::AssertIndex"),
        prim!("Rpi::Assume"),
    ]
    .contains(&prim)
}

/// Returns the ports with conditions whose failure ends the command.
fn asserted_conditions(net: &Net) -> impl Iterator<Item = PortRef> + '_ {
    let checks = net.nodes.iter();
    let checks = checks.filter(|node| is_check(node.prim));
    checks.filter_map(|node| node.inputs.first().and_then(Input::port))
}

/// Returns the uninitialised delays that outputs and activations of the net depend on, in the order of the net.
fn read_early(solution: &Solution<'_>) -> Vec<NodeId> {
    let net = solution.net();
    let mut roots = Vec::new();
    for (port, from) in sinks(net) {
        for phase in 0..PHASES {
            roots.extend(uninitialised_root(
                &solution.value_for(port, from, phase).value,
            ));
        }
    }
    roots.sort_unstable();
    roots.dedup();
    roots
}

fn uninitialised_root(known: &AbstractValue) -> Option<NodeId> {
    match known {
        AbstractValue::Undefined { root, .. } => Some(*root),
        _ => None,
    }
}

/// Returns the ports that must have a value in every cycle: those that outputs, activations and primitives with state
/// read. Each is returned with the fragment in which it is read.
fn sinks(net: &Net) -> impl Iterator<Item = (PortRef, FragmentId)> + '_ {
    let own = |port: PortRef| (port, net.node(port.node).fragment);
    let strict = net.claims.iter().filter(|claim| claim.is_strict);
    let strict: FastSet<&str> = strict.map(|claim| claim.key.as_str()).collect();
    // Flows exported for a claim are only observed. The condition of a strict claim must have a value.
    let counts = move |key: &str| !is_claim_key(key) || strict.contains(key);
    let exports = net.exports.iter().filter(move |export| counts(&export.key));
    let exports = exports.map(move |export| own(export.source));
    let results = match &net.termination {
        Termination::Results(results) => &results[..],
        Termination::Ports { .. } => &[],
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
    // A primitive with state may store an uninitialised value and output it later.
    let remembers = |n: &&Node| {
        let state = n.desc().state;
        n.desc().role == Role::Compute && !matches!(state, StateSize::None)
    };
    let remembering = net.nodes.iter().filter(remembers);
    let remembering = remembering.flat_map(|node| {
        let ports = node.inputs.iter().filter_map(Input::port);
        ports.map(move |port| (port, node.fragment))
    });
    let sinks = exports.chain(results).chain(activations).chain(leaving);
    sinks.chain(remembering)
}

/// Returns the error for the uninitialised delays `roots` in the equation of `flow`. `is_first` is whether the flow has
/// no value in the very first cycle.
fn uninitialised_error(
    net: &Net,
    flow: Option<&str>,
    roots: &[NodeId],
    is_first: bool,
) -> Diagnostic {
    let place = |root: &NodeId| net.node(*root).origin.span;
    if let [one] = roots
        && is_current_delay(net, *one)
    {
        return Diagnostic::new(Code::RPI5002, "`current` is read before it is initialised")
            .primary(
                place(one),
                "no value until its clock ticks, which may be later than the first cycle",
            )
            .help("use a clock that is true in the first cycle, `when on` with `on = true -> ...;`, or a value for the other cycles, `if ... then ... else ...` instead of `current`");
    }
    let what = flow.map_or_else(|| "this expression".to_owned(), |flow| format!("`{flow}`"));
    let message = match is_first {
        true => format!("{what} has no value in the first cycle"),
        false => format!("{what} has no value in one of the first cycles"),
    };
    let mut diagnostic = Diagnostic::new(Code::RPI5001, message);
    for root in roots {
        diagnostic = diagnostic.primary(place(root), "no previous value in the first cycle");
    }
    let mut places = roots.iter().map(place);
    if places.any(|place| net.outer_delays.contains(&place)) {
        // `->` inside would restart together with the fragment or state.
        let delays = roots.first().map(|root| Quote::text(place(root)));
        let delay = delays.map(|delay| delay.to_string()).unwrap_or_default();
        return diagnostic.help(format!("initialise it outside of the fragment or state by an equation of its own, `before = ... -> {delay};`, and read `before` here"));
    }
    if let ([one], None) = (roots, flow)
        && let Some(condition) = claim_condition(net, place(one))
    {
        return diagnostic
            .help(format!(
                "begin the condition by `true ->`, so that it holds in the first cycle, or give a first value: `(... -> {})`",
                Quote::text(place(one))
            ))
            .fix(Fix::maybe("let it hold in the first cycle").insert_before(condition, "true -> "));
    }
    diagnostic
        .help("write the value for the first cycle before `->`")
        .fix(first_value_fix(net, roots))
}

/// Returns the fix that writes a first value before each delay.
fn first_value_fix(net: &Net, roots: &[NodeId]) -> Fix {
    let mut fix = Fix::maybe("give it a first value");
    for root in roots {
        let (first, place) = (initial_value_text(net, *root), net.node(*root).origin.span);
        // A delay that is the whole equation needs no parentheses.
        fix = match net.node(*root).origin.flow {
            Some(_) => fix.insert_before(place, first),
            None => {
                let fix = fix.insert_before(place, format!("({first}"));
                fix.insert_after(place, ")")
            }
        };
    }
    fix
}

/// Returns the location of the condition of the claim that contains `place`.
fn claim_condition(net: &Net, place: Span) -> Option<Span> {
    let around = net.claims.iter().filter(|claim| claim.span.contains(place));
    let conditions = around.filter_map(|claim| {
        let export = net.exports.iter().find(|export| export.key == claim.key)?;
        let span = net.node(export.source.node).origin.span;
        (claim.span.contains(span) && span.contains(place)).then_some(span)
    });
    conditions.into_iter().next()
}

/// Returns the node with the flow whose equation contains the delay `root`: the nearest node with the name of a flow
/// that depends on it. `None` if there is none.
fn enclosing_equation(net: &Net, users: &Readers, root: NodeId) -> Option<NodeId> {
    let mut seen = vec![root];
    let mut next = 0;
    while let Some(id) = seen.get(next).copied() {
        if net.node(id).origin.flow.is_some() {
            return Some(id);
        }
        for user in users.readers_of(id) {
            if !seen.contains(user) {
                seen.push(*user);
            }
        }
        next += 1;
    }
    None
}

/// Returns whether a delay belongs to a `current`, which holds the value of a sampled flow: its input is that flow when
/// the clock ticks, else the delay's own output.
fn is_current_delay(net: &Net, delay: NodeId) -> bool {
    let input = net.node(delay).inputs.first().and_then(Input::port);
    input.is_some_and(|port| {
        let source = net.node(port.node);
        let same_place = source.origin.span == net.node(delay).origin.span;
        let otherwise = source.inputs.get(2).and_then(Input::port);
        same_place
            && rule(source) == TransferRule::Conditional
            && otherwise.is_some_and(|port| port.node == delay)
    })
}

/// Returns the source text of an initial value for a delay, followed by `->`.
fn initial_value_text(net: &Net, root: NodeId) -> &'static str {
    use rpi_image::{Scalar, Type};
    match net.node(root).outputs.first() {
        Some(Type::Scalar(Scalar::Bool)) => "false -> ",
        Some(Type::Scalar(Scalar::Int)) => "0 -> ",
        _ => "0.0 -> ",
    }
}
