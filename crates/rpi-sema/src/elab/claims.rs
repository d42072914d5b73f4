//! Elaborates claims (assertions, checks and contracts) for the running net.
//!
//! A claim is left out, or ends the command if it fails, or is exported together with the flows that it reads, so that
//! the host sees which claim fails and with which values.

use crate::elab::block;
use crate::elab::expr;
use crate::elab::external_ports;
use crate::elab::flows;
use crate::elab::presence;
use crate::elab::scope::Scope;
use crate::elab::signal::{Signal, empty_wire};
use crate::elab::{ElabMode, Elaborator, Position};
use crate::ty::Ty;
use crate::typed::{BlockId, Claim, ClaimKind, ExprId, FlowId, Unit, UnitKind};
use crate::typed::{ElementwiseOp, TypedKind};
use rpi_diag::{Code, Diagnostic, Span};
use rpi_image::Value;
use rpi_image::claim::{claim_key, read_key};
use rpi_net::prim;
use rpi_net::{self as net, ClaimRead};
use rpi_prims::PrimId;

/// Treatment of a program's claims (assertions and clauses of contracts) at run time.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub enum ClaimPolicy {
    /// Claims are left out, together with everything that only claims need.
    Off,
    /// Claims and the flows that they read are exported for the host. The run continues after a claim has failed.
    #[default]
    Report,
    /// A claim that fails is a fault, which ends the command. Claims are not exported.
    Fault,
    /// Claims are exported for the host, and a failed claim is a fault. The host sees the cause of the fault.
    ReportAndFault,
}

impl ClaimPolicy {
    fn is_reported(self) -> bool {
        matches!(self, ClaimPolicy::Report | ClaimPolicy::ReportAndFault)
    }

    fn is_fault(self) -> bool {
        matches!(self, ClaimPolicy::Fault | ClaimPolicy::ReportAndFault)
    }
}

/// Elaborates a claim: evaluates its condition in the net, and adds its export and its check according to the policy.
pub(super) fn elab_claim<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    block: BlockId,
    claim: &'u Claim,
    at: Position,
) {
    let of_test = scope.unit.kind == UnitKind::Test;
    let policy = match elab.mode {
        ElabMode::Constant => ClaimPolicy::Fault,
        _ if of_test => ClaimPolicy::Report,
        _ => elab.claim_policy,
    };
    elab.has_claims = true;
    if policy == ClaimPolicy::Off {
        return;
    }
    let label = claim.label.as_ref().map_or("claim", |label| label.as_str());
    block::set_node_name(elab, &format!("{}{label}", scope.prefix));
    let condition = expr::elab_condition(elab, scope, claim.condition, at);
    // In a fragment or a test, a claim that is always false may state that the code is never reached.
    let everywhere = at == Position::ROOT && !of_test;
    if elab.mode == ElabMode::Net && everywhere && condition == Signal::Const(Value::bool(false)) {
        elab.diagnostics
            .extend(always_false_error(elab, scope, claim));
    }
    if policy.is_fault() {
        presence::assert(
            elab,
            fault_primitive(scope, claim),
            &condition,
            at,
            claim.span,
        );
    }
    if policy.is_reported() {
        export_claim(elab, scope, (block, claim), &condition, at);
    }
}

/// Exports the condition of a claim and the flows that it reads, so that the host can observe the claim. `condition` is
/// the signal of the condition.
fn export_claim<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    (block, claim): (BlockId, &'u Claim),
    condition: &Signal,
    at: Position,
) {
    let fragment = fragment_around(scope, block);
    let key = claim_key(elab.net.claims.len() + 1);
    let condition = presence::imply_guard(elab, condition, at, claim.span);
    let port = external_ports::export_port(elab, &key, &condition, &Ty::Bool, at, claim.span);
    elab.kept_exports.extend(port);
    let mut parts = Vec::new();
    tuple_elements(scope, claim.condition, &mut parts);
    let reads = parts
        .iter()
        .flat_map(|part| export_part(elab, scope, part, &key))
        .collect();
    elab.net.claims.push(net::Claim {
        key,
        kind: claim.kind,
        path: format!("{}{fragment}", scope.prefix)
            .trim_end_matches('.')
            .to_owned(),
        subject: match fragment.as_str() {
            "" => scope.unit.name.to_string(),
            name => name.to_owned(),
        },
        mode: claim.mode.as_ref().map(ToString::to_string),
        label: claim.label.as_ref().map(ToString::to_string),
        span: claim.span,
        reads_past: reads_past(scope, claim.condition),
        is_strict: !scope.unit.is_lustre,
        reads,
    });
}

/// Returns the error for a claim that is false in every cycle. The claim is false by itself, or because of the
/// arguments of the call in which it is inlined. `None` for a guarantee that is false because of the arguments only.
fn always_false_error(
    elab: &Elaborator<'_>,
    scope: &Scope<'_>,
    claim: &Claim,
) -> Option<Diagnostic> {
    let of_its_own =
        || crate::elab::evaluate_constant(elab.units, scope.unit, claim.condition).is_ok();
    match (scope.call_span.filter(|_| !of_its_own()), claim.kind) {
        (None, _) => Some(always_false(claim)),
        (Some(call), ClaimKind::Assume) => Some(violated_assumption(call, claim, &scope.unit.name)),
        // A guarantee only has to hold where the assumptions hold.
        (Some(_), ClaimKind::Guarantee) => None,
        (Some(call), _) => Some(always_false(claim).secondary(call, "false for this call")),
    }
}

/// Exports the leaves (scalar parts) of a flow, or of a part of one, that the claim with the key `claim` reads. Returns
/// the names and keys of the exports.
fn export_part<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    part: &ReadPart,
    claim: &str,
) -> Vec<ClaimRead> {
    let expr = scope.unit.expr(part.expr);
    let wire = match part.flow {
        Some(flow) => flows::elab_flow(elab, scope, flow, expr.span),
        // The expression has been elaborated with the claim.
        None => scope.cached(part.expr, None).unwrap_or_else(empty_wire),
    };
    let mut leaves: Vec<(String, Ty)> = Vec::new();
    let ty = part.flow.map_or(&expr.ty, |flow| &scope.unit.flow(flow).ty);
    ty.for_each_leaf(&mut |path, ty| leaves.push((format!("{}{path}", part.name), ty.clone())));
    let leaves = leaves.into_iter().zip(wire.iter()).skip(part.first);
    let mut reads = Vec::new();
    for ((name, ty), signal) in leaves.take(part.count) {
        let key = read_key(claim, &name);
        let port = external_ports::export_port(elab, &key, signal, &ty, Position::ROOT, expr.span);
        let ty = crate::ty::machine_types::external_type(&ty).0;
        elab.kept_exports.extend(port);
        reads.push(ClaimRead {
            values: match &ty {
                Ty::Enum(e) => e.values.iter().map(ToString::to_string).collect(),
                _ => Vec::new(),
            },
            unit: match &ty {
                Ty::Real(dim) if !dim.is_dimensionless() => format!("[{dim}]"),
                _ => String::new(),
            },
            name,
            key,
        });
    }
    reads
}

/// Returns the primitive that ends the command if the claim fails. `Rpi::Assume` marks conditions that later analyses
/// may rely on without proof: assertions, and the assumptions of the program as a whole. The assumptions of a callee,
/// which its caller must ensure, and all other claims use `Rpi::Assert`.
fn fault_primitive(scope: &Scope<'_>, claim: &Claim) -> PrimId {
    match claim.kind {
        ClaimKind::Assert => prim!("Rpi::Assume"),
        ClaimKind::Assume if scope.prefix.is_empty() => prim!("Rpi::Assume"),
        _ => prim!("Rpi::Assert"),
    }
}

/// Returns the error for an assumption of the callee `of` that is false in every cycle because of the call at `call`.
fn violated_assumption(call: Span, claim: &Claim, of: &str) -> Diagnostic {
    Diagnostic::new(
        Code::RPI3102,
        format!("this call breaks an assumption of `{of}`"),
    )
    .primary(
        call,
        "the assumption is false for these arguments, in every cycle",
    )
    .secondary(claim.span, "the assumption")
    .help("pass arguments for which the assumption holds, or correct it if it is too strong")
}

/// Returns the error for a claim that is false for all inputs.
fn always_false(claim: &Claim) -> Diagnostic {
    let what = match claim.kind {
        ClaimKind::Assert => "this assertion can never hold",
        ClaimKind::Check => "this property can never hold",
        ClaimKind::Assume => "no caller can satisfy this assumption",
        ClaimKind::Guarantee => "this guarantee can never hold",
        ClaimKind::ModeCompleteness => "no mode of this contract can ever apply",
    };
    Diagnostic::new(Code::RPI3102, what)
        .primary(claim.span, "false in every cycle")
        .help("correct the condition, or delete it")
}

/// Returns the name of the block around a claim; empty in the body of a unit, and in a test, where all claims belong to
/// the test.
fn fragment_around(scope: &Scope<'_>, block: BlockId) -> String {
    if scope.unit.kind == UnitKind::Test {
        return String::new();
    }
    let content = scope.unit.block(block);
    let block = match (content.is_contract, content.parent) {
        (true, Some(parent)) => scope.unit.block(parent),
        _ => content,
    };
    block.name.to_string()
}

/// Returns whether an expression depends on earlier cycles: it contains a `pre`, or a call, which may have state.
fn reads_past(scope: &Scope<'_>, id: ExprId) -> bool {
    let kind = &scope.unit.expr(id).kind;
    let mut found = matches!(
        kind,
        TypedKind::Each(ElementwiseOp::Pre, _) | TypedKind::Call(_)
    );
    kind.operands(&mut |operand| found = found || reads_past(scope, operand));
    found
}

/// Part of a flow, of a sensor port or of a predeclared flow that a claim reads: `count` leaves (scalar parts) from
/// leaf `first` on.
#[derive(PartialEq)]
struct ReadPart {
    /// Name of the flow or port that is read, as written in the claim.
    name: String,
    flow: Option<FlowId>,
    /// Expression that reads the part.
    expr: ExprId,
    first: usize,
    count: usize,
}

impl ReadPart {
    fn is_same(&self, other: &ReadPart) -> bool {
        (&self.name, self.first, self.count) == (&other.name, other.first, other.count)
    }
}

/// Appends the flows and parts of flows that an expression reads to `parts`, in text order and without duplicates.
fn tuple_elements(scope: &Scope<'_>, id: ExprId, parts: &mut Vec<ReadPart>) {
    match read_part(scope, id) {
        Some(part) if parts.iter().any(|known| known.is_same(&part)) => {}
        Some(part) => parts.push(part),
        None => {
            let kind = &scope.unit.expr(id).kind;
            kind.operands(&mut |operand| tuple_elements(scope, operand, parts));
        }
    }
}

/// Returns the leaves (scalar parts) that an expression of the form `flow`, `flow.part` or `device.port`, or a
/// predeclared flow, reads; `None` for any other expression.
fn read_part(scope: &Scope<'_>, id: ExprId) -> Option<ReadPart> {
    let unit = scope.unit;
    let expr = unit.expr(id);
    let whole = |name: String, flow: Option<FlowId>| ReadPart {
        name,
        flow,
        expr: id,
        first: 0,
        count: expr.ty.leaf_count(),
    };
    match &expr.kind {
        TypedKind::Flow(flow) => Some(whole(flow_name(unit, *flow), Some(*flow))),
        TypedKind::Part { base, at } => read_part(scope, *base).map(|part| ReadPart {
            first: part.first + *at as usize,
            count: expr.ty.leaf_count(),
            ..part
        }),
        TypedKind::Sensor { device, port } => {
            let TypedKind::Flow(device) = unit.expr(*device).kind else {
                return None;
            };
            let port = unit
                .device_type_instance(device)?
                .ports
                .get(*port as usize)?;
            Some(whole(
                format!("{}.{}", unit.flow(device).name, port.name),
                None,
            ))
        }
        TypedKind::Prim(call) => {
            let name = crate::typed::predeclared::predeclared_flow_of_prim(call.prim.desc().name)?;
            Some(whole(name.to_owned(), None))
        }
        _ => None,
    }
}

/// Returns the name of a flow, with the name of its block before it if the block is a fragment or state.
fn flow_name(unit: &Unit, flow: FlowId) -> String {
    let flow = unit.flow(flow);
    match unit.block(flow.block) {
        block if block.is_contract || block.parent.is_none() => flow.name.to_string(),
        block => format!("{}.{}", block.name, flow.name),
    }
}
