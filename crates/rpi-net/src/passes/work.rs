//! Upper bound on the work of one cycle (M13): the sum over all primitives. Of mutually exclusive fragments, only the
//! largest counts.

use super::proof::{Background, Effort, Happening, Prover};
use crate::net::{FragmentId, Input, Net, Node};
use crate::tree::Tree;
use rpi_diag::{Code, Finding};
use rpi_image::{Type, Value};

/// Maximal number of sibling fragments that are compared with each other; beyond it, the work of all siblings is added
/// up.
const COMPARED: usize = 64;

/// Bounds in elementary operations (one real addition is 1).
#[derive(Clone, PartialEq, Eq, Default, Debug)]
pub struct Work {
    /// For each fragment, the bound of its own primitives and all child fragments.
    of: Vec<u64>,
}

impl Work {
    /// Computes the bounds of a net.
    pub(crate) fn new(background: Background<'_>) -> Self {
        let (net, tree) = (background.net, background.tree);
        let effort = Effort::default();
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
        Work { of }
    }

    /// Bound of a fragment; that of the root is the bound of the whole net.
    #[must_use]
    pub fn of(&self, fragment: FragmentId) -> u64 {
        self.of.get(fragment.index()).copied().unwrap_or(0)
    }
}

/// Bound of a primitive: its declared work, scaled by the largest array or matrix that it reads or writes.
fn work_of(net: &Net, node: &Node) -> u64 {
    let inputs = node.inputs.iter().filter_map(|input| type_of(net, input));
    let params = node.params.iter().filter_map(Value::ty);
    let types = inputs.chain(params).chain(node.outputs.iter().copied());
    let factor = types.map(Type::work_factor).max().unwrap_or(1);
    u64::from(node.desc().work).saturating_mul(factor)
}

fn type_of(net: &Net, input: &Input) -> Option<Type> {
    match input {
        Input::Open => None,
        Input::Const(value) => value.ty(),
        Input::Port(port) => {
            let node = net.nodes.get(port.node.index())?;
            node.outputs.get(usize::from(port.port)).copied()
        }
    }
}

/// Bound of the children of a fragment. In a group of mutually exclusive children, only the largest counts.
fn children(prover: &mut Prover<'_>, tree: &Tree, id: FragmentId, of: &[u64]) -> u64 {
    // In descending order, so that the first member of a group has its largest bound.
    let mut sorted = tree.children(id).to_vec();
    sorted.sort_by_key(|f| (std::cmp::Reverse(of[f.index()]), *f));
    if sorted.len() > COMPARED {
        return sorted.iter().map(|f| of[f.index()]).sum();
    }
    let mut groups: Vec<Vec<FragmentId>> = Vec::new();
    for child in sorted {
        let fits = |group: &&mut Vec<FragmentId>| group.iter().all(|f| exclude(prover, *f, child));
        match groups.iter_mut().find(fits) {
            Some(group) => group.push(child),
            None => groups.push(vec![child]),
        }
    }
    groups.iter().map(|group| of[group[0].index()]).sum()
}

fn exclude(prover: &mut Prover<'_>, a: FragmentId, b: FragmentId) -> bool {
    let active = |fragment| Happening {
        fragment,
        present: Vec::new(),
    };
    prover.is_refuted(&active(a), &active(b), 0)
}

/// Target machine for which a program is checked.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Machine {
    /// Worst-case time of an elementary operation in nanoseconds.
    pub ns_per_operation: f64,
    /// Period of a cycle in nanoseconds.
    pub period_ns: u64,
}

impl Default for Machine {
    /// Conservative estimate: a ten-year-old machine with cold caches in every cycle, and a period of 1 ms.
    fn default() -> Machine {
        Machine {
            ns_per_operation: 10.0,
            period_ns: 1_000_000,
        }
    }
}

impl Machine {
    /// Worst-case time of a number of operations in nanoseconds.
    #[must_use]
    pub fn time_of(&self, operations: u64) -> f64 {
        operations as f64 * self.ns_per_operation
    }
}

/// Compares the bounds with the declared budgets of a program and with the period. Returns a diagnostic for each
/// excess.
#[must_use]
pub fn over_budget(net: &Net, work: &Work, machine: Machine) -> Vec<Finding> {
    let fragments = net.fragment_ids();
    let mut findings: Vec<Finding> = fragments
        .filter_map(|id| of_fragment(net, work, machine, id))
        .collect();
    findings.extend(of_cycle(net, work, machine));
    findings
}

fn of_fragment(net: &Net, work: &Work, machine: Machine, id: FragmentId) -> Option<Finding> {
    let fragment = net.fragment(id);
    let (budget, bound) = (fragment.budget_ns?, work.of(id));
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
        Finding::new(Code::RPI7001, message)
            .at(fragment.origin.span, label)
            .help("declare a larger budget, or do less in one cycle"),
    )
}

/// Checks that a command meets its period.
fn of_cycle(net: &Net, work: &Work, machine: Machine) -> Option<Finding> {
    let root = net.fragment(FragmentId::ROOT);
    let bound = work.of(FragmentId::ROOT);
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
        Finding::new(Code::RPI7002, message)
            .at(root.origin.span, label)
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
