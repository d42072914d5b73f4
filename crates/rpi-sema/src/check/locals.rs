//! Names inside a body, by block: flows, constants, inline fragments, and states.

use super::Constant;
use super::body::Body;
use super::types::PortTy;
use crate::hash::Map;
use crate::program::{DeclKind, Lookup, Space, twice};
use crate::ty::Ty;
use crate::typed::{Block, BlockId, Flow, FlowId, FlowRole, Optional};
use rpi_diag::Span;
use rpi_syntax::Name;
use rpi_syntax::ast::{self, Ident, Locals};

/// Meaning of a name inside a body.
#[derive(Clone, Debug)]
pub(super) enum Local {
    /// Flow.
    Flow(FlowId),
    /// Constant.
    Constant(Constant),
    /// Inline fragment.
    Block(BlockId),
    /// State of an automaton.
    State(BlockId),
    /// States of several automata: the locations of two of them, and their number.
    States([Span; 2], usize),
}

/// Names of one block.
#[derive(Default, Debug)]
pub(super) struct Scope {
    /// Meaning of each name, and the location of its declaration.
    names: Map<Name, (Local, Span)>,
    /// Names in text order, for "did you mean".
    order: Vec<Name>,
}

impl Scope {
    fn reserve(&mut self, names: usize) {
        self.names.reserve(names);
        self.order.reserve(names);
    }
}

/// Estimated number of source characters per expression in dense text. The estimate may be too low: reserved memory
/// that is not used costs nothing.
const LETTERS_PER_EXPR: usize = 5;

impl Body<'_, '_> {
    /// Returns the meaning of a name in the current block or the blocks around it.
    pub(super) fn find_local(&self, name: &str) -> Option<Local> {
        let mut block = Some(self.block);
        while let Some(id) = block {
            if let Some((local, _)) = self.scopes[id.0 as usize].names.get(name) {
                return Some(local.clone());
            }
            block = self.unit.block(id).parent;
        }
        None
    }

    /// Returns the meaning of a name in one block, without the blocks around it.
    pub(super) fn find_in(&self, block: BlockId, name: &str) -> Option<Local> {
        let scope = &self.scopes[block.0 as usize];
        scope.names.get(name).map(|(local, _)| local.clone())
    }

    /// Returns the names visible in the current block, innermost block first.
    pub(super) fn local_names(&self) -> impl Iterator<Item = &str> {
        let blocks = std::iter::successors(Some(self.block), |id| self.unit.block(*id).parent);
        blocks.flat_map(|id| self.names_in(id))
    }

    /// Returns the names of one block in text order.
    pub(super) fn names_in(&self, block: BlockId) -> impl Iterator<Item = &str> {
        self.scopes[block.0 as usize].order.iter().map(Name::as_str)
    }

    /// Declares a name in the current block; reports a second declaration.
    pub(super) fn declare(&mut self, name: &Ident, local: Local) {
        let scope = &mut self.scopes[self.block.0 as usize];
        match scope.names.get(&name.name) {
            Some((first, place)) => {
                let finding = twice(&name.name, name.span, *place);
                // It is not known which of the two an equation defines, so that neither is reported as undefined.
                for local in [first, &local] {
                    if let Local::Flow(flow) = local {
                        self.broken.push(*flow);
                    }
                }
                self.report(finding);
            }
            None => {
                scope.names.insert(name.name.clone(), (local, name.span));
                scope.order.push(name.name.clone());
            }
        }
    }

    /// Declares the name of a state. If another automaton has a state of that name, the name is ambiguous outside of
    /// the automata, and the block's name gets a number for traces.
    pub(super) fn declare_state_name(&mut self, name: &Ident, block: BlockId) {
        let scope = &mut self.scopes[self.block.0 as usize];
        let Some((local, first)) = scope.names.get_mut(&name.name) else {
            return self.declare(name, Local::State(block));
        };
        let number = match local {
            Local::State(_) => 2,
            Local::States(_, count) => *count + 1,
            _ => return self.declare(name, Local::State(block)),
        };
        *local = Local::States([*first, name.span], number);
        self.unit.blocks[block.0 as usize].name = format!("{}#{number}", name.name).into();
    }

    /// Reports a local Lustre flow with the name of a constant of the file.
    pub(super) fn hides_nothing(&mut self, name: &Ident) {
        if self.is_rpi() {
            return;
        }
        let Lookup::Found(id) = self
            .c
            .program
            .lookup_in(Space::Value, self.module, &name.name)
        else {
            return;
        };
        let decl = self.c.program.decl(id);
        if matches!(decl.kind, DeclKind::Const(_)) {
            let finding = twice(&name.name, name.span, decl.span);
            self.report(finding);
        }
    }

    /// Adds a flow with a declared type to the current block.
    pub(super) fn declare_flow(&mut self, name: &Ident, port: &PortTy, role: FlowRole) -> FlowId {
        let optional = Optional::Declared(port.optional);
        let flow = self.add_flow(name, port.ty.clone(), optional, role);
        self.declare(name, Local::Flow(flow));
        flow
    }

    /// Adds a flow whose type is inferred from its equation.
    pub(super) fn introduce_flow(&mut self, name: &Ident) -> FlowId {
        let flow = self.add_flow(name, Ty::Unknown, Optional::Inferred, FlowRole::Local);
        self.declare(name, Local::Flow(flow));
        flow
    }

    /// Adds a flow without declaring its name.
    pub(super) fn add_flow(
        &mut self,
        name: &Ident,
        ty: Ty,
        optional: Optional,
        role: FlowRole,
    ) -> FlowId {
        let id = FlowId(u32::try_from(self.unit.flows.len()).unwrap_or(u32::MAX));
        self.unit.flows.push(Flow {
            name: name.name.clone(),
            ty,
            optional,
            role,
            block: self.block,
            clock: None,
            default: None,
            span: name.span,
        });
        self.defined_by.push(None);
        id
    }

    /// Reserves memory for the declarations and equations of a body. Growing a table step by step copies it at every
    /// step, and the system must clear each page of each copy.
    pub(super) fn make_room(&mut self, body: &ast::Body) {
        let flows = self.new_flows(body);
        self.unit.flows.reserve(flows);
        self.defined_by.reserve(flows);
        self.scopes[self.block.0 as usize].reserve(flows);
        let statements = &body.statements;
        self.pending.reserve(statements.len());
        self.current().equations.reserve(statements.len());
        if let [first, .., last] = &statements[..] {
            let letters = last.span.end.saturating_sub(first.span.start) as usize;
            self.unit.exprs.reserve(letters / LETTERS_PER_EXPR);
        }
    }

    /// Returns an upper bound of the number of flows that a body declares or introduces.
    fn new_flows(&self, body: &ast::Body) -> usize {
        let declared = body.locals.iter().map(|section| match section {
            Locals::Var(vars) => vars.iter().map(|var| var.names.len()).sum(),
            Locals::Const(_) => 0,
        });
        let introduced = match self.is_rpi() {
            true => body.statements.len(),
            false => 0,
        };
        declared.sum::<usize>() + introduced
    }

    /// Adds a block inside the current one.
    pub(super) fn add_block(&mut self, name: &Name, span: Span) -> BlockId {
        let id = BlockId(u32::try_from(self.unit.blocks.len()).unwrap_or(u32::MAX));
        self.unit
            .blocks
            .push(Block::new(name.clone(), Some(self.block), span));
        self.scopes.push(Scope::default());
        id
    }
}
