//! Presence analysis: which flows can be absent. Computes the least solution of the rules of M4, unit by unit.
//!
//! A call is analysed by its callee's declared ports only. A function is lifted: absent arguments make its results
//! absent. A value that must be present but may be absent is reported.

use crate::clocks::{self, ClockId, Clocks, InactiveBlocks};
use crate::facts::Absence;
use crate::facts::dependents::Definition;
use crate::facts::dependents::Dependents;
use crate::reuse::Memo;
use crate::typed::{Activation, ElementwiseOp, TypedKind};
use crate::typed::{BlockId, ExprId, FlowId, FlowPresence, TargetPlace, Unit};
use rpi_diag::suppression::{self, Cause, suppress};
use rpi_diag::{Diagnostic, Severity};
use rpi_image::Presence;
use std::rc::Rc;

/// Results of the analyses of a unit: the clocks of its values, and which values may be absent.
#[derive(Clone, Debug, Default)]
pub struct Facts {
    exprs: Vec<Absence>,
    pub(super) flows: Vec<Absence>,
    /// Clocks of the unit's expressions and flows.
    pub clocks: Clocks,
}

impl Facts {
    /// Returns which leaves (scalar parts) of an expression can be absent.
    #[must_use]
    pub fn absence(&self, id: ExprId) -> Absence {
        self.exprs
            .get(id.0 as usize)
            .cloned()
            .unwrap_or(Absence::NEVER)
    }

    /// Returns which leaves (scalar parts) of a flow can be absent.
    #[must_use]
    pub fn flow_absence(&self, id: FlowId) -> Absence {
        let known = self.flows.get(id.0 as usize);
        known.cloned().unwrap_or(Absence::NEVER)
    }
}

/// Results of the analysis of each unit, with its diagnostics.
pub type FactsMemo = Memo<(Rc<Facts>, Vec<Diagnostic>)>;

/// Infers clocks and absence in the units for which `sound` is true, those without type errors. Returns the results for
/// all units, by index, and the diagnostics.
#[must_use]
pub fn analyse(units: &[Rc<Unit>], sound: &[bool]) -> (Vec<Rc<Facts>>, Vec<Diagnostic>) {
    analyse_reusing(units, sound, &[], &mut FactsMemo::default())
}

/// Returns the results of [`analyse`], and reuses those of the last analysis with the same `memo`. `versions` has for each
/// unit a number that is the same if the unit and all that it calls are the same; 0 if the results must not be reused.
#[must_use]
pub fn analyse_reusing(
    units: &[Rc<Unit>],
    sound: &[bool],
    versions: &[u64],
    memo: &mut FactsMemo,
) -> (Vec<Rc<Facts>>, Vec<Diagnostic>) {
    let mut all: Vec<Vec<Diagnostic>> = vec![Vec::new(); units.len()];
    let none = Rc::new(Facts::default());
    let mut facts: Vec<Rc<Facts>> = units.iter().map(|_| none.clone()).collect();
    for at in callees_first(units) {
        if sound.get(at).copied().unwrap_or(false) {
            let version = versions.get(at).copied().unwrap_or(0);
            let (found, diagnostics) = memo.get_or_compute(version, || {
                let (found, mut diagnostics) = compute_unit_properties(units, &facts, &units[at]);
                diagnostics.sort_by_key(Diagnostic::span);
                (Rc::new(found), diagnostics)
            });
            facts[at] = found;
            all[at] = diagnostics;
        }
    }
    memo.end_round();
    let mut diagnostics: Vec<Diagnostic> = all.into_iter().flatten().collect();
    for task in units.iter().filter(|unit| !unit.steps.is_empty()) {
        crate::facts::takeover::value_sources(units, &facts, task, &mut diagnostics);
    }
    (facts, diagnostics)
}

/// Returns the results for all units, also for those with errors. `known` has those that an analysis has computed.
#[must_use]
pub fn analyse_rest(units: &[Rc<Unit>], known: &[Option<Rc<Facts>>]) -> Vec<Rc<Facts>> {
    let none = Rc::new(Facts::default());
    let known = |at: usize| known.get(at).cloned().flatten();
    let mut facts: Vec<Rc<Facts>> = (0..units.len())
        .map(|at| known(at).unwrap_or_else(|| none.clone()))
        .collect();
    for at in callees_first(units) {
        if known(at).is_none() {
            facts[at] = Rc::new(compute_unit_properties(units, &facts, &units[at]).0);
        }
    }
    facts
}

/// Returns the results of the analyses of one unit. `facts` must have the results for the units that it calls.
fn compute_unit_properties(
    units: &[Rc<Unit>],
    facts: &[Rc<Facts>],
    unit: &Unit,
) -> (Facts, Vec<Diagnostic>) {
    let (clocks, mut diagnostics) = clocks::infer(units, facts, unit);
    let mut inference = PresenceInference::new(units, facts, unit, &clocks);
    if !inference.can_be_absent() {
        let found = Facts {
            clocks,
            ..Facts::default()
        };
        return (found, diagnostics);
    }
    let reads = Dependents::new(unit);
    inference.solve(&reads);
    let mut absent = Vec::new();
    crate::facts::presence_check::check_presence(&inference, &reads, &mut absent);
    remove_consequences(&mut absent, &diagnostics);
    diagnostics.append(&mut absent);
    let (exprs, flows) = (inference.exprs, inference.flows);
    let found = Facts {
        exprs,
        flows,
        clocks,
    };
    (found, diagnostics)
}

/// Returns the indices of the units, each after the units that it calls. A recursion is cut at an arbitrary unit.
pub(crate) fn callees_first(units: &[Rc<Unit>]) -> Vec<usize> {
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
                    TypedKind::Call(call) => Some(call.unit.0 as usize),
                    _ => None,
                });
                open.extend(calls.filter(|callee| !met[*callee]).map(|at| (at, false)));
            }
        }
    }
    order
}

/// Removes diagnostics about absent values that are consequences of others, or of `mismatches` between clocks.
fn remove_consequences(absent: &mut Vec<Diagnostic>, mismatches: &[Diagnostic]) {
    let several_clocks = mismatches.iter().map(Diagnostic::span).collect();
    suppress(absent, Cause::ClockMismatch(&several_clocks));
    if !mismatches.is_empty() {
        suppression::suppress_warnings(absent);
    }
    let errors = absent.iter().filter(|f| f.severity() == Severity::Error);
    let values = errors.map(Diagnostic::span).collect();
    suppress(absent, Cause::AbsentValues(&values));
}

/// State of inferring which values of one unit can be absent.
pub(super) struct PresenceInference<'u> {
    pub(super) units: &'u [Rc<Unit>],
    pub(super) facts: &'u [Rc<Facts>],
    pub(super) unit: &'u Unit,
    pub(super) clocks: &'u Clocks,
    /// For each expression, which of its leaves can be absent. Empty until `solve` starts.
    pub(super) exprs: Vec<Absence>,
    pub(super) flows: Vec<Absence>,
    pub(super) inactive_blocks: InactiveBlocks<'u>,
}

impl<'u> PresenceInference<'u> {
    fn new(
        units: &'u [Rc<Unit>],
        facts: &'u [Rc<Facts>],
        unit: &'u Unit,
        clocks: &'u Clocks,
    ) -> Self {
        let declared = |optional: FlowPresence| match optional {
            FlowPresence::Declared(optional) => Absence::Uniform(optional),
            FlowPresence::Inferred => Absence::NEVER,
        };
        PresenceInference {
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
            inactive_blocks: InactiveBlocks::new(unit),
        }
    }

    /// Returns whether anything in the unit can be absent. For most units, the inference can be skipped.
    fn can_be_absent(&self) -> bool {
        let of_expr = |(id, kind): (ExprId, &TypedKind)| match kind {
            TypedKind::None
            | TypedKind::When { .. }
            | TypedKind::Merge { .. }
            | TypedKind::Current(_) => true,
            TypedKind::Sensor { .. } | TypedKind::Each(ElementwiseOp::Coalesce, _) => true,
            TypedKind::Prim(call) => {
                let outputs = call.prim.desc().outputs;
                outputs
                    .iter()
                    .any(|port| !matches!(port.presence, Presence::Strict | Presence::Always))
                    && !self.add_prim(id, call).iter().all(|absent| !absent)
            }
            TypedKind::Call(call) => {
                self.call(id, call).any() || !matches!(call.activation, Activation::Always)
            }
            _ => false,
        };
        self.inactive_blocks.has_inactive()
            || self.clocks.has_samplings()
            || self.flows.iter().any(Absence::any)
            || (0..)
                .map(ExprId)
                .zip(&self.unit.exprs)
                .any(|(id, expr)| of_expr((id, &expr.kind)))
    }

    fn solve(&mut self, reads: &Dependents<'_>) {
        self.exprs.resize(self.unit.exprs.len(), Absence::NEVER);
        for id in (0..).map(ExprId).take(self.unit.exprs.len()) {
            self.exprs[id.0 as usize] = self.expr(id, reads);
        }
        // Absence only ever grows, so the iteration ends.
        let mut changed: Vec<FlowId> = Vec::new();
        for definition in &reads.definitions {
            self.update_definition(definition, &mut changed);
        }
        while let Some(flow) = changed.pop() {
            let mut open: Vec<u32> = reads.flow_readers(flow).to_vec();
            for definition in reads.definitions_of_shared(flow) {
                self.update_definition(&reads.definitions[*definition as usize], &mut changed);
            }
            while let Some(id) = open.pop().map(ExprId) {
                let absence = self.expr(id, reads);
                if absence == self.exprs[id.0 as usize] {
                    continue;
                }
                self.exprs[id.0 as usize] = absence;
                open.extend(reads.parents(id));
                for definition in reads.definitions_of_expr(id) {
                    self.update_definition(&reads.definitions[*definition as usize], &mut changed);
                }
            }
        }
    }

    /// Updates which leaves of the flows that a definition defines can be absent. Appends the changed flows to
    /// `changed`.
    fn update_definition(&mut self, definition: &Definition<'_>, changed: &mut Vec<FlowId>) {
        match definition {
            Definition::Equation(block, equation) => {
                let mut at = 0;
                for target in &equation.targets {
                    let count = target.ty.leaf_count();
                    if let TargetPlace::Flow { flow, at: offset } = target.place {
                        let part =
                            self.value_for_targets(equation.value, (at, count), &target.place);
                        let part = match self
                            .inactive_blocks
                            .crosses_inactive(*block, self.unit.flow(flow).block)
                        {
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
                let mut absence = Absence::Uniform(shared.is_partially_defined());
                for inner in shared.contributions() {
                    let slower = |k: usize| {
                        let clocks =
                            [inner, shared.flow].map(|id| self.clocks.flow_clocks(id).leaf(k));
                        self.clocks.is_slower(clocks[0], clocks[1])
                    };
                    let inner = self.flows[inner.0 as usize].clone();
                    let inner = inner.or(count, slower);
                    absence = absence.combine(&inner, count, |a, b| a || b);
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
        if self.unit.flow(flow).optional != FlowPresence::Inferred || !part.any() {
            return;
        }
        let whole = self.unit.flow(flow).ty.leaf_count();
        let part = Absence::NEVER.replaced(whole, at, part, count);
        let joined = known.combine(&part, whole, |a, b| a || b);
        if joined != *known {
            self.flows[flow.0 as usize] = joined;
            changed.push(flow);
        }
    }

    /// Returns the absence of a flow for an expression in the block `reader`. A flow of a block that may be inactive
    /// can be absent outside of the block.
    pub(super) fn flow(&self, flow: FlowId, reader: BlockId) -> Absence {
        match self.inactive_blocks.is_outside(flow, reader) {
            true => Absence::MAYBE,
            false => self.flows[flow.0 as usize].clone(),
        }
    }

    pub(super) fn absence(&self, id: ExprId) -> Absence {
        let known = self.exprs.get(id.0 as usize);
        known.cloned().unwrap_or(Absence::NEVER)
    }

    pub(super) fn count(&self, id: ExprId) -> usize {
        self.unit.expr(id).ty.leaf_count()
    }

    /// Returns the absence of a value for an expression on the clock `reader`. The value is also absent while its own
    /// clock does not tick.
    pub(super) fn on_clock(&self, id: ExprId, reader: ClockId) -> Absence {
        let slower = |k: usize| self.clocks.is_slower(self.clocks.leaf(id, k), reader);
        match self.clocks.expr_clocks(id).uniform() {
            Some(_) if slower(0) => Absence::MAYBE,
            Some(_) => self.absence(id),
            None => self.absence(id).or(self.count(id), slower),
        }
    }

    /// Returns the absence of an operand of the elementwise operator `reader`, leaf by leaf on the clock of the result.
    pub(super) fn for_reader(&self, reader: ExprId, operand: ExprId) -> Absence {
        match self.clocks.expr_clocks(reader).uniform() {
            Some(clock) => self.on_clock(operand, clock),
            None => {
                let leaf = |k: usize| [operand, reader].map(|id| self.clocks.leaf(id, k));
                let slower = |k: usize| self.clocks.is_slower(leaf(k)[0], leaf(k)[1]);
                self.absence(operand).or(self.count(reader), slower)
            }
        }
    }

    /// Returns the absence of `count` leaves of an equation's value, from leaf `first` on, on the clock of the flow
    /// they define.
    pub(super) fn value_for_targets(
        &self,
        value: ExprId,
        (first, count): (usize, usize),
        place: &TargetPlace,
    ) -> Absence {
        let wanted = |k: usize| match place {
            TargetPlace::Flow { flow, at } => self.clocks.flow_clocks(*flow).leaf(*at as usize + k),
            _ => ClockId::BASE,
        };
        let slower = |k: usize| {
            self.clocks
                .is_slower(self.clocks.leaf(value, first + k), wanted(k))
        };
        let part = self.absence(value).part(first, count);
        match self.clocks.has_samplings() {
            true => part.or(count, slower),
            false => part,
        }
    }

    /// Returns whether an operand of the strict operator or call `reader` may be absent when that is evaluated.
    pub(super) fn is_absent_in(&self, reader: ExprId, operand: ExprId) -> bool {
        self.on_clock(operand, self.clocks.computed_on(reader))
            .any()
    }

    /// Returns whether a flow is defined by equations and declared as always present.
    pub(super) fn must_be_present(&self, flow: FlowId) -> bool {
        let flow = self.unit.flow(flow);
        flow.role.has_equation() && flow.optional == FlowPresence::Declared(false)
    }
}
