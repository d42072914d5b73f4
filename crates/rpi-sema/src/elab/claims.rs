//! Claims: what becomes of them when the net runs.
//!
//! They are left out, or end the command where they do not hold, or are published together with the flows that they
//! read, so that whoever runs the net sees when one fails and with which values.

use super::scope::Scope;
use super::signal::{Signal, nothing};
use super::{At, Elab, Mode};
use crate::ty::Ty;
use crate::typed::{BlockId, Claim, ClaimKind, Each, ExprId, FlowId, Kind, Unit, UnitKind};
use rpi_diag::{Code, Finding, Span};
use rpi_image::Value;
use rpi_image::claim::{claim_key, read_key};
use rpi_net::prim;
use rpi_net::{self as net, ClaimRead};
use rpi_prims::PrimId;

/// What becomes of the claims of a program: of its assertions and contracts.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub enum Claims {
    /// They are left out: neither they nor what only they need is computed.
    Off,
    /// They are published, with the flows that they read; the run goes on.
    #[default]
    Report,
    /// One that does not hold is a fault, which ends the command.
    Fault,
    /// Both: whoever runs the net sees what the fault comes from.
    ReportedFault,
}

impl Claims {
    fn is_reported(self) -> bool {
        matches!(self, Claims::Report | Claims::ReportedFault)
    }

    fn is_fault(self) -> bool {
        matches!(self, Claims::Fault | Claims::ReportedFault)
    }
}

impl<'u> Elab<'u> {
    /// A claim of a body or contract.
    pub(super) fn claim(
        &mut self,
        scope: &mut Scope<'u>,
        block: BlockId,
        claim: &'u Claim,
        at: At,
    ) {
        let of_test = scope.unit.kind == UnitKind::Test;
        let policy = match self.mode {
            Mode::Constant => Claims::Fault,
            _ if of_test => Claims::Report,
            _ => self.claims,
        };
        self.has_claims = true;
        if policy == Claims::Off {
            return;
        }
        let label = claim.label.as_ref().map_or("claim", |label| label.as_str());
        self.begin(&format!("{}{label}", scope.prefix));
        let condition = self.one(scope, claim.condition, at);
        // Elsewhere it may say that nothing gets there.
        let everywhere = at == At::ROOT && !of_test;
        if self.mode == Mode::Net && everywhere && condition == Signal::Const(Value::bool(false)) {
            self.findings.extend(self.never_holds(scope, claim));
        }
        if policy.is_fault() {
            self.assert(check(scope, claim), &condition, at, claim.span);
        }
        if policy.is_reported() {
            self.publish(scope, (block, claim), &condition, at);
        }
    }

    /// Publishes whether a claim holds and what it reads.
    fn publish(
        &mut self,
        scope: &mut Scope<'u>,
        (block, claim): (BlockId, &'u Claim),
        condition: &Signal,
        at: At,
    ) {
        let fragment = fragment_around(scope, block);
        let key = claim_key(self.net.claims.len() + 1);
        let condition = self.where_chosen(condition, at, claim.span);
        let port = self.export_port(&key, &condition, &Ty::Bool, at, claim.span);
        self.watched.extend(port);
        let mut parts = Vec::new();
        parts_of(scope, claim.condition, &mut parts);
        let reads = parts
            .iter()
            .flat_map(|part| self.published(scope, part, &key))
            .collect();
        self.net.claims.push(net::Claim {
            key,
            kind: claim.kind,
            path: format!("{}{fragment}", scope.prefix)
                .trim_end_matches('.')
                .to_owned(),
            of: match fragment.as_str() {
                "" => scope.unit.name.to_string(),
                name => name.to_owned(),
            },
            mode: claim.mode.as_ref().map(ToString::to_string),
            label: claim.label.as_ref().map(ToString::to_string),
            span: claim.span,
            looks_back: looks_back(scope, claim.condition),
            is_strict: !scope.unit.is_lustre,
            reads,
        });
    }

    /// A claim that is false in every cycle: of its own, or because of what this call gives.
    fn never_holds(&self, scope: &Scope<'_>, claim: &Claim) -> Option<Finding> {
        let of_its_own = || super::constant(self.units, scope.unit, claim.condition).is_ok();
        match (scope.called.filter(|_| !of_its_own()), claim.kind) {
            (None, _) => Some(never(claim)),
            (Some(call), ClaimKind::Assume) => Some(broken_by(call, claim, &scope.unit.name)),
            // It is owed where the assumptions are kept.
            (Some(_), ClaimKind::Guarantee) => None,
            (Some(call), _) => Some(never(claim).also(call, "for this call")),
        }
    }

    /// Publishes the leaves of something that a claim reads.
    fn published(&mut self, scope: &mut Scope<'u>, part: &Part, claim: &str) -> Vec<ClaimRead> {
        let expr = scope.unit.expr(part.expr);
        let wire = match part.flow {
            Some(flow) => self.flow(scope, flow, expr.span),
            // It is elaborated: the claim has been.
            None => scope.recall(part.expr, None).unwrap_or_else(nothing),
        };
        let mut leaves: Vec<(String, Ty)> = Vec::new();
        let ty = part.flow.map_or(&expr.ty, |flow| &scope.unit.flow(flow).ty);
        ty.leaves(&mut |path, ty| leaves.push((format!("{}{path}", part.name), ty.clone())));
        let leaves = leaves.into_iter().zip(wire.iter()).skip(part.first);
        let mut reads = Vec::new();
        for ((name, ty), signal) in leaves.take(part.count) {
            let key = read_key(claim, &name);
            let port = self.export_port(&key, signal, &ty, At::ROOT, expr.span);
            let ty = crate::check::outside_type(&ty).0;
            self.watched.extend(port);
            reads.push(ClaimRead {
                values: match &ty {
                    Ty::Enum(e) => e.values.iter().map(ToString::to_string).collect(),
                    _ => Vec::new(),
                },
                unit: match &ty {
                    Ty::Real(dim) if !dim.is_plain() => format!("[{dim}]"),
                    _ => String::new(),
                },
                name,
                key,
            });
        }
        reads
    }
}

/// What ends the command where a claim does not hold: what holds by the writer's word, as do assertions and what the
/// program as a whole assumes, is told from what follows. The assumptions of a callee bind its caller.
fn check(scope: &Scope<'_>, claim: &Claim) -> PrimId {
    match claim.kind {
        ClaimKind::Assert => prim!("Rpi::Assume"),
        ClaimKind::Assume if scope.prefix.is_empty() => prim!("Rpi::Assume"),
        _ => prim!("Rpi::Assert"),
    }
}

/// An assumption that is false in every cycle of a call.
fn broken_by(call: Span, claim: &Claim, of: &str) -> Finding {
    Finding::new(
        Code::RPI3102,
        format!("this call breaks an assumption of `{of}`"),
    )
    .at(call, "whatever comes in")
    .also(claim.span, "false in every cycle of the call")
    .help("give other values; or correct the assumption, if it asks for too much")
}

/// A claim that is false whatever the program does.
fn never(claim: &Claim) -> Finding {
    let what = match claim.kind {
        ClaimKind::Assert => "this assertion can never hold",
        ClaimKind::Check => "this property can never hold",
        ClaimKind::Assume => "no caller can keep this assumption",
        ClaimKind::Guarantee => "this guarantee can never be kept",
        ClaimKind::Modes => "no mode of this contract can ever apply",
    };
    Finding::new(Code::RPI3102, what)
        .at(claim.span, "false in every cycle")
        .help("correct the condition, or delete it")
}

/// The name of the fragment in place that a claim stands in; empty in the body, and in a test, whose claims are all its
/// own.
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

/// Whether an expression reads earlier cycles, itself or by what it calls.
fn looks_back(scope: &Scope<'_>, id: ExprId) -> bool {
    let kind = &scope.unit.expr(id).kind;
    let mut found = matches!(kind, Kind::Each(Each::Pre, _) | Kind::Call(_));
    kind.operands(&mut |operand| found = found || looks_back(scope, operand));
    found
}

/// Some leaves of a flow, of a device's port, or a predeclared flow.
#[derive(PartialEq)]
struct Part {
    /// Its name where the claim stands.
    name: String,
    flow: Option<FlowId>,
    /// The expression that it is read by.
    expr: ExprId,
    first: usize,
    count: usize,
}

impl Part {
    fn is(&self, other: &Part) -> bool {
        (&self.name, self.first, self.count) == (&other.name, other.first, other.count)
    }
}

/// What an expression reads, in the order of the text, each once.
fn parts_of(scope: &Scope<'_>, id: ExprId, parts: &mut Vec<Part>) {
    match part(scope, id) {
        Some(part) if parts.iter().any(|known| known.is(&part)) => {}
        Some(part) => parts.push(part),
        None => {
            let kind = &scope.unit.expr(id).kind;
            kind.operands(&mut |operand| parts_of(scope, operand, parts));
        }
    }
}

/// The leaves that `flow`, `flow.part`, `device.port` or a predeclared flow stands for.
fn part(scope: &Scope<'_>, id: ExprId) -> Option<Part> {
    let unit = scope.unit;
    let expr = unit.expr(id);
    let whole = |name: String, flow: Option<FlowId>| Part {
        name,
        flow,
        expr: id,
        first: 0,
        count: expr.ty.leaf_count(),
    };
    match &expr.kind {
        Kind::Flow(flow) => Some(whole(flow_name(unit, *flow), Some(*flow))),
        Kind::Part { base, at } => part(scope, *base).map(|part| Part {
            first: part.first + *at as usize,
            count: expr.ty.leaf_count(),
            ..part
        }),
        Kind::Sensor { device, port } => {
            let Kind::Flow(device) = unit.expr(*device).kind else {
                return None;
            };
            let port = unit.device(device)?.ports.get(*port as usize)?;
            Some(whole(
                format!("{}.{}", unit.flow(device).name, port.name),
                None,
            ))
        }
        Kind::Prim(call) => {
            let name = crate::check::predeclared_name(call.prim.desc().name)?;
            Some(whole(name.to_owned(), None))
        }
        _ => None,
    }
}

/// A flow's name as the text reads it: with the fragment in place that it belongs to.
fn flow_name(unit: &Unit, flow: FlowId) -> String {
    let flow = unit.flow(flow);
    match unit.block(flow.block) {
        block if block.is_contract || block.parent.is_none() => flow.name.to_string(),
        block => format!("{}.{}", block.name, flow.name),
    }
}
