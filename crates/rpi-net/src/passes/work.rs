//! A bound on the work of one cycle (M13): the sum over all primitives, of fragments that exclude each other the largest.

use super::proof::{Background, Effort, Happening, Prover};
use crate::net::{FragmentId, Net};
use crate::tree::Tree;
use rpi_diag::{Code, Finding};

/// Fragments side by side that are compared with each other; of more, all work is added up.
const COMPARED: usize = 64;

/// Bounds in elementary operations (a real addition is 1).
#[derive(Clone, PartialEq, Eq, Default, Debug)]
pub struct Work {
    /// For each fragment its own primitives with all fragments in it.
    of: Vec<u64>,
}

impl Work {
    /// Sums up a net.
    pub(crate) fn new(background: Background<'_>) -> Self {
        let (net, tree) = (background.net, background.tree);
        let effort = Effort::default();
        let mut prover = Prover::new(background, &effort);
        let mut of = vec![0_u64; net.fragments.len()];
        for id in net.fragment_ids().rev() {
            let own: u64 = tree
                .nodes(id)
                .iter()
                .map(|n| u64::from(net.node(*n).desc().work))
                .sum();
            of[id.index()] = own + children(&mut prover, tree, id, &of);
        }
        Work { of }
    }

    /// The bound for a fragment; for the root that of the whole net.
    #[must_use]
    pub fn of(&self, fragment: FragmentId) -> u64 {
        self.of.get(fragment.index()).copied().unwrap_or(0)
    }
}

/// The bound for the children of a fragment: groups of which only one is active, each with its largest.
fn children(prover: &mut Prover<'_>, tree: &Tree, id: FragmentId, of: &[u64]) -> u64 {
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

/// Compares bounds with the budgets that a program states. `ns_per_operation` is that of a measured machine.
#[must_use]
pub fn over_budget(net: &Net, work: &Work, ns_per_operation: f64) -> Vec<Finding> {
    let over = net.fragment_ids().filter_map(|id| {
        let fragment = net.fragment(id);
        let (budget, bound) = (fragment.budget_ns?, work.of(id));
        let needed = bound as f64 * ns_per_operation;
        let name = if fragment.name.is_empty() {
            &net.name
        } else {
            &fragment.name
        };
        (needed > budget as f64).then(|| {
            let message = format!(
                "`{name}` may need {:.1} us of its budget of {:.1} us",
                needed / 1e3,
                budget as f64 / 1e3
            );
            Finding::new(Code::RPI7001, message)
                .at(fragment.origin.span, format!("{bound} operations at most"))
                .help("state a larger budget, or do less in one cycle")
        })
    });
    over.collect()
}
