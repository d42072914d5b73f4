//! Absence of an expression, from that of its operands.

use crate::facts::Absence;
use crate::facts::dependents::Reads;
use crate::facts::presence::Inference;
use crate::ty::Ty;
use crate::typed::{Activation, Call, Each, Kind, PrimCall};
use crate::typed::{ExprId, FlowId, UnitKind};
use rpi_image::{Need, Presence, Role};

impl Inference<'_> {
    pub(super) fn expr(&self, id: ExprId, reads: &Reads<'_>) -> Absence {
        let expr = self.unit.expr(id);
        let count = expr.ty.leaf_count();
        match &expr.kind {
            Kind::Fault | Kind::Const(_) | Kind::Literal(_) | Kind::Outside | Kind::Present(_) => {
                Absence::NEVER
            }
            Kind::None => Absence::MAYBE,
            Kind::Flow(flow) => self.flow(*flow, reads.blocks[id.0 as usize]),
            Kind::Sensor { device, port } => self.sensor(*device, *port),
            Kind::Part { base, at } => self.of(*base).part(*at as usize, count),
            Kind::Slice { base, .. } | Kind::Repeat(base) => Absence::All(self.of(*base).any()),
            Kind::Select { base, index } => {
                let slowest = |operand: &ExprId| self.is_absent_in(id, *operand);
                let one = self.clocks.row(id).one().is_some();
                Absence::All([base, index].into_iter().any(slowest) || !one)
            }
            Kind::Build(parts) => {
                let leaves = parts.iter().flat_map(|part| {
                    let absence = self.of(*part);
                    (0..self.count(*part)).map(move |k| absence.leaf(k))
                });
                Absence::of(leaves)
            }
            Kind::Replace { base, at, value } => {
                let part = self.of(*value);
                self.of(*base)
                    .replaced(count, *at as usize, &part, self.count(*value))
            }
            Kind::Each(each, operands) => self.each(*each, operands, id),
            Kind::Equal { operands, .. } => {
                Absence::All(operands.iter().any(|one| self.is_absent_in(id, *one)))
            }
            Kind::Prim(call) => Absence::of(self.prim_leaves(id, call, &expr.ty)),
            Kind::Call(call) => self.call(id, call),
            Kind::When { value, .. } => {
                let slower = |k: usize| !self.clocks.beyond_sampled(*value, k, id).1.is_empty();
                match self.clocks.any() {
                    true => self.of(*value).or(count, slower),
                    false => self.of(*value),
                }
            }
            Kind::Merge { on, cases } => {
                let any = cases.iter().any(|(_, id)| self.of(*id).any());
                Absence::All(any || self.of(*on).any())
            }
            // In Lustre the initialisation analysis rejects reads before the first tick.
            Kind::Current(operand) if self.unit.is_lustre => self.of(*operand),
            Kind::Current(_) => Absence::MAYBE,
        }
    }

    fn sensor(&self, device: ExprId, port: u32) -> Absence {
        match &self.unit.expr(device).ty {
            Ty::Device(device) => {
                let port = device.ports.get(port as usize);
                Absence::All(port.is_some_and(|port| port.optional))
            }
            _ => Absence::NEVER,
        }
    }

    fn each(&self, each: Each, operands: &[ExprId], id: ExprId) -> Absence {
        let count = self.count(id);
        let or = |a: bool, b: bool| a || b;
        match (each, operands) {
            (Each::If, [condition, yes, no]) => {
                let [yes, no] = [yes, no].map(|branch| self.seen_by(id, *branch));
                let undecided = |k: usize| {
                    let clock = self.clocks.leaf(id, k);
                    self.seen_at(*condition, clock).any()
                };
                match self.clocks.row(id).one() {
                    Some(_) if undecided(0) => Absence::MAYBE,
                    Some(_) => yes.with(&no, count, or),
                    None => yes.with(&no, count, or).or(count, undecided),
                }
            }
            (Each::Pre | Each::Last, [x]) => self.of(*x),
            (Each::Arrow, [a, b]) => {
                let [a, b] = [a, b].map(|side| self.seen_by(id, *side));
                a.with(&b, count, or)
            }
            (Each::Coalesce, [a, b]) if self.covers(*a, *b) => Absence::NEVER,
            (Each::Coalesce | Each::Hold, [a, b]) => {
                let [a, b] = [a, b].map(|operand| self.seen_by(id, *operand));
                a.with(&b, count, |a, b| a && b)
            }
            _ => Absence::MAYBE,
        }
    }

    fn covers(&self, a: ExprId, b: ExprId) -> bool {
        let total = |flow: FlowId| !self.flows[flow.0 as usize].any();
        crate::facts::exclusive_fragments::covers(self.unit, a, b, total)
    }

    /// Returns for each output of a primitive whether it can be absent.
    pub(super) fn prim(&self, id: ExprId, call: &PrimCall) -> Vec<bool> {
        let desc = call.prim.desc();
        let connected: Vec<bool> = call
            .inputs
            .iter()
            .flatten()
            .map(|input| self.is_absent_in(id, *input))
            .collect();
        let is_open = |(port, given): (&rpi_image::InPort, &Option<ExprId>)| {
            given.is_none() && matches!(port.need, Need::Absent | Need::Required)
        };
        let open = desc.inputs.iter().zip(&call.inputs).any(is_open);
        let some = connected.iter().any(|absent| *absent);
        let rule = |presence: Presence| match presence {
            Presence::Always => false,
            Presence::Maybe => true,
            Presence::Strict => some,
            Presence::IfAll => some || open,
            Presence::IfAny => !connected.iter().any(|absent| !absent),
        };
        let is_delay = desc.role == Role::Delay;
        let outputs = desc
            .outputs
            .iter()
            .map(|port| rule(port.presence) || (is_delay && some));
        outputs.collect()
    }

    fn prim_leaves(
        &self,
        id: ExprId,
        call: &PrimCall,
        ty: &Ty,
    ) -> impl Iterator<Item = bool> + use<> {
        let ports = self.prim(id, call);
        let counts: Vec<usize> = match (&ports[..], ty) {
            ([_], ty) => vec![ty.leaf_count()],
            (_, ty) => ty
                .members()
                .iter()
                .map(|member| member.ty.leaf_count())
                .collect(),
        };
        let leaves = ports.into_iter().zip(counts);
        leaves.flat_map(|(absent, count)| std::iter::repeat_n(absent, count))
    }

    pub(super) fn call(&self, id: ExprId, call: &Call) -> Absence {
        let callee = &self.units[call.unit.0 as usize];
        if callee.kind == UnitKind::Function {
            let is_absent = |(port, arg): (&FlowId, &Option<ExprId>)| {
                arg.is_some_and(|arg| self.given(id, callee.flow(*port), arg).any())
            };
            if callee.inputs.iter().zip(&call.args).any(is_absent) {
                return Absence::MAYBE;
            }
        }
        let when_it_runs = Absence::of(callee.optional_leaves());
        match call.activation {
            Activation::Condact { default: None, .. } => Absence::MAYBE,
            Activation::Condact {
                default: Some(before),
                ..
            } => {
                let count = callee.optional_leaves().count();
                when_it_runs.with(&self.seen_by(id, before), count, |run, before| {
                    run || before
                })
            }
            Activation::Always | Activation::Restart { .. } => when_it_runs,
        }
    }
}
