//! Absence of an expression, from that of its operands.

use crate::facts::Absence;
use crate::facts::dependents::Dependents;
use crate::facts::presence::PresenceInference;
use crate::ty::Ty;
use crate::typed::{Activation, Call, ElementwiseOp, PrimCall, TypedKind};
use crate::typed::{ExprId, FlowId, UnitKind};
use rpi_image::{Fallback, Presence, Role};

impl PresenceInference<'_> {
    pub(super) fn expr(&self, id: ExprId, reads: &Dependents<'_>) -> Absence {
        let expr = self.unit.expr(id);
        let count = expr.ty.leaf_count();
        match &expr.kind {
            TypedKind::Error
            | TypedKind::Const(_)
            | TypedKind::Literal(_)
            | TypedKind::Arbitrary
            | TypedKind::Present(_) => Absence::NEVER,
            TypedKind::None => Absence::MAYBE,
            TypedKind::Flow(flow) => self.flow(*flow, reads.blocks[id.0 as usize]),
            TypedKind::Sensor { device, port } => self.sensor(*device, *port),
            TypedKind::Part { base, at } => self.absence(*base).part(*at as usize, count),
            TypedKind::Slice { base, .. } | TypedKind::Repeat(base) => {
                Absence::Uniform(self.absence(*base).any())
            }
            TypedKind::Select { base, index } => {
                let slowest = |operand: &ExprId| self.is_absent_in(id, *operand);
                let one = self.clocks.expr_clocks(id).uniform().is_some();
                Absence::Uniform([base, index].into_iter().any(slowest) || !one)
            }
            TypedKind::Build(parts) => {
                let leaves = parts.iter().flat_map(|part| {
                    let absence = self.absence(*part);
                    (0..self.count(*part)).map(move |k| absence.leaf(k))
                });
                Absence::from_leaves(leaves)
            }
            TypedKind::Replace { base, at, value } => {
                let part = self.absence(*value);
                self.absence(*base)
                    .replaced(count, *at as usize, &part, self.count(*value))
            }
            TypedKind::Each(each, operands) => self.each(*each, operands, id),
            TypedKind::Equal { operands, .. } => {
                Absence::Uniform(operands.iter().any(|one| self.is_absent_in(id, *one)))
            }
            TypedKind::Prim(call) => Absence::from_leaves(self.prim_leaves(id, call, &expr.ty)),
            TypedKind::Call(call) => self.call(id, call),
            TypedKind::When { value, .. } => self.when(*value, id, count),
            TypedKind::Merge { on, cases } => {
                let any = cases.iter().any(|(_, id)| self.absence(*id).any());
                Absence::Uniform(any || self.absence(*on).any())
            }
            // In Lustre the initialisation analysis rejects reads before the first tick.
            TypedKind::Current(operand) if self.unit.is_lustre => self.absence(*operand),
            TypedKind::Current(_) => Absence::MAYBE,
        }
    }

    fn when(&self, value: ExprId, id: ExprId, count: usize) -> Absence {
        if !self.clocks.has_samplings() {
            return self.absence(value);
        }
        let is_slower = |k: usize| {
            !self
                .clocks
                .split_operand_samplings(value, k, id)
                .1
                .is_empty()
        };
        self.absence(value).or(count, is_slower)
    }

    fn sensor(&self, device: ExprId, port: u32) -> Absence {
        match &self.unit.expr(device).ty {
            Ty::Device(device) => {
                let port = device.ports.get(port as usize);
                Absence::Uniform(port.is_some_and(|port| port.optional))
            }
            _ => Absence::NEVER,
        }
    }

    /// Returns which leaves (scalar parts) of `if c then yes else no`, the expression `id`, can be absent: those for
    /// which the condition or a branch can be absent.
    fn choice(&self, condition: ExprId, [yes, no]: [Absence; 2], id: ExprId) -> Absence {
        let count = self.count(id);
        let branches = yes.combine(&no, count, |yes, no| yes || no);
        let undecided = |k: usize| {
            let clock = self.clocks.leaf(id, k);
            self.on_clock(condition, clock).any()
        };
        match self.clocks.expr_clocks(id).uniform() {
            Some(_) if undecided(0) => Absence::MAYBE,
            Some(_) => branches,
            None => branches.or(count, undecided),
        }
    }

    fn each(&self, each: ElementwiseOp, operands: &[ExprId], id: ExprId) -> Absence {
        let count = self.count(id);
        let or = |a: bool, b: bool| a || b;
        match (each, operands) {
            (ElementwiseOp::If, [condition, yes, no]) => {
                let branches = [yes, no].map(|branch| self.for_reader(id, *branch));
                self.choice(*condition, branches, id)
            }
            (ElementwiseOp::Pre | ElementwiseOp::Last, [x]) => self.absence(*x),
            (ElementwiseOp::Arrow, [a, b]) => {
                let [a, b] = [a, b].map(|side| self.for_reader(id, *side));
                a.combine(&b, count, or)
            }
            (ElementwiseOp::Coalesce, [a, b]) if self.covers(*a, *b) => Absence::NEVER,
            (ElementwiseOp::Coalesce | ElementwiseOp::Hold, [a, b]) => {
                let [a, b] = [a, b].map(|operand| self.for_reader(id, *operand));
                a.combine(&b, count, |a, b| a && b)
            }
            _ => Absence::MAYBE,
        }
    }

    fn covers(&self, a: ExprId, b: ExprId) -> bool {
        let total = |flow: FlowId| !self.flows[flow.0 as usize].any();
        crate::facts::exclusive_fragments::is_always_present(self.unit, a, b, total)
    }

    /// Returns for each output of a primitive whether it can be absent. `id` is the expression of the call.
    pub(super) fn add_prim(&self, id: ExprId, call: &PrimCall) -> Vec<bool> {
        let desc = call.prim.desc();
        let connected: Vec<bool> = call
            .inputs
            .iter()
            .flatten()
            .map(|input| self.is_absent_in(id, *input))
            .collect();
        let is_open = |(port, given): (&rpi_image::InPort, &Option<ExprId>)| {
            given.is_none() && matches!(port.fallback, Fallback::AbsentValue | Fallback::Required)
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
        let ports = self.add_prim(id, call);
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
                arg.is_some_and(|arg| self.argument_absence(id, callee.flow(*port), arg).any())
            };
            if callee.inputs.iter().zip(&call.args).any(is_absent) {
                return Absence::MAYBE;
            }
        }
        let when_it_runs = Absence::from_leaves(callee.optional_leaves());
        match call.activation {
            Activation::Condact { default: None, .. } => Absence::MAYBE,
            Activation::Condact {
                default: Some(before),
                ..
            } => {
                let count = callee.optional_leaves().count();
                when_it_runs.combine(&self.for_reader(id, before), count, |run, before| {
                    run || before
                })
            }
            Activation::Always | Activation::Restart { .. } => when_it_runs,
        }
    }
}
