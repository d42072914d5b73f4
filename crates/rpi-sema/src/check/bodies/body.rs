//! State of checking one body. The steps are: declare names, infer types, check.

use crate::check::Checker;
use crate::check::bodies::locals;
use crate::check::bodies::locals::Local;
use crate::check::bodies::locals::Scope;
use crate::check::bodies::type_inference::Guess;
use crate::check::bodies::type_inference::Missing;
use crate::check::bodies::type_inference::Pending;
use crate::check::diagnostics::report;
use crate::check::diagnostics::reported::Told;
use crate::check::exprs::bindings::Bound;
use crate::check::exprs::bindings::Unwatched;
use crate::check::signatures::imported::Import;
use crate::check::signatures::static_args::Statics;
use crate::check::signatures::unit;
use crate::hash::{Map, Set};
use crate::program::{DeclId, ModuleId};
use crate::ty::Ty;
use crate::typed::{Block, BlockId, Expr, ExprId, FlowId, Kind, Unit, UnitKind};
use rpi_diag::{Finding, Span};
use rpi_syntax::ast::Locals;
use rpi_syntax::{Mode, Name};
use std::rc::Rc;

/// Body that is being checked.
pub(crate) struct Body<'c, 'a> {
    pub(crate) c: &'c mut Checker<'a>,
    /// Module of the declaration, in which names are resolved.
    pub(crate) module: ModuleId,
    /// Language of the file, which decides the keywords: RPI or Lustre.
    pub(crate) mode: Mode,
    /// Static arguments of the instance.
    pub(crate) statics: Rc<Statics>,
    /// Typed result so far.
    pub(crate) unit: Unit,
    /// Block whose text is being checked.
    pub(crate) block: BlockId,
    /// Declared names, by block index.
    pub(crate) scopes: Vec<Scope>,
    /// All equations of the body.
    pub(crate) pending: Vec<Pending<'a>>,
    /// For each flow without a declared type, the index in `pending` of the equation that defines it.
    pub(crate) defined_by: Vec<Option<usize>>,
    /// Local declarations by block. Their clocks are resolved when all flows are declared.
    pub(crate) clocks_stated: Vec<(BlockId, &'a [Locals])>,
    /// For each flow local to a state, the shared flow outside that it contributes to.
    pub(crate) shares: Map<FlowId, FlowId>,
    /// For each shared flow, the flows local to states that contribute to it. The inverse of `shares`.
    pub(crate) versions: Map<FlowId, Vec<FlowId>>,
    /// For each shared flow with an equation beside the automaton, the flow of that equation (see `defaults.rs`).
    pub(crate) defaults: Map<FlowId, FlowId>,
    /// Reads of flows whose types were not known yet.
    pub(crate) missing: Vec<Missing>,
    /// Flows that a faulty statement may define. No missing definition is reported for them.
    pub(crate) broken: Vec<FlowId>,
    /// Undefined names of flows that have been reported.
    pub(crate) unknown: Told<Name>,
    /// Flows reported as not usable as clocks.
    pub(crate) no_clocks: Told<FlowId>,
    /// Whether types are being inferred. Errors are reported later, when all types are known.
    pub(crate) inferring: bool,
    /// Policy for guessing types from number literals.
    pub(crate) guesses: Guess,
    /// Whether a signature is being checked, where frames need no declaration.
    pub(crate) in_signature: bool,
    /// Locations of number literals without a unit.
    pub(crate) numbers: Set<Span>,
    /// Location of the first expression with state.
    pub(crate) state_at: Option<Span>,
    /// Names bound by expressions, innermost last.
    pub(crate) bound: Vec<Bound>,
    /// Equations that define an array element by element.
    pub(crate) elements: Vec<&'a rpi_syntax::ast::Equation>,
    /// Number of equations that define parts of a flow, by name.
    pub(crate) parts_defined: Map<Name, u32>,
    /// Number of `pre` operators around the current expression.
    pub(crate) past: u32,
    /// Number of reads of static parameters.
    pub(crate) statics_read: usize,
    /// Number of names bound before the bound variable whose type is being checked. The type must not depend on these.
    pub(crate) fixed_before: Option<usize>,
    /// Whether the current expression is in a branch chosen by a condition on a bound variable.
    pub(crate) guarded: bool,
    /// Contracts imported by the contracts of the body.
    pub(crate) imports: Vec<Import<'a>>,
    /// For each mode of the last checked contract, the condition under which it applies.
    pub(crate) applies: Vec<ExprId>,
    /// Whether the body is that of a declared contract.
    pub(crate) is_contract: bool,
    /// Whether names of callees are resolved as contracts instead of nodes.
    pub(crate) importing: bool,
    /// Modes of the contract being checked.
    pub(crate) modes: Vec<&'a rpi_syntax::ast::ContractMode>,
    /// Modes whose conditions are being checked, each needed by the previous one.
    pub(crate) open_modes: Vec<Name>,
    /// Whether a dependency cycle of modes has been reported.
    pub(crate) ringed_modes: bool,
    /// While a claim is being checked: the first part of it that no run can evaluate.
    pub(crate) claim: Option<Unwatched>,
    /// Whether the body contains an exact time.
    pub(crate) has_times: bool,
    /// Flows declared in seconds, with the locations of their types.
    pub(crate) seconds: Vec<(FlowId, Span)>,
    /// Diagnostics of this body.
    pub(crate) findings: Vec<Finding>,
    /// Index of the diagnostic whose fix writes a number as a real. Adjacent numbers extend this fix.
    pub(crate) made_real: Option<usize>,
}

impl<'c, 'a> Body<'c, 'a> {
    /// Creates the state for the body of a declaration with these static arguments.
    pub(crate) fn new(
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

    /// Creates an empty body for expressions at the top of a module.
    pub(crate) fn around(c: &'c mut Checker<'a>, decl: DeclId) -> Self {
        let unit = Unit::new(Name::from(""), UnitKind::Constant, Span::NONE);
        Body::new(c, decl, Rc::default(), unit)
    }

    /// Moves the diagnostics to the checker and returns the unit.
    pub(crate) fn leave(mut self) -> Unit {
        self.c.findings.append(&mut self.findings);
        self.unit
    }

    /// Adds an expression. A time, or a fixed duration in seconds, is wrapped in a `Part`, which can later be replaced
    /// by a conversion between ticks and seconds.
    pub(crate) fn add(&mut self, kind: Kind, ty: Ty, span: Span) -> ExprId {
        match unit::reads_rpi_syntax(self)
            && crate::check::types::exact_time::may_be_converted(&self.unit, &kind, &ty)
        {
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

    /// Adds an error expression, for an error that has been reported.
    pub(crate) fn fault(&mut self, span: Span) -> ExprId {
        self.add(Kind::Fault, Ty::Unknown, span)
    }

    /// Reports an error and adds an error expression.
    pub(crate) fn fault_with(&mut self, finding: Finding, span: Span) -> ExprId {
        report::report_diagnostic(self, finding);
        self.fault(span)
    }

    /// Returns the type of an expression.
    pub(crate) fn ty_of(&self, id: ExprId) -> &Ty {
        &self.unit.expr(id).ty
    }

    /// Returns the location of an expression.
    pub(crate) fn span_of(&self, id: ExprId) -> Span {
        self.unit.expr(id).span
    }

    /// Runs `work` with `block` as the current block.
    pub(crate) fn within<T>(&mut self, block: BlockId, work: impl FnOnce(&mut Self) -> T) -> T {
        let outer = std::mem::replace(&mut self.block, block);
        let result = work(self);
        self.block = outer;
        result
    }

    /// Returns the current block.
    pub(crate) fn current(&mut self) -> &mut Block {
        &mut self.unit.blocks[self.block.0 as usize]
    }

    /// Returns the flow that a name means in the current block.
    pub(crate) fn local_flow(&self, name: &str) -> Option<FlowId> {
        match locals::find_local(self, name) {
            Some(Local::Flow(flow)) => Some(flow),
            _ => None,
        }
    }

    /// Records an undefined name of a flow; returns whether it has not been reported before.
    pub(crate) fn is_new_unknown(&mut self, name: &Name) -> bool {
        self.unknown.tell(name, self.findings.len())
    }

    /// Records an expression with state. Functions report it, as they must not have state.
    pub(crate) fn has_state(&mut self, span: Span) {
        self.state_at.get_or_insert(span);
    }
}

impl Unit {
    /// Creates an empty unit.
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
