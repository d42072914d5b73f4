//! The intermediate representation of the lowering: operations on virtual registers in a tree of scopes. All passes
//! work on it.

use crate::access::AccessTable;
use crate::registers::{Register, Registers};
use rpi_image::DeviceResponse;
use rpi_image::external::ExternalFunction;
use rpi_image::image::{
    CommandEnd, CoreFlow, DevicePort, Export, Form, Fragment, InputPort, SensorPort, Signal,
};
use rpi_prims::PrimId;

/// Index of a scope (a group of operations that are skipped together) in [`FlatNet::scopes`]; 0 is the root, which is
/// always active.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub(crate) struct ScopeId(pub(crate) u32);

impl ScopeId {
    pub(crate) const ROOT: ScopeId = ScopeId(0);

    pub(crate) const fn index(self) -> usize {
        self.0 as usize
    }
}

/// Kind of an operation of the flat net.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub(crate) enum OpKind {
    /// Call of a primitive in one form of its code, with or without presences. Its operand words are laid out as in
    /// [`rpi_image::operands`], with registers in place of memory slots.
    Run(PrimId, Form),
    /// Copy of one value. The operand words are the source register and the target register.
    Copy,
    /// Output of a set-point: index into [`Tables::actuators`], and the number of operand words that are inputs. The
    /// remaining words are registers for the responses of the device.
    Actuate(u32, u32),
    /// Call of a device function: index into [`Tables::functions`], and the number of operand words that are arguments.
    /// The remaining words are registers for the results.
    Call(u32, u32),
}

/// One operation of a flat net: a primitive call, a copy or a device access.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct Op {
    pub(crate) kind: OpKind,
    /// Index of the first operand word of the operation in [`FlatNet::words`].
    pub(crate) at: u32,
    pub(crate) len: u32,
    /// Index of the net's node that the operation computes; [`NO_NODE`] for operations added by the lowering.
    pub(crate) node: u32,
}

/// An element of a scope: an operation or a nested scope.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Item {
    /// Operation, as an index into [`FlatNet::ops`].
    Op(u32),
    Scope(ScopeId),
}

/// Group of operations and nested scopes that are skipped together in cycles in which a Boolean register is false.
#[derive(Clone, Debug)]
pub(crate) struct Scope {
    pub(crate) parent: Option<ScopeId>,
    /// Boolean register that is true in the cycles in which the scope runs. [`Register::TRUE`] for a scope that exists
    /// only for its reset.
    pub(crate) guard: Register,
    /// Reset at the start of the scope: a Boolean register, and the index of the fragment whose initial state is
    /// restored if that register is false. `None` if the scope has no reset.
    pub(crate) reset: Option<(Register, u32)>,
    pub(crate) items: Vec<Item>,
    /// Pairs of registers (source, target) copied at the end of each cycle in which the scope is active. The targets
    /// are read in the next such cycle.
    pub(crate) latches: Vec<(Register, Register)>,
}

/// Tables of the image, such as sensors and exports, with register numbers in place of memory slots.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tables {
    pub(crate) fragments: Vec<Fragment>,
    /// Sensors, each with the index of the node that reads it.
    pub(crate) sensors: Vec<(SensorPort, u32)>,
    pub(crate) actuators: Vec<Actuator>,
    pub(crate) functions: Vec<Function>,
    pub(crate) inputs: Vec<InputPort>,
    pub(crate) exports: Vec<Export>,
    pub(crate) flows: Vec<CoreFlow>,
    pub(crate) end: CommandEnd,
    /// Out-ports that an observer can read, as index of the node, index of the port and registers of the value. Empty
    /// unless all ports must be observable.
    pub(crate) probes: Vec<(u32, u8, Signal)>,
}

/// Actuator port of a device. The registers of its inputs and of the device's responses are operand words of the
/// operation that sets the port.
#[derive(Clone, Debug)]
pub(crate) struct Actuator {
    pub(crate) port: DevicePort,
    pub(crate) answers: &'static [DeviceResponse],
}

/// Function of a device, such as inverse kinematics. The registers of its arguments and results are operand words of
/// the operation that calls the function.
#[derive(Clone, Debug)]
pub(crate) struct Function {
    pub(crate) port: DevicePort,
    /// Whether a call may yield no result. If true, the last operand word is a register that receives whether there was
    /// a result.
    pub(crate) may_fail: bool,
    /// Upper bound of the work of one call, in elementary operations (the addition of two reals is 1).
    pub(crate) work: u32,
    /// Signature in C if the function is not one of a device.
    pub(crate) external: Option<ExternalFunction>,
}

/// A net translated to operations on registers, in nested scopes. Presence and activation of its flows are Boolean
/// registers.
#[derive(Clone, Debug)]
pub(crate) struct FlatNet {
    pub(crate) registers: Registers,
    pub(crate) accesses: AccessTable,
    pub(crate) words: Vec<u32>,
    pub(crate) ops: Vec<Op>,
    pub(crate) scopes: Vec<Scope>,
    pub(crate) tables: Tables,
}

/// Value in place of the node index for operations that belong to no node of the net.
pub(crate) const NO_NODE: u32 = u32::MAX;

impl FlatNet {
    /// Creates an empty flat net with the root scope, and capacity for about `primitives` primitives. Reserving memory
    /// avoids the fragmentation that growing large tables causes.
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

    /// Creates a scope inside `parent` that runs in the cycles in which `guard` is true. Returns its index.
    /// [`FlatNet::close`] must be called to insert it into the items of `parent`.
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

    /// Appends a scope created by [`FlatNet::open`] to the items of its parent.
    pub(crate) fn close(&mut self, scope: ScopeId) {
        if let Some(parent) = self.scopes[scope.index()].parent {
            self.scopes[parent.index()].items.push(Item::Scope(scope));
        }
    }

    /// Appends an operation with the operand words `words` to a scope. `node` is the index of its node, or [`NO_NODE`].
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

    /// Appends a copy of one value from register `from` to register `to` to a scope. `node` is the index of its node,
    /// or [`NO_NODE`].
    pub(crate) fn copy(&mut self, scope: ScopeId, from: Register, to: Register, node: u32) {
        self.push(scope, OpKind::Copy, &[from.0, to.0], node);
    }

    pub(crate) fn words(&self, op: Op) -> &[u32] {
        &self.words[op.at as usize..(op.at + op.len) as usize]
    }
}

/// Converts a length or position to a 32-bit index. Panics from 2^32 on, which no table of a net reaches.
pub(crate) fn index(n: usize) -> u32 {
    u32::try_from(n).expect("fewer than 2^32 parts")
}
