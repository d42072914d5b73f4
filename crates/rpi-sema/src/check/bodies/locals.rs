//! Names inside a body, by block: flows, constants, inline fragments, and states.

use crate::check::Constant;
use crate::check::bodies::body::Body;
use crate::check::diagnostics::report;
use crate::check::signatures::unit;
use crate::check::types::DeclaredType;
use crate::hash::FastMap;
use crate::program::{DeclKind, Lookup, NameSpace, duplicate_name_error};
use crate::ty::Ty;
use crate::typed::{Block, BlockId, Flow, FlowId, FlowPresence, FlowRole};
use rpi_diag::Span;
use rpi_syntax::Name;
use rpi_syntax::ast::{self, Ident, Locals};

/// Meaning of a name inside a body.
#[derive(Clone, Debug)]
pub(crate) enum Local {
    /// Flow of the body: a port or a local flow.
    Flow(FlowId),
    /// Constant bound to the name, such as a static parameter.
    Constant(Constant),
    /// Inline fragment with this block.
    Block(BlockId),
    /// State of an automaton with this block.
    State(BlockId),
    /// Name of states of several automata, so that the name is ambiguous outside of them: the locations of two of these
    /// states, and the number of states.
    AmbiguousState([Span; 2], usize),
}

/// Names that a block declares, with what they refer to.
#[derive(Default, Debug)]
pub(crate) struct Scope {
    /// Meaning of each name, and the location of its declaration.
    names: FastMap<Name, (Local, Span)>,
    /// The same names in the order of their declarations, for the "did you mean" suggestions.
    order: Vec<Name>,
    /// Flows that the inline fragments and states directly in this block declare, with the first block that does.
    inner_flows: FastMap<Name, BlockId>,
}

impl Scope {
    fn reserve(&mut self, names: usize) {
        self.names.reserve(names);
        self.order.reserve(names);
    }
}

/// Estimated number of source characters per expression in dense text, for the size of tables. The estimate may be too
/// low, because reserved memory that is not used costs nothing.
const CHARS_PER_EXPR: usize = 5;

/// Returns the meaning of a name in the current block or the blocks around it; `None` if none of them declares the
/// name.
pub(crate) fn find_local(cx: &Body<'_, '_>, name: &str) -> Option<Local> {
    let mut block = Some(cx.block);
    while let Some(id) = block {
        if let Some((local, _)) = cx.scopes[id.0 as usize].names.get(name) {
            return Some(local.clone());
        }
        block = cx.unit.block(id).parent;
    }
    None
}

/// Returns the meaning of a name in one block, without the blocks around it; `None` if the block does not declare the
/// name.
pub(crate) fn find_in_block(cx: &Body<'_, '_>, block: BlockId, name: &str) -> Option<Local> {
    let scope = &cx.scopes[block.0 as usize];
    scope.names.get(name).map(|(local, _)| local.clone())
}

/// Returns the names visible in the current block, innermost block first.
pub(crate) fn local_names<'s>(cx: &'s Body<'_, '_>) -> impl Iterator<Item = &'s str> {
    let blocks = std::iter::successors(Some(cx.block), |id| cx.unit.block(*id).parent);
    blocks.flat_map(|id| names_in(cx, id))
}

/// Returns the names that one block declares, in text order.
pub(crate) fn names_in<'s>(cx: &'s Body<'_, '_>, block: BlockId) -> impl Iterator<Item = &'s str> {
    cx.scopes[block.0 as usize].order.iter().map(Name::as_str)
}

/// Declares a name in the current block; reports an error if the block already declares it.
pub(crate) fn declare(cx: &mut Body<'_, '_>, name: &Ident, local: Local) {
    let scope = &mut cx.scopes[cx.block.0 as usize];
    match scope.names.get(&name.name) {
        Some((first, place)) => {
            let diagnostic = duplicate_name_error(&name.name, name.span, *place);
            // It is not known which of the two an equation defines, so that neither is reported as undefined.
            for local in [first, &local] {
                if let Local::Flow(flow) = local {
                    cx.reported.erroneous_flows.push(*flow);
                }
            }
            report::report_diagnostic(cx, diagnostic);
        }
        None => {
            let is_flow = matches!(local, Local::Flow(_));
            scope.names.insert(name.name.clone(), (local, name.span));
            scope.order.push(name.name.clone());
            if is_flow {
                record_inner_flow(cx, &name.name);
            }
        }
    }
}

/// Records a flow of the current block, if it has a name, in the block around it.
fn record_inner_flow(cx: &mut Body<'_, '_>, name: &Name) {
    let block = cx.unit.block(cx.block);
    if let Some(parent) = block.parent.filter(|_| !block.name.is_empty()) {
        let around = &mut cx.scopes[parent.0 as usize].inner_flows;
        around.entry(name.clone()).or_insert(cx.block);
    }
}

/// Returns the first inline fragment or state directly in the current block that declares the flow `name`; `None` if
/// none does.
pub(crate) fn inner_block_of_flow(cx: &Body<'_, '_>, name: &str) -> Option<BlockId> {
    let scope = &cx.scopes[cx.block.0 as usize];
    scope.inner_flows.get(name).copied()
}

/// Declares the name of a state of an automaton in the current block. If another automaton of the block has a state of
/// that name, the name becomes ambiguous outside of the automata, and the name of the state's block gets a number
/// (`Run#2`) so that traces can distinguish them.
pub(crate) fn declare_state_name(cx: &mut Body<'_, '_>, name: &Ident, block: BlockId) {
    let scope = &mut cx.scopes[cx.block.0 as usize];
    let Some((local, first)) = scope.names.get_mut(&name.name) else {
        return declare(cx, name, Local::State(block));
    };
    let number = match local {
        Local::State(_) => 2,
        Local::AmbiguousState(_, count) => *count + 1,
        _ => return declare(cx, name, Local::State(block)),
    };
    *local = Local::AmbiguousState([*first, name.span], number);
    cx.unit.blocks[block.0 as usize].name = format!("{}#{number}", name.name).into();
}

/// Reports a local flow of Lustre that has the name of a constant of the same file.
pub(crate) fn report_constant_shadowing(cx: &mut Body<'_, '_>, name: &Ident) {
    if unit::reads_rpi_syntax(cx) {
        return;
    }
    let Lookup::Found(id) = cx
        .checker
        .program
        .lookup_in(NameSpace::Value, cx.module, &name.name)
    else {
        return;
    };
    let decl = cx.checker.program.decl(id);
    if matches!(decl.kind, DeclKind::Const(_)) {
        let diagnostic = duplicate_name_error(&name.name, name.span, decl.span);
        report::report_diagnostic(cx, diagnostic);
    }
}

/// Adds a flow with a declared type to the current block, declares its name, and returns the flow.
pub(crate) fn declare_flow(
    cx: &mut Body<'_, '_>,
    name: &Ident,
    port: &DeclaredType,
    role: FlowRole,
) -> FlowId {
    let optional = FlowPresence::Declared(port.optional);
    let flow = add_flow(cx, name, port.ty.clone(), optional, role);
    declare(cx, name, Local::Flow(flow));
    flow
}

/// Adds a local flow whose type is inferred from its equation to the current block, declares its name, and returns the
/// flow.
pub(crate) fn introduce_flow(cx: &mut Body<'_, '_>, name: &Ident) -> FlowId {
    let flow = add_flow(
        cx,
        name,
        Ty::Unknown,
        FlowPresence::Inferred,
        FlowRole::Local,
    );
    declare(cx, name, Local::Flow(flow));
    flow
}

/// Adds a flow to the current block without making its name visible, and returns the flow.
pub(crate) fn add_flow(
    cx: &mut Body<'_, '_>,
    name: &Ident,
    ty: Ty,
    optional: FlowPresence,
    role: FlowRole,
) -> FlowId {
    let id = FlowId(u32::try_from(cx.unit.flows.len()).unwrap_or(u32::MAX));
    cx.unit.flows.push(Flow {
        name: name.name.clone(),
        ty,
        optional,
        role,
        block: cx.block,
        clock: None,
        default: None,
        span: name.span,
    });
    cx.inference.defined_by.push(None);
    id
}

/// Reserves memory for the declarations and equations of a body. Without it, the tables would be copied each time that
/// they grow, and the system would clear the pages of each copy.
pub(crate) fn reserve_tables(cx: &mut Body<'_, '_>, body: &ast::Body) {
    let flows = max_new_flows(cx, body);
    cx.unit.flows.reserve(flows);
    cx.inference.defined_by.reserve(flows);
    cx.scopes[cx.block.0 as usize].reserve(flows);
    let statements = &body.statements;
    cx.pending.reserve(statements.len());
    cx.current_block().equations.reserve(statements.len());
    if let [first, .., last] = &statements[..] {
        let letters = last.span.end.saturating_sub(first.span.start) as usize;
        cx.unit.exprs.reserve(letters / CHARS_PER_EXPR);
    }
}

/// Returns an upper bound of the number of flows that a body declares or introduces.
fn max_new_flows(cx: &Body<'_, '_>, body: &ast::Body) -> usize {
    let declared = body.locals.iter().map(|section| match section {
        Locals::Var(vars) => vars.iter().map(|var| var.names.len()).sum(),
        Locals::Const(_) => 0,
    });
    let introduced = match unit::reads_rpi_syntax(cx) {
        true => body.statements.len(),
        false => 0,
    };
    declared.sum::<usize>() + introduced
}

/// Adds a block, such as an inline fragment or a state, inside of the current block and returns it.
pub(crate) fn add_block(cx: &mut Body<'_, '_>, name: &Name, span: Span) -> BlockId {
    let id = BlockId(u32::try_from(cx.unit.blocks.len()).unwrap_or(u32::MAX));
    cx.unit
        .blocks
        .push(Block::new(name.clone(), Some(cx.block), span));
    cx.scopes.push(Scope::default());
    id
}
