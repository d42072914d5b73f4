//! Tree of the fragments of a net: parents, children and the nodes directly inside each fragment.
//!
//! The tree is built once per net for all passes. It does not depend on what the nodes compute.

use crate::net::{FragmentId, Net, NodeId};

/// Element of a fragment's content: a node, or a fragment inside it.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum Item {
    /// Node that is directly in the fragment.
    Node(NodeId),
    /// Child fragment with everything in it.
    Fragment(FragmentId),
}

/// Tree of the fragments of one net. All vectors are indexed by fragment.
#[derive(Clone, Debug)]
pub struct FragmentTree {
    parent: Vec<Option<FragmentId>>,
    depth: Vec<u32>,
    children: Vec<Vec<FragmentId>>,
    nodes: Vec<Vec<NodeId>>,
    /// Lowest node index in each fragment and the fragments inside it; `u32::MAX` if there are no nodes.
    first_node: Vec<u32>,
}

impl FragmentTree {
    /// Builds the fragment tree of a net. In `net.fragments`, each fragment must come after its parent.
    #[must_use]
    pub fn new(net: &Net) -> Self {
        let count = net.fragments.len();
        let mut tree = FragmentTree {
            parent: net.fragments.iter().map(|f| f.parent).collect(),
            depth: vec![0; count],
            children: vec![Vec::new(); count],
            nodes: vec![Vec::new(); count],
            first_node: vec![u32::MAX; count],
        };
        for id in net.fragment_ids() {
            if let Some(parent) = net.fragment(id).parent {
                tree.depth[id.index()] = tree.depth[parent.index()] + 1;
                tree.children[parent.index()].push(id);
            }
        }
        for id in net.node_ids() {
            tree.nodes[net.node(id).fragment.index()].push(id);
        }
        tree.find_first_nodes();
        tree
    }

    fn find_first_nodes(&mut self) {
        for at in (0..self.parent.len()).rev() {
            let own = self.nodes[at].first().map_or(u32::MAX, |n| n.0);
            self.first_node[at] = self.first_node[at].min(own);
            if let Some(parent) = self.parent[at] {
                let inner = self.first_node[at];
                let outer = &mut self.first_node[parent.index()];
                *outer = inner.min(*outer);
            }
        }
    }

    /// Returns the nodes directly in a fragment, in declaration order.
    #[must_use]
    pub fn nodes(&self, fragment: FragmentId) -> &[NodeId] {
        &self.nodes[fragment.index()]
    }

    /// Returns the fragments directly in a fragment, in declaration order.
    #[must_use]
    pub fn children(&self, fragment: FragmentId) -> &[FragmentId] {
        &self.children[fragment.index()]
    }

    /// Returns the nodes and child fragments directly in a fragment, in declaration order. The position of a child
    /// fragment is that of its first node.
    #[must_use]
    pub fn items(&self, fragment: FragmentId) -> Vec<Item> {
        let nodes = self.nodes(fragment).iter();
        let nodes = nodes.map(|n| (n.0, Item::Node(*n)));
        let children = self.children(fragment).iter();
        let children = children.map(|f| (self.first_node[f.index()], Item::Fragment(*f)));
        let mut items: Vec<(u32, Item)> = nodes.chain(children).collect();
        // The input is two sorted runs, which a stable sort merges in linear time.
        items.sort();
        items.into_iter().map(|(_, item)| item).collect()
    }

    /// Returns the nodes and child fragments directly in a fragment, and those in its children that only group the
    /// operations of one clock, at any depth. The order is that of the declarations.
    #[must_use]
    pub fn items_through_clocks(&self, net: &Net, fragment: FragmentId) -> Vec<Item> {
        let is_clock = |f: &FragmentId| net.fragment(*f).is_clock;
        let mut open: Vec<FragmentId> = self.children(fragment).to_vec();
        open.retain(is_clock);
        if open.is_empty() {
            return self.items(fragment);
        }
        open.push(fragment);
        let mut items: Vec<(u32, Item)> = Vec::new();
        while let Some(around) = open.pop() {
            let nodes = self.nodes(around).iter();
            items.extend(nodes.map(|n| (n.0, Item::Node(*n))));
            let children = self.children(around).iter();
            items.extend(children.map(|f| (self.first_node[f.index()], Item::Fragment(*f))));
            if around != fragment {
                let inner = self.children(around).iter().copied();
                open.extend(inner.filter(is_clock));
            }
        }
        items.sort_unstable();
        items.into_iter().map(|(_, item)| item).collect()
    }

    /// Returns the enclosing fragment; `None` for the root.
    #[must_use]
    pub fn parent(&self, fragment: FragmentId) -> Option<FragmentId> {
        self.parent[fragment.index()]
    }

    /// Returns the number of fragments around a fragment; 0 for the root.
    #[must_use]
    pub fn depth(&self, fragment: FragmentId) -> u32 {
        self.depth[fragment.index()]
    }

    /// Returns the innermost fragment that is or encloses both fragments (lowest common ancestor).
    #[must_use]
    pub fn common_ancestor(&self, a: FragmentId, b: FragmentId) -> FragmentId {
        let (mut a, mut b) = (a, b);
        while a != b {
            let deeper = if self.depth(a) >= self.depth(b) {
                &mut a
            } else {
                &mut b
            };
            match self.parent(*deeper) {
                Some(up) => *deeper = up,
                None => break,
            }
        }
        a
    }

    /// Returns the fragments from `inner` outwards, up to but not including `outer`, which is or encloses `inner`.
    pub fn between(
        &self,
        inner: FragmentId,
        outer: FragmentId,
    ) -> impl Iterator<Item = FragmentId> + '_ {
        std::iter::successors(Some(inner), |f| self.parent(*f)).take_while(move |f| *f != outer)
    }

    /// Returns the direct child of `outer` that is or encloses `inner`; `None` if `inner` is `outer`.
    #[must_use]
    pub fn child_towards(&self, outer: FragmentId, inner: FragmentId) -> Option<FragmentId> {
        self.between(inner, outer).last()
    }
}
