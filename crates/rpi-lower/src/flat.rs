//! The net taken apart: operations on slots in a tree of scopes. What the passes work on.

use crate::access::Shapes;
use crate::slots::{Slot, Slots};
use rpi_image::Answer;
use rpi_image::image::{DevicePort, End, Export, Flow, Form, Fragment, InputPort, Sensor, Signal};
use rpi_prims::PrimId;

/// Number of a scope; 0 is the root, always active.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub(crate) struct ScopeId(pub(crate) u32);

impl ScopeId {
    pub(crate) const ROOT: ScopeId = ScopeId(0);

    pub(crate) const fn index(self) -> usize {
        self.0 as usize
    }
}

/// What an operation does.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub(crate) enum Work {
    /// One primitive; words as [`rpi_image::operands`] tells, with slots in place of cells.
    Run(PrimId, Form),
    /// One value: words from, to.
    Copy,
    /// Index into [`Tables::actuators`], and how many of the words are inputs; the others are answers.
    Actuate(u32, u32),
    /// Index into [`Tables::functions`], and how many of the words are arguments; the others are results.
    Call(u32, u32),
}

/// One operation.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct Op {
    pub(crate) work: Work,
    /// Its words in [`Flat::words`].
    pub(crate) at: u32,
    pub(crate) len: u32,
    /// The node that it computes; `u32::MAX` for what the lowering adds.
    pub(crate) node: u32,
}

/// What stands in a scope, in order.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Item {
    /// Index into [`Flat::ops`].
    Op(u32),
    Scope(ScopeId),
}

/// Operations that are skipped together.
#[derive(Clone, Debug)]
pub(crate) struct Scope {
    pub(crate) parent: Option<ScopeId>,
    /// Skipped unless it is true; [`Slot::TRUE`] for a scope that exists for its reset.
    pub(crate) guard: Slot,
    /// Initial state for a fragment unless the slot is true, before anything else.
    pub(crate) reset: Option<(Slot, u32)>,
    pub(crate) items: Vec<Item>,
    /// Values kept for the next cycle: (from, to).
    pub(crate) latches: Vec<(Slot, Slot)>,
}

/// Tables of the image, with slots in place of cells.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tables {
    pub(crate) fragments: Vec<Fragment>,
    /// Sensors with the node for which each is read.
    pub(crate) sensors: Vec<(Sensor, u32)>,
    pub(crate) actuators: Vec<Actuator>,
    pub(crate) functions: Vec<Function>,
    pub(crate) inputs: Vec<InputPort>,
    pub(crate) exports: Vec<Export>,
    pub(crate) flows: Vec<Flow>,
    pub(crate) end: End,
    /// Every port: node, port, value.
    pub(crate) probes: Vec<(u32, u8, Signal)>,
}

/// An actuator port; inputs and answers are words of its operation.
#[derive(Clone, Debug)]
pub(crate) struct Actuator {
    pub(crate) port: DevicePort,
    pub(crate) answers: &'static [Answer],
}

/// A device function; arguments and results are words of its operation.
#[derive(Clone, Debug)]
pub(crate) struct Function {
    pub(crate) port: DevicePort,
    /// The last of its words tells whether there was a result.
    pub(crate) maybe: bool,
}

/// A net taken apart.
#[derive(Clone, Debug)]
pub(crate) struct Flat {
    pub(crate) slots: Slots,
    pub(crate) shapes: Shapes,
    pub(crate) words: Vec<u32>,
    pub(crate) ops: Vec<Op>,
    pub(crate) scopes: Vec<Scope>,
    pub(crate) tables: Tables,
}

/// An operation that belongs to no node.
pub(crate) const NO_NODE: u32 = u32::MAX;

impl Flat {
    /// Nothing yet, with room for about so many primitives: large tables that grow leave holes behind.
    pub(crate) fn new(primitives: usize) -> Self {
        let root = Scope {
            parent: None,
            guard: Slot::TRUE,
            reset: None,
            items: Vec::new(),
            latches: Vec::new(),
        };
        Flat {
            slots: Slots::new(2 * primitives),
            shapes: Shapes::default(),
            words: Vec::with_capacity(4 * primitives),
            ops: Vec::with_capacity(primitives + primitives / 8),
            scopes: vec![root],
            tables: Tables::default(),
        }
    }

    /// Opens a scope inside `parent`. It takes its place there when it is closed.
    pub(crate) fn open(&mut self, parent: ScopeId, guard: Slot) -> ScopeId {
        let id = ScopeId(index(self.scopes.len()));
        self.scopes.push(Scope {
            parent: Some(parent),
            guard,
            reset: None,
            items: Vec::new(),
            latches: Vec::new(),
        });
        id
    }

    /// Puts a scope into its parent, behind everything that is there so far.
    pub(crate) fn close(&mut self, scope: ScopeId) {
        if let Some(parent) = self.scopes[scope.index()].parent {
            self.scopes[parent.index()].items.push(Item::Scope(scope));
        }
    }

    /// Adds an operation at the end of a scope.
    pub(crate) fn push(&mut self, scope: ScopeId, work: Work, words: &[u32], node: u32) {
        if let Work::Run(prim, form) = work {
            self.shapes.of(prim, form);
        }
        let op = Op {
            work,
            at: index(self.words.len()),
            len: index(words.len()),
            node,
        };
        self.words.extend_from_slice(words);
        self.scopes[scope.index()]
            .items
            .push(Item::Op(index(self.ops.len())));
        self.ops.push(op);
    }

    pub(crate) fn words(&self, op: Op) -> &[u32] {
        &self.words[op.at as usize..(op.at + op.len) as usize]
    }
}

/// Nothing in a net has 2^32 parts.
pub(crate) fn index(n: usize) -> u32 {
    u32::try_from(n).expect("fewer than 2^32 parts")
}
