//! The intermediate representation of the lowering: operations on virtual registers in a tree of scopes. All passes
//! work on it.

use crate::access::AccessTable;
use crate::registers::{Register, Registers};
use rpi_image::DeviceResponse;
use rpi_image::image::{
    CommandEnd, CoreFlow, DevicePort, Export, Form, Fragment, InputPort, SensorPort, Signal,
};
use rpi_prims::PrimId;

/// Index of a scope; 0 is the root, which is always active.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub(crate) struct ScopeId(pub(crate) u32);

impl ScopeId {
    pub(crate) const ROOT: ScopeId = ScopeId(0);

    pub(crate) const fn index(self) -> usize {
        self.0 as usize
    }
}

/// What an operation of the flat net computes.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub(crate) enum OpKind {
    /// A call of a primitive. Its words are laid out as in [`rpi_image::operands`], with registers in place of memory
    /// slots.
    Run(PrimId, Form),
    /// A copy of one value. Words: source, target.
    Copy,
    /// A set-point: index into [`Tables::actuators`], and the number of words that are inputs. The other words are
    /// answers.
    Actuate(u32, u32),
    /// A device function: index into [`Tables::functions`], and the number of words that are arguments. The other words
    /// are results.
    Call(u32, u32),
}

/// One operation of a flat net: a primitive call, a copy or a device access.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct Op {
    pub(crate) kind: OpKind,
    /// Start of its words in [`FlatNet::words`].
    pub(crate) at: u32,
    pub(crate) len: u32,
    /// The node that it computes; [`NO_NODE`] for operations added by the lowering.
    pub(crate) node: u32,
}

/// An element of a scope: an operation or a nested scope.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Item {
    /// Operation, as an index into [`FlatNet::ops`].
    Op(u32),
    Scope(ScopeId),
}

/// Operations that are skipped together, with nested scopes.
#[derive(Clone, Debug)]
pub(crate) struct Scope {
    pub(crate) parent: Option<ScopeId>,
    /// The scope is skipped unless this register is true. [`Register::TRUE`] for a scope that exists only for its reset.
    pub(crate) guard: Register,
    /// Fragment whose initial state is restored at the start of the scope, unless the register is true.
    pub(crate) reset: Option<(Register, u32)>,
    pub(crate) items: Vec<Item>,
    /// Pairs of registers (source, target) copied at the end of the cycle, for values that are read in the next one.
    pub(crate) latches: Vec<(Register, Register)>,
}

/// Tables of the image, with registers in place of memory slots.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tables {
    pub(crate) fragments: Vec<Fragment>,
    /// Sensors, each with the node that reads it.
    pub(crate) sensors: Vec<(SensorPort, u32)>,
    pub(crate) actuators: Vec<Actuator>,
    pub(crate) functions: Vec<Function>,
    pub(crate) inputs: Vec<InputPort>,
    pub(crate) exports: Vec<Export>,
    pub(crate) flows: Vec<CoreFlow>,
    pub(crate) end: CommandEnd,
    /// Every port of every node, as node number, port number and location of the value.
    pub(crate) probes: Vec<(u32, u8, Signal)>,
}

/// An actuator port. Its inputs and responses are operand words of the operation that sets it.
#[derive(Clone, Debug)]
pub(crate) struct Actuator {
    pub(crate) port: DevicePort,
    pub(crate) answers: &'static [DeviceResponse],
}

/// A device function. Its arguments and results are operand words of the operation that calls it.
#[derive(Clone, Debug)]
pub(crate) struct Function {
    pub(crate) port: DevicePort,
    /// Whether a call may have no result. The last operand word then receives whether there was one.
    pub(crate) may_fail: bool,
    /// Bound of the work of a call, in elementary operations.
    pub(crate) work: u32,
}

/// A net translated to operations on registers, in nested scopes without fragments and links.
#[derive(Clone, Debug)]
pub(crate) struct FlatNet {
    pub(crate) registers: Registers,
    pub(crate) accesses: AccessTable,
    pub(crate) words: Vec<u32>,
    pub(crate) ops: Vec<Op>,
    pub(crate) scopes: Vec<Scope>,
    pub(crate) tables: Tables,
}

/// Node number of operations that belong to no node.
pub(crate) const NO_NODE: u32 = u32::MAX;

impl FlatNet {
    /// An empty net with capacity for about `primitives` primitives. Reserving avoids the fragmentation that growing
    /// large tables causes.
    pub(crate) fn new(primitives: usize) -> Self {
        let root = Scope {
            parent: None,
            guard: Register::TRUE,
            reset: None,
            items: Vec::new(),
            latches: Vec::new(),
        };
        FlatNet {
            registers: Registers::new(2 * primitives),
            accesses: AccessTable::default(),
            words: Vec::with_capacity(4 * primitives),
            ops: Vec::with_capacity(primitives + primitives / 8),
            scopes: vec![root],
            tables: Tables::default(),
        }
    }

    /// Opens a scope inside `parent`. The scope is inserted there when it is closed.
    pub(crate) fn open(&mut self, parent: ScopeId, guard: Register) -> ScopeId {
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

    /// Appends a scope to the items of its parent.
    pub(crate) fn close(&mut self, scope: ScopeId) {
        if let Some(parent) = self.scopes[scope.index()].parent {
            self.scopes[parent.index()].items.push(Item::Scope(scope));
        }
    }

    /// Appends an operation to a scope.
    pub(crate) fn push(&mut self, scope: ScopeId, work: OpKind, words: &[u32], node: u32) {
        if let OpKind::Run(prim, form) = work {
            self.accesses.get_or_compute(prim, form);
        }
        let op = Op {
            kind: work,
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

    /// Appends a copy of one value to a scope.
    pub(crate) fn copy(&mut self, scope: ScopeId, from: Register, to: Register, node: u32) {
        self.push(scope, OpKind::Copy, &[from.0, to.0], node);
    }

    pub(crate) fn words(&self, op: Op) -> &[u32] {
        &self.words[op.at as usize..(op.at + op.len) as usize]
    }
}

/// Converts a length to an index. No table of a net has 2^32 entries.
pub(crate) fn index(n: usize) -> u32 {
    u32::try_from(n).expect("fewer than 2^32 parts")
}
