//! Blocks that may be inactive. A flow of such a block is optional for readers outside it.

use crate::typed::{BlockId, FlowId, Unit};

/// Blocks of a unit, with whether each may be inactive while its parent block is active.
#[derive(Clone, Debug)]
pub struct InactiveBlocks<'u> {
    unit: &'u Unit,
    may_be_inactive: Vec<bool>,
}

impl<'u> InactiveBlocks<'u> {
    /// Creates the table for a unit. Blocks with an activation condition and states of automata may be inactive.
    #[must_use]
    pub fn new(unit: &'u Unit) -> Self {
        let has_condition = unit.blocks.iter().map(|block| block.when.is_some());
        let mut gated: Vec<bool> = has_condition.collect();
        let automata = unit.blocks.iter().flat_map(|block| &block.automata);
        for state in automata.flat_map(|automaton| &automaton.states) {
            gated[state.block.0 as usize] = true;
        }
        // The activation of the fragment itself is handled where it is called.
        gated[0] = false;
        InactiveBlocks {
            unit,
            may_be_inactive: gated,
        }
    }

    /// Whether any block of the unit may be inactive.
    #[must_use]
    pub fn has_inactive(&self) -> bool {
        self.may_be_inactive.contains(&true)
    }

    /// Whether any of the blocks from `from` outwards, up to but not including `to`, may be inactive. `false` if `to`
    /// does not enclose `from`.
    #[must_use]
    pub fn crosses_inactive(&self, from: BlockId, to: BlockId) -> bool {
        let mut block = from;
        let mut crossed = false;
        while block != to {
            crossed |= self.may_be_inactive[block.0 as usize];
            match self.unit.block(block).parent {
                Some(parent) => block = parent,
                None => return false,
            }
        }
        crossed
    }

    /// Whether an expression in block `reader` is outside of a block that contains `flow` and may be inactive, so that
    /// the flow may be absent for the expression.
    #[must_use]
    pub fn is_outside(&self, flow: FlowId, reader: BlockId) -> bool {
        let own = self.unit.flow(flow).block;
        if own == reader || own == BlockId::ROOT {
            return false;
        }
        let parent = |block: &BlockId| self.unit.block(*block).parent;
        let around: Vec<BlockId> = std::iter::successors(Some(reader), parent).collect();
        let mut outwards = std::iter::successors(Some(own), parent);
        let common = outwards.find(|block| around.contains(block));
        self.crosses_inactive(own, common.unwrap_or(BlockId::ROOT))
    }
}
