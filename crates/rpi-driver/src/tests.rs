//! The tests of a program: what is run for each, and what is watched meanwhile.

use std::collections::{BTreeMap, BTreeSet};

use rpi_diag::Span;
use rpi_net::{FragmentId, Input, Net};

/// A test, ready to be run.
#[derive(Clone, Debug)]
pub struct Test {
    /// What it shows, in words.
    pub title: String,
    /// Where its title stands.
    pub span: Span,
    /// What is run.
    pub net: Net,
    /// The choices that may go either way.
    pub branches: Vec<Branch>,
    /// Where the fragments of the net stand in the text, by their paths.
    pub fragments: BTreeMap<String, Span>,
}

/// An `if` whose condition is not known before the test runs.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub struct Branch {
    /// Where it stands.
    pub span: Span,
    /// `path.port` of its condition.
    pub condition: String,
}

/// The choices of a net, each once: a choice between composite values is one primitive per leaf.
pub(crate) fn branches(net: &Net) -> Vec<Branch> {
    let conditionals = net.nodes.iter().filter(|node| {
        let choice = node.desc().name.ends_with("Conditional");
        choice && !node.origin.span.is_none()
    });
    let branches: BTreeSet<Branch> = conditionals
        .filter_map(|node| {
            let &Input::Port(port) = node.inputs.first()? else {
                return None;
            };
            let source = net.node(port.node);
            let name = source.desc().outputs.get(usize::from(port.port))?.name;
            Some(Branch {
                span: node.origin.span,
                condition: format!("{}.{name}", net.path(source.fragment, &source.name)),
            })
        })
        .collect();
    branches.into_iter().collect()
}

/// Where the fragments of a net stand in the text, by their paths.
pub(crate) fn fragments(net: &Net) -> BTreeMap<String, Span> {
    let inner = net.fragment_ids().skip(1);
    let place = |id| {
        let fragment = net.fragment(id);
        let parent = fragment.parent.unwrap_or(FragmentId::ROOT);
        (net.path(parent, &fragment.name), fragment.origin.span)
    };
    inner.map(place).collect()
}
