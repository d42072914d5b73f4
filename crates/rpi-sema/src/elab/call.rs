//! Calls: a unit inlined at one place.

use super::expr::leaf_scalars;
use super::families::Family;
use super::scope::{Scope, State};
use super::signal::{Signal, Wire};
use super::{At, Elab, MAX_DEPTH, Mode, NotConstant};
use crate::typed::{Activation, BlockId, Call, ExprId, Unit, UnitId, UnitKind};
use rpi_diag::{Code, Finding, Span};
use rpi_image::{Scalar, Value};
use rpi_net::{self as net, Absent, Fragment, FragmentId, Origin, PortRef, Restart};

/// A call that does not run in all cycles.
struct Run {
    /// When it runs.
    every: Signal,
    /// What it gives then, and what is given before the first time.
    result: Wire,
    default: Option<Wire>,
    /// Which leaves of that may be absent when it runs.
    optional: Vec<bool>,
}

/// What a call gives for an in-port.
pub(super) struct Arg {
    wire: Wire,
    span: Span,
}

impl<'u> Elab<'u> {
    /// A call.
    pub(super) fn call(
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
                    return super::signal::nothing();
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
            // State goes on whatever an `if` chooses.
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

    /// What a call gives at a place, with what decides about its clocks.
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

    /// An argument: absent where its clock does not tick and the call's does.
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

    /// The path of what an expression makes: the flow's if it is the flow's whole value.
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

    /// An activation by a condition.
    pub(super) fn when(&mut self, condition: &Signal, at: At, span: Span) -> net::Activation {
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
    pub(super) fn fragment(
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

    /// What a call gives that does not run in all cycles: its result, or what it was last.
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
            // That a run gave nothing is kept, too.
            true => {
                let inputs = [run.every.clone(), signal, before];
                self.family(Family::Conditional, scalar, &inputs, at, span)
            }
            false => self.family(Family::Coalesce, scalar, &[signal, before], at, span),
        };
        self.bind_alias(result, &held);
        held
    }

    /// A unit with its in-ports connected; gives its out-ports.
    pub(super) fn inlined(
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
            return super::signal::nothing();
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
            // It runs, cycle by cycle; only functions are worked out beforehand.
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

    /// The leaves of a unit's out-ports, for a reader in all its cycles if they are lifted.
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
        // The flow that it gives has that name itself.
        made.origin.flow = Some(scope.unit.name.to_string());
        fragment
    }

    /// Gives a unit's in-ports what the caller connects, or their defaults.
    pub(super) fn connect(&mut self, scope: &mut Scope<'u>, args: &[Option<Arg>], at: At) {
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

    /// Calls are nested too deeply: one instance calls itself, or there are too many one in the other.
    fn too_deep(&mut self, id: UnitId, span: Span) -> Wire {
        let unit = &self.units[id.0 as usize];
        let message = match self.calling.contains(&id) {
            true => format!("`{}` calls itself without end", unit.name),
            false => format!("calls are nested more than {MAX_DEPTH} deep"),
        };
        let finding = Finding::new(Code::RPI1011, message)
            .at(span, format!("`{}` is called here", unit.name))
            .also(unit.span, "declared here")
            .help("a recursion over static parameters ends by `with`");
        self.refuse(finding, span)
    }

    /// Reports why there is no net, or no constant; the first reason counts.
    pub(super) fn refuse(&mut self, finding: Finding, span: Span) -> Wire {
        if self.mode == Mode::Constant {
            return self.fail(NotConstant::Fault(span, finding.message));
        }
        if self.failure.is_none() {
            self.findings.push(finding);
        }
        self.fail(NotConstant::Faulty)
    }

    /// Gives an alias its signal.
    pub(super) fn bind_alias(&mut self, port: PortRef, signal: &Signal) {
        if let Some(alias) = super::signal::alias_of(port) {
            self.aliases[alias].get_or_insert_with(|| signal.clone());
        }
    }
}
