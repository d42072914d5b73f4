//! State of checking one body. The steps are: declare names, infer types, check.

use crate::check::Checker;
use crate::check::bodies::locals;
use crate::check::bodies::locals::Local;
use crate::check::bodies::locals::Scope;
use crate::check::bodies::type_inference::GuessPolicy;
use crate::check::bodies::type_inference::PendingEquation;
use crate::check::bodies::type_inference::UnknownRead;
use crate::check::diagnostics::report;
use crate::check::diagnostics::reported::ReportedErrors;
use crate::check::exprs::bindings::Binding;
use crate::check::exprs::bindings::NotEvaluable;
use crate::check::limits::nesting;
use crate::check::signatures::imported::ContractInstance;
use crate::check::signatures::static_args::StaticBindings;
use crate::check::signatures::unit;
use crate::hash::{FastMap, FastSet};
use crate::program::{DeclId, ModuleId};
use crate::ty::Ty;
use crate::typed::{Block, BlockId, ExprId, FlowId, Unit, UnitKind};
use crate::typed::{Expr, TypedKind};
use rpi_diag::{Diagnostic, Span};
use rpi_syntax::ast::Locals;
use rpi_syntax::{Dialect, Name};
use std::rc::Rc;

/// State of checking one body: its declared names, equations and typed result so far.
pub(crate) struct Body<'c, 'a> {
    pub(crate) checker: &'c mut Checker<'a>,
    /// Module of the declaration, in which names are resolved.
    pub(crate) module: ModuleId,
    /// Language of the file, which decides the keywords: RPI or Lustre.
    pub(crate) mode: Dialect,
    /// Static arguments of the instance that is checked.
    pub(crate) statics: Rc<StaticBindings>,
    /// Number of reads of static parameters.
    pub(crate) static_read_count: usize,
    /// Typed result so far.
    pub(crate) unit: Unit,
    /// Block whose text is being checked.
    pub(crate) block: BlockId,
    /// Declared names, by block index.
    pub(crate) scopes: Vec<Scope>,
    /// Names bound by expressions around the current one, such as quantified variables.
    pub(crate) bindings: Bindings,
    /// All equations of the body, which are checked after the declarations.
    pub(crate) pending: Vec<PendingEquation<'a>>,
    /// Declarations and equations that are resolved when all flows are declared.
    pub(crate) definitions: Definitions<'a>,
    /// Flows that the states of an automaton define together.
    pub(crate) shared: SharedFlows,
    /// Inference of the types of flows without a declared type.
    pub(crate) inference: Inference,
    /// Use of exact time in the body.
    pub(crate) times: Times,
    /// What the checks of the body's contracts share.
    pub(crate) contract: Contracts<'a>,
    /// Whether a signature is being checked, where frames need no declaration.
    pub(crate) in_signature: bool,
    /// Location of the first expression with state.
    pub(crate) first_state_span: Option<Span>,
    /// Diagnostics of this body.
    pub(crate) diagnostics: Vec<Diagnostic>,
    /// Names and flows with a reported error.
    pub(crate) reported: Reported,
}

/// Names bound by expressions, and where in these expressions the current one is.
#[derive(Default)]
pub(crate) struct Bindings {
    /// Bound names, innermost last.
    pub(crate) bound_names: Vec<Binding>,
    /// Number of `pre` operators around the current expression.
    pub(crate) pre_depth: u32,
    /// Number of names bound before the bound variable whose type is being checked. The type must not depend on these.
    pub(crate) forbidden: Option<usize>,
    /// Whether the current expression is in a branch chosen by a condition on a bound variable.
    pub(crate) in_guarded_branch: bool,
    /// Branches of `if` around the current expression: the condition, and its value for which the branch is taken.
    pub(crate) branches: Vec<(ExprId, bool)>,
    /// Call of a function of another language around the current expression. Undefined names in it are of that language
    /// as well, and are not reported.
    pub(crate) foreign_call: Option<Span>,
}

/// Declarations and equations that are resolved when all flows of the body are declared.
#[derive(Default)]
pub(crate) struct Definitions<'a> {
    /// Local declarations by block; their clocks are resolved after type inference.
    pub(crate) declared_clocks: Vec<(BlockId, &'a [Locals])>,
    /// Equations that define an array element by element.
    pub(crate) element_equations: Vec<&'a rpi_syntax::ast::Equation>,
    /// Number of equations that define parts of a flow, by name.
    pub(crate) part_equation_counts: FastMap<Name, u32>,
}

/// Flows that the states of an automaton define together.
#[derive(Default)]
pub(crate) struct SharedFlows {
    /// For each flow local to a state, the shared flow to which it contributes.
    pub(crate) flow_of: FastMap<FlowId, FlowId>,
    /// For each shared flow, the flows local to states that contribute to it. The inverse of `flow_of`.
    pub(crate) contributions: FastMap<FlowId, Vec<FlowId>>,
    /// For each shared flow with an equation beside the automaton, the flow of that equation (see `defaults.rs`).
    pub(crate) defaults: FastMap<FlowId, FlowId>,
}

/// State of the inference of types.
#[derive(Default)]
pub(crate) struct Inference {
    /// Whether types are being inferred. Errors are reported later, when all types are known.
    pub(crate) is_running: bool,
    /// For each flow without a declared type, the index in `pending` of the equation that defines it.
    pub(crate) defined_by: Vec<Option<usize>>,
    /// Reads of flows whose types were not known yet.
    pub(crate) unknown_reads: Vec<UnknownRead>,
    /// Policy for guessing types from number literals.
    pub(crate) guess_policy: GuessPolicy,
    /// Locations of number literals without a unit.
    pub(crate) number_literals: FastSet<Span>,
    /// Index of the latest diagnostic with a fix that writes a number as a real. Adjacent numbers extend this fix.
    pub(crate) real_fix_index: Option<usize>,
}

/// Use of exact time in the body.
#[derive(Default)]
pub(crate) struct Times {
    /// Whether the body contains an exact time.
    pub(crate) are_used: bool,
    /// Flows declared in seconds, with the locations of their types.
    pub(crate) declared_seconds: Vec<(FlowId, Span)>,
}

/// State of checking the contracts of the body.
#[derive(Default)]
pub(crate) struct Contracts<'a> {
    /// Contracts imported by the contracts of the body.
    pub(crate) imports: Vec<ContractInstance<'a>>,
    /// Whether the body is that of a declared contract.
    pub(crate) is_contract: bool,
    /// Sections of local declarations of the body, while a contract is checked that does not see them.
    pub(crate) hidden_locals: &'a [rpi_syntax::ast::Locals],
    /// Whether names of callees are resolved as contracts instead of nodes.
    pub(crate) resolving_contract: bool,
    /// Modes of the contract being checked.
    pub(crate) modes: Vec<&'a rpi_syntax::ast::ContractMode>,
    /// For each mode of the last checked contract, the condition under which it applies.
    pub(crate) mode_conditions: Vec<ExprId>,
    /// Modes whose conditions are being checked, each needed by the previous one.
    pub(crate) modes_in_progress: Vec<Name>,
    /// Whether a dependency cycle of modes has been reported.
    pub(crate) mode_cycle_reported: bool,
    /// While a claim is being checked: the first part of it that no run can evaluate.
    pub(crate) claim_check: Option<NotEvaluable>,
}

/// Names and flows with a reported error, for which nothing more is reported.
#[derive(Default)]
pub(crate) struct Reported {
    /// Flows that a faulty statement may define. No missing definition is reported for them.
    pub(crate) erroneous_flows: Vec<FlowId>,
    /// Undefined names of flows.
    pub(crate) undefined_names: ReportedErrors<Name>,
    /// Undefined names that were reported as those of flows, with their diagnostics.
    pub(crate) undefined_flows: ReportedErrors<Name>,
    /// Flows that cannot be clocks.
    pub(crate) invalid_clocks: ReportedErrors<FlowId>,
}

impl<'c, 'a> Body<'c, 'a> {
    /// Creates the state for the body of a declaration with these static arguments.
    pub(crate) fn new(
        checker: &'c mut Checker<'a>,
        decl: DeclId,
        statics: Rc<StaticBindings>,
        unit: Unit,
    ) -> Self {
        let decl = checker.program.decl(decl);
        Body {
            module: decl.module,
            mode: decl.mode,
            checker,
            statics,
            static_read_count: 0,
            scopes: unit.blocks.iter().map(|_| Scope::default()).collect(),
            unit,
            block: BlockId::ROOT,
            bindings: Bindings::default(),
            pending: Vec::new(),
            definitions: Definitions::default(),
            shared: SharedFlows::default(),
            inference: Inference::default(),
            times: Times::default(),
            contract: Contracts::default(),
            in_signature: false,
            first_state_span: None,
            diagnostics: Vec::new(),
            reported: Reported::default(),
        }
    }

    /// Creates an empty body for expressions at the top of a module.
    pub(crate) fn for_top_level(c: &'c mut Checker<'a>, decl: DeclId) -> Self {
        let unit = Unit::new(Name::from(""), UnitKind::Constant, Span::NONE);
        Body::new(c, decl, Rc::default(), unit)
    }

    /// Moves the diagnostics to the checker and returns the unit.
    pub(crate) fn finish(mut self) -> Unit {
        self.checker.diagnostics.append(&mut self.diagnostics);
        self.unit
    }

    /// Adds an expression. A time, or a fixed duration in seconds, is wrapped in a `Part`, which can later be replaced
    /// by a conversion between ticks and seconds.
    pub(crate) fn add(&mut self, kind: TypedKind, ty: Ty, span: Span) -> ExprId {
        let (kind, ty) = match nesting::may_hold(self, &ty, span) {
            true => (kind, ty),
            false => (TypedKind::Error, Ty::Unknown),
        };
        match unit::reads_rpi_syntax(self)
            && crate::check::types::exact_time::may_be_converted(&self.unit, &kind, &ty)
        {
            true => {
                self.times.are_used |= ty == Ty::Duration;
                let base = self.push(kind, ty.clone(), span);
                self.push(TypedKind::Part { base, at: 0 }, ty, span)
            }
            false => self.push(kind, ty, span),
        }
    }

    fn push(&mut self, kind: TypedKind, ty: Ty, span: Span) -> ExprId {
        let id = ExprId(u32::try_from(self.unit.exprs.len()).unwrap_or(u32::MAX));
        let ty = ty.widened();
        self.unit.exprs.push(Expr { kind, ty, span });
        id
    }

    /// Adds an error expression, for an error that has been reported.
    pub(crate) fn error_expr(&mut self, span: Span) -> ExprId {
        self.add(TypedKind::Error, Ty::Unknown, span)
    }

    /// Reports an error and adds an error expression.
    pub(crate) fn report_error_expr(&mut self, diagnostic: Diagnostic, span: Span) -> ExprId {
        report::report_diagnostic(self, diagnostic);
        self.error_expr(span)
    }

    /// Returns the type that the checker has inferred for an expression.
    pub(crate) fn ty_of(&self, id: ExprId) -> &Ty {
        &self.unit.expr(id).ty
    }

    /// Returns the location of an expression.
    pub(crate) fn span_of(&self, id: ExprId) -> Span {
        self.unit.expr(id).span
    }

    /// Runs `work` with `block` as the current block, then restores the previous one.
    pub(crate) fn in_block<T>(&mut self, block: BlockId, work: impl FnOnce(&mut Self) -> T) -> T {
        let outer = std::mem::replace(&mut self.block, block);
        let result = work(self);
        self.block = outer;
        result
    }

    /// Returns the block whose statements are being checked: a body, an inline fragment, a state or a contract.
    pub(crate) fn current_block(&mut self) -> &mut Block {
        &mut self.unit.blocks[self.block.0 as usize]
    }

    /// Returns the flow that a name means in the current block.
    pub(crate) fn find_flow(&self, name: &str) -> Option<FlowId> {
        match locals::find_local(self, name) {
            Some(Local::Flow(flow)) => Some(flow),
            _ => None,
        }
    }

    /// Records an undefined name of a flow; returns whether it has not been reported before.
    pub(crate) fn record_undefined(&mut self, name: &Name) -> bool {
        self.reported
            .undefined_names
            .record(name, self.diagnostics.len())
    }

    /// Records an expression with state in the body. Functions report it, as they must not have state.
    pub(crate) fn record_state(&mut self, span: Span) {
        self.first_state_span.get_or_insert(span);
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
            static_conditions: Vec::new(),
            blocks: vec![Block::new(Name::from(""), None, span)],
            has_clocks: false,
            has_state: false,
            is_lustre: false,
            free_frames: Vec::new(),
            steps: Vec::new(),
            repeat_counts: Vec::new(),
        }
    }
}
