//! Upper bound on the work of one cycle (M13): the sum over all primitives. Of mutually exclusive fragments, only the
//! largest counts.

use super::fact_prover::{EffortBudget, Event, ProofContext, Prover};
use crate::fragment_tree::FragmentTree;
use crate::net::{FragmentId, Input, Net, Node};
use rpi_diag::{Code, Diagnostic};
use rpi_image::{Type, Value};

/// Maximal number of sibling fragments that are compared with each other; beyond it, the work of all siblings is added
/// up.
const MAX_COMPARED: usize = 64;

/// Upper bounds of the work of a cycle, in elementary operations (one real addition is 1).
#[derive(Clone, PartialEq, Eq, Default, Debug)]
pub struct WorkBounds {
    /// For each fragment, the bound of its own primitives and all child fragments.
    bounds: Vec<u64>,
}

impl WorkBounds {
    /// Computes the bounds of a net.
    pub(crate) fn new(background: ProofContext<'_>) -> Self {
        let (net, tree) = (background.net, background.tree);
        let effort = EffortBudget::default();
        let mut prover = Prover::new(background, &effort);
        let mut of = vec![0_u64; net.fragments.len()];
        for id in net.fragment_ids().rev() {
            let own: u64 = tree
                .nodes(id)
                .iter()
                .map(|n| work_of(net, net.node(*n)))
                .sum();
            of[id.index()] = own.saturating_add(children(&mut prover, tree, id, &of));
        }
        WorkBounds { bounds: of }
    }

    /// Bound of a fragment; that of the root is the bound of the whole net.
    #[must_use]
    pub fn bound(&self, fragment: FragmentId) -> u64 {
        self.bounds.get(fragment.index()).copied().unwrap_or(0)
    }
}

/// Work bound of a primitive: its declared work, scaled by the largest array or matrix that it reads or writes.
fn work_of(net: &Net, node: &Node) -> u64 {
    let inputs = node.inputs.iter().filter_map(|input| type_of(net, input));
    let params = node.params.iter().filter_map(Value::ty);
    let types = inputs.chain(params).chain(node.outputs.iter().copied());
    let factor = types.map(Type::work_factor).max().unwrap_or(1);
    u64::from(node.desc().work).saturating_mul(factor)
}

fn type_of(net: &Net, input: &Input) -> Option<Type> {
    match input {
        Input::Unconnected => None,
        Input::Const(value) => value.ty(),
        Input::Port(port) => {
            let node = net.nodes.get(port.node.index())?;
            node.outputs.get(usize::from(port.port)).copied()
        }
    }
}

/// Work bound of the children of a fragment. Of mutually exclusive children, only the largest counts.
fn children(prover: &mut Prover<'_>, tree: &FragmentTree, id: FragmentId, of: &[u64]) -> u64 {
    // In descending order, so that the first member of a group has its largest bound.
    let mut sorted = tree.children(id).to_vec();
    sorted.sort_by_key(|f| (std::cmp::Reverse(of[f.index()]), *f));
    if sorted.len() > MAX_COMPARED {
        return sorted.iter().map(|f| of[f.index()]).sum();
    }
    let mut groups: Vec<Vec<FragmentId>> = Vec::new();
    for child in sorted {
        let is_exclusive =
            |group: &&mut Vec<FragmentId>| group.iter().all(|f| are_exclusive(prover, *f, child));
        match groups.iter_mut().find(is_exclusive) {
            Some(group) => group.push(child),
            None => groups.push(vec![child]),
        }
    }
    groups.iter().map(|group| of[group[0].index()]).sum()
}

fn are_exclusive(prover: &mut Prover<'_>, a: FragmentId, b: FragmentId) -> bool {
    let active = |fragment| Event {
        fragment,
        present: Vec::new(),
    };
    prover.is_refuted(&active(a), &active(b), 0)
}

/// Target machine for which a program is checked.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct MachineProfile {
    /// Worst-case time of an elementary operation in nanoseconds.
    pub ns_per_operation: f64,
    /// Period of a cycle in nanoseconds.
    pub period_ns: u64,
}

impl Default for MachineProfile {
    /// Profile of a slow machine: ten years old, with cold caches in every cycle, and a period of 1 ms.
    fn default() -> MachineProfile {
        MachineProfile {
            ns_per_operation: 10.0,
            period_ns: 1_000_000,
        }
    }
}

impl MachineProfile {
    /// Worst-case time of a number of operations in nanoseconds.
    #[must_use]
    pub fn time_of(&self, operations: u64) -> f64 {
        operations as f64 * self.ns_per_operation
    }
}

/// Compares the work bounds with the declared budgets of a program and with the period. Returns a diagnostic for each
/// excess.
#[must_use]
pub fn over_budget(net: &Net, work: &WorkBounds, machine: MachineProfile) -> Vec<Diagnostic> {
    let fragments = net.fragment_ids();
    let mut diagnostics: Vec<Diagnostic> = fragments
        .filter_map(|id| over_fragment_budget(net, work, machine, id))
        .collect();
    diagnostics.extend(over_period(net, work, machine));
    diagnostics
}

fn over_fragment_budget(
    net: &Net,
    work: &WorkBounds,
    machine: MachineProfile,
    id: FragmentId,
) -> Option<Diagnostic> {
    let fragment = net.fragment(id);
    let (budget, bound) = (fragment.budget_ns?, work.bound(id));
    let needed = machine.time_of(bound);
    if needed <= budget as f64 {
        return None;
    }
    let name = match fragment.name.as_str() {
        "" => &net.name,
        name => name,
    };
    let (needed, budget) = (time(needed), time(budget as f64));
    let message = format!("`{name}` may need {needed}, but its budget is {budget}");
    let label = format!(
        "{bound} operations at worst, {} ns each",
        machine.ns_per_operation
    );
    Some(
        Diagnostic::new(Code::RPI7001, message)
            .primary(fragment.origin.span, label)
            .help("declare a larger budget, or do less in one cycle"),
    )
}

/// Checks that a command meets its period.
fn over_period(net: &Net, work: &WorkBounds, machine: MachineProfile) -> Option<Diagnostic> {
    let root = net.fragment(FragmentId::ROOT);
    let bound = work.bound(FragmentId::ROOT);
    let (needed, period) = (machine.time_of(bound), machine.period_ns as f64);
    let (what, took) = match root.budget_ns {
        Some(budget) if budget as f64 > period => ("declares a budget of", budget as f64),
        _ if needed > period => ("may need", needed),
        _ => return None,
    };
    let name = &net.name;
    let message = format!(
        "`{name}` {what} {} in a cycle of {}",
        time(took),
        time(period)
    );
    let label = format!(
        "{bound} operations at worst, {} ns each",
        machine.ns_per_operation
    );
    Some(
        Diagnostic::new(Code::RPI7002, message)
            .primary(root.origin.span, label)
            .help("do less in one cycle, or run it with a longer period"),
    )
}

/// Formats a time in a suitable unit.
fn time(ns: f64) -> String {
    match ns {
        0.0..1e3 => format!("{ns:.0} ns"),
        1e3..1e6 => format!("{:.1} us", ns / 1e3),
        _ => format!("{:.2} ms", ns / 1e6),
    }
}
