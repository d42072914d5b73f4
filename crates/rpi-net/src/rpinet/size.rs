//! How large a net is, counted in its text and in the net that was read from it.

use super::text::{Given, Kind, Text};
use crate::net::{Activation, FragmentId, Net};
use std::collections::BTreeSet;

/// Counts of a net.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct Size {
    /// Primitives.
    pub primitives: usize,
    /// Fragments besides the root.
    pub fragments: usize,
    /// Of these, those that are not always active.
    pub gated: usize,
    /// Fragments within each other besides the root.
    pub depth: usize,
    /// Connected in-ports of primitives and fragments.
    pub links: usize,
    /// Different types of primitives.
    pub types: usize,
    /// Length of the text; 0 for a net that has none.
    pub bytes: usize,
}

impl Size {
    /// Counts a net as it will run: what its text repeats counts once, and a link counts where it ends, at a primitive,
    /// whatever borders it crosses.
    #[must_use]
    pub fn of(net: &Net) -> Size {
        let linked = |n: &crate::net::Node| n.inputs.iter().filter(|i| i.port().is_some()).count();
        let gated = |f: &&crate::net::Fragment| !matches!(f.activation, Activation::Always);
        let depth = |id: FragmentId| net.enclosing(id).count() - 1;
        Size {
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

    /// Counts a text as it stands, as the reference counts: a definition that stands twice counts twice, and every
    /// argument that is a link counts.
    pub(super) fn of_text(text: &Text<'_>) -> Size {
        let mut size = Size {
            fragments: text.fragments.len() - 1,
            depth: depth(text),
            bytes: text.text.trim_end().len(),
            ..Size::default()
        };
        let mut types = BTreeSet::new();
        for definition in &text.definitions {
            let arguments = text.arguments(definition);
            let links = arguments
                .iter()
                .filter(|a| matches!(a.value, Given::Link(_)));
            size.links += links.count();
            match definition.kind {
                Kind::Primitive(ty) => {
                    size.primitives += 1;
                    types.insert(text.str(ty));
                }
                Kind::Fragment(_) => {
                    let gated = arguments
                        .iter()
                        .any(|a| text.str(a.name) == super::build::ACTIVATION);
                    size.gated += usize::from(gated);
                }
            }
        }
        size.types = types.len();
        size
    }
}

fn depth(text: &Text<'_>) -> usize {
    let mut depths = vec![0_usize; text.fragments.len()];
    for (k, body) in text.fragments.iter().enumerate() {
        if let Some(id) = body.definition {
            depths[k] = depths[text.definition(id).scope as usize] + 1;
        }
    }
    depths.into_iter().max().unwrap_or(0)
}
