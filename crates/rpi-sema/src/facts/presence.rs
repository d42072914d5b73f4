//! Presence analysis: which flows can be absent. Computes the least solution of the rules of M4, unit by unit.
//!
//! A call is analysed by its callee's declared ports only. A function is lifted: absent arguments make its results
//! absent. A value that must be present but may be absent is reported.

use crate::clocks::{self, Borders, ClockId, Clocks};
use crate::facts::Absence;
use crate::facts::dependents::Definition;
use crate::facts::dependents::Reads;
use crate::typed::{Activation, Each, Kind};
use crate::typed::{BlockId, ExprId, FlowId, Optional, Place, Unit};
use rpi_diag::{Code, Finding, Fix, Severity, Span};
use rpi_image::Presence;
use std::collections::BTreeSet;

/// Results of the analyses of a unit.
#[derive(Clone, Debug, Default)]
pub struct Facts {
    exprs: Vec<Absence>,
    pub(super) flows: Vec<Absence>,
    /// Clocks of the unit's expressions and flows.
    pub clocks: Clocks,
}

impl Facts {
    /// Returns which leaves of an expression can be absent.
    #[must_use]
    pub fn absence(&self, id: ExprId) -> Absence {
        self.exprs
            .get(id.0 as usize)
            .cloned()
            .unwrap_or(Absence::NEVER)
    }

    /// Returns which leaves of a flow can be absent.
    #[must_use]
    pub fn flow(&self, id: FlowId) -> Absence {
        let known = self.flows.get(id.0 as usize);
        known.cloned().unwrap_or(Absence::NEVER)
    }
}

/// Analyses the units that are `sound` and returns the facts of all units and the diagnostics.
#[must_use]
pub fn find(units: &[Unit], sound: &[bool]) -> (Vec<Facts>, Vec<Finding>) {
    let mut all: Vec<Vec<Finding>> = vec![Vec::new(); units.len()];
    let mut facts = vec![Facts::default(); units.len()];
    for at in callees_first(units) {
        if sound.get(at).copied().unwrap_or(false) {
            let (found, mut findings) = of_unit(units, &facts, &units[at]);
            findings.sort_by_key(Finding::span);
            facts[at] = found;
            all[at] = findings;
        }
    }
    let mut findings: Vec<Finding> = all.into_iter().flatten().collect();
    for task in units {
        crate::facts::takeover::handed(units, &facts, task, &mut findings);
    }
    (facts, findings)
}

/// Analyses one unit. `facts` must hold the results of its callees.
fn of_unit(units: &[Unit], facts: &[Facts], unit: &Unit) -> (Facts, Vec<Finding>) {
    let (clocks, mut findings) = clocks::find(units, facts, unit);
    let apart = findings.clone();
    let mut inference = Inference::new(units, facts, unit, &clocks);
    if !inference.has_source() {
        let found = Facts {
            clocks,
            ..Facts::default()
        };
        return (found, findings);
    }
    let reads = Reads::new(unit);
    inference.solve(&reads);
    let mut absent = Vec::new();
    crate::facts::presence_check::demand(&inference, &reads, &mut absent);
    keep_causes(&mut absent, &apart);
    findings.append(&mut absent);
    let (exprs, flows) = (inference.exprs, inference.flows);
    let found = Facts {
        exprs,
        flows,
        clocks,
    };
    (found, findings)
}

/// Returns the indices of the units, callees before callers. Recursion is broken at an arbitrary unit.
fn callees_first(units: &[Unit]) -> Vec<usize> {
    let mut order = Vec::with_capacity(units.len());
    let mut met = vec![false; units.len()];
    for start in 0..units.len() {
        // Iterative, because a chain of calls may be longer than the stack is deep.
        let mut open = vec![(start, false)];
        while let Some((at, is_left)) = open.pop() {
            if is_left {
                order.push(at);
            } else if !std::mem::replace(&mut met[at], true) {
                open.push((at, true));
                let calls = units[at].exprs.iter().filter_map(|expr| match &expr.kind {
                    Kind::Call(call) => Some(call.unit.0 as usize),
                    _ => None,
                });
                open.extend(calls.filter(|callee| !met[*callee]).map(|at| (at, false)));
            }
        }
    }
    order
}

/// Removes diagnostics that only follow from others, or from clock mismatches (`apart`).
fn keep_causes(absent: &mut Vec<Finding>, apart: &[Finding]) {
    // An expression with a clock mismatch, in itself or inside, is absent in some cycles as a consequence.
    let told: BTreeSet<Span> = apart.iter().map(Finding::span).collect();
    absent.retain(|finding| !has_in_itself(&told, finding.span()));
    // After a clock mismatch or an absence error inside the expression, a warning about a needless `??` may be wrong.
    let is_error = |finding: &Finding| finding.severity() == Severity::Error;
    let wrong = absent.iter().filter(|finding| is_error(finding));
    let wrong: BTreeSet<Span> = wrong.map(Finding::span).collect();
    absent.retain(|finding| {
        let mut labels = finding.labels.iter();
        let is_about_wrong = labels.any(|label| has_in_itself(&wrong, label.span));
        is_error(finding) || apart.is_empty() && !is_about_wrong
    });
}

/// Returns whether `place` equals or contains one of the spans.
fn has_in_itself(places: &BTreeSet<Span>, place: Span) -> bool {
    let start = Span { end: 0, ..place };
    let within = places.range(start..).take_while(|at| at.file == place.file);
    within
        .take_while(|at| at.start < place.end)
        .any(|at| at.end <= place.end)
}

/// State of the presence inference for one unit.
pub(super) struct Inference<'u> {
    pub(super) units: &'u [Unit],
    pub(super) facts: &'u [Facts],
    pub(super) unit: &'u Unit,
    pub(super) clocks: &'u Clocks,
    /// Absence of each expression. Empty until `solve` starts.
    pub(super) exprs: Vec<Absence>,
    pub(super) flows: Vec<Absence>,
    pub(super) borders: Borders<'u>,
}

impl<'u> Inference<'u> {
    fn new(units: &'u [Unit], facts: &'u [Facts], unit: &'u Unit, clocks: &'u Clocks) -> Self {
        let declared = |optional: Optional| match optional {
            Optional::Declared(optional) => Absence::All(optional),
            Optional::Inferred => Absence::NEVER,
        };
        Inference {
            units,
            facts,
            unit,
            clocks,
            exprs: Vec::new(),
            flows: unit
                .flows
                .iter()
                .map(|flow| declared(flow.optional))
                .collect(),
            borders: Borders::new(unit),
        }
    }

    /// Returns whether anything in the unit can be absent. Most units can skip the inference.
    fn has_source(&self) -> bool {
        let of_expr = |(id, kind): (ExprId, &Kind)| match kind {
            Kind::None | Kind::When { .. } | Kind::Merge { .. } | Kind::Current(_) => true,
            Kind::Sensor { .. } | Kind::Each(Each::Coalesce, _) => true,
            Kind::Prim(call) => {
                let outputs = call.prim.desc().outputs;
                outputs
                    .iter()
                    .any(|port| !matches!(port.presence, Presence::Strict | Presence::Always))
                    && !self.prim(id, call).iter().all(|absent| !absent)
            }
            Kind::Call(call) => {
                self.call(id, call).any() || !matches!(call.activation, Activation::Always)
            }
            _ => false,
        };
        self.borders.any()
            || self.clocks.any()
            || self.flows.iter().any(Absence::any)
            || (0..)
                .map(ExprId)
                .zip(&self.unit.exprs)
                .any(|(id, expr)| of_expr((id, &expr.kind)))
    }

    fn solve(&mut self, reads: &Reads<'_>) {
        self.exprs.resize(self.unit.exprs.len(), Absence::NEVER);
        for id in (0..).map(ExprId).take(self.unit.exprs.len()) {
            self.exprs[id.0 as usize] = self.expr(id, reads);
        }
        // Absence only ever grows, so the iteration ends.
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

    /// Updates the absence of inferred flows from their definition.
    fn define(&mut self, definition: &Definition<'_>, changed: &mut Vec<FlowId>) {
        match definition {
            Definition::Equation(block, equation) => {
                let mut at = 0;
                for target in &equation.targets {
                    let count = target.ty.leaf_count();
                    if let Place::Flow { flow, at: offset } = target.place {
                        let part = self.taken(equation.value, (at, count), &target.place);
                        let part = match self.borders.crossed(*block, self.unit.flow(flow).block) {
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
                    let slower = |k: usize| {
                        let clocks = [inner, shared.flow].map(|id| self.clocks.flow(id).leaf(k));
                        self.clocks.is_slower(clocks[0], clocks[1])
                    };
                    let inner = self.flows[inner.0 as usize].clone();
                    let inner = inner.or(count, slower);
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

    /// Returns the absence of a flow for a reader in a block. Outside a block that may be inactive it may be absent.
    pub(super) fn flow(&self, flow: FlowId, reader: BlockId) -> Absence {
        match self.borders.is_outside(flow, reader) {
            true => Absence::MAYBE,
            false => self.flows[flow.0 as usize].clone(),
        }
    }

    pub(super) fn of(&self, id: ExprId) -> Absence {
        let known = self.exprs.get(id.0 as usize);
        known.cloned().unwrap_or(Absence::NEVER)
    }

    pub(super) fn count(&self, id: ExprId) -> usize {
        self.unit.expr(id).ty.leaf_count()
    }

    /// Returns the absence of a value for a reader on one clock: also absent where the value's own clock does not tick.
    pub(super) fn seen_at(&self, id: ExprId, reader: ClockId) -> Absence {
        let slower = |k: usize| self.clocks.is_slower(self.clocks.leaf(id, k), reader);
        match self.clocks.row(id).one() {
            Some(_) if slower(0) => Absence::MAYBE,
            Some(_) => self.of(id),
            None => self.of(id).or(self.count(id), slower),
        }
    }

    /// Returns the absence of an operand of an elementwise operator.
    pub(super) fn seen_by(&self, reader: ExprId, operand: ExprId) -> Absence {
        match self.clocks.row(reader).one() {
            Some(clock) => self.seen_at(operand, clock),
            None => {
                let leaf = |k: usize| [operand, reader].map(|id| self.clocks.leaf(id, k));
                let slower = |k: usize| self.clocks.is_slower(leaf(k)[0], leaf(k)[1]);
                self.of(operand).or(self.count(reader), slower)
            }
        }
    }

    /// Returns the absence of leaves of a value on the clock of the equation's target.
    pub(super) fn taken(
        &self,
        value: ExprId,
        (first, count): (usize, usize),
        place: &Place,
    ) -> Absence {
        let wanted = |k: usize| match place {
            Place::Flow { flow, at } => self.clocks.flow(*flow).leaf(*at as usize + k),
            _ => ClockId::BASE,
        };
        let slower = |k: usize| {
            self.clocks
                .is_slower(self.clocks.leaf(value, first + k), wanted(k))
        };
        let part = self.of(value).part(first, count);
        match self.clocks.any() {
            true => part.or(count, slower),
            false => part,
        }
    }

    /// Returns whether an operand of a strict operator or call may be absent.
    pub(super) fn is_absent_in(&self, reader: ExprId, operand: ExprId) -> bool {
        self.seen_at(operand, self.clocks.place(reader)).any()
    }

    /// Returns whether a flow is defined by equations and declared as present.
    pub(super) fn must_be_present(&self, flow: FlowId) -> bool {
        let flow = self.unit.flow(flow);
        flow.role.has_equation() && flow.optional == Optional::Declared(false)
    }

    /// Returns a fix that rewrites `if present(x) then x else y` to `x ?? y`.
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
        let fix = Fix::maybe("replace it with `x ?? y`")
            .replace(before, "")
            .replace(between, " ?? ");
        same.then_some(fix)
    }

    /// Returns a fix that appends `?? otherwise` to an expression.
    pub(super) fn coalesced(&self, id: ExprId, otherwise: &str) -> Fix {
        let span = self.unit.expr(id).span;
        let fix = Fix::maybe(format!("use `{otherwise}` while it is absent"));
        match self.unit.expr(id).kind {
            Kind::Flow(_) | Kind::Part { .. } | Kind::Call(_) => {
                fix.insert_after(span, format!(" ?? {otherwise}"))
            }
            _ => fix
                .insert_before(span, "(")
                .insert_after(span, format!(") ?? {otherwise}")),
        }
    }

    /// Reports a value that may be absent but must be present, for a reader on clock `reader`. `why` is the label.
    pub(super) fn absent_here(&self, id: ExprId, reader: ClockId, why: &str) -> Finding {
        let span = self.unit.expr(id).span;
        let message = match self.unit.expr(id).kind {
            Kind::Flow(flow) => format!("`{}` may be absent here", self.unit.flow(flow).name),
            _ => "this value may be absent".to_owned(),
        };
        let finding = Finding::new(Code::RPI3001, message).at(span, why.to_owned());
        let finding = match self.present_or(id) {
            Some(fix) => finding
                .help("`x ?? y` is `x` where it is present, and `y` where it is not")
                .fix(fix),
            None => {
                finding.help("handle the absence: `x ?? other`, `hold(x, init)`, or `present(x)`")
            }
        };
        match crate::facts::presence_check::origin(self, id, reader) {
            Some((span, text)) => finding.also(span, text),
            None => finding,
        }
    }
}
