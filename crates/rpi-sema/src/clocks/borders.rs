//! Borders of blocks that may be inactive: behind one of these a flow of the block is an optional flow of the surroundings.

use crate::typed::{BlockId, FlowId, Unit};

/// The blocks of a unit, and which of them may be inactive while the block around is active.
#[derive(Clone, Debug)]
pub struct Borders<'u> {
    unit: &'u Unit,
    gated: Vec<bool>,
}

impl<'u> Borders<'u> {
    /// The borders of a unit.
    #[must_use]
    pub fn new(unit: &'u Unit) -> Self {
        let has_condition = unit.blocks.iter().map(|block| block.when.is_some());
        let mut gated: Vec<bool> = has_condition.collect();
        let automata = unit.blocks.iter().flat_map(|block| &block.automata);
        for state in automata.flat_map(|automaton| &automaton.states) {
            gated[state.block.0 as usize] = true;
        }
        // A fragment's own activation is its caller's business.
        gated[0] = false;
        Borders { unit, gated }
    }

    /// Whether there is any.
    #[must_use]
    pub fn any(&self) -> bool {
        self.gated.contains(&true)
    }

    /// Whether one lies between a block and one around it.
    #[must_use]
    pub fn crossed(&self, from: BlockId, to: BlockId) -> bool {
        let mut block = from;
        let mut crossed = false;
        while block != to {
            crossed |= self.gated[block.0 as usize];
            match self.unit.block(block).parent {
                Some(parent) => block = parent,
                None => return false,
            }
        }
        crossed
    }

    /// Whether one lies between a flow and an expression in another block that reads it.
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
        self.crossed(own, common.unwrap_or(BlockId::ROOT))
    }
}
