//! Which flows can be absent: the least solution of the rules of M4, unit by unit.
//!
//! A call is judged by its callee's declared ports alone; a function lifts, so that absent arguments make its results
//! absent. What must be present and may not be is reported.

use super::Absence;
use super::reads::{Definition, Reads};
use crate::clocks::{self, Clocks};
use crate::ty::Ty;
use crate::typed::{
    Activation, BlockId, Call, Each, ExprId, FlowId, Kind, Optional, Place, PrimCall, Unit,
    UnitKind,
};
use rpi_diag::{Code, Finding, Fix, Severity, Span};
use rpi_image::{Need, Presence, Role};
use std::collections::BTreeSet;

/// What is known of a unit.
#[derive(Clone, Debug, Default)]
pub struct Facts {
    exprs: Vec<Absence>,
    flows: Vec<Absence>,
    /// By which clock its expressions and flows tick.
    pub clocks: Clocks,
}

impl Facts {
    /// Whether some leaf of an expression can be absent.
    #[must_use]
    pub fn absence(&self, id: ExprId) -> Absence {
        self.exprs
            .get(id.0 as usize)
            .cloned()
            .unwrap_or(Absence::NEVER)
    }

    /// Whether some leaf of a flow can be absent.
    #[must_use]
    pub fn flow(&self, id: FlowId) -> Absence {
        let known = self.flows.get(id.0 as usize);
        known.cloned().unwrap_or(Absence::NEVER)
    }
}

/// Finds out which flows of the units that are `sound` can be absent, and what is wrong with that.
#[must_use]
pub fn find(units: &[Unit], sound: &[bool]) -> (Vec<Facts>, Vec<Finding>) {
    let mut findings = Vec::new();
    let mut facts = Vec::with_capacity(units.len());
    for (unit, sound) in units.iter().zip(sound) {
        if !sound {
            facts.push(Facts::default());
            continue;
        }
        let before = findings.len();
        let (clocks, apart) = clocks::find(units, unit);
        findings.extend(apart.iter().cloned());
        let mut inference = Inference::new(units, unit, &clocks);
        if inference.has_source() {
            let reads = Reads::new(unit);
            inference.solve(&reads);
            let mut absent = Vec::new();
            super::demand::demand(&inference, &reads, &mut absent);
            keep_causes(&mut absent, &apart);
            findings.append(&mut absent);
            let (exprs, flows) = (inference.exprs, inference.flows);
            facts.push(Facts {
                exprs,
                flows,
                clocks,
            });
        } else {
            facts.push(Facts {
                clocks,
                ..Facts::default()
            });
        }
        findings[before..].sort_by_key(Finding::span);
    }
    for task in units {
        super::handed::handed(units, &facts, task, &mut findings);
    }
    (facts, findings)
}

/// Takes away what only follows from others, or from clocks that do not meet.
fn keep_causes(absent: &mut Vec<Finding>, apart: &[Finding]) {
    // Of what has been told to have another clock, or has it in itself, it follows that it is absent in some cycles.
    let told: BTreeSet<Span> = apart.iter().map(Finding::span).collect();
    absent.retain(|finding| !has_in_itself(&told, finding.span()));
    // Where clocks do not meet, or something in it is absent that must not be, what is needlessly asked to be present can
    // not be told.
    let is_error = |finding: &Finding| finding.severity() == Severity::Error;
    let wrong = absent.iter().filter(|finding| is_error(finding));
    let wrong: BTreeSet<Span> = wrong.map(Finding::span).collect();
    absent.retain(|finding| {
        let mut labels = finding.labels.iter();
        let is_about_wrong = labels.any(|label| has_in_itself(&wrong, label.span));
        is_error(finding) || apart.is_empty() && !is_about_wrong
    });
}

/// Whether a place is one of these, or contains one.
fn has_in_itself(places: &BTreeSet<Span>, place: Span) -> bool {
    let start = Span { end: 0, ..place };
    let within = places.range(start..).take_while(|at| at.file == place.file);
    within
        .take_while(|at| at.start < place.end)
        .any(|at| at.end <= place.end)
}

/// The solution on its way.
pub(super) struct Inference<'u> {
    pub(super) units: &'u [Unit],
    pub(super) unit: &'u Unit,
    pub(super) clocks: &'u Clocks,
    /// Empty, as long as nothing is known to be absent.
    pub(super) exprs: Vec<Absence>,
    flows: Vec<Absence>,
    /// For each block whether it may be inactive while its parent is active.
    gated: Vec<bool>,
}

impl<'u> Inference<'u> {
    fn new(units: &'u [Unit], unit: &'u Unit, clocks: &'u Clocks) -> Self {
        let declared = |optional: Optional| match optional {
            Optional::Declared(optional) => Absence::All(optional),
            Optional::Inferred => Absence::NEVER,
        };
        let mut gated: Vec<bool> = unit
            .blocks
            .iter()
            .map(|block| block.when.is_some())
            .collect();
        let automata = unit.blocks.iter().flat_map(|block| &block.automata);
        for state in automata.flat_map(|automaton| &automaton.states) {
            gated[state.block.0 as usize] = true;
        }
        // A fragment's own activation is its caller's business.
        gated[0] = false;
        Inference {
            units,
            unit,
            clocks,
            exprs: Vec::new(),
            flows: unit
                .flows
                .iter()
                .map(|flow| declared(flow.optional))
                .collect(),
            gated,
        }
    }

    /// Whether anything in the unit can make something absent at all.
    fn has_source(&self) -> bool {
        let of_expr = |kind: &Kind| match kind {
            Kind::None | Kind::When { .. } | Kind::Merge { .. } | Kind::Current(_) => true,
            Kind::Sensor { .. } | Kind::Each(Each::Coalesce, _) => true,
            Kind::Prim(call) => {
                let outputs = call.prim.desc().outputs;
                outputs
                    .iter()
                    .any(|port| !matches!(port.presence, Presence::Strict | Presence::Always))
                    && !self.prim(call).iter().all(|absent| !absent)
            }
            Kind::Call(call) => {
                self.call(call).any() || !matches!(call.activation, Activation::Always)
            }
            _ => false,
        };
        self.gated.iter().any(|gated| *gated)
            || self.clocks.any()
            || self.flows.iter().any(Absence::any)
            || self.unit.exprs.iter().any(|expr| of_expr(&expr.kind))
    }

    fn solve(&mut self, reads: &Reads<'_>) {
        self.exprs.resize(self.unit.exprs.len(), Absence::NEVER);
        for id in (0..).map(ExprId).take(self.unit.exprs.len()) {
            self.exprs[id.0 as usize] = self.expr(id, reads);
        }
        let mut changed: Vec<FlowId> = Vec::new();
        for definition in &reads.definitions {
            self.define(definition, &mut changed);
        }
        while let Some(flow) = changed.pop() {
            let mut open: Vec<u32> = reads.of_flow(flow).to_vec();
            for definition in reads.shared_by(flow) {
                self.define(&reads.definitions[*definition as usize], &mut changed);
            }
            while let Some(id) = open.pop().map(ExprId) {
                let absence = self.expr(id, reads);
                if absence == self.exprs[id.0 as usize] {
                    continue;
                }
                self.exprs[id.0 as usize] = absence;
                open.extend(reads.parents(id));
                for definition in reads.defined_by(id) {
                    self.define(&reads.definitions[*definition as usize], &mut changed);
                }
            }
        }
    }

    /// Gives inferred flows the absence of what defines them.
    fn define(&mut self, definition: &Definition<'_>, changed: &mut Vec<FlowId>) {
        match definition {
            Definition::Equation(block, equation) => {
                let value = self.exprs[equation.value.0 as usize].clone();
                let mut at = 0;
                for target in &equation.targets {
                    let count = target.ty.leaf_count();
                    if let Place::Flow { flow, at: offset } = target.place {
                        let part = value.part(at, count);
                        let part = match self.crossed(*block, self.unit.flow(flow).block) {
                            true => Absence::MAYBE,
                            false => part,
                        };
                        self.join(flow, offset as usize, &part, count, changed);
                    }
                    at += count;
                }
            }
            Definition::Shared(shared) => {
                let count = self.unit.flow(shared.flow).ty.leaf_count();
                let mut absence = Absence::All(shared.is_left_open());
                for inner in shared.contributions() {
                    let inner = self.flows[inner.0 as usize].clone();
                    absence = absence.with(&inner, count, |a, b| a || b);
                }
                self.join(shared.flow, 0, &absence, count, changed);
            }
        }
    }

    fn join(
        &mut self,
        flow: FlowId,
        at: usize,
        part: &Absence,
        count: usize,
        changed: &mut Vec<FlowId>,
    ) {
        let known = &self.flows[flow.0 as usize];
        if self.unit.flow(flow).optional != Optional::Inferred || !part.any() {
            return;
        }
        let whole = self.unit.flow(flow).ty.leaf_count();
        let part = Absence::NEVER.replaced(whole, at, part, count);
        let joined = known.with(&part, whole, |a, b| a || b);
        if joined != *known {
            self.flows[flow.0 as usize] = joined;
            changed.push(flow);
        }
    }

    /// Whether between a block and one around it lies a block that may be inactive.
    fn crossed(&self, from: BlockId, to: BlockId) -> bool {
        let mut block = from;
        let mut crossed = false;
        while block != to {
            crossed |= self.gated[block.0 as usize];
            match self.unit.block(block).parent {
                Some(parent) => block = parent,
                None => return false,
            }
        }
        crossed
    }

    /// A flow as it is seen from a block: absent, too, while a fragment around it that is not around the reader is
    /// inactive.
    fn flow(&self, flow: FlowId, reader: BlockId) -> Absence {
        let own = self.unit.flow(flow).block;
        let around: Vec<BlockId> =
            std::iter::successors(Some(reader), |block| self.unit.block(*block).parent).collect();
        let common = std::iter::successors(Some(own), |block| self.unit.block(*block).parent)
            .find(|block| around.contains(block));
        match self.crossed(own, common.unwrap_or(BlockId::ROOT)) {
            true => Absence::MAYBE,
            false => self.flows[flow.0 as usize].clone(),
        }
    }

    fn of(&self, id: ExprId) -> Absence {
        let known = self.exprs.get(id.0 as usize);
        known.cloned().unwrap_or(Absence::NEVER)
    }

    fn count(&self, id: ExprId) -> usize {
        self.unit.expr(id).ty.leaf_count()
    }

    fn expr(&self, id: ExprId, reads: &Reads<'_>) -> Absence {
        let count = self.count(id);
        let own = self.computed(id, reads);
        self.clocks.lifted(id).iter().fold(own, |absence, lift| {
            let leaves = lift.leaves.start..lift.leaves.end.min(count);
            absence.replaced(count, leaves.start, &Absence::MAYBE, leaves.len())
        })
    }

    fn computed(&self, id: ExprId, reads: &Reads<'_>) -> Absence {
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
                Absence::All(self.of(*base).any() || self.of(*index).any())
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
                Absence::All(operands.iter().any(|id| self.of(*id).any()))
            }
            Kind::Prim(call) => Absence::of(self.prim_leaves(call, &expr.ty)),
            Kind::Call(call) => self.call(call),
            Kind::When { value, .. } => self.of(*value),
            Kind::Merge { on, cases } => {
                let any = cases.iter().any(|(_, id)| self.of(*id).any());
                Absence::All(any || self.of(*on).any())
            }
            // In Lustre the initialisation analysis sees to it that nobody reads it before its first tick.
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
            (Each::If, [condition, yes, no]) => match self.of(*condition).any() {
                true => Absence::MAYBE,
                false => self.of(*yes).with(&self.of(*no), count, or),
            },
            (Each::Pre | Each::Last, [x]) => self.of(*x),
            (Each::Arrow, [a, b]) => self.of(*a).with(&self.of(*b), count, or),
            (Each::Coalesce, [a, b]) if self.covers(*a, *b) => Absence::NEVER,
            (Each::Coalesce | Each::Hold, [a, b]) => {
                let [a, b] = [a, b].map(|operand| self.read_by(id, *operand));
                a.with(&b, count, |a, b| a && b)
            }
            _ => Absence::MAYBE,
        }
    }

    /// An operand for an operator that looks at its presence: one of a slower clock is absent when that does not tick.
    pub(super) fn read_by(&self, reader: ExprId, operand: ExprId) -> Absence {
        match self.clocks.beyond(operand, reader).is_empty() {
            true => self.of(operand),
            false => Absence::MAYBE,
        }
    }

    fn covers(&self, a: ExprId, b: ExprId) -> bool {
        let total = |flow: FlowId| !self.flows[flow.0 as usize].any();
        super::exclusive::covers(self.unit, a, b, total)
    }

    /// For each out-port whether it can be absent.
    fn prim(&self, call: &PrimCall) -> Vec<bool> {
        let desc = call.prim.desc();
        let connected: Vec<bool> = call
            .inputs
            .iter()
            .flatten()
            .map(|id| self.of(*id).any())
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

    fn prim_leaves(&self, call: &PrimCall, ty: &Ty) -> impl Iterator<Item = bool> + use<> {
        let ports = self.prim(call);
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

    fn call(&self, call: &Call) -> Absence {
        let callee = &self.units[call.unit.0 as usize];
        if callee.kind == UnitKind::Function {
            let lifted = call.args.iter().flatten().any(|id| self.of(*id).any());
            if lifted {
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
                when_it_runs.with(&self.of(before), count, |run, before| run || before)
            }
            Activation::Always | Activation::Restart { .. } => when_it_runs,
        }
    }

    /// A flow that no equation of the unit can make absent.
    pub(super) fn must_be_present(&self, flow: FlowId) -> bool {
        let flow = self.unit.flow(flow);
        flow.role.has_equation() && flow.optional == Optional::Declared(false)
    }

    /// `x ?? y` for `if present(x) then x else y`.
    fn present_or(&self, id: ExprId) -> Option<Fix> {
        let Kind::Each(Each::If, operands) = &self.unit.expr(id).kind else {
            return None;
        };
        let [condition, yes, no] = operands[..] else {
            return None;
        };
        let Kind::Present(asked) = self.unit.expr(condition).kind else {
            return None;
        };
        let flow = |id: ExprId| match self.unit.expr(id).kind {
            Kind::Flow(flow) => Some(flow),
            _ => None,
        };
        let same = flow(asked).is_some() && flow(asked) == flow(yes);
        let [whole, yes, no] = [id, yes, no].map(|id| self.unit.expr(id).span);
        let before = Span {
            end: yes.start,
            ..whole
        };
        let between = Span {
            start: yes.end,
            end: no.start,
            ..whole
        };
        let fix = Fix::maybe("write `x ?? y`")
            .replace(before, "")
            .replace(between, " ?? ");
        same.then_some(fix)
    }

    /// A value with another behind it for where it is absent.
    pub(super) fn coalesced(&self, id: ExprId, otherwise: &str) -> Fix {
        let span = self.unit.expr(id).span;
        let fix = Fix::maybe(format!("take `{otherwise}` where it is absent"));
        match self.unit.expr(id).kind {
            Kind::Flow(_) | Kind::Part { .. } | Kind::Call(_) => {
                fix.insert_after(span, format!(" ?? {otherwise}"))
            }
            _ => fix
                .insert_before(span, "(")
                .insert_after(span, format!(") ?? {otherwise}")),
        }
    }

    /// Reports a value that may be absent where it must not.
    pub(super) fn absent_here(&self, id: ExprId, why: &str) -> Finding {
        let span = self.unit.expr(id).span;
        let message = match self.unit.expr(id).kind {
            Kind::Flow(flow) => format!("`{}` may be absent here", self.unit.flow(flow).name),
            _ => "this may be absent".to_owned(),
        };
        let finding = Finding::new(Code::RPI3001, message).at(span, why.to_owned());
        let finding = match self.present_or(id) {
            Some(fix) => finding
                .help("`x ?? y` is `x` where it is present, and `y` where it is not")
                .fix(fix),
            None => {
                finding.help("say what holds then: `x ?? other`, `hold(x, init)`, or `present(x)`")
            }
        };
        match super::demand::origin(self, id) {
            Some((span, text)) => finding.also(span, text),
            None => finding,
        }
    }
}
