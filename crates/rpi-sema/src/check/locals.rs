//! Names inside a body: flows, constants, fragments in place and states, by block.

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

/// What a name inside a body stands for.
#[derive(Clone, Debug)]
pub(super) enum Local {
    /// A flow.
    Flow(FlowId),
    /// A constant.
    Constant(Constant),
    /// A fragment in place.
    Block(BlockId),
    /// A state.
    State(BlockId),
    /// States of several automata: where two of them are declared, and how many there are.
    States([Span; 2], usize),
}

/// The names of one block.
#[derive(Default, Debug)]
pub(super) struct Scope {
    names: Map<Name, (Local, Span)>,
    /// In text order, for "did you mean".
    order: Vec<Name>,
}

impl Scope {
    fn reserve(&mut self, names: usize) {
        self.names.reserve(names);
        self.order.reserve(names);
    }
}

/// How many letters of a text are one expression, where these stand close: memory that is reserved and not used costs
/// nothing.
const LETTERS_PER_EXPR: usize = 5;

impl Body<'_, '_> {
    /// What a name means here: in this block, or else in those around it.
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

    /// What a name means in one block alone.
    pub(super) fn find_in(&self, block: BlockId, name: &str) -> Option<Local> {
        let scope = &self.scopes[block.0 as usize];
        scope.names.get(name).map(|(local, _)| local.clone())
    }

    /// The names that can be seen from here, nearest block first.
    pub(super) fn local_names(&self) -> impl Iterator<Item = &str> {
        let blocks = std::iter::successors(Some(self.block), |id| self.unit.block(*id).parent);
        blocks.flat_map(|id| self.names_in(id))
    }

    /// The names of one block in text order.
    pub(super) fn names_in(&self, block: BlockId) -> impl Iterator<Item = &str> {
        self.scopes[block.0 as usize].order.iter().map(Name::as_str)
    }

    /// Gives a name a meaning in the current block; a second meaning is reported.
    pub(super) fn declare(&mut self, name: &Ident, local: Local) {
        let scope = &mut self.scopes[self.block.0 as usize];
        match scope.names.get(&name.name) {
            Some((first, place)) => {
                let finding = twice(&name.name, name.span, *place);
                // Which of them an equation means is not known.
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

    /// Gives a state its name. Another automaton may have a state of that name: then it stands for neither outside of them,
    /// and a number tells them apart in traces.
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

    /// In Lustre a local flow is not called like a constant of the file.
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

    /// Adds a declared flow to the current block.
    pub(super) fn declare_flow(&mut self, name: &Ident, port: &PortTy, role: FlowRole) -> FlowId {
        let optional = Optional::Declared(port.optional);
        let flow = self.add_flow(name, port.ty.clone(), optional, role);
        self.declare(name, Local::Flow(flow));
        flow
    }

    /// Adds a flow whose type is that of its equation.
    pub(super) fn introduce_flow(&mut self, name: &Ident) -> FlowId {
        let flow = self.add_flow(name, Ty::Unknown, Optional::Inferred, FlowRole::Local);
        self.declare(name, Local::Flow(flow));
        flow
    }

    /// Adds a flow to the table, without a meaning for its name.
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

    /// Makes room for what a body declares, all at once: a table that grows step by step is copied at every step, and each
    /// page of each copy is one that the system has to clear.
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

    /// How many flows a body declares or introduces, at most.
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
