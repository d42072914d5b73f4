//! Elaborates an entry point: a command, a test, or a node on its own.

use crate::elab::arrays;
use crate::elab::block;
use crate::elab::call;
use crate::elab::expr;
use crate::elab::external_ports;
use crate::elab::node_budget;
use crate::elab::nodes;
use crate::elab::resolve_aliases;
use crate::elab::scope::{FlowState, Scope};
use crate::elab::signal::{Signal, single_wire};
use crate::elab::subrange;
use crate::elab::time;
use crate::elab::watched_flows::{self, FlowSelection};
use crate::elab::{ClaimPolicy, ElabMode, Elaborator, LazyOperand, Position};
use crate::facts::Facts;
use crate::ty::Ty;
use crate::typed::{BlockId, FlowId, FlowRole, Leaf, Unit, UnitId, UnitKind};
use rpi_diag::{Code, Diagnostic};
use rpi_image::{Scalar, Value};
use rpi_net::{ExportPort, Input, Net, Origin, ResultKind, ResultPort, Termination};
use rpi_syntax::ast::CommandEndKind;
use std::rc::Rc;

/// Index of the output of an input primitive with the time at which the input was last written. The output is absent
/// before the first write.
pub(super) const UPDATED_PORT: u8 = 1;

/// Value of a parameter of a command when the command is loaded.
#[derive(Clone, PartialEq, Debug)]
pub enum Argument {
    /// Values of the leaves (scalar parts) of the parameter; for a device, its name.
    Value(Vec<Leaf>),
    /// The parameter has its default value.
    Default,
    /// The value is not known. The net is then only checked, not run.
    Unknown,
}

/// Leaf (scalar part) of an input or output of the net of a unit: its key, type and presence.
#[derive(Clone, PartialEq, Debug)]
pub struct PortShape {
    /// Key by which the host sets or reads the leaf, such as `x.f[2]`.
    pub key: String,
    /// Type of the scalar part.
    pub ty: Ty,
    /// Whether the leaf may be absent in a cycle.
    pub optional: bool,
}

/// Leaf (scalar part) of a local flow that the host can observe although the flow is neither an input nor an output.
#[derive(Clone, PartialEq, Debug)]
pub struct ObservableFlow {
    /// Key, type and presence of the leaf.
    pub shape: PortShape,
    /// Export of the net with the value of the leaf.
    pub port: ExportPort,
}

/// Net of a unit that runs on its own, with its inputs and outputs.
#[derive(Clone, Debug)]
pub struct ElaboratedUnit {
    /// Elaborated net of the unit.
    pub net: Net,
    /// Inputs that the host sets, one entry for each leaf (scalar part).
    pub inputs: Vec<PortShape>,
    /// Outputs, one entry for each leaf (scalar part).
    pub outputs: Vec<PortShape>,
    /// Whether the unit or a unit that it calls contains claims (assertions or clauses of contracts), even if they were
    /// left out.
    pub has_claims: bool,
    /// Local flows that can be observed, one entry for each leaf (scalar part); empty if they were not requested.
    pub locals: Vec<ObservableFlow>,
    /// Diagnostics of the elaboration.
    pub diagnostics: Vec<Diagnostic>,
    /// Operands that are not needed in every cycle and contain state, which runs in all cycles; inner operands first.
    pub stateful_operands: Vec<LazyOperand>,
    /// Whether a branch that a constant condition never takes was left out of the net. A dependency cycle may lead
    /// through that branch.
    pub dropped_code: bool,
    /// Names of all flows of the net; empty unless flows are watched.
    flow_names: Vec<String>,
}

/// Elaborates the net of a unit. `args` are the values of its parameters in order; further parameters are unknown.
/// `claims` is the treatment of assertions and contracts.
#[must_use]
pub fn elaborate(
    units: &[Rc<Unit>],
    facts: &[Rc<Facts>],
    id: UnitId,
    args: &[Argument],
    claims: ClaimPolicy,
) -> ElaboratedUnit {
    Elaboration::new(units, facts, id, args, claims).run(ElabMode::Net)
}

/// Elaborates the net of a unit as [`elaborate`] does, and exports the selected flows besides. Also returns the names of all
/// flows of the net.
#[must_use]
pub fn elaborate_watched(
    units: &[Rc<Unit>],
    facts: &[Rc<Facts>],
    id: UnitId,
    args: &[Argument],
    claims: ClaimPolicy,
    watch: FlowSelection,
) -> (ElaboratedUnit, Vec<String>) {
    let mut elaborated = Elaboration {
        watch,
        ..Elaboration::new(units, facts, id, args, claims)
    }
    .run(ElabMode::Net);
    let names = std::mem::take(&mut elaborated.flow_names);
    (elaborated, names)
}

/// Elaborates a unit with a net node for every equation, so that a dependency cycle in the net names every equation on
/// it.
#[must_use]
pub fn elaborate_dependency_steps(
    units: &[Rc<Unit>],
    facts: &[Rc<Facts>],
    id: UnitId,
    args: &[Argument],
) -> Net {
    let job = Elaboration::new(units, facts, id, args, ClaimPolicy::Report);
    job.run(ElabMode::DependencySteps).net
}

/// Returns whether the source of a unit has a dependency cycle within one cycle if branches that constant conditions
/// never take are included.
#[must_use]
pub fn has_hidden_dependency_cycle(
    units: &[Rc<Unit>],
    facts: &[Rc<Facts>],
    id: UnitId,
    args: &[Argument],
) -> bool {
    let job = Elaboration::new(units, facts, id, args, ClaimPolicy::Report);
    rpi_net::passes::has_dependency_cycle(&job.run(ElabMode::Dependencies).net)
}

/// Elaborates the net of a node that runs on its own, outside of any command. `locals` is whether its local flows can
/// be observed.
#[must_use]
pub fn elaborate_node(
    units: &[Rc<Unit>],
    facts: &[Rc<Facts>],
    id: UnitId,
    claims: ClaimPolicy,
    locals: bool,
) -> ElaboratedUnit {
    let job = Elaboration::new(units, facts, id, &[], claims);
    Elaboration { locals, ..job }.run(ElabMode::Net)
}

/// Parameters of one elaboration: the units with the results of their analyses, the unit to be elaborated, and its
/// arguments.
struct Elaboration<'u, 'a> {
    units: &'u [Rc<Unit>],
    facts: &'u [Rc<Facts>],
    id: UnitId,
    args: &'a [Argument],
    claims: ClaimPolicy,
    /// Whether the local flows of the unit can be observed by the host.
    locals: bool,
    /// Flows to be exported besides those of the program.
    watch: FlowSelection,
}

impl<'u, 'a> Elaboration<'u, 'a> {
    fn new(
        units: &'u [Rc<Unit>],
        facts: &'u [Rc<Facts>],
        id: UnitId,
        args: &'a [Argument],
        claims: ClaimPolicy,
    ) -> Self {
        Elaboration {
            units,
            facts,
            id,
            args,
            claims,
            locals: false,
            watch: FlowSelection::default(),
        }
    }

    /// Runs the elaboration and returns the net with its inputs, outputs and diagnostics. `mode` is the purpose of the
    /// net.
    fn run(&self, mode: ElabMode) -> ElaboratedUnit {
        let mut elab = Elaborator::new(self.units, self.facts, mode);
        elab.claim_policy = self.claims;
        elab.watch.selection = self.watch.clone();
        node_budget::credit_text(&mut elab, self.id);
        let unit = &self.units[self.id.0 as usize];
        elab.records_coverage = unit.kind == UnitKind::Test;
        elab.net.name = unit.name.to_string();
        reserve_nodes(&mut elab, unit);
        let root = &mut elab.net.fragments[0];
        root.budget_ns = unit.block(BlockId::ROOT).budget_ns;
        root.origin.span = unit.span;
        let mut scope = Scope::new(unit, self.id);
        let unknown = elab_parameters(&mut elab, &mut scope, self.args);
        let inputs = external_ports::unit_inputs(&mut elab, &mut scope);
        block::body(&mut elab, &mut scope, Position::ROOT);
        let outputs = external_ports::unit_outputs(&mut elab, &mut scope);
        external_ports::exports(&mut elab, &mut scope);
        driver(&mut elab, &mut scope);
        watched_flows::export_watched(&mut elab, &mut scope, Position::ROOT);
        let claims = elab.kept_exports.len();
        let locals = match self.locals {
            true => external_ports::elab_locals(&mut elab, &mut scope),
            false => Vec::new(),
        };
        for (port, value) in unknown {
            call::bind_alias(&mut elab, port, &Signal::Const(value));
        }
        resolve_aliases::resolve_aliases(&mut elab);
        if elab.records_coverage {
            crate::elab::coverage_points::make_names_unique(&mut elab.net);
        }
        let ports = elab.kept_exports.split_off(claims);
        let locals = locals.into_iter().zip(ports);
        watched_flows::drop_repeated(&mut elab);
        elab.net.exports.append(&mut elab.kept_exports);
        ElaboratedUnit {
            net: elab.net,
            inputs,
            outputs,
            has_claims: elab.has_claims,
            locals: locals
                .map(|(shape, port)| ObservableFlow { shape, port })
                .collect(),
            diagnostics: elab.diagnostics,
            stateful_operands: elab.lazy_operands,
            dropped_code: elab.leaves_out_code,
            flow_names: elab.watch.names,
        }
    }
}

/// Reserves memory for the nodes of a large unit. Most expressions need at most one node, and a state of an automaton
/// needs a few more.
fn reserve_nodes(elab: &mut Elaborator<'_>, unit: &Unit) {
    const LARGE: usize = 10_000;
    const OF_A_STATE: usize = 4;
    let blocks = unit.blocks.len();
    if unit.exprs.len() >= LARGE {
        elab.net
            .nodes
            .reserve(unit.exprs.len() + OF_A_STATE * blocks);
        elab.net.fragments.reserve(blocks);
        nodes::reserve_aliases(elab, unit.flows.len());
    }
}

/// Connects the parameters of a unit to the values of its arguments. A parameter with an unknown value gets placeholder
/// ports, which are returned with the neutral values that they must get at the end.
fn elab_parameters<'u>(
    elab: &mut Elaborator<'u>,
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
                time::constants(elab, leaves, &declared.ty, Position::ROOT, declared.span)
            }
            (_, _, Ty::Device(_)) => {
                single_wire(Signal::Const(Value::Str(declared.name.to_string())))
            }
            (_, Some(default), _) => expr::elab_expr(elab, scope, default, Position::ROOT),
            _ => {
                let mut leaves = Vec::new();
                for scalar in crate::elab::expr::leaf_scalars(&declared.ty) {
                    // Truth values and numbers decide what can happen at all, so they must not be fixed: they become
                    // external inputs.
                    if matches!(scalar, Scalar::Bool | Scalar::Int | Scalar::Real) {
                        leaves.push(external_ports::external_input(
                            elab,
                            &declared.name,
                            scalar,
                            declared.span,
                        ));
                        continue;
                    }
                    let alias = nodes::new_alias(elab, scalar);
                    unknown.push((alias, Value::neutral(scalar.into())));
                    leaves.push(Signal::Port(alias));
                }
                leaves.into()
            }
        };
        *scope.state(*flow) = FlowState::Done(wire);
        subrange::check_external_input(elab, scope, *flow);
    }
    unknown
}

/// Returns the warning for a test without an assertion. Such a test can only fail by a fault.
fn no_assertion(unit: &Unit) -> Diagnostic {
    Diagnostic::new(
        Code::RPI9004,
        "this test has no assertion, so it always passes",
    )
    .primary(unit.span, "checks nothing")
    .help("state with `assert` what must hold")
}

fn driver<'u>(elab: &mut Elaborator<'u>, scope: &mut Scope<'u>) {
    let unit = scope.unit;
    let ends = &unit.block(BlockId::ROOT).ends;
    let endless = unit.kind == UnitKind::Test && ends.is_empty();
    if endless && !elab.has_claims {
        elab.diagnostics.push(no_assertion(unit));
    }
    if !unit.kind.is_root() || endless {
        return;
    }
    elab.net.is_test = unit.kind == UnitKind::Test;
    let mut results = Vec::new();
    for end in ends {
        block::set_node_name(elab, &end.result);
        let signal = expr::elab_condition(elab, scope, end.condition, Position::ROOT);
        let condition = match signal {
            Signal::Const(value) => Input::constant(value),
            other => match arrays::port_of(elab, &other, Scalar::Bool, Position::ROOT, end.span) {
                Some(port) => Input::Port(port),
                None => Input::Unconnected,
            },
        };
        results.push(ResultPort {
            name: end.result.to_string(),
            kind: match end.kind {
                CommandEndKind::Finish => ResultKind::Finish,
                CommandEndKind::Yield => ResultKind::Yield,
                CommandEndKind::Fail => ResultKind::Fail,
            },
            condition,
            origin: Origin {
                span: end.span,
                flow: Some(end.result.to_string()),
            },
        });
    }
    elab.net.termination = Termination::Results(results);
}

/// Returns the parameters of a unit in the order in which [`elaborate`] takes their values.
#[must_use]
pub fn parameters(unit: &Unit) -> Vec<FlowId> {
    let is_param = |id: &FlowId| unit.flow(*id).role == FlowRole::Param;
    unit.inputs.iter().copied().filter(is_param).collect()
}
