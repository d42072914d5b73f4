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
use rpi_diag::{Diagnostic, Fix, Span};
use rpi_syntax::ast::Locals;
use rpi_syntax::{Dialect, Name};
use std::rc::Rc;

/// State of checking the body of one declaration, such as a node, command or task: its declared names, its equations,
/// and the typed result so far.
pub(crate) struct Body<'c, 'a> {
    pub(crate) checker: &'c mut Checker<'a>,
    /// Module that contains the declaration. Names that the body does not declare are resolved in this module.
    pub(crate) module: ModuleId,
    /// Language of the file, which decides the keywords: RPI or Lustre.
    pub(crate) mode: Dialect,
    /// Values of the static parameters for which this instance of the declaration is checked, by name.
    pub(crate) statics: Rc<StaticBindings>,
    /// Number of times that the check has read the value of a static parameter so far. A difference shows whether an
    /// expression depends on one.
    pub(crate) static_read_count: usize,
    /// Typed form of the body so far: its flows, expressions and blocks.
    pub(crate) unit: Unit,
    /// Block whose statements are being checked: the whole body, an inline fragment, a state of an automaton, or a
    /// contract.
    pub(crate) block: BlockId,
    /// Names that each block declares, indexed by block.
    pub(crate) scopes: Vec<Scope>,
    /// Names bound by the expressions around the expression that is being checked, such as the variables of
    /// quantifiers.
    pub(crate) bindings: Bindings,
    /// All equations of the body. They are checked after all flows are declared.
    pub(crate) pending: Vec<PendingEquation<'a>>,
    /// Declarations and equations that can be resolved only after all flows of the body are declared.
    pub(crate) definitions: Definitions<'a>,
    /// Flows that several states of an automaton define.
    pub(crate) shared: SharedFlows,
    /// State of inferring the types of flows without a declared type.
    pub(crate) inference: Inference,
    /// Uses of exact time (whole ticks) in the body.
    pub(crate) times: Times,
    /// State of checking the contracts of the body: imports, modes, and the claim being checked.
    pub(crate) contract: Contracts<'a>,
    /// Whether the ports of a declaration are being checked. In ports, a frame name that is not declared stands for any
    /// frame.
    pub(crate) in_signature: bool,
    /// Location of the first expression with state, such as `pre x`; `None` if no expression so far has state.
    pub(crate) first_state_span: Option<Span>,
    /// Diagnostics of this body so far. `finish` moves them to the checker.
    pub(crate) diagnostics: Vec<Diagnostic>,
    /// Names and flows with a reported error, so that no further errors are reported for them.
    pub(crate) reported: Reported,
}

/// Names bound by the expressions around the current expression, and the operators and branches around it.
#[derive(Default)]
pub(crate) struct Bindings {
    /// Names bound by the expressions around the current expression, innermost last.
    pub(crate) bound_names: Vec<Binding>,
    /// Number of delay operators such as `pre` around the current expression.
    pub(crate) pre_depth: u32,
    /// While the type of a quantified variable is being checked: the number of names bound before it. The type must not
    /// depend on these names. `None` otherwise.
    pub(crate) forbidden: Option<usize>,
    /// Whether the current expression is in a branch of an `if` whose condition reads a quantified variable or an array
    /// index.
    pub(crate) in_guarded_branch: bool,
    /// Branches of `if` around the current expression: the condition of the `if`, and whether the branch is the one for
    /// a true condition.
    pub(crate) branches: Vec<(ExprId, bool)>,
    /// Location of the call of a function of another language, such as `printf(x)`, around the current expression.
    /// Undefined names in its arguments are assumed to be of that language as well and are not reported. `None` outside
    /// of such a call.
    pub(crate) foreign_call: Option<Span>,
}

/// Local declarations and equations that can be resolved only when all flows of the body are declared.
#[derive(Default)]
pub(crate) struct Definitions<'a> {
    /// Sections of local declarations of each block. The clocks that they state (`var x: int when c`) are resolved
    /// after type inference.
    pub(crate) declared_clocks: Vec<(BlockId, &'a [Locals])>,
    /// Equations that define an array element by element, such as `a[i] = b[i] + 1`.
    pub(crate) element_equations: Vec<&'a rpi_syntax::ast::Equation>,
    /// Number of equations that define a part of the flow with this name, such as `a[0] = 1`.
    pub(crate) part_equation_counts: FastMap<Name, u32>,
}

/// Flows that several states of an automaton define. Each such shared flow has a local version in each of these states.
#[derive(Default)]
pub(crate) struct SharedFlows {
    /// For each flow local to a state, the flow outside of the automaton whose value it gives while the state is
    /// active.
    pub(crate) flow_of: FastMap<FlowId, FlowId>,
    /// For each flow that an automaton defines, the flows local to its states that give its value. The inverse of
    /// `flow_of`.
    pub(crate) contributions: FastMap<FlowId, Vec<FlowId>>,
    /// For each flow that an automaton defines and that also has an equation beside the automaton, the flow with the
    /// value of that equation. The value is the default in states without an equation for the flow.
    pub(crate) defaults: FastMap<FlowId, FlowId>,
}

/// State of inferring the types of flows without a declared type.
#[derive(Default)]
pub(crate) struct Inference {
    /// Whether types are being inferred. Errors are not reported until the types of all flows are known.
    pub(crate) is_running: bool,
    /// For each flow, indexed by flow, the index in `pending` of the equation from which its type is inferred; `None`
    /// for a flow with a declared type.
    pub(crate) defined_by: Vec<Option<usize>>,
    /// Reads of flows of unknown type in the equation that is being checked.
    pub(crate) unknown_reads: Vec<UnknownRead>,
    /// Which types may be guessed from number literals when nothing else determines the type of a flow.
    pub(crate) guess_policy: GuessPolicy,
    /// Locations of the number literals that are written without a unit.
    pub(crate) number_literals: FastSet<Span>,
    /// Flows declared in per cent, `real[%]`.
    pub(crate) per_cent_flows: FastSet<FlowId>,
    /// Index of the latest diagnostic if its fix writes an integer literal as a real. The fix is extended to further
    /// integers in the same expression. `None` if no such fix can be extended.
    pub(crate) real_fix_index: Option<usize>,
    /// Index of the latest diagnostic about an integer and a real literal of which either may be wrong, with the fix that
    /// writes the real one as an integer.
    pub(crate) integer_fix: Option<(usize, Fix)>,
}

/// Uses of exact time (whole ticks) in the body.
#[derive(Default)]
pub(crate) struct Times {
    /// Whether the body contains an expression whose type is an exact time.
    pub(crate) are_used: bool,
    /// Flows declared as a real in seconds, with the locations of their declared types.
    pub(crate) declared_seconds: Vec<(FlowId, Span)>,
}

/// State of checking the contracts of the body.
#[derive(Default)]
pub(crate) struct Contracts<'a> {
    /// Contracts that the contracts of the body import, with their arguments.
    pub(crate) imports: Vec<ContractInstance<'a>>,
    /// Local declarations of the body while its contract is checked, which must not read them; empty otherwise.
    pub(crate) hidden_locals: &'a [rpi_syntax::ast::Locals],
    /// Whether the name in a call is resolved as a contract, because an import is being checked, and not as a node.
    pub(crate) resolving_contract: bool,
    /// Modes of the contract that is being checked.
    pub(crate) modes: Vec<&'a rpi_syntax::ast::ContractMode>,
    /// For each mode of the last checked contract, in text order, the condition under which the mode applies.
    pub(crate) mode_conditions: Vec<ExprId>,
    /// Names of the modes whose conditions are being checked. The condition of each mode reads the next mode.
    pub(crate) modes_in_progress: Vec<Name>,
    /// Whether a dependency cycle of modes has been reported. Only one is reported for each body.
    pub(crate) mode_cycle_reported: bool,
    /// The first part of the claim being checked that cannot be evaluated at run time, such as a quantifier; `None`
    /// while no claim is being checked.
    pub(crate) claim_check: Option<NotEvaluable>,
}

/// Names and flows with a reported error, for which no further error is reported.
#[derive(Default)]
pub(crate) struct Reported {
    /// Flows whose definition has a reported error. No missing definition is reported for them.
    pub(crate) erroneous_flows: Vec<FlowId>,
    /// Names that were read or defined as flows and are not declared, with their diagnostics.
    pub(crate) undefined_names: ReportedErrors<Name>,
    /// Names for which the read of an undefined flow has been reported. An equation for the same name adds a help text
    /// to that diagnostic.
    pub(crate) undefined_flows: ReportedErrors<Name>,
    /// Flows that were used as a clock although they are no Boolean or enum, with their diagnostics.
    pub(crate) invalid_clocks: ReportedErrors<FlowId>,
}

impl<'c, 'a> Body<'c, 'a> {
    /// Creates the state for checking the body of `decl`. `statics` are the values of its static parameters, and `unit`
    /// is the typed result to be completed.
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

    /// Creates an empty body for checking an expression outside of any declaration with a body, such as the value of a
    /// global constant. `decl` decides the module and the language.
    pub(crate) fn for_top_level(c: &'c mut Checker<'a>, decl: DeclId) -> Self {
        let unit = Unit::new(Name::from(""), UnitKind::Constant, Span::NONE);
        Body::new(c, decl, Rc::default(), unit)
    }

    /// Ends the check: moves the diagnostics of the body to the checker and returns the typed unit.
    pub(crate) fn finish(mut self) -> Unit {
        self.checker.diagnostics.append(&mut self.diagnostics);
        self.unit
    }

    /// Adds an expression to the typed unit and returns its identifier. A time, or a fixed duration in seconds, is
    /// wrapped in a `Part` expression, which can later be replaced by a conversion between ticks and seconds.
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

    /// Adds an expression of unknown type that stands for an expression with a reported error, and returns its
    /// identifier.
    pub(crate) fn error_expr(&mut self, span: Span) -> ExprId {
        self.add(TypedKind::Error, Ty::Unknown, span)
    }

    /// Reports a diagnostic, and adds an expression of unknown type in place of the expression with the error.
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

    /// Returns the flow with this name that is visible in the current block; `None` if the name is undefined or has
    /// another meaning.
    pub(crate) fn find_flow(&self, name: &str) -> Option<FlowId> {
        match locals::find_local(self, name) {
            Some(Local::Flow(flow)) => Some(flow),
            _ => None,
        }
    }

    /// Records that a name of a flow is undefined. Returns whether it is the first record of the name, so that each
    /// name is reported once.
    pub(crate) fn record_undefined(&mut self, name: &Name) -> bool {
        self.reported
            .undefined_names
            .record(name, self.diagnostics.len())
    }

    /// Records that an expression with this location has state, as in `pre x`. Only the first location is stored. A
    /// body with state is an error in a function.
    pub(crate) fn record_state(&mut self, span: Span) {
        self.first_state_span.get_or_insert(span);
    }
}

impl Unit {
    /// Creates a unit without flows, with one empty block.
    #[must_use]
    pub fn new(name: Name, kind: UnitKind, span: Span) -> Unit {
        Unit {
            name,
            kind,
            is_contract: false,
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
            identity_defaults: Vec::new(),
            steps: Vec::new(),
            repeat_counts: Vec::new(),
        }
    }
}
