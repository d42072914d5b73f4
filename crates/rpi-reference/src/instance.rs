//! Instance of a unit: its memory, and its values in the current cycle.

use std::collections::{BTreeMap, BTreeSet};

use rpi_sema::typed::{BlockId, ExprId, FlowId, Unit, UnitId};

use crate::value::Leaf;

/// Index of an instance in the list of all instances ever created ([`Interpreter::instances`](crate::Interpreter)).
pub(crate) type InstanceId = usize;

/// Leaf (scalar part) of an expression: the expression, and the index of the leaf in it.
pub(crate) type LeafId = (ExprId, usize);

/// Instance of a unit (function, node, command) with its own memory: the whole program, or the callee of one call.
pub(crate) struct Instance<'p> {
    pub(crate) unit: &'p Unit,
    pub(crate) id: UnitId,
    /// Context in which the caller evaluates the call, and the arguments of the call; `None` for the whole program.
    pub(crate) caller: Option<(EvalContext, &'p [Option<ExprId>])>,
    /// Memory of the delays that belong to no block: those in the condition of a named fragment.
    pub(crate) around: Memory,
    /// Memory of each block (body, fragment or state of an automaton), by block index.
    pub(crate) blocks: Vec<Memory>,
    /// Values that have been computed in the current cycle.
    pub(crate) current: CycleValues,
}

/// Memory of a block (body, fragment or state of an automaton) from one cycle to the next. A restart of the block
/// clears it (M6.2).
#[derive(Clone, Default)]
pub(crate) struct Memory {
    /// Values that `pre`, `hold`, `current` and calls with an activation condition store for the next cycle, by
    /// expression and leaf.
    pub(crate) delayed_values: BTreeMap<LeafId, Leaf>,
    /// Values of the previous cycle of the flows that states of an automaton share, by flow and index of the leaf
    /// (scalar part).
    pub(crate) last: BTreeMap<(FlowId, usize), Leaf>,
    /// Leaves (scalar parts) of `a -> b` and `first` that have had their first cycle (M5.1).
    pub(crate) started: BTreeSet<LeafId>,
    /// For each call in the block, the instance of the callee, which holds its state.
    pub(crate) calls: BTreeMap<ExprId, InstanceId>,
    /// Inner blocks (fragments) that were active in the previous cycle of this block.
    pub(crate) was_active: BTreeSet<BlockId>,
    /// For each automaton in the block, its state in the next cycle, and whether that state restarts.
    pub(crate) states: BTreeMap<usize, State>,
    /// For each automaton in the block, the indices of the states that were entered with a restart and left before they
    /// ran.
    pub(crate) pending_restarts: BTreeMap<usize, BTreeSet<u32>>,
}

/// State of an automaton in a cycle: its index, and whether it restarts.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct State {
    pub(crate) index: u32,
    pub(crate) restarts: bool,
}

/// Values that an instance has computed in the current cycle. All collections are empty at the start of a cycle.
#[derive(Clone, Default)]
pub(crate) struct CycleValues {
    /// True if the enclosing `if`s need the result of the call that the instance executes. Faults count only then.
    pub(crate) chosen: bool,
    /// Values of leaves (scalar parts) of expressions; `None` while the evaluation of the leaf is in progress.
    pub(crate) leaves: BTreeMap<LeafId, Option<Leaf>>,
    /// Expressions all of whose leaves and operands have been evaluated.
    pub(crate) visited: BTreeSet<ExprId>,
    /// For each block (body, fragment or state) that has been looked at, whether it is active.
    pub(crate) active: BTreeMap<BlockId, bool>,
    /// States of the automata that have been evaluated, by block and index of the automaton.
    pub(crate) states: BTreeMap<(BlockId, usize), State>,
    /// Calls that have been reached, each with the instance of the callee, or `None` if the call does not run.
    pub(crate) entered: BTreeMap<ExprId, Option<InstanceId>>,
}

/// Context in which an expression is evaluated: instance, block, and whether the value is needed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EvalContext {
    pub(crate) instance: InstanceId,
    /// Block (body, fragment or state) whose memory the expression uses; `None` for the condition of a named fragment,
    /// which is outside of all blocks.
    pub(crate) block: Option<BlockId>,
    /// True if the enclosing `if`s need the value. Faults in a branch that is not needed do not count (M6.6).
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

    /// Clears the memory of a block (fragment or state) and of all blocks in it.
    pub(crate) fn reset(&mut self, block: BlockId) {
        for k in (0..).map(BlockId).take(self.blocks.len()) {
            if self.unit_blocks_around(k).any(|around| around == block) {
                self.blocks[k.0 as usize] = Memory::default();
            }
        }
    }

    /// Returns a block and its enclosing blocks, beginning with the block itself.
    fn unit_blocks_around(&self, block: BlockId) -> impl Iterator<Item = BlockId> + use<'p> {
        let unit = self.unit;
        std::iter::successors(Some(block), move |block| unit.block(*block).parent)
    }
}

impl EvalContext {
    /// Returns the context for an operand of an operator with state. The operand is needed in all cycles, whatever an
    /// enclosing `if` selects, so its faults count.
    pub(crate) fn unguarded(self) -> EvalContext {
        EvalContext {
            chosen: true,
            ..self
        }
    }
}
