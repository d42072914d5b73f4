//! Size of a net, counted in its text or in the net itself.

use super::parsed_text::{Argument, ArgumentValue, DefinitionKind, ParsedText};
use crate::net::{Activation, FragmentId, Net};
use std::collections::BTreeSet;

/// Numbers of elements of a net, for comparisons of nets.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct NetSize {
    /// Number of nodes (uses of primitives) in all fragments.
    pub primitives: usize,
    /// Number of fragments besides the root.
    pub fragments: usize,
    /// Number of fragments that are not always active.
    pub gated: usize,
    /// Maximum nesting depth of fragments; 0 if there is only the root.
    pub depth: usize,
    /// Number of in-ports of primitives and fragments that are connected to an out-port.
    pub links: usize,
    /// Number of different primitives that are used.
    pub types: usize,
    /// Length of the text in bytes; 0 for a net without text.
    pub bytes: usize,
}

impl NetSize {
    /// Counts the elements of a net as it will run. A repeated definition counts once. A link counts once, at the
    /// in-port of the primitive where it ends, whatever borders it crosses.
    #[must_use]
    pub fn from_net(net: &Net) -> NetSize {
        let linked = |n: &crate::net::Node| n.inputs.iter().filter(|i| i.port().is_some()).count();
        let gated = |f: &&crate::net::Fragment| !matches!(f.activation, Activation::Always);
        let depth = |id: FragmentId| net.ancestors(id).count() - 1;
        NetSize {
            primitives: net.nodes.len(),
            fragments: net.fragments.len() - 1,
            gated: net.fragments.iter().filter(gated).count(),
            depth: net.fragment_ids().map(depth).max().unwrap_or(0),
            links: net.nodes.iter().map(linked).sum(),
            types: net
                .nodes
                .iter()
                .map(|n| n.prim)
                .collect::<BTreeSet<_>>()
                .len(),
            bytes: 0,
        }
    }

    /// Counts the elements of a text as the reference system does. A repeated definition counts twice, and each
    /// argument that is a link counts.
    pub(super) fn from_text(text: &ParsedText<'_>) -> NetSize {
        let mut size = NetSize {
            fragments: text.fragments.len() - 1,
            depth: depth(text),
            bytes: text.text.trim_end().len(),
            ..NetSize::default()
        };
        let mut types = BTreeSet::new();
        for definition in &text.definitions {
            let arguments = text.arguments(definition);
            let links = arguments
                .iter()
                .filter(|a| matches!(a.value, ArgumentValue::Link(_)));
            size.links += links.count();
            match definition.kind {
                DefinitionKind::Primitive(ty) => {
                    size.primitives += 1;
                    types.insert(text.str(ty));
                }
                DefinitionKind::Fragment(_) => {
                    size.gated += usize::from(has_activation(text, arguments));
                }
            }
        }
        size.types = types.len();
        size
    }
}

/// Returns whether the arguments of a fragment contain the in-port that activates it.
fn has_activation(text: &ParsedText<'_>, arguments: &[Argument]) -> bool {
    let mut names = arguments.iter().map(|a| text.str(a.name));
    names.any(|name| name == super::build::ACTIVATION)
}

fn depth(text: &ParsedText<'_>) -> usize {
    let mut depths = vec![0_usize; text.fragments.len()];
    for (k, body) in text.fragments.iter().enumerate() {
        if let Some(id) = body.definition {
            depths[k] = depths[text.definition(id).scope as usize] + 1;
        }
    }
    depths.into_iter().max().unwrap_or(0)
}
