//! Elaborates calls by inlining the callee at the place of the call.

use crate::elab::expr::leaf_scalars;
use crate::elab::families::Family;
use crate::elab::scope::{Scope, State};
use crate::elab::signal::{Signal, Wire};
use crate::elab::{At, Elab, MAX_DEPTH, Mode, NotConstant};
use crate::typed::{Activation, BlockId, Call, ExprId, Unit, UnitId, UnitKind};
use rpi_diag::{Code, Finding, Span};
use rpi_image::{Scalar, Value};
use rpi_net::{self as net, Absent, Fragment, FragmentId, Origin, PortRef, Restart};

/// A call that does not run in all cycles.
struct Run {
    /// Condition under which the call runs.
    every: Signal,
    /// Results of the call when it runs, and their defaults before its first run.
    result: Wire,
    default: Option<Wire>,
    /// For each leaf of the results, whether it may be absent when the call runs.
    optional: Vec<bool>,
}

/// Argument of a call: its wire and its span.
pub(in crate::elab) struct Arg {
    wire: Wire,
    span: Span,
}

impl<'u> Elab<'u> {
    /// Elaborates a call expression according to its activation.
    pub(in crate::elab) fn call(
        &mut self,
        scope: &mut Scope<'u>,
        call: &'u Call,
        id: ExprId,
        at: At,
    ) -> Wire {
        let span = scope.unit.expr(id).span;
        let args = self.arguments(scope, call, id, at);
        let path = self.path(id);
        match &call.activation {
            Activation::Always => self.results_of(scope, call, (id, &args), at, path),
            Activation::Restart { every } => {
                let every = self.operand(scope, [id, *every], at.unguarded());
                let Some(every) = self.port_of(&every, Scalar::Bool, at, span) else {
                    return crate::elab::signal::nothing();
                };
                let activation = net::Activation::Always;
                let inner =
                    self.fragment(&path, at.fragment, activation, Restart::Every(every), span);
                self.results_of(scope, call, (id, &args), At::fragment(inner), path)
            }
            Activation::Condact {
                every,
                default,
                restart,
            } => {
                let every = self.operand(scope, [id, *every], at.unguarded());
                let restart = restart.map(|restart| [id, restart]);
                let inner = self.activated(scope, &every, restart, &path, at, span);
                self.keeps_results = !scope.unit.is_lustre;
                let result = self.results_of(scope, call, (id, &args), At::fragment(inner), path);
                let result = self.leaving(&result, inner, at.fragment);
                let default =
                    default.map(|one| self.operand_wire(scope, [id, one], at.unguarded()));
                let callee = &self.units[call.unit.0 as usize];
                let run = Run {
                    every,
                    result,
                    default,
                    optional: callee.optional_leaves().collect(),
                };
                self.held(&run, id, scope, at)
            }
        }
    }

    fn arguments(
        &mut self,
        scope: &mut Scope<'u>,
        call: &'u Call,
        id: ExprId,
        at: At,
    ) -> Vec<Option<Arg>> {
        let callee = &self.units[call.unit.0 as usize];
        let given = match self.is_guarded(call) {
            true => at,
            // A callee with state runs in all cycles, whichever branch of an `if` is chosen, so its arguments are not
            // guarded.
            false => at.unguarded(),
        };
        let mut args = Vec::with_capacity(call.args.len());
        for (port, arg) in callee.inputs.iter().zip(&call.args) {
            let count = callee.flow(*port).ty.leaf_count();
            let is_sampled = callee.flow(*port).clock.is_some();
            args.push(arg.map(|arg| Arg {
                wire: match is_sampled {
                    true => self.wide(scope, arg, count, given),
                    false => self.argument(scope, [id, arg], count, given),
                },
                span: scope.unit.expr(arg).span,
            }));
        }
        args
    }

    /// Inlines a call at `at` and binds the deciders that it exposes.
    fn results_of(
        &mut self,
        scope: &mut Scope<'u>,
        call: &'u Call,
        (id, args): (ExprId, &[Option<Arg>]),
        at: At,
        path: String,
    ) -> Wire {
        let span = scope.unit.expr(id).span;
        let wire = self.inlined(call.unit, args, at, path, span);
        let exposed = std::mem::take(&mut self.exposed);
        self.bind_inside(scope, id, exposed);
        wire
    }

    /// Returns an argument of a call. Its leaves are absent where the clock of the call ticks and their own does not.
    fn argument(
        &mut self,
        scope: &mut Scope<'u>,
        [id, arg]: [ExprId; 2],
        count: usize,
        at: At,
    ) -> Wire {
        let wire = self.operand_wire(scope, [id, arg], at);
        match (&wire[..], count) {
            ([Signal::Absent], n) if n != 1 => (0..n).map(|_| Signal::Absent).collect(),
            _ => wire,
        }
    }

    /// Returns the path for the nodes of an expression: the name of the flow if the expression is the flow's whole
    /// value, else a numbered name.
    fn path(&mut self, id: ExprId) -> String {
        if self.top == Some(id) {
            return self.name.clone();
        }
        self.serial += 1;
        format!("{}#{}", self.name, self.serial - 1)
    }

    fn activated(
        &mut self,
        scope: &mut Scope<'u>,
        every: &Signal,
        restart: Option<[ExprId; 2]>,
        path: &str,
        at: At,
        span: Span,
    ) -> FragmentId {
        let at = at.unguarded();
        let restart = restart.map(|pair| self.operand(scope, pair, at));
        let restart = restart.and_then(|signal| self.port_of(&signal, Scalar::Bool, at, span));
        let restart = restart.map_or(Restart::Never, Restart::Every);
        let activation = self.when(every, at, span);
        self.fragment(path, at.fragment, activation, restart, span)
    }

    /// Returns the activation by a condition; `Always` for the constant `true`.
    pub(in crate::elab) fn when(
        &mut self,
        condition: &Signal,
        at: At,
        span: Span,
    ) -> net::Activation {
        if *condition == Signal::Const(Value::bool(true)) {
            return net::Activation::Always;
        }
        match self.port_of(condition, Scalar::Bool, at, span) {
            Some(condition) => net::Activation::When {
                condition,
                absent: Absent::Inactive,
            },
            None => net::Activation::Always,
        }
    }

    /// Adds a fragment to the net.
    pub(in crate::elab) fn fragment(
        &mut self,
        path: &str,
        parent: FragmentId,
        activation: net::Activation,
        restart: Restart,
        span: Span,
    ) -> FragmentId {
        self.net.add_fragment(Fragment {
            name: path.to_owned(),
            parent: Some(parent),
            activation,
            restart,
            is_clock: false,
            inputs: Vec::new(),
            outputs: Vec::new(),
            budget_ns: None,
            origin: Origin {
                span,
                flow: Some(path.to_owned()),
            },
        })
    }

    /// Returns the results of a call that does not run in all cycles: those of this cycle, or those of its last run.
    fn held(&mut self, run: &Run, id: ExprId, scope: &Scope<'u>, at: At) -> Wire {
        let span = scope.unit.expr(id).span;
        let scalars = leaf_scalars(&scope.unit.expr(id).ty);
        let leaves = scalars.into_iter().take(run.result.len()).enumerate();
        let leaves: Vec<Signal> = leaves
            .map(|(k, scalar)| self.held_leaf(run, k, scalar, at, span))
            .collect();
        leaves.into()
    }

    fn held_leaf(&mut self, run: &Run, k: usize, scalar: Scalar, at: At, span: Span) -> Signal {
        let signal = run.result[k].clone();
        let default = run.default.as_ref().and_then(|wire| wire.get(k)).cloned();
        let is_optional = run.optional.get(k).copied().unwrap_or_default();
        if let (Some(default @ Signal::Const(_)), false) = (&default, is_optional) {
            return self.family(Family::Hold, scalar, &[signal, default.clone()], at, span);
        }
        let result = self.new_alias(scalar);
        let alias = Signal::Port(result);
        let pre = match default.is_none() || is_optional {
            true => Family::OptionalPre,
            false => Family::Pre,
        };
        let before = self.delay(pre, scalar, &alias, at, span);
        let before = match default {
            None => before,
            Some(default) => {
                let first = self.first(at.fragment, span);
                let inputs = [first, default, before];
                self.family(Family::Conditional, scalar, &inputs, at, span)
            }
        };
        let held = match is_optional {
            // A run whose result is absent is remembered as absent, too.
            true => {
                let inputs = [run.every.clone(), signal, before];
                self.family(Family::Conditional, scalar, &inputs, at, span)
            }
            false => self.family(Family::Coalesce, scalar, &[signal, before], at, span),
        };
        self.bind_alias(result, &held);
        held
    }

    /// Inlines a unit with its inputs connected and returns its outputs.
    pub(in crate::elab) fn inlined(
        &mut self,
        id: UnitId,
        args: &[Option<Arg>],
        at: At,
        path: String,
        span: Span,
    ) -> Wire {
        let unit = &self.units[id.0 as usize];
        if self.calling.len() >= MAX_DEPTH {
            return self.too_deep(id, span);
        }
        self.pay_for(id);
        if !self.may_call(span) {
            return crate::elab::signal::nothing();
        }
        self.calling.push(id);
        let outer = (std::mem::take(&mut self.name), self.serial, self.top);
        let entered = std::mem::replace(&mut self.entered, at.guard);
        let result = self.inlined_here(unit, id, args, at, path, span);
        (self.name, self.serial, self.top) = outer;
        self.entered = entered;
        self.calling.pop();
        result
    }

    fn inlined_here(
        &mut self,
        unit: &'u Unit,
        id: UnitId,
        args: &[Option<Arg>],
        at: At,
        path: String,
        span: Span,
    ) -> Wire {
        if self.mode == Mode::Constant && unit.kind == UnitKind::Node {
            // A node runs cycle by cycle; only functions can be evaluated at compile time.
            return self.fail(NotConstant::Flow(span));
        }
        let keeps_results = std::mem::take(&mut self.keeps_results);
        self.called_here(unit);
        let mut scope = Scope::new(unit, id);
        scope.called = Some(span);
        let in_fragment = unit.kind == UnitKind::Fragment && self.mode != Mode::Constant;
        scope.prefix = if in_fragment || path.is_empty() {
            String::new()
        } else {
            format!("{path}.")
        };
        self.name.clone_from(&path);
        let at = match self.is_stateless(id) {
            true => at,
            false => at.unguarded(),
        };
        scope.base = at.fragment;
        self.connect(&mut scope, args, at);
        let inner = match in_fragment {
            true => At::fragment(self.fragment_of_unit(&mut scope, &path, at, span)),
            false => at,
        };
        if in_fragment {
            self.ports_enter(&mut scope, inner.fragment);
        }
        let around = std::mem::replace(&mut scope.base, inner.fragment);
        let spans: Vec<Option<Span>> = args.iter().map(|arg| Some(arg.as_ref()?.span)).collect();
        self.inputs_in_subranges(&mut scope, &spans, inner);
        scope.base = around;
        if self.mode != Mode::Constant {
            self.body(&mut scope, inner);
        }
        let is_lifted = keeps_results || crate::clocks::may_be_inactive(unit);
        let around = std::mem::replace(&mut scope.base, inner.fragment);
        let leaves = self.outputs_of(&mut scope, is_lifted, span);
        scope.base = around;
        self.exposed = match self.mode {
            Mode::Constant => Vec::new(),
            _ => self.expose(&mut scope, id, span),
        };
        self.leaving(&leaves, inner.fragment, at.fragment)
    }

    /// Returns the leaves of a unit's outputs. If `is_lifted`, they are made readable in all cycles of the unit.
    fn outputs_of(&mut self, scope: &mut Scope<'u>, is_lifted: bool, span: Span) -> Wire {
        let mut leaves = Vec::new();
        for output in &scope.unit.outputs {
            let mut wire = self.flow(scope, *output, span);
            if is_lifted {
                wire = self.off_clock_absent(scope, *output, &wire, span);
            }
            leaves.extend(wire.iter().cloned());
        }
        leaves.into()
    }

    fn fragment_of_unit(
        &mut self,
        scope: &mut Scope<'u>,
        path: &str,
        at: At,
        span: Span,
    ) -> FragmentId {
        let root = scope.unit.block(BlockId::ROOT);
        let activation = match root.when {
            Some(when) => {
                let condition = self.one(scope, when, at);
                self.when(&condition, at, span)
            }
            None => net::Activation::Always,
        };
        let restart = if root.restart {
            Restart::OnActivation
        } else {
            Restart::Never
        };
        let fragment = self.fragment(path, at.fragment, activation, restart, span);
        let made = &mut self.net.fragments[fragment.0 as usize];
        made.budget_ns = root.budget_ns;
        // The output flow has that path itself, so the fragment gets the unit's name.
        made.origin.flow = Some(scope.unit.name.to_string());
        fragment
    }

    /// Connects a unit's inputs to the arguments of the caller, or to their defaults.
    pub(in crate::elab) fn connect(&mut self, scope: &mut Scope<'u>, args: &[Option<Arg>], at: At) {
        let unit = scope.unit;
        for (flow, arg) in unit.inputs.iter().zip(args) {
            let wire = match (arg, unit.flow(*flow).default) {
                (Some(arg), _) => arg.wire.clone(),
                (None, Some(default)) => self.expr(scope, default, at),
                (None, None) => continue,
            };
            *scope.state(*flow) = State::Known(wire);
        }
    }

    /// Reports calls that are nested too deeply: infinite recursion of one instance, or a long chain of calls.
    fn too_deep(&mut self, id: UnitId, span: Span) -> Wire {
        let unit = &self.units[id.0 as usize];
        let message = match self.calling.contains(&id) {
            true => format!("`{}` is infinitely recursive", unit.name),
            false => format!("calls are nested more than {MAX_DEPTH} deep"),
        };
        let finding = Finding::new(Code::RPI1011, message)
            .at(span, format!("`{}` is called here", unit.name))
            .also(unit.span, "declared here")
            .help("end a recursion over static parameters with `with`");
        self.refuse(finding, span)
    }

    /// Reports an error that prevents the net or constant. Only the first one is kept.
    pub(in crate::elab) fn refuse(&mut self, finding: Finding, span: Span) -> Wire {
        if self.mode == Mode::Constant {
            return self.fail(NotConstant::Fault(span, finding.message));
        }
        if self.failure.is_none() {
            self.findings.push(finding);
        }
        self.fail(NotConstant::Faulty)
    }

    /// Binds an alias to its signal, unless it is bound already.
    pub(in crate::elab) fn bind_alias(&mut self, port: PortRef, signal: &Signal) {
        if let Some(alias) = crate::elab::signal::alias_of(port) {
            self.aliases[alias].get_or_insert_with(|| signal.clone());
        }
    }
}
