//! Upper bound on the work of one cycle (M13): the sum over all primitives. Of mutually exclusive fragments, only the
//! largest counts.

use super::fact_prover::{EffortBudget, Event, ProofContext, Prover};
use crate::fragment_tree::FragmentTree;
use crate::net::{FragmentId, Input, Net, Node};
use rpi_diag::{Code, Diagnostic, with_noun};
use rpi_image::{Type, Value};

/// Maximum number of sibling fragments that are tested for mutual exclusion. If there are more, the work of all is
/// added up.
const MAX_COMPARED: usize = 64;

/// Upper bounds of the work in a cycle, in elementary operations. One addition of reals is one operation.
#[derive(Clone, PartialEq, Eq, Default, Debug)]
pub struct WorkBounds {
    /// For each fragment, the bound for its own primitives and all child fragments together.
    bounds: Vec<u64>,
}

impl WorkBounds {
    /// Computes the bounds for all fragments of a net.
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

    /// Returns the work bound of a fragment. The bound of the root is that of the whole net.
    #[must_use]
    pub fn bound(&self, fragment: FragmentId) -> u64 {
        self.bounds.get(fragment.index()).copied().unwrap_or(0)
    }
}

/// Returns the work bound of a node: the declared work of its primitive, scaled by the largest array or matrix that it
/// reads or writes.
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

/// Returns the work bound of the children of the fragment `id`. Of mutually exclusive children, only the largest bound
/// counts. `of` are the bounds of the fragments computed so far.
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

/// Computer on which a program is to run, for checks of execution times.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct MachineProfile {
    /// Worst-case time of an elementary operation in nanoseconds.
    pub ns_per_operation: f64,
    /// Period of a cycle of the command in nanoseconds.
    pub period_ns: u64,
}

impl Default for MachineProfile {
    /// Returns the profile of a slow computer: 10 ns per operation, as on a ten year old machine with cold caches in
    /// every cycle, and a period of 1 ms.
    fn default() -> MachineProfile {
        MachineProfile {
            ns_per_operation: 10.0,
            period_ns: 1_000_000,
        }
    }
}

impl MachineProfile {
    /// Returns the worst-case time in nanoseconds for a number of elementary operations.
    #[must_use]
    pub fn time_of(&self, operations: u64) -> f64 {
        operations as f64 * self.ns_per_operation
    }
}

/// Returns a diagnostic for each fragment whose worst-case time exceeds its declared budget, and one if a cycle of the
/// command may exceed the period.
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
    let help = format!(
        "declare a larger budget, `budget {}`, or do less in one cycle",
        budget_literal(needed)
    );
    let (needed, budget) = (time(needed), time(budget as f64));
    let message = format!("`{name}` may need {needed}, but its budget is {budget}");
    let label = operations_label(bound, machine);
    Some(
        Diagnostic::new(Code::RPI7001, message)
            .primary(fragment.origin.span, label)
            .help(help),
    )
}

/// Returns a diagnostic if the work or the declared budget of a command exceeds the period of its cycles.
fn over_period(net: &Net, work: &WorkBounds, machine: MachineProfile) -> Option<Diagnostic> {
    let root = net.fragment(FragmentId::ROOT);
    let bound = work.bound(FragmentId::ROOT);
    let (needed, period) = (machine.time_of(bound), machine.period_ns as f64);
    let (what, took, label) = match root.budget_ns {
        Some(budget) if budget as f64 > period => (
            "declares a budget of",
            budget as f64,
            "its budget must not exceed the period of the run".to_owned(),
        ),
        _ if needed > period => ("may need", needed, operations_label(bound, machine)),
        _ => return None,
    };
    let name = &net.name;
    let message = format!(
        "`{name}` {what} {} in a cycle of {}",
        time(took),
        time(period)
    );
    let help = match took > needed {
        true => "declare a smaller budget, or run the command with a longer period",
        false => "do less in one cycle, or run the command with a longer period",
    };
    Some(
        Diagnostic::new(Code::RPI7002, message)
            .primary(root.origin.span, label)
            .help(help),
    )
}

/// Returns the text of a label that derives a worst-case execution time from the work bound of a fragment.
fn operations_label(bound: u64, machine: MachineProfile) -> String {
    let count = usize::try_from(bound).unwrap_or(usize::MAX);
    format!(
        "{} at worst, {} ns each",
        with_noun(count, "operation"),
        machine.ns_per_operation
    )
}

/// Formats a time as a literal of the language, rounded up to a whole number of its unit.
fn budget_literal(ns: f64) -> String {
    match ns {
        0.0..1e3 => format!("{:.0}[ns]", ns.ceil()),
        1e3..1e6 => format!("{:.0}[us]", (ns / 1e3).ceil()),
        _ => format!("{:.0}[ms]", (ns / 1e6).ceil()),
    }
}

/// Returns a time in nanoseconds as text, in ns, us or ms.
fn time(ns: f64) -> String {
    match ns {
        0.0..1e3 => format!("{ns:.0} ns"),
        1e3..1e6 => format!("{:.1} us", ns / 1e3),
        _ => format!("{:.2} ms", ns / 1e6),
    }
}
