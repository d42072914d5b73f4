//! An instance of a unit: what it remembers from cycle to cycle, and what is known of it in the present one.

use std::collections::{BTreeMap, BTreeSet};

use rpi_sema::typed::{BlockId, ExprId, FlowId, Unit, UnitId};

use crate::value::Leaf;

/// Index of an instance among all that ever were.
pub(crate) type InstanceId = usize;

/// A place in an expression's value.
pub(crate) type Place = (ExprId, usize);

/// A unit at work: the whole program, or what stands behind one call.
pub(crate) struct Instance<'p> {
    pub(crate) unit: &'p Unit,
    pub(crate) id: UnitId,
    /// Where it is called, and by which arguments; none for the whole program.
    pub(crate) caller: Option<(Here, &'p [Option<ExprId>])>,
    /// What is remembered around the body: by the conditions of a named fragment.
    pub(crate) around: Memory,
    /// What is remembered in each block.
    pub(crate) blocks: Vec<Memory>,
    /// What is known in this cycle.
    pub(crate) now: Now,
}

/// What a block remembers. Starting a block afresh is forgetting all of it (M6.2).
#[derive(Clone, Default)]
pub(crate) struct Memory {
    /// What `pre`, `hold`, `current` and activated calls keep for the next cycle.
    pub(crate) kept: BTreeMap<Place, Leaf>,
    /// What the flows that states share were.
    pub(crate) last: BTreeMap<(FlowId, usize), Leaf>,
    /// The leaves of `a -> b`, and the `first`, that have had their first cycle (M5.1).
    pub(crate) begun: BTreeSet<Place>,
    /// The instance behind each call.
    pub(crate) calls: BTreeMap<ExprId, InstanceId>,
    /// The blocks in it that were active in its previous cycle.
    pub(crate) was_active: BTreeSet<BlockId>,
    /// For each of its automata the state of the next cycle, and whether it starts afresh.
    pub(crate) states: BTreeMap<usize, State>,
    /// For each of its automata the states that were entered afresh and left before they ran.
    pub(crate) owed: BTreeMap<usize, BTreeSet<u32>>,
}

/// The state of an automaton.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct State {
    pub(crate) index: u32,
    pub(crate) afresh: bool,
}

/// What is known of an instance in this cycle; nothing at its beginning.
#[derive(Clone, Default)]
pub(crate) struct Now {
    /// Whether the call was chosen by the `if`s around it.
    pub(crate) chosen: bool,
    /// Leaves that have been worked out; none while that is going on.
    pub(crate) leaves: BTreeMap<Place, Option<Leaf>>,
    /// Expressions that have been visited.
    pub(crate) visited: BTreeSet<ExprId>,
    /// Blocks of which the activity is known.
    pub(crate) active: BTreeMap<BlockId, bool>,
    /// Automata of which the state is known.
    pub(crate) states: BTreeMap<(BlockId, usize), State>,
    /// Calls that were reached, with the instance if it runs.
    pub(crate) entered: BTreeMap<ExprId, Option<InstanceId>>,
}

/// Where an expression is evaluated.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Here {
    pub(crate) instance: InstanceId,
    /// The block that remembers; none for what stands around the body.
    pub(crate) block: Option<BlockId>,
    /// False in a branch that no `if` chose: what would fault there does not (M6.6).
    pub(crate) chosen: bool,
}

impl<'p> Instance<'p> {
    pub(crate) fn new(
        unit: &'p Unit,
        id: UnitId,
        caller: Option<(Here, &'p [Option<ExprId>])>,
    ) -> Instance<'p> {
        Instance {
            unit,
            id,
            caller,
            around: Memory::default(),
            blocks: vec![Memory::default(); unit.blocks.len()],
            now: Now::default(),
        }
    }

    pub(crate) fn memory(&mut self, block: Option<BlockId>) -> &mut Memory {
        match block {
            Some(block) => &mut self.blocks[block.0 as usize],
            None => &mut self.around,
        }
    }

    /// Forgets what a block and those in it remember.
    pub(crate) fn start_afresh(&mut self, block: BlockId) {
        for k in (0..).map(BlockId).take(self.blocks.len()) {
            if self.unit_blocks_around(k).any(|around| around == block) {
                self.blocks[k.0 as usize] = Memory::default();
            }
        }
    }

    /// A block and those around it, from the inside out.
    fn unit_blocks_around(&self, block: BlockId) -> impl Iterator<Item = BlockId> + use<'p> {
        let unit = self.unit;
        std::iter::successors(Some(block), move |block| unit.block(*block).parent)
    }
}

impl Here {
    /// The same place on the way to a state: that goes on in all cycles, whatever an `if` chooses, and so do its faults.
    pub(crate) fn unguarded(self) -> Here {
        Here {
            chosen: true,
            ..self
        }
    }
}
