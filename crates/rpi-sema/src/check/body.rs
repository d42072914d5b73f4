//! The state of checking one body, and its course: declare, infer, check.

use super::Checker;
use super::bound::{Bound, Unwatched};
use super::imported::Import;
use super::locals::{Local, Scope};
use super::order::{Guess, Missing, Pending};
use super::statics::Statics;
use super::told::Told;
use crate::hash::{Map, Set};
use crate::program::{DeclId, ModuleId};
use crate::ty::Ty;
use crate::typed::{Block, BlockId, Expr, ExprId, FlowId, Kind, Unit, UnitKind};
use rpi_diag::{Finding, Span};
use rpi_syntax::ast::Locals;
use rpi_syntax::{Mode, Name};
use std::rc::Rc;

/// One body while it is checked.
pub(super) struct Body<'c, 'a> {
    pub(super) c: &'c mut Checker<'a>,
    pub(super) module: ModuleId,
    /// Which words its file knows.
    pub(super) mode: Mode,
    pub(super) statics: Rc<Statics>,
    pub(super) unit: Unit,
    /// The block whose text is being read.
    pub(super) block: BlockId,
    pub(super) scopes: Vec<Scope>,
    /// The equations, and of each flow without declared type the one that defines it.
    pub(super) pending: Vec<Pending<'a>>,
    pub(super) defined_by: Vec<Option<usize>>,
    /// Declarations of each block, of which the clocks are looked at later.
    pub(super) clocks_stated: Vec<(BlockId, &'a [Locals])>,
    /// For the flow of a state the one outside that it is a version of.
    pub(super) shares: Map<FlowId, FlowId>,
    /// Of each flow that states share their versions of it.
    pub(super) versions: Map<FlowId, Vec<FlowId>>,
    /// Of each flow that states share and an equation beside them defines, too, the flow of that equation.
    pub(super) defaults: Map<FlowId, FlowId>,
    /// Flows that were read before their types were known.
    pub(super) missing: Vec<Missing>,
    /// Flows that a statement with a reported fault seems to define.
    pub(super) broken: Vec<FlowId>,
    /// Names of flows that nothing declares, as far as that has been reported.
    pub(super) unknown: Told<Name>,
    /// Flows that are no clocks, as far as that has been reported.
    pub(super) no_clocks: Told<FlowId>,
    /// Whether types are being looked for: faults are reported later, when all are known.
    pub(super) inferring: bool,
    /// Which numbers tell types, where nothing else does.
    pub(super) guesses: Guess,
    /// Whether a signature is being read, where frames need no declaration.
    pub(super) in_signature: bool,
    /// Where numbers without a unit stand.
    pub(super) numbers: Set<Span>,
    /// Where state was met first.
    pub(super) state_at: Option<Span>,
    /// Names that expressions bring in, innermost last.
    pub(super) bound: Vec<Bound>,
    /// Equations that define arrays element by element.
    pub(super) elements: Vec<&'a rpi_syntax::ast::Equation>,
    /// How many equations define parts of a flow.
    pub(super) parts_defined: Map<Name, u32>,
    /// How many `pre` stand around what is being checked.
    pub(super) past: u32,
    /// How often static parameters have been read.
    pub(super) statics_read: usize,
    /// The names bound before the type of a bound variable: it does not depend on them.
    pub(super) fixed_before: Option<usize>,
    /// Whether a condition about a bound variable decides if what is being checked is computed.
    pub(super) guarded: bool,
    /// The contracts that are taken up, by whichever contract of the body.
    pub(super) imports: Vec<Import<'a>>,
    /// For each mode of the contract that was checked last whether it applies.
    pub(super) applies: Vec<ExprId>,
    /// Whether this is a contract by itself.
    pub(super) is_contract: bool,
    /// Whether contracts are being looked for, not nodes.
    pub(super) importing: bool,
    /// The modes of the contract that is being checked, and those that are being worked out.
    pub(super) modes: Vec<&'a rpi_syntax::ast::ContractMode>,
    pub(super) open_modes: Vec<Name>,
    /// Whether it has been said that modes need themselves.
    pub(super) ringed_modes: bool,
    /// Whether a claim is being checked, and whether it needs more than a run can show.
    pub(super) claim: Option<Unwatched>,
    /// Whether a time has been met.
    pub(super) has_times: bool,
    /// Flows that are declared in seconds, with the places of their types.
    pub(super) seconds: Vec<(FlowId, Span)>,
    pub(super) findings: Vec<Finding>,
    /// Which of them has a fix that writes a number as a real; others beside it may join.
    pub(super) made_real: Option<usize>,
}

impl<'c, 'a> Body<'c, 'a> {
    pub(super) fn new(
        c: &'c mut Checker<'a>,
        decl: DeclId,
        statics: Rc<Statics>,
        unit: Unit,
    ) -> Self {
        let decl = c.program.decl(decl);
        Body {
            module: decl.module,
            mode: decl.mode,
            c,
            statics,
            scopes: unit.blocks.iter().map(|_| Scope::default()).collect(),
            unit,
            block: BlockId::ROOT,
            pending: Vec::new(),
            defined_by: Vec::new(),
            clocks_stated: Vec::new(),
            shares: Map::default(),
            versions: Map::default(),
            defaults: Map::default(),
            missing: Vec::new(),
            broken: Vec::new(),
            unknown: Told::default(),
            no_clocks: Told::default(),
            inferring: false,
            guesses: Guess::Nothing,
            in_signature: false,
            numbers: Set::default(),
            state_at: None,
            bound: Vec::new(),
            elements: Vec::new(),
            parts_defined: Map::default(),
            past: 0,
            statics_read: 0,
            fixed_before: None,
            guarded: false,
            imports: Vec::new(),
            applies: Vec::new(),
            is_contract: false,
            importing: false,
            modes: Vec::new(),
            open_modes: Vec::new(),
            ringed_modes: false,
            claim: None,
            has_times: false,
            seconds: Vec::new(),
            findings: Vec::new(),
            made_real: None,
        }
    }

    /// A body without text of its own, for what stands at the top of a module.
    pub(super) fn around(c: &'c mut Checker<'a>, decl: DeclId) -> Self {
        let unit = Unit::new(Name::from(""), UnitKind::Constant, Span::NONE);
        Body::new(c, decl, Rc::default(), unit)
    }

    /// Ends the work on this body: its findings become the program's.
    pub(super) fn leave(mut self) -> Unit {
        self.c.findings.append(&mut self.findings);
        self.unit
    }

    /// Adds an expression to the table.
    pub(super) fn add(&mut self, kind: Kind, ty: Ty, span: Span) -> ExprId {
        match self.is_rpi() && super::time::may_be_converted(&self.unit, &kind, &ty) {
            true => {
                self.has_times |= ty == Ty::Duration;
                let base = self.push(kind, ty.clone(), span);
                self.push(Kind::Part { base, at: 0 }, ty, span)
            }
            false => self.push(kind, ty, span),
        }
    }

    fn push(&mut self, kind: Kind, ty: Ty, span: Span) -> ExprId {
        let id = ExprId(u32::try_from(self.unit.exprs.len()).unwrap_or(u32::MAX));
        let ty = ty.widened();
        self.unit.exprs.push(Expr { kind, ty, span });
        id
    }

    /// Stands for an expression with a fault that has been reported.
    pub(super) fn fault(&mut self, span: Span) -> ExprId {
        self.add(Kind::Fault, Ty::Unknown, span)
    }

    /// Reports, and stands for the expression.
    pub(super) fn fault_with(&mut self, finding: Finding, span: Span) -> ExprId {
        self.report(finding);
        self.fault(span)
    }

    /// The type of an expression.
    pub(super) fn ty_of(&self, id: ExprId) -> &Ty {
        &self.unit.expr(id).ty
    }

    /// The place of an expression.
    pub(super) fn span_of(&self, id: ExprId) -> Span {
        self.unit.expr(id).span
    }

    /// Runs `work` with another block as the current one.
    pub(super) fn within<T>(&mut self, block: BlockId, work: impl FnOnce(&mut Self) -> T) -> T {
        let outer = std::mem::replace(&mut self.block, block);
        let result = work(self);
        self.block = outer;
        result
    }

    /// The block whose content is being added to.
    pub(super) fn current(&mut self) -> &mut Block {
        &mut self.unit.blocks[self.block.0 as usize]
    }

    /// A flow of this body by its name in the current block.
    pub(super) fn local_flow(&self, name: &str) -> Option<FlowId> {
        match self.find_local(name) {
            Some(Local::Flow(flow)) => Some(flow),
            _ => None,
        }
    }

    /// Whether it is worth saying that nothing declares a flow of this name.
    pub(super) fn is_new_unknown(&mut self, name: &Name) -> bool {
        self.unknown.tell(name, self.findings.len())
    }

    /// Notes that there is state here, for functions, which have none.
    pub(super) fn has_state(&mut self, span: Span) {
        self.state_at.get_or_insert(span);
    }
}

impl Unit {
    /// A unit without content.
    #[must_use]
    pub fn new(name: Name, kind: UnitKind, span: Span) -> Unit {
        Unit {
            name,
            kind,
            span,
            flows: Vec::new(),
            inputs: Vec::new(),
            outputs: Vec::new(),
            exprs: Vec::new(),
            chosen: Vec::new(),
            blocks: vec![Block::new(Name::from(""), None, span)],
            has_clocks: false,
            has_state: false,
            is_lustre: false,
            free_frames: Vec::new(),
            steps: Vec::new(),
            counts: Vec::new(),
        }
    }
}
