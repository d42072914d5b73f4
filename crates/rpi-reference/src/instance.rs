//! Instance of a unit: its memory, and its values in the current cycle.

use std::collections::{BTreeMap, BTreeSet};

use rpi_sema::typed::{BlockId, ExprId, FlowId, Unit, UnitId};

use crate::value::Leaf;

/// Index of an instance among all instances ever created.
pub(crate) type InstanceId = usize;

/// Leaf of an expression: the expression and the index of the leaf.
pub(crate) type LeafId = (ExprId, usize);

/// Instance of a unit: the whole program, or the callee of one call.
pub(crate) struct Instance<'p> {
    pub(crate) unit: &'p Unit,
    pub(crate) id: UnitId,
    /// Context of the call and its arguments; `None` for the whole program.
    pub(crate) caller: Option<(EvalContext, &'p [Option<ExprId>])>,
    /// Memory of the delays outside of the body. The condition of a named fragment reads them.
    pub(crate) around: Memory,
    /// State of the delays of each block (body, fragment or state of an automaton), by block index.
    pub(crate) blocks: Vec<Memory>,
    /// Values of the flows that have been computed in the current cycle.
    pub(crate) current: CycleValues,
}

/// Memory of a block. Restarting a block clears it (M6.2).
#[derive(Clone, Default)]
pub(crate) struct Memory {
    /// Values kept for the next cycle by `pre`, `hold`, `current` and activated calls.
    pub(crate) delayed_values: BTreeMap<LeafId, Leaf>,
    /// Previous values of the flows shared by states.
    pub(crate) last: BTreeMap<(FlowId, usize), Leaf>,
    /// Leaves of `a -> b` and `first` that have had their first cycle (M5.1).
    pub(crate) started: BTreeSet<LeafId>,
    /// For each call in the body, the instance of the callee that holds its state.
    pub(crate) calls: BTreeMap<ExprId, InstanceId>,
    /// Inner blocks that were active in the previous cycle of this block.
    pub(crate) was_active: BTreeSet<BlockId>,
    /// For each automaton the state of the next cycle, and whether it restarts.
    pub(crate) states: BTreeMap<usize, State>,
    /// For each automaton the states that were entered with a restart and left before they ran.
    pub(crate) pending_restarts: BTreeMap<usize, BTreeSet<u32>>,
}

/// State of an automaton in a cycle, by index, and whether the state restarts.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct State {
    pub(crate) index: u32,
    pub(crate) restarts: bool,
}

/// Values of an instance that have been computed in the current cycle; empty when the cycle begins.
#[derive(Clone, Default)]
pub(crate) struct CycleValues {
    /// Whether the enclosing `if`s chose the call.
    pub(crate) chosen: bool,
    /// Evaluated leaves; `None` while the evaluation is in progress.
    pub(crate) leaves: BTreeMap<LeafId, Option<Leaf>>,
    /// Expressions that have been evaluated completely.
    pub(crate) visited: BTreeSet<ExprId>,
    /// Blocks whose activity is known.
    pub(crate) active: BTreeMap<BlockId, bool>,
    /// Automata whose state is known.
    pub(crate) states: BTreeMap<(BlockId, usize), State>,
    /// Calls that were reached in the cycle, with the instance if the call runs.
    pub(crate) entered: BTreeMap<ExprId, Option<InstanceId>>,
}

/// Context in which an expression is evaluated.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EvalContext {
    pub(crate) instance: InstanceId,
    /// Block whose memory is used; `None` outside of the body.
    pub(crate) block: Option<BlockId>,
    /// Whether the enclosing `if`s need the value. Faults in a branch that is not needed do not count (M6.6).
    pub(crate) chosen: bool,
}

impl<'p> Instance<'p> {
    pub(crate) fn new(
        unit: &'p Unit,
        id: UnitId,
        caller: Option<(EvalContext, &'p [Option<ExprId>])>,
    ) -> Instance<'p> {
        Instance {
            unit,
            id,
            caller,
            around: Memory::default(),
            blocks: vec![Memory::default(); unit.blocks.len()],
            current: CycleValues::default(),
        }
    }

    pub(crate) fn memory(&mut self, block: Option<BlockId>) -> &mut Memory {
        match block {
            Some(block) => &mut self.blocks[block.0 as usize],
            None => &mut self.around,
        }
    }

    /// Clears the memory of a block and of all inner blocks.
    pub(crate) fn reset(&mut self, block: BlockId) {
        for k in (0..).map(BlockId).take(self.blocks.len()) {
            if self.unit_blocks_around(k).any(|around| around == block) {
                self.blocks[k.0 as usize] = Memory::default();
            }
        }
    }

    /// Returns a block and its enclosing blocks, from the inside out.
    fn unit_blocks_around(&self, block: BlockId) -> impl Iterator<Item = BlockId> + use<'p> {
        let unit = self.unit;
        std::iter::successors(Some(block), move |block| unit.block(*block).parent)
    }
}

impl EvalContext {
    /// Returns the context for an operand of an operator with state: the operand is needed in all cycles, whatever an
    /// `if` chooses, so its faults count.
    pub(crate) fn unguarded(self) -> EvalContext {
        EvalContext {
            chosen: true,
            ..self
        }
    }
}
