//! Checks for clock mismatches. The message names both the clock found and the clock expected.

use crate::clocks::clock::Clock;
use crate::clocks::clock_help::sample_or_hold;
use crate::clocks::constants::case_clock;
use crate::clocks::initialisation::presence_phrase;
use crate::clocks::leaf_clocks::LeafClocks;
use crate::clocks::solve::Solver;
use crate::clocks::span_set::SpanSet;
use crate::facts::Definition;
use crate::typed::{Call, ElementwiseOp, TypedKind};
use crate::typed::{Equation, ExprId, FlowId, FlowPresence, TargetPlace};
use rpi_diag::{Code, Diagnostic, Fix, Span};
use std::collections::{BTreeMap, BTreeSet};

const CLOCK_MISMATCH: &str = "clock mismatch";

/// Checks the clocks of a unit after inference and returns the errors.
pub(super) fn check(solver: &mut Solver<'_>) -> Vec<Diagnostic> {
    let faulty = vec![false; solver.unit.exprs.len()];
    let mut check = Check {
        solver,
        has_error: faulty,
        diagnostics: Vec::new(),
        reported: BTreeSet::new(),
        sampled_currents: BTreeMap::new(),
        currents: Vec::new(),
    };
    check.declarations();
    for id in (0..)
        .map(ExprId)
        .take(check.has_error.len())
        .collect::<Vec<_>>()
    {
        check.expr(id);
    }
    check.equations();
    check.check_base_clock_reads();
    check.check_useless_currents();
    check.diagnostics
}

pub(super) struct Check<'s, 'u> {
    pub(super) solver: &'s mut Solver<'u>,
    /// For each expression, whether it or one of its operands has a reported error. Expressions that read it are then
    /// not checked.
    has_error: Vec<bool>,
    pub(super) diagnostics: Vec<Diagnostic>,
    reported: BTreeSet<Span>,
    /// For each `current x` in an expression `current x when c`, the location of the whole expression.
    sampled_currents: BTreeMap<ExprId, Span>,
    /// `current` expressions with an operand that has a value in every cycle, so that `current` has no effect; each
    /// with its operand.
    currents: Vec<(ExprId, ExprId)>,
}

impl<'u> Check<'_, 'u> {
    fn declarations(&mut self) {
        for (id, flow) in (0..).map(FlowId).zip(&self.solver.unit.flows) {
            let clock = self.solver.flows[id.0 as usize].leaf(0);
            if flow.clock.is_some() && self.solver.chain(clock).is_none() {
                let text = "the clock of this flow depends on the flow itself";
                self.report(flow.span, text.to_owned(), sample_or_hold(self.is_lustre()));
            }
        }
    }

    pub(super) fn is_lustre(&self) -> bool {
        self.solver.unit.is_lustre
    }

    pub(super) fn row(&self, id: ExprId) -> LeafClocks<Clock> {
        self.solver.exprs[id.0 as usize].clone()
    }

    /// Checks the clocks of the operands of an expression, and records whether there is an error.
    fn expr(&mut self, id: ExprId) {
        let unit = self.solver.unit;
        let kind = &unit.expr(id).kind;
        let mut operands = Vec::new();
        kind.operands(&mut |operand| operands.push(operand));
        if operands.iter().any(|id| self.has_error[id.0 as usize]) {
            self.has_error[id.0 as usize] = true;
            return;
        }
        let own = self.row(id);
        let fits = match kind {
            TypedKind::Part { .. }
            | TypedKind::Slice { .. }
            | TypedKind::Repeat(_)
            | TypedKind::Replace { .. } => true,
            TypedKind::Build(_) => true,
            TypedKind::When { value, .. } => self.add_when(id, *value),
            TypedKind::Merge { on, cases } => cases.iter().all(|(value, case)| {
                let wanted = case_clock(self.solver, *on, *value);
                wanted.is_none_or(|wanted| self.check_exact(*case, &LeafClocks::Uniform(wanted)))
            }),
            TypedKind::Current(operand) => {
                if self.row(*operand).iter().any(|clock| clock == Clock::BASE) {
                    self.currents.push((id, *operand));
                }
                true
            }
            TypedKind::Call(call) => self.arguments(id, call),
            TypedKind::Each(each, operands) if !self.is_lustre() => {
                self.check_initialisation(id, *each, operands)
            }
            TypedKind::Each(..) => operands
                .iter()
                .all(|operand| self.check_exact(*operand, &own)),
            _ => self.strict(id, &operands),
        };
        self.has_error[id.0 as usize] = !fits;
    }

    /// Checks the clocks of the operands of a strict operator, which needs all of them, and returns whether they are
    /// correct. Outside of Lustre, operands with slower clocks are optional, so that only the last operand of
    /// `s - 1 when c` is checked: there, the whole expression was probably meant to be sampled.
    fn strict(&mut self, id: ExprId, operands: &[ExprId]) -> bool {
        let own = LeafClocks::Uniform(self.row(id).leaf(0));
        match self.sampled_last_operand(id, operands) {
            Some(end) => self.check_sampled_last_operand(id, end, &own),
            None if self.is_lustre() => operands
                .iter()
                .all(|operand| self.check_exact(*operand, &own)),
            None => true,
        }
    }

    /// Whether all leaves (scalar parts) of an expression have the expected clocks. Reports a mismatch.
    fn check_exact(&mut self, id: ExprId, wanted: &LeafClocks<Clock>) -> bool {
        let own = self.row(id);
        let count = self.solver.unit.expr(id).ty.leaf_count().max(1);
        let count = match (&own, wanted) {
            (LeafClocks::Uniform(_), LeafClocks::Uniform(_)) => 1,
            _ => count,
        };
        let mut pairs = (0..count).map(|k| (own.leaf(k), wanted.leaf(k)));
        match pairs.find(|(own, wanted)| own != wanted) {
            Some((found, wanted)) => self.report_mismatch(found, wanted, id),
            None => true,
        }
    }

    fn report_mismatch(&mut self, found: Clock, wanted: Clock, id: ExprId) -> bool {
        let help = self.mismatch_help(found, wanted, id);
        let [found, wanted] = [found, wanted].map(|clock| self.describe(clock));
        let text = format!(
            "this value is present {}, but is needed {wanted}",
            presence_phrase(&found)
        );
        self.report(self.solver.unit.expr(id).span, text, help);
        false
    }

    /// Returns the last operand of an expression such as `s - 1 when c` if only that operand is sampled; `None`
    /// otherwise.
    fn sampled_last_operand(&self, id: ExprId, operands: &[ExprId]) -> Option<ExprId> {
        let unit = self.solver.unit;
        let (last, others) = operands.split_last()?;
        let (whole, part) = (unit.expr(id).span, unit.expr(*last));
        let TypedKind::When { value, .. } = part.kind else {
            return None;
        };
        let is_sampled = |id: &ExprId| matches!(unit.expr(*id).kind, TypedKind::When { .. });
        let value = unit.expr(value).span;
        let is_end = part.span.end == whole.end && value.end <= part.span.end;
        (is_end && !others.iter().any(is_sampled)).then_some(*last)
    }

    /// Checks that the last operand `end` of an expression such as `s - 1 when c` has the clock `own` of the
    /// expression. On a mismatch, the fix samples the whole expression. Returns whether the clock is correct.
    fn check_sampled_last_operand(
        &mut self,
        id: ExprId,
        end: ExprId,
        own: &LeafClocks<Clock>,
    ) -> bool {
        if self.check_exact(end, own) {
            return true;
        }
        let unit = self.solver.unit;
        let (whole, part) = (unit.expr(id).span, unit.expr(end));
        if let (Some(diagnostic), TypedKind::When { value, .. }) =
            (self.diagnostics.last_mut(), &part.kind)
            && diagnostic.span() == part.span
        {
            let fix = Fix::maybe("sample the whole")
                .insert_before(whole, "(")
                .insert_after(unit.expr(*value).span, ")");
            // The help for the mismatch would only apply to the last operand.
            diagnostic.help = vec![
                "`when` binds before other operators: the parentheses make it sample the whole"
                    .to_owned(),
            ];
            *diagnostic = diagnostic.clone().fix(fix);
        }
        false
    }

    /// Whether the operand `value` of `when` has a clock that the operator accepts: the clock of the condition, or a
    /// faster one. Outside of Lustre, every clock is accepted, because the value of a slower operand is optional.
    fn add_when(&mut self, id: ExprId, value: ExprId) -> bool {
        let unit = self.solver.unit;
        self.sampled_currents.insert(value, unit.expr(id).span);
        if !self.is_lustre() {
            return true;
        }
        let own = self.row(id).leaf(0);
        let parent = self.solver.parent(own).unwrap_or(Clock::BASE);
        let chain = self.solver.chain(parent).unwrap_or_default();
        let is_faster = |clock: Clock| chain.contains(&clock);
        self.row(value).iter().all(is_faster)
            || self.check_exact(value, &LeafClocks::Uniform(parent))
    }

    fn arguments(&mut self, id: ExprId, call: &'u Call) -> bool {
        let units = self.solver.units;
        let callee = &units[call.unit.0 as usize];
        let base = self.solver.calls.get(&id).copied().unwrap_or(Clock::BASE);
        let mut fits = true;
        for (formal, arg) in callee.inputs.iter().zip(&call.args) {
            let Some(arg) = arg else { continue };
            let path = self.solver.port_path(call, callee, *formal, 0);
            if self.is_lustre() || !path.is_empty() {
                let wanted = self.solver.translate_clock(id, call, &path, base);
                fits &= self.check_exact(*arg, &LeafClocks::Uniform(wanted));
            }
        }
        let mut deciding = Vec::new();
        call.activation.operands(&mut |id| deciding.push(id));
        if self.is_lustre() {
            for operand in deciding {
                fits &= self.check_exact(operand, &LeafClocks::Uniform(base));
            }
        }
        fits
    }

    /// Checks that the value of each equation has the clock of the flow that it defines, unless that flow may be absent
    /// in further cycles.
    fn equations(&mut self) {
        for k in 0..self.solver.reads.definitions.len() {
            if let Definition::Equation(_, equation) = self.solver.reads.definitions[k]
                && !self.has_error[equation.value.0 as usize]
            {
                self.equation(equation);
            }
        }
    }

    fn equation(&mut self, equation: &Equation) {
        let value = self.row(equation.value);
        let mut first = 0;
        for target in &equation.targets {
            let count = target.ty.leaf_count();
            let part = value.part(first, count);
            first += count;
            let own = match target.place {
                TargetPlace::Flow { flow, .. } if !self.accepts_slower(flow) => {
                    self.solver.flows[flow.0 as usize].leaf(0)
                }
                TargetPlace::Port { .. } if self.is_lustre() => Clock::BASE,
                _ => continue,
            };
            let mut clocks = part.iter();
            if let Some(clock) = clocks.find(|clock| *clock != own && own != Clock::ANY) {
                self.report_mismatch(clock, own, equation.value);
                self.hint_kept_value(target, equation.value);
                return;
            }
        }
    }

    /// Whether a flow accepts a value with a slower clock than its own: its clock is inferred, or it is declared
    /// optional.
    fn accepts_slower(&self, flow: FlowId) -> bool {
        self.solver.inferred[flow.0 as usize]
            || !self.is_lustre()
                && self.solver.unit.flow(flow).optional == FlowPresence::Declared(true)
    }

    /// In Lustre, checks that conditions of blocks, ends and transitions, and exported values, are on the base clock.
    fn check_base_clock_reads(&mut self) {
        if !self.is_lustre() {
            return;
        }
        for block in &self.solver.unit.blocks {
            let ends = block.ends.iter().map(|end| end.condition);
            let exports = block.exports.iter().map(|export| export.value);
            let states = block
                .automata
                .iter()
                .flat_map(|automaton| &automaton.states);
            let transitions = states.flat_map(|state| state.unless.iter().chain(&state.until));
            let transitions = transitions.filter_map(|transition| transition.condition);
            let all = block.when.into_iter().chain(ends).chain(exports);
            for id in all.chain(transitions) {
                if !self.has_error[id.0 as usize] {
                    self.check_exact(id, &LeafClocks::Uniform(Clock::BASE));
                }
            }
        }
    }

    pub(super) fn describe(&self, clock: Clock) -> String {
        let mut chain = self.solver.chain(clock).unwrap_or_default();
        chain.reverse();
        let ticks = chain
            .iter()
            .filter_map(|clock| self.solver.ticks.sampling(*clock));
        let path: Vec<crate::clocks::Sampling> = ticks.collect();
        match path.is_empty() {
            true => "in all cycles".to_owned(),
            false => {
                let solver = &self.solver;
                let text =
                    crate::clocks::format_clock(solver.units, solver.facts, solver.unit, &path);
                format!("`{text}`")
            }
        }
    }

    fn report(&mut self, span: Span, text: String, help: String) {
        if self.reported.insert(span) {
            let diagnostic = Diagnostic::new(Code::RPI3007, CLOCK_MISMATCH).primary(span, text);
            self.diagnostics.push(diagnostic.help(help));
        }
    }

    /// Adds a diagnostic, unless a clock error has been reported at the same location.
    pub(super) fn add(&mut self, diagnostic: Diagnostic) {
        if self.reported.insert(diagnostic.span()) {
            self.diagnostics.push(diagnostic);
        }
    }

    /// Reports `current` of a flow that has a value in every cycle. The diagnostic lists operands of different clocks
    /// as a possible cause.
    fn check_useless_currents(&mut self) {
        // A mismatch around this place has been reported already; this one would follow from it.
        let reported = SpanSet::new(&self.reported);
        for (id, operand) in std::mem::take(&mut self.currents) {
            let unit = self.solver.unit;
            let span = unit.expr(id).span;
            if reported.contains(span) || !self.reported.insert(span) {
                continue;
            }
            let mut parts = Vec::new();
            unit.expr(operand)
                .kind
                .operands(&mut |part| parts.push(part));
            let own = self.row(operand).leaf(0);
            let is_call = matches!(
                unit.expr(operand).kind,
                TypedKind::Call(_) | TypedKind::When { .. }
            );
            let clocks = parts.into_iter().filter(|_| !is_call);
            let clocks = clocks.map(|part| (part, self.solver.common_clock(part)));
            let clocks: Vec<_> = clocks.collect();
            let is_base = clocks.iter().all(|(_, clock)| *clock == own);
            let label = match is_base {
                true => "`current` of a flow on the base clock has no effect",
                false => "the operands in this `current` have different clocks",
            };
            let mut diagnostic =
                Diagnostic::new(Code::RPI3007, CLOCK_MISMATCH).primary(span, label);
            for (part, clock) in clocks.into_iter().filter(|_| !is_base) {
                let text = match clock == Clock::BASE {
                    true => "this operand is on the base clock".to_owned(),
                    false => format!("the clock of this operand is {}", self.describe(clock)),
                };
                diagnostic = diagnostic.secondary(unit.expr(part).span, text);
            }
            let diagnostic = match self.sampled_currents.get(&id) {
                Some(whole) => diagnostic
                    .help("`current` binds before `when`: the parentheses make it hold what is sampled")
                    .fix(
                        Fix::maybe("hold what is sampled")
                            .insert_before(unit.expr(operand).span, "(")
                            .insert_after(*whole, ")"),
                    ),
                None if is_base => diagnostic.help(
                    "leave out `current`, which holds a value that is sampled by `when`",
                ),
                None if self.is_lustre() => diagnostic.help(sample_or_hold(true)),
                None => diagnostic.help(format!(
                    "operands of different clocks are present together in some cycles: {} holds their latest result",
                    self.held(operand)
                )),
            };
            self.diagnostics.push(diagnostic);
        }
    }

    /// Whether the operands of an initialisation (`->`, or `if` on the first cycle) have the same clock. Reports a
    /// mismatch. Operands of any other `if` may have different clocks.
    fn check_initialisation(
        &mut self,
        id: ExprId,
        each: ElementwiseOp,
        operands: &[ExprId],
    ) -> bool {
        match (each, operands) {
            (ElementwiseOp::Arrow, [a, b]) => self.check_same_clock(id, [*a, *b]),
            (ElementwiseOp::If, [condition, a, b]) if self.is_first(*condition) => {
                self.check_same_clock(id, [*a, *b])
            }
            _ => true,
        }
    }

    fn is_first(&self, condition: ExprId) -> bool {
        let kind = &self.solver.unit.expr(condition).kind;
        matches!(kind, TypedKind::Prim(call) if call.prim.desc().role == rpi_image::Role::First)
    }
}
