//! What is run: a command, or a node by itself.

use super::families::Family;
use super::scope::{Scope, State};
use super::signal::{Signal, Wire, single};
use super::{At, Claims, Elab, Mode, NotConstant, Operand};
use crate::clocks::ClockId;
use crate::facts::Facts;
use crate::ty::Ty;
use crate::typed::{BlockId, ExprId, FlowId, FlowRole, Leaf, Optional, Unit, UnitId, UnitKind};
use rpi_diag::Finding;
use rpi_image::{Scalar, Value};
use rpi_net::{Driver, ExportPort, Given, Input, Net, Origin, ResultKind, ResultPort};
use rpi_syntax::ast::EndKind;

/// The port of an input that tells when it was set last, absent before.
const UPDATED: u8 = 1;

/// What a parameter of a command is when it is loaded.
#[derive(Clone, PartialEq, Debug)]
pub enum Argument {
    /// Its leaves; the name of the device if it is one.
    Value(Vec<Leaf>),
    /// What its declaration says.
    Default,
    /// Not known yet: the net is only to be checked.
    Unknown,
}

/// A port of what is run: where its leaves come from or go to.
#[derive(Clone, PartialEq, Debug)]
pub struct PortShape {
    /// Key of the leaf, `x.f[2]`.
    pub key: String,
    /// Its type.
    pub ty: Ty,
    /// Whether it may be absent.
    pub optional: bool,
}

/// A flow that is neither read nor written from outside, but can be looked at.
#[derive(Clone, PartialEq, Debug)]
pub struct Local {
    /// Its name and type.
    pub shape: PortShape,
    /// Where its value is.
    pub port: ExportPort,
}

/// A net, and how to talk to it.
#[derive(Clone, Debug)]
pub struct Elaborated {
    /// The net.
    pub net: Net,
    /// In-ports, leaf by leaf.
    pub inputs: Vec<PortShape>,
    /// Out-ports, leaf by leaf.
    pub outputs: Vec<PortShape>,
    /// Whether there are claims in it, whatever has become of them.
    pub has_claims: bool,
    /// Other flows of the unit itself, leaf by leaf, if they were asked for.
    pub locals: Vec<Local>,
    /// What was found on the way.
    pub findings: Vec<Finding>,
    /// Operands that are not always needed and have state, inner ones first.
    pub operands: Vec<Operand>,
    /// Whether a branch was left out that only a constant rules out: there may be a ring through it.
    pub leaves_out: bool,
}

/// Makes the net of a unit. `args` are for its parameters, in order; what is missing is not known.
#[must_use]
pub fn elaborate(
    units: &[Unit],
    facts: &[Facts],
    id: UnitId,
    args: &[Argument],
    claims: Claims,
) -> Elaborated {
    Job::new(units, facts, id, args, claims).run(Mode::Net)
}

/// The net of a unit with a node for every equation, so that a dependency cycle through it names each step.
#[must_use]
pub fn elaborate_steps(units: &[Unit], facts: &[Facts], id: UnitId, args: &[Argument]) -> Net {
    let job = Job::new(units, facts, id, args, Claims::Report);
    job.run(Mode::Steps).net
}

/// Whether something depends on itself within a cycle through what only a constant rules out.
#[must_use]
pub fn hides_ring(units: &[Unit], facts: &[Facts], id: UnitId, args: &[Argument]) -> bool {
    let job = Job::new(units, facts, id, args, Claims::Report);
    rpi_net::passes::has_ring(&job.run(Mode::Whole).net)
}

/// Makes the net of a node that runs by itself, outside of any command; its local flows can be looked at if they are
/// asked for.
#[must_use]
pub fn elaborate_alone(
    units: &[Unit],
    facts: &[Facts],
    id: UnitId,
    claims: Claims,
    locals: bool,
) -> Elaborated {
    let job = Job::new(units, facts, id, &[], claims);
    Job { locals, ..job }.run(Mode::Net)
}

/// What is to be elaborated.
struct Job<'u, 'a> {
    units: &'u [Unit],
    facts: &'u [Facts],
    id: UnitId,
    args: &'a [Argument],
    claims: Claims,
    /// Whether its local flows are asked for.
    locals: bool,
}

impl<'u, 'a> Job<'u, 'a> {
    fn new(
        units: &'u [Unit],
        facts: &'u [Facts],
        id: UnitId,
        args: &'a [Argument],
        claims: Claims,
    ) -> Self {
        Job {
            units,
            facts,
            id,
            args,
            claims,
            locals: false,
        }
    }

    /// What became of it.
    fn run(&self, mode: Mode) -> Elaborated {
        let mut elab = Elab::new(self.units, self.facts, mode);
        elab.claims = self.claims;
        elab.pay_for(self.id);
        let unit = &self.units[self.id.0 as usize];
        elab.tells_landmarks = unit.kind == UnitKind::Test;
        elab.net.name = unit.name.to_string();
        elab.make_room(unit);
        let root = &mut elab.net.fragments[0];
        root.budget_ns = unit.block(BlockId::ROOT).budget_ns;
        root.origin.span = unit.span;
        let mut scope = Scope::new(unit, self.id);
        let unknown = elab.parameters(&mut scope, self.args);
        let inputs = elab.inputs(&mut scope);
        elab.body(&mut scope, At::ROOT);
        let outputs = elab.outputs(&mut scope);
        elab.exports(&mut scope);
        elab.driver(&mut scope);
        let claims = elab.watched.len();
        let locals = match self.locals {
            true => elab.locals(&mut scope),
            false => Vec::new(),
        };
        for (port, value) in unknown {
            elab.bind_alias(port, &Signal::Const(value));
        }
        elab.settle();
        if elab.tells_landmarks {
            super::landmarks::tell_apart(&mut elab.net);
        }
        let ports = elab.watched.split_off(claims);
        let locals = locals.into_iter().zip(ports);
        elab.net.exports.append(&mut elab.watched);
        Elaborated {
            net: elab.net,
            inputs,
            outputs,
            has_claims: elab.has_claims,
            locals: locals.map(|(shape, port)| Local { shape, port }).collect(),
            findings: elab.findings,
            operands: elab.operands,
            leaves_out: elab.leaves_out,
        }
    }
}

impl<'u> Elab<'u> {
    /// Makes room for the nodes of a large unit at once: most expressions are one at most, and a state takes a few besides.
    fn make_room(&mut self, unit: &Unit) {
        const LARGE: usize = 10_000;
        const OF_A_STATE: usize = 4;
        let blocks = unit.blocks.len();
        if unit.exprs.len() >= LARGE {
            self.net
                .nodes
                .reserve(unit.exprs.len() + OF_A_STATE * blocks);
            self.net.fragments.reserve(blocks);
            self.expect_aliases(unit.flows.len());
        }
    }

    /// Connects the parameters. Those that are not known become aliases that stand for neutral values.
    fn parameters(
        &mut self,
        scope: &mut Scope<'u>,
        args: &[Argument],
    ) -> Vec<(rpi_net::PortRef, Value)> {
        let unit = scope.unit;
        let mut unknown = Vec::new();
        let params = unit
            .inputs
            .iter()
            .filter(|id| unit.flow(**id).role == FlowRole::Param);
        for (k, flow) in params.enumerate() {
            let declared = unit.flow(*flow);
            let wire = match (args.get(k), declared.default, &declared.ty) {
                (Some(Argument::Value(leaves)), ..) => {
                    self.constants(leaves, &declared.ty, At::ROOT, declared.span)
                }
                (_, _, Ty::Device(_)) => {
                    single(Signal::Const(Value::Str(declared.name.to_string())))
                }
                (_, Some(default), _) => self.expr(scope, default, At::ROOT),
                _ => {
                    let mut leaves = Vec::new();
                    for scalar in super::expr::leaf_scalars(&declared.ty) {
                        // A Boolean decides what can happen at all: it stands for both values.
                        if scalar == Scalar::Bool {
                            leaves.push(self.outside(&declared.name, scalar, declared.span));
                            continue;
                        }
                        let alias = self.new_alias(scalar);
                        unknown.push((alias, Value::neutral(scalar.into())));
                        leaves.push(Signal::Port(alias));
                    }
                    leaves.into()
                }
            };
            *scope.state(*flow) = State::Known(wire);
            self.outside_in_subranges(scope, *flow);
        }
        unknown
    }

    /// In-ports of a node by itself, and what a command takes over: set from outside, by key.
    fn inputs(&mut self, scope: &mut Scope<'u>) -> Vec<PortShape> {
        let unit = scope.unit;
        let mut shapes = Vec::new();
        for flow in unit
            .inputs
            .iter()
            .filter(|id| unit.flow(**id).role != FlowRole::Param)
        {
            let declared = unit.flow(*flow);
            self.begin(&declared.name);
            let default = declared.default.map(|id| self.expr(scope, id, At::ROOT));
            let optional = declared.optional == Optional::Declared(true);
            let mut leaves: Vec<(String, Ty)> = Vec::new();
            declared.ty.leaves(&mut |path, ty| {
                leaves.push((format!("{}{path}", declared.name), ty.clone()))
            });
            let mut wire = Vec::with_capacity(leaves.len());
            for (k, (key, ty)) in leaves.into_iter().enumerate() {
                let (seen, scalar) = crate::check::outside_type(&ty);
                let default = default.as_ref().and_then(|wire| wire.get(k)).cloned();
                let default =
                    default.map(|signal| self.in_seconds(&signal, &ty, At::ROOT, declared.span));
                let value = match (ty == Ty::Duration, declared.default) {
                    (true, Some(id)) => super::constant(self.units, unit, id)
                        .ok()
                        .and_then(|leaves| leaves.get(k).cloned()),
                    _ => default
                        .as_ref()
                        .and_then(|signal| self.settled_constant(signal)),
                };
                let given = self.outside_at((&key, value), scalar, At::ROOT, declared.span);
                let given = match optional {
                    true => self.unless_given(&given, scalar, default.as_ref(), declared.span),
                    false => given,
                };
                wire.push(self.in_ticks(given, &ty, At::ROOT, declared.span));
                let ty = seen;
                if declared.role == FlowRole::Given {
                    self.net.given.push(Given {
                        key: key.clone(),
                        is_needed: declared.default.is_none() && !optional,
                    });
                }
                shapes.push(PortShape { key, ty, optional });
            }
            *scope.state(*flow) = State::Known(wire.into());
            self.outside_in_subranges(scope, *flow);
        }
        shapes
    }

    /// An input that may be absent is what it is otherwise, or absent, until it is set.
    fn unless_given(
        &mut self,
        given: &Signal,
        scalar: Scalar,
        default: Option<&Signal>,
        span: rpi_diag::Span,
    ) -> Signal {
        let Signal::Port(value) = given else {
            return given.clone();
        };
        let updated = Signal::Port(rpi_net::PortRef {
            port: UPDATED,
            ..*value
        });
        let is_open = self.family(Family::IsNull, Scalar::Time, &[updated], At::ROOT, span);
        let otherwise = default.cloned().unwrap_or(Signal::Absent);
        let inputs = [is_open, otherwise, given.clone()];
        self.family(Family::Conditional, scalar, &inputs, At::ROOT, span)
    }

    /// A value that the program leaves open is set from outside, if anybody sets it.
    pub(super) fn left_open(&mut self, scope: &Scope<'u>, id: ExprId, at: At) -> Wire {
        let expr = scope.unit.expr(id);
        if self.mode == Mode::Constant {
            return self.fail(NotConstant::Flow(expr.span));
        }
        self.serial += 1;
        let name = format!("{}#any{}", self.name, self.serial - 1);
        let mut leaves: Vec<(String, Ty)> = Vec::new();
        let mut leaf = |path: String, ty: &Ty| leaves.push((format!("{name}{path}"), ty.clone()));
        expr.ty.leaves(&mut |path, ty| leaf(path.to_owned(), ty));
        let leaves = leaves.into_iter();
        let signals = leaves.map(|(key, ty)| {
            let given = self.outside_at((&key, None), Self::scalar_outside(&ty), at, expr.span);
            self.in_ticks(given, &ty, at, expr.span)
        });
        signals.collect()
    }

    fn outside(&mut self, key: &str, scalar: Scalar, span: rpi_diag::Span) -> Signal {
        self.outside_at((key, None), scalar, At::ROOT, span)
    }

    /// What is set from outside by a key, with the value that it has until then, if one is said.
    fn outside_at(
        &mut self,
        (key, default): (&str, Option<Value>),
        scalar: Scalar,
        at: At,
        span: rpi_diag::Span,
    ) -> Signal {
        let Some(prim) = super::families::member(Family::Input, scalar) else {
            return Signal::Absent;
        };
        let value = |param: &rpi_image::Param| match param.name {
            "Key" => Some(Value::Str(key.to_owned())),
            "Value" if default.is_some() => default.clone(),
            _ => crate::check::param_default(param),
        };
        let params = prim.desc().params.iter().filter_map(value).collect();
        let wire = self.prim(prim, Vec::new(), params, at, span);
        if let Some(Signal::Port(port)) = wire.first() {
            let node = &mut self.net.nodes[port.node.index()];
            key.clone_into(&mut node.name);
            node.origin.flow = Some(key.to_owned());
        }
        wire.first().cloned().unwrap_or(Signal::Absent)
    }

    /// Out-ports of a node by itself are published.
    fn outputs(&mut self, scope: &mut Scope<'u>) -> Vec<PortShape> {
        let unit = scope.unit;
        let mut shapes = Vec::new();
        for flow in &unit.outputs {
            let declared = unit.flow(*flow);
            let wire = self.flow(scope, *flow, declared.span);
            self.begin(&declared.name);
            let wire = self.off_clock_absent(scope, *flow, &wire, declared.span);
            let mut leaves: Vec<(String, Ty)> = Vec::new();
            declared.ty.leaves(&mut |path, ty| {
                leaves.push((format!("{}{path}", declared.name), ty.clone()))
            });
            for ((key, ty), signal) in leaves.into_iter().zip(wire.iter()) {
                self.export(&key, signal, &ty, declared.span);
                let optional = declared.optional != Optional::Declared(false);
                let ty = crate::check::outside_type(&ty).0;
                shapes.push(PortShape { key, ty, optional });
            }
        }
        shapes
    }

    pub(super) fn export(&mut self, key: &str, signal: &Signal, ty: &Ty, span: rpi_diag::Span) {
        let port = self.export_port(key, signal, ty, At::ROOT, span);
        self.net.exports.extend(port);
    }

    /// What publishes a flow; a constant is there in the cycles of the place.
    pub(super) fn export_port(
        &mut self,
        key: &str,
        signal: &Signal,
        ty: &Ty,
        at: At,
        span: rpi_diag::Span,
    ) -> Option<ExportPort> {
        let signal = self.in_seconds(signal, ty, at, span);
        let source = self.port_of(&signal, Self::scalar_outside(ty), at, span)?;
        Some(ExportPort {
            key: key.to_owned(),
            source,
            origin: Origin {
                span,
                flow: Some(key.to_owned()),
            },
        })
    }

    /// The flows between in-ports and out-ports, under the names of the blocks that they stand in.
    fn locals(&mut self, scope: &mut Scope<'u>) -> Vec<PortShape> {
        let unit = scope.unit;
        let mut shapes = Vec::new();
        for id in (0..).map(FlowId).take(unit.flows.len()) {
            let declared = unit.flow(id);
            let is_device = matches!(declared.ty, Ty::Device(_));
            if declared.role != FlowRole::Local || is_device {
                continue;
            }
            let is_inner = declared.block != BlockId::ROOT;
            let wire = self.read_flow(scope, (id, is_inner), At::ROOT, declared.span);
            let wire = match is_inner {
                true => wire,
                false => self.off_clock_absent(scope, id, &wire, declared.span),
            };
            let name = unit.path_of(id);
            self.begin(&name);
            let mut leaves: Vec<(String, Ty)> = Vec::new();
            declared
                .ty
                .leaves(&mut |path, ty| leaves.push((format!("{name}{path}"), ty.clone())));
            for ((key, ty), signal) in leaves.into_iter().zip(wire.iter()) {
                if let Some(port) = self.export_port(&key, signal, &ty, At::ROOT, declared.span) {
                    self.watched.push(port);
                    let optional = declared.optional != Optional::Declared(false);
                    let ty = crate::check::outside_type(&ty).0;
                    shapes.push(PortShape { key, ty, optional });
                }
            }
        }
        shapes
    }

    fn exports(&mut self, scope: &mut Scope<'u>) {
        let unit = scope.unit;
        for (k, block) in unit.blocks.iter().enumerate() {
            let fragment = scope.fragments[k].unwrap_or(rpi_net::FragmentId::ROOT);
            for export in &block.exports {
                scope.base = fragment;
                let wire = self.read_at(scope, export.value, ClockId::BASE, At::fragment(fragment));
                scope.base = rpi_net::FragmentId::ROOT;
                self.begin(&export.key);
                let mut leaves: Vec<(String, Ty)> = Vec::new();
                let ty = &unit.expr(export.value).ty;
                ty.leaves(&mut |path, ty| {
                    leaves.push((format!("{}{path}", export.key), ty.clone()))
                });
                for ((key, ty), signal) in leaves.into_iter().zip(wire.iter()) {
                    self.export(&key, signal, &ty, export.span);
                }
            }
        }
    }

    fn driver(&mut self, scope: &mut Scope<'u>) {
        let unit = scope.unit;
        let ends = &unit.block(BlockId::ROOT).ends;
        let endless = unit.kind == UnitKind::Test && ends.is_empty();
        if !unit.kind.is_root() || endless {
            return;
        }
        self.net.is_test = unit.kind == UnitKind::Test;
        let mut results = Vec::new();
        for end in ends {
            self.begin(&end.result);
            let signal = self.one(scope, end.condition, At::ROOT);
            let condition = match signal {
                Signal::Const(value) => Input::constant(value),
                other => match self.port_of(&other, Scalar::Bool, At::ROOT, end.span) {
                    Some(port) => Input::Port(port),
                    None => Input::Open,
                },
            };
            results.push(ResultPort {
                name: end.result.to_string(),
                kind: match end.kind {
                    EndKind::Finish => ResultKind::Finish,
                    EndKind::Yield => ResultKind::Yield,
                    EndKind::Fail => ResultKind::Fail,
                },
                condition,
                origin: Origin {
                    span: end.span,
                    flow: Some(end.result.to_string()),
                },
            });
        }
        self.net.driver = Driver::Results(results);
    }
}

/// The parameters of a unit, in the order in which [`elaborate`] takes arguments.
#[must_use]
pub fn parameters(unit: &Unit) -> Vec<FlowId> {
    let is_param = |id: &FlowId| unit.flow(*id).role == FlowRole::Param;
    unit.inputs.iter().copied().filter(is_param).collect()
}
