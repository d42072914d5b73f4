//! Checks for clock mismatches. The message names both the clock found and the clock expected.

use crate::clocks::clock::Clock;
use crate::clocks::constants::case_clock;
use crate::clocks::leaf_clocks::Row;
use crate::clocks::solve::Solver;
use crate::clocks::span_set::Covered;
use crate::facts::Definition;
use crate::typed::{Call, Each, Kind};
use crate::typed::{Equation, ExprId, FlowId, Optional, Place};
use rpi_diag::{Code, Finding, Fix, Span};
use std::collections::{BTreeMap, BTreeSet};

const APART: &str = "clock mismatch";

const SAMPLE_OR_HOLD: &str =
    "sample the faster flow (`x when c`), or hold the slower one (`current x`)";

/// Checks the clocks of a unit and returns the errors.
pub(super) fn check(solver: &mut Solver<'_>) -> Vec<Finding> {
    let faulty = vec![false; solver.unit.exprs.len()];
    let mut check = Check {
        solver,
        faulty,
        findings: Vec::new(),
        reported: BTreeSet::new(),
        sampled_currents: BTreeMap::new(),
        currents: Vec::new(),
    };
    check.declarations();
    for id in (0..)
        .map(ExprId)
        .take(check.faulty.len())
        .collect::<Vec<_>>()
    {
        check.expr(id);
    }
    check.equations();
    check.read_always();
    check.not_sampled();
    check.findings
}

pub(super) struct Check<'s, 'u> {
    pub(super) solver: &'s mut Solver<'u>,
    /// For each expression, whether it or one of its operands has been reported. Its readers are then not checked.
    faulty: Vec<bool>,
    findings: Vec<Finding>,
    reported: BTreeSet<Span>,
    /// For each `current` that is sampled directly (`current x when c`), the span of the whole expression.
    sampled_currents: BTreeMap<ExprId, Span>,
    /// `current` expressions whose operand has a leaf on the base clock, each with that operand.
    currents: Vec<(ExprId, ExprId)>,
}

impl<'u> Check<'_, 'u> {
    fn declarations(&mut self) {
        for (id, flow) in (0..).map(FlowId).zip(&self.solver.unit.flows) {
            let clock = self.solver.flows[id.0 as usize].leaf(0);
            if flow.clock.is_some() && self.solver.chain(clock).is_none() {
                let text = "the clock of this flow depends on the flow itself";
                self.report(flow.span, text.to_owned());
            }
        }
    }

    fn is_lustre(&self) -> bool {
        self.solver.unit.is_lustre
    }

    fn row(&self, id: ExprId) -> Row<Clock> {
        self.solver.exprs[id.0 as usize].clone()
    }

    /// Checks the operands of an expression.
    fn expr(&mut self, id: ExprId) {
        let unit = self.solver.unit;
        let kind = &unit.expr(id).kind;
        let mut operands = Vec::new();
        kind.operands(&mut |operand| operands.push(operand));
        if operands.iter().any(|id| self.faulty[id.0 as usize]) {
            self.faulty[id.0 as usize] = true;
            return;
        }
        let own = self.row(id);
        let fits = match kind {
            Kind::Part { .. } | Kind::Slice { .. } | Kind::Repeat(_) | Kind::Replace { .. } => true,
            Kind::Build(_) => true,
            Kind::When { value, .. } => self.sampled(id, *value),
            Kind::Merge { on, cases } => cases.iter().all(|(value, case)| {
                let wanted = case_clock(self.solver, *on, *value);
                wanted.is_none_or(|wanted| self.exact(*case, &Row::All(wanted)))
            }),
            Kind::Current(operand) => {
                if self.row(*operand).iter().any(|clock| clock == Clock::BASE) {
                    self.currents.push((id, *operand));
                }
                true
            }
            Kind::Call(call) => self.arguments(id, call),
            Kind::Each(each, operands) if !self.is_lustre() => {
                self.is_of_one_clock(id, *each, operands)
            }
            Kind::Each(..) => operands.iter().all(|operand| self.exact(*operand, &own)),
            _ => self.strict(id, &operands),
        };
        self.faulty[id.0 as usize] = !fits;
    }

    /// Checks the operands of a strict operator. Outside Lustre, operands of slower clocks are optional, so only the
    /// last operand of `s - 1 when c` is checked: there the whole was probably meant to be sampled.
    fn strict(&mut self, id: ExprId, operands: &[ExprId]) -> bool {
        let own = Row::All(self.row(id).leaf(0));
        match self.sampled_end(id, operands) {
            Some(end) => self.sampled_in_part(id, end, &own),
            None if self.is_lustre() => operands.iter().all(|operand| self.exact(*operand, &own)),
            None => true,
        }
    }

    /// Returns whether all leaves of an expression have the expected clocks. Reports a mismatch.
    fn exact(&mut self, id: ExprId, wanted: &Row<Clock>) -> bool {
        let own = self.row(id);
        let count = self.solver.unit.expr(id).ty.leaf_count().max(1);
        let count = match (&own, wanted) {
            (Row::All(_), Row::All(_)) => 1,
            _ => count,
        };
        let mut pairs = (0..count).map(|k| (own.leaf(k), wanted.leaf(k)));
        match pairs.find(|(own, wanted)| own != wanted) {
            Some((found, wanted)) => self.apart(found, wanted, self.solver.unit.expr(id).span),
            None => true,
        }
    }

    fn apart(&mut self, found: Clock, wanted: Clock, span: Span) -> bool {
        let [found, wanted] = [found, wanted].map(|clock| self.words(clock));
        let text = format!("expected a value {wanted}, found one {found}");
        self.report(span, text);
        false
    }

    /// Returns the last operand of `s - 1 when c` if only that operand is sampled.
    fn sampled_end(&self, id: ExprId, operands: &[ExprId]) -> Option<ExprId> {
        let unit = self.solver.unit;
        let (last, others) = operands.split_last()?;
        let (whole, part) = (unit.expr(id).span, unit.expr(*last));
        let Kind::When { value, .. } = part.kind else {
            return None;
        };
        let is_sampled = |id: &ExprId| matches!(unit.expr(*id).kind, Kind::When { .. });
        let value = unit.expr(value).span;
        let is_end = part.span.end == whole.end && value.end <= part.span.end;
        (is_end && !others.iter().any(is_sampled)).then_some(*last)
    }

    /// Checks the last operand of `s - 1 when c`. On a mismatch, suggests sampling the whole expression.
    fn sampled_in_part(&mut self, id: ExprId, end: ExprId, own: &Row<Clock>) -> bool {
        if self.exact(end, own) {
            return true;
        }
        let unit = self.solver.unit;
        let (whole, part) = (unit.expr(id).span, unit.expr(end));
        if let (Some(told), Kind::When { value, .. }) = (self.findings.last_mut(), &part.kind)
            && told.span() == part.span
        {
            let fix = Fix::maybe("sample the whole")
                .insert_before(whole, "(")
                .insert_after(unit.expr(*value).span, ")");
            *told = told
                .clone()
                .help("`when` binds before other operators: `(a - b) when c`")
                .fix(fix);
        }
        false
    }

    /// Returns whether the operand of `when` has the clock of the deciding flow or a faster one in its chain. Outside
    /// Lustre, a slower operand is optional and always accepted.
    fn sampled(&mut self, id: ExprId, value: ExprId) -> bool {
        let unit = self.solver.unit;
        self.sampled_currents.insert(value, unit.expr(id).span);
        if !self.is_lustre() {
            return true;
        }
        let own = self.row(id).leaf(0);
        let parent = self.solver.parent(own).unwrap_or(Clock::BASE);
        let chain = self.solver.chain(parent).unwrap_or_default();
        let is_faster = |clock: Clock| chain.contains(&clock);
        self.row(value).iter().all(is_faster) || self.exact(value, &Row::All(parent))
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
                let wanted = self.solver.through(id, call, &path, base);
                fits &= self.exact(*arg, &Row::All(wanted));
            }
        }
        let mut deciding = Vec::new();
        call.activation.operands(&mut |id| deciding.push(id));
        if self.is_lustre() {
            for operand in deciding {
                fits &= self.exact(operand, &Row::All(base));
            }
        }
        fits
    }

    /// Checks that each equation's value has the clock of its target, unless the target may be absent beyond its clock.
    fn equations(&mut self) {
        for k in 0..self.solver.reads.definitions.len() {
            if let Definition::Equation(_, equation) = self.solver.reads.definitions[k]
                && !self.faulty[equation.value.0 as usize]
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
                Place::Flow { flow, .. } if !self.is_lifted(flow) => {
                    self.solver.flows[flow.0 as usize].leaf(0)
                }
                Place::Port { .. } if self.is_lustre() => Clock::BASE,
                _ => continue,
            };
            let mut clocks = part.iter();
            if let Some(clock) = clocks.find(|clock| *clock != own && own != Clock::ANY) {
                self.apart(clock, own, self.solver.unit.expr(equation.value).span);
                return;
            }
        }
    }

    /// Returns whether a flow also accepts values of slower clocks.
    fn is_lifted(&self, flow: FlowId) -> bool {
        self.solver.inferred[flow.0 as usize]
            || !self.is_lustre() && self.solver.unit.flow(flow).optional == Optional::Declared(true)
    }

    /// In Lustre, checks that conditions of blocks, ends and transitions, and exported values, are on the base clock.
    fn read_always(&mut self) {
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
                if !self.faulty[id.0 as usize] {
                    self.exact(id, &Row::All(Clock::BASE));
                }
            }
        }
    }

    pub(super) fn words(&self, clock: Clock) -> String {
        let mut chain = self.solver.chain(clock).unwrap_or_default();
        chain.reverse();
        let ticks = chain
            .iter()
            .filter_map(|clock| self.solver.ticks.tick(*clock));
        let path: Vec<crate::clocks::Tick> = ticks.collect();
        match path.is_empty() {
            true => "in all cycles".to_owned(),
            false => {
                let solver = &self.solver;
                let text = crate::clocks::print(solver.units, solver.facts, solver.unit, &path);
                format!("`{text}`")
            }
        }
    }

    fn report(&mut self, span: Span, text: String) {
        if self.reported.insert(span) {
            let finding = Finding::new(Code::RPI3007, APART).at(span, text);
            self.findings.push(finding.help(SAMPLE_OR_HOLD));
        }
    }

    /// Adds a diagnostic at a place that has no clock diagnostic yet.
    pub(super) fn add(&mut self, finding: Finding) {
        if self.reported.insert(finding.span()) {
            self.findings.push(finding);
        }
    }

    /// Reports `current` of a flow on the base clock. Lists operands of different clocks as a possible cause.
    fn not_sampled(&mut self) {
        // A mismatch around this place has been reported already; this one would follow from it.
        let told = Covered::by(&self.reported);
        for (id, operand) in std::mem::take(&mut self.currents) {
            let unit = self.solver.unit;
            let span = unit.expr(id).span;
            if told.contain(span) || !self.reported.insert(span) {
                continue;
            }
            let told = "`current` of a flow on the base clock has no effect";
            let mut finding = Finding::new(Code::RPI3007, APART).at(span, told);
            let mut parts = Vec::new();
            unit.expr(operand)
                .kind
                .operands(&mut |part| parts.push(part));
            let own = self.row(operand).leaf(0);
            let is_call = matches!(unit.expr(operand).kind, Kind::Call(_) | Kind::When { .. });
            for part in parts.into_iter().filter(|_| !is_call) {
                let clock = self.solver.whole(part);
                if clock != own {
                    let text = format!("the clock of this operand is {}", self.words(clock));
                    finding = finding.also(unit.expr(part).span, text);
                }
            }
            let finding = match self.sampled_currents.get(&id) {
                Some(whole) => finding
                    .help(
                        "`current` binds before `when`: `current (x when c)` holds what is sampled",
                    )
                    .fix(
                        Fix::maybe("hold what is sampled")
                            .insert_before(unit.expr(operand).span, "(")
                            .insert_after(*whole, ")"),
                    ),
                None => finding.help(SAMPLE_OR_HOLD),
            };
            self.findings.push(finding);
        }
    }

    /// Returns whether an initialisation (`->`, or `if` on the first cycle) has operands of one clock. Any other `if`
    /// may mix clocks.
    fn is_of_one_clock(&mut self, id: ExprId, each: Each, operands: &[ExprId]) -> bool {
        match (each, operands) {
            (Each::Arrow, [a, b]) => self.mixes_none(id, [*a, *b]),
            (Each::If, [condition, a, b]) if self.is_first(*condition) => {
                self.mixes_none(id, [*a, *b])
            }
            _ => true,
        }
    }

    fn is_first(&self, condition: ExprId) -> bool {
        let kind = &self.solver.unit.expr(condition).kind;
        matches!(kind, Kind::Prim(call) if call.prim.desc().role == rpi_image::Role::First)
    }
}
