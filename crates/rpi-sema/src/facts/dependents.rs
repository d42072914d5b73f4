//! Dependency lists for fixpoint iterations: from operands to expressions, from flows to their readers, from values to
//! their definitions. A change is propagated only to its readers.

use crate::typed::TypedKind;
use crate::typed::{BlockId, Equation, ExprId, FlowId, SharedFlow, Unit};

/// Source of the value of a flow: an equation, or the states of an automaton.
#[derive(Clone, Copy)]
pub(crate) enum Definition<'u> {
    /// The flow is defined by an equation, which is in this block.
    Equation(BlockId, &'u Equation),
    /// The flow is defined by several states of an automaton.
    Shared(&'u SharedFlow),
}

/// Dependencies of a unit from expressions and flows to the expressions and definitions that read them, for the
/// fixed-point iteration of analyses.
pub(crate) struct Dependents<'u> {
    pub(crate) definitions: Vec<Definition<'u>>,
    /// Block of each expression, indexed by expression.
    pub(crate) blocks: Vec<BlockId>,
    parents: AdjacencyLists,
    flow_readers: AdjacencyLists,
    /// Indices of definitions in two groups of lists: first for each expression, the definitions that have it as their
    /// value; then for each flow, the definitions of flows outside of an automaton to which it gives a value in a
    /// state.
    definitions_by_value: AdjacencyLists,
    exprs: usize,
}

impl<'u> Dependents<'u> {
    pub(crate) fn new(unit: &'u Unit) -> Self {
        let definitions = definitions(unit);
        let exprs = unit.exprs.len();
        let mut parents = Vec::new();
        let mut of_flows = Vec::new();
        for (id, expr) in (0u32..).zip(&unit.exprs) {
            expr.kind
                .operands(&mut |operand| parents.push((operand.0, id)));
            if let TypedKind::Flow(flow) = expr.kind {
                of_flows.push((flow.0, id));
            }
        }
        Dependents {
            blocks: blocks(unit),
            parents: AdjacencyLists::new(exprs, &parents),
            flow_readers: AdjacencyLists::new(unit.flows.len(), &of_flows),
            definitions_by_value: AdjacencyLists::new(
                exprs + unit.flows.len(),
                &definition_pairs(&definitions, exprs),
            ),
            definitions,
            exprs,
        }
    }

    /// Returns the indices of the expressions that have this expression as an operand.
    pub(crate) fn parents(&self, id: ExprId) -> &[u32] {
        self.parents.list(id.0 as usize)
    }

    /// Returns the indices of the expressions that read a flow.
    pub(crate) fn flow_readers(&self, flow: FlowId) -> &[u32] {
        self.flow_readers.list(flow.0 as usize)
    }

    /// Returns the indices of the definitions whose value is this expression.
    pub(crate) fn definitions_of_expr(&self, id: ExprId) -> &[u32] {
        self.definitions_by_value.list(id.0 as usize)
    }

    /// Returns the indices of the definitions, by states of an automaton, of the flows to which this flow gives a value
    /// in a state.
    pub(crate) fn definitions_of_shared(&self, flow: FlowId) -> &[u32] {
        self.definitions_by_value.list(self.exprs + flow.0 as usize)
    }
}

fn definitions(unit: &Unit) -> Vec<Definition<'_>> {
    let mut all = Vec::new();
    for (block, content) in (0..).map(BlockId).zip(&unit.blocks) {
        all.extend(
            content
                .equations
                .iter()
                .map(|e| Definition::Equation(block, e)),
        );
        let shared = content
            .automata
            .iter()
            .flat_map(|automaton| &automaton.shared);
        all.extend(shared.map(Definition::Shared));
    }
    all
}

fn definition_pairs(definitions: &[Definition<'_>], exprs: usize) -> Vec<(u32, u32)> {
    let mut pairs = Vec::new();
    for (k, definition) in (0u32..).zip(definitions) {
        match definition {
            Definition::Equation(_, equation) => pairs.push((equation.value.0, k)),
            Definition::Shared(shared) => {
                let at = |flow: FlowId| u32::try_from(exprs).unwrap_or(u32::MAX) + flow.0;
                pairs.extend(shared.contributions().map(|flow| (at(flow), k)));
            }
        }
    }
    pairs
}

/// Returns the block of each expression of a unit, indexed by expression.
fn blocks(unit: &Unit) -> Vec<BlockId> {
    let mut blocks = vec![BlockId::ROOT; unit.exprs.len()];
    for (id, block) in (0..).map(BlockId).zip(&unit.blocks) {
        if id == BlockId::ROOT && unit.blocks.len() == 1 {
            break;
        }
        let roots = block.equations.iter().map(|e| e.value);
        let claims = block.claims.iter().map(|claim| claim.condition);
        let states = block
            .automata
            .iter()
            .flat_map(|automaton| &automaton.states);
        // A strong condition is evaluated in the block around the states, a weak one in its state.
        let unless = states.clone().flat_map(|s| &s.unless);
        let unless = unless.filter_map(|t| t.condition);
        let until = states.flat_map(|s| {
            s.until
                .iter()
                .filter_map(move |t| Some((s.block, t.condition?)))
        });
        roots
            .chain(claims)
            .chain(unless)
            .for_each(|root| checkpoint(unit, root, id, &mut blocks));
        until.for_each(|(state, root)| checkpoint(unit, root, state, &mut blocks));
        if let (Some(when), Some(parent)) = (block.when, block.parent) {
            checkpoint(unit, when, parent, &mut blocks);
        }
    }
    blocks
}

fn checkpoint(unit: &Unit, root: ExprId, block: BlockId, blocks: &mut [BlockId]) {
    let mut parts = unit.traverse(root);
    while let Some((id, _)) = parts.next() {
        blocks[id.0 as usize] = block;
        parts.enter(id);
    }
}

/// Lists of indices, one list for each vertex of a graph, stored in one vector.
struct AdjacencyLists {
    first: Vec<u32>,
    items: Vec<u32>,
}

impl AdjacencyLists {
    /// Creates `lists` lists from pairs of the index of a list and an item. The items of a list remain in their order.
    fn new(lists: usize, pairs: &[(u32, u32)]) -> Self {
        let mut first = vec![0; lists + 1];
        for (list, _) in pairs {
            first[*list as usize + 1] += 1;
        }
        for k in 1..first.len() {
            first[k] += first[k - 1];
        }
        let mut next = first.clone();
        let mut items = vec![0; pairs.len()];
        for (list, item) in pairs {
            let at = &mut next[*list as usize];
            items[*at as usize] = *item;
            *at += 1;
        }
        AdjacencyLists { first, items }
    }

    fn list(&self, list: usize) -> &[u32] {
        &self.items[self.first[list] as usize..self.first[list + 1] as usize]
    }
}
