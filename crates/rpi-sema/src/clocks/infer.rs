//! Clocks of expressions and equations.

use super::covered::Covered;
use super::lift::Lift;
use super::order;
use super::terms::{FlowTerms, Term, Terms, of};
use super::{Clocks, Lifted};
use crate::typed::{Each, Equation, ExprId, FlowId, FlowRole, Kind, Optional, Place, Unit};
use rpi_diag::{Code, Finding, Fix, Span};
use std::collections::{BTreeMap, BTreeSet};

const APART: &str = "two clocks do not meet";

const SAMPLE_OR_HOLD: &str =
    "sample the faster flow (`x when c`), or hold the slower one (`current x`)";

/// The clocks of a value: one, or those of the results of a call, each with its number of leaves.
#[derive(Clone, Debug)]
pub(super) enum Of {
    One(Term),
    Each(Vec<(Term, usize)>),
}

impl Of {
    pub(super) fn first(&self) -> Term {
        match self {
            Of::One(term) => *term,
            Of::Each(parts) => parts.first().map_or(Terms::BASE, |(term, _)| *term),
        }
    }
}

/// A unit whose clocks are being inferred.
pub(super) struct Inference<'u> {
    pub(super) units: &'u [Unit],
    pub(super) unit: &'u Unit,
    pub(super) terms: Terms,
    pub(super) flows: FlowTerms,
    /// For each flow whether it is what one of several states defines, or what they define together.
    pub(super) of_states: Vec<bool>,
    /// The equation that is looked at.
    bound: Option<&'u Equation>,
    /// Of each expression the clocks of its value.
    pub(super) values: Vec<Of>,
    /// The expressions of which the clocks have been looked at.
    looked_at: Vec<bool>,
    /// Of each expression the clock by which it is computed.
    places: Vec<Term>,
    /// Of each `current` that is sampled where it stands, `current x when c`, the whole.
    sampled_currents: BTreeMap<ExprId, Span>,
    /// `current`: its operand, and the clock of the result.
    currents: Vec<(ExprId, ExprId, Term)>,
    /// Operands that are read by another clock than theirs, or leaves of theirs are.
    pub(super) lifted: BTreeMap<ExprId, Vec<Lift>>,
    findings: Vec<Finding>,
    reported: BTreeSet<Span>,
}

pub(super) fn infer(units: &[Unit], unit: &Unit) -> (Clocks, Vec<Finding>) {
    let mut inference = Inference::new(units, unit);
    inference.flows();
    let is_told = |flow: FlowId| !inference.terms.is_open(of(&inference.flows, flow));
    for ring in order::equations(unit, is_told) {
        inference.ring(&ring);
    }
    for (id, is_claim) in beside_equations(unit) {
        inference.exprs([id]);
        inference.read_always(id, is_claim);
    }
    inference.finish()
}

/// For each flow whether states define it.
fn of_states(unit: &Unit) -> Vec<bool> {
    let mut of_states = vec![false; unit.flows.len()];
    let automata = unit.blocks.iter().flat_map(|block| &block.automata);
    for shared in automata.flat_map(|automaton| &automaton.shared) {
        for flow in shared.contributions().chain([shared.flow]) {
            of_states[flow.0 as usize] = true;
        }
    }
    of_states
}

/// The expressions that define no flow, and which of them are claims.
fn beside_equations(unit: &Unit) -> Vec<(ExprId, bool)> {
    let mut claims: Vec<ExprId> = Vec::new();
    let mut others: Vec<ExprId> = Vec::new();
    for block in &unit.blocks {
        claims.extend(block.claims.iter().map(|claim| claim.condition));
        others.extend(block.when);
        others.extend(block.ends.iter().map(|end| end.condition));
        others.extend(block.exports.iter().map(|export| export.value));
        let states = block
            .automata
            .iter()
            .flat_map(|automaton| &automaton.states);
        let transitions = states.flat_map(|state| state.unless.iter().chain(&state.until));
        others.extend(transitions.filter_map(|transition| transition.condition));
    }
    let claims = claims.into_iter().map(|id| (id, true));
    claims
        .chain(others.into_iter().map(|id| (id, false)))
        .collect()
}

impl<'u> Inference<'u> {
    fn new(units: &'u [Unit], unit: &'u Unit) -> Self {
        let terms = Terms::new();
        Inference {
            units,
            unit,
            terms,
            bound: None,
            flows: vec![Terms::BASE; unit.flows.len()],
            of_states: of_states(unit),
            values: vec![Of::One(Terms::BASE); unit.exprs.len()],
            looked_at: vec![false; unit.exprs.len()],
            places: vec![Terms::BASE; unit.exprs.len()],
            sampled_currents: BTreeMap::new(),
            currents: Vec::new(),
            lifted: BTreeMap::new(),
            findings: Vec::new(),
            reported: BTreeSet::new(),
        }
    }

    /// Flows have the clock that their declaration states; a local one without declaration has that of its equation. What
    /// several states define may be sampled in one of them alone: it has a value in all cycles, which may be absent.
    fn flows(&mut self) {
        for (k, flow) in self.unit.flows.iter().enumerate() {
            let inferred = flow.optional == Optional::Inferred && flow.role == FlowRole::Local;
            if flow.clock.is_some() || inferred && !self.of_states[k] {
                self.flows[k] = self.terms.open();
            }
        }
        for (k, flow) in self.unit.flows.iter().enumerate() {
            if let Some(on) = flow.clock {
                let parent = of(&self.flows, on.flow);
                let sampled = self.terms.on(parent, on);
                let own = self.flows[k];
                if !self.terms.unify(own, sampled) {
                    self.report_at(
                        flow.span,
                        "this flow decides about its own clock".to_owned(),
                    );
                }
            }
        }
    }

    /// Equations that read one another. What nothing in them gives another clock has a value in all cycles, whoever reads
    /// it.
    fn ring(&mut self, equations: &[&'u Equation]) {
        let told = self.findings.len();
        for equation in equations {
            self.bound = Some(equation);
            self.exprs([equation.value]);
            self.equation(equation);
        }
        self.bound = None;
        // What does not fit in itself fits whatever reads it.
        if self.findings.len() > told {
            return;
        }
        for target in equations.iter().flat_map(|equation| &equation.targets) {
            if let Place::Flow { flow, .. } = target.place
                && self.terms.is_open(of(&self.flows, flow))
            {
                self.terms.unify(of(&self.flows, flow), Terms::BASE);
            }
        }
    }

    /// Looks at expressions and their parts, operands first.
    fn exprs(&mut self, roots: impl Into<Vec<ExprId>>) {
        let mut open: Vec<ExprId> = roots.into();
        let mut parts = Vec::new();
        while let Some(id) = open.pop() {
            if !std::mem::replace(&mut self.looked_at[id.0 as usize], true) {
                parts.push(id);
                let kind = &self.unit.expr(id).kind;
                kind.operands(&mut |operand| open.push(operand));
            }
        }
        parts.sort_unstable();
        for id in parts {
            self.values[id.0 as usize] = self.expr(id);
        }
    }

    fn expr(&mut self, id: ExprId) -> Of {
        let expr = self.unit.expr(id);
        if let Kind::Present(_) | Kind::Each(..) = expr.kind {
            expr.kind.operands(&mut |operand| self.as_one(operand));
        }
        let place = match &expr.kind {
            Kind::Fault
            | Kind::Const(_)
            | Kind::Literal(_)
            | Kind::None
            | Kind::Outside
            | Kind::Sensor { .. } => self.terms.open(),
            Kind::Flow(flow) => match self.unit.flow(*flow).role {
                FlowRole::Param => self.terms.open(),
                _ => of(&self.flows, *flow),
            },
            Kind::Part { base, at } => return self.part(id, *base, *at),
            Kind::Build(parts) if matches!(expr.ty, crate::ty::Ty::Tuple(_)) => {
                return self.tuple(id, parts);
            }
            Kind::When { value, clock } => {
                self.sampled_currents.insert(*value, expr.span);
                let of_flow = of(&self.flows, clock.flow);
                self.sampled(*value, of_flow);
                self.terms.on(of_flow, *clock)
            }
            Kind::Merge { on, cases } => self.merge(*on, cases),
            Kind::Current(operand) => {
                let inner = self.one(*operand);
                match self.terms.parent(inner) {
                    Some((parent, _)) => parent,
                    None => {
                        let result = self.terms.open();
                        self.currents.push((id, *operand, result));
                        result
                    }
                }
            }
            Kind::Call(call) => return self.call(id, call),
            Kind::Present(_) | Kind::Each(Each::Coalesce | Each::Hold, _) => self.terms.open(),
            Kind::Each(Each::If | Each::Arrow | Each::Pre | Each::Last, operands) => {
                return self.leafwise(id, operands);
            }
            kind => {
                let mut operands = Vec::new();
                kind.operands(&mut |operand| operands.push(operand));
                match self.sampled_end(id, &operands) {
                    Some(end) => self.sampled_in_part(id, end, &operands),
                    None => self.together(&operands),
                }
            }
        };
        self.places[id.0 as usize] = place;
        Of::One(place)
    }

    /// The one clock of a value.
    pub(super) fn one(&mut self, id: ExprId) -> Term {
        match self.values[id.0 as usize].clone() {
            Of::One(term) => term,
            Of::Each(_) => {
                let term = self.terms.open();
                self.all(id, term);
                term
            }
        }
    }

    /// The one clock of several values, or that at which those of other clocks may be absent. If they have none the fault
    /// is theirs alone: what is done with them fits.
    fn together(&mut self, operands: &[ExprId]) -> Term {
        if let Some(place) = self.meeting(operands) {
            return place;
        }
        self.at_one(operands).unwrap_or_else(|| self.terms.open())
    }

    /// The one clock of several values.
    fn at_one(&mut self, operands: &[ExprId]) -> Option<Term> {
        let place = self.terms.open();
        let mut fit = true;
        for operand in operands {
            fit &= self.all(*operand, place);
        }
        fit.then_some(place)
    }

    /// All of a value has a clock; false if it has another, which is reported.
    pub(super) fn all(&mut self, id: ExprId, wanted: Term) -> bool {
        let span = self.unit.expr(id).span;
        match self.values[id.0 as usize].clone() {
            Of::One(term) => self.meet(term, wanted, span),
            Of::Each(parts) => {
                let mut fit = true;
                for (term, _) in parts {
                    fit &= self.meet(term, wanted, span);
                }
                fit
            }
        }
    }

    /// The end of `s - 1 when c`, if nothing before it is sampled.
    fn sampled_end(&self, id: ExprId, operands: &[ExprId]) -> Option<ExprId> {
        let (last, others) = operands.split_last()?;
        let (whole, part) = (self.unit.expr(id).span, self.unit.expr(*last));
        let Kind::When { value, .. } = part.kind else {
            return None;
        };
        let is_sampled = |id: &ExprId| matches!(self.unit.expr(*id).kind, Kind::When { .. });
        let value = self.unit.expr(value).span;
        let is_end = part.span.end == whole.end && value.end <= part.span.end;
        (is_end && !others.iter().any(is_sampled)).then_some(*last)
    }

    /// `s - 1 when c`, of which only the end is sampled: if that does not fit, the whole was meant, it seems.
    fn sampled_in_part(&mut self, id: ExprId, end: ExprId, operands: &[ExprId]) -> Term {
        if let Some(place) = self.at_one(operands) {
            return place;
        }
        let (whole, part) = (self.unit.expr(id).span, self.unit.expr(end));
        if let (Some(told), Kind::When { value, .. }) = (self.findings.last_mut(), &part.kind)
            && told.span() == part.span
        {
            let fix = Fix::maybe("sample the whole")
                .insert_before(whole, "(")
                .insert_after(self.unit.expr(*value).span, ")");
            *told = told
                .clone()
                .help("`when` binds before other operators: `(a - b) when c`")
                .fix(fix);
        }
        // Which of both was meant is not known: what reads the whole fits.
        self.terms.open()
    }

    /// What is sampled has the clock of the flow that decides, or a faster one from which that is sampled.
    fn sampled(&mut self, value: ExprId, of_flow: Term) {
        match self.values[value.0 as usize].clone() {
            Of::One(term) if !self.terms.is_open(term) && self.terms.leads_to(of_flow, term) => {}
            _ => {
                self.all(value, of_flow);
            }
        }
    }

    fn part(&mut self, id: ExprId, base: ExprId, at: u32) -> Of {
        let mut first = 0;
        let term = match self.values[base.0 as usize].clone() {
            Of::One(term) => term,
            Of::Each(parts) => {
                let found = parts.iter().find(|(_, leaves)| {
                    first += leaves;
                    (at as usize) < first
                });
                found.map_or(Terms::BASE, |(term, _)| *term)
            }
        };
        self.places[id.0 as usize] = term;
        Of::One(term)
    }

    fn tuple(&mut self, id: ExprId, parts: &[ExprId]) -> Of {
        let mut all = Vec::with_capacity(parts.len());
        for part in parts {
            match self.values[part.0 as usize].clone() {
                Of::One(term) => all.push((term, self.unit.expr(*part).ty.leaf_count())),
                Of::Each(parts) => all.extend(parts),
            }
        }
        self.places[id.0 as usize] = all.first().map_or(Terms::BASE, |(term, _)| *term);
        Of::Each(all)
    }

    /// Operators that work leaf by leaf have one clock.
    fn leafwise(&mut self, id: ExprId, operands: &[ExprId]) -> Of {
        let place = self.together(operands);
        self.places[id.0 as usize] = place;
        Of::One(place)
    }

    fn merge(&mut self, on: ExprId, cases: &[(u32, ExprId)]) -> Term {
        let place = self.one(on);
        let Kind::Flow(flow) = self.unit.expr(on).kind else {
            return place;
        };
        for (value, case) in cases {
            let on = crate::typed::ClockOn {
                flow,
                value: *value,
            };
            let sampled = self.terms.on(place, on);
            self.all(*case, sampled);
        }
        place
    }

    /// Makes two clocks the same, or reports that they are not, which is false.
    pub(super) fn meet(&mut self, found: Term, wanted: Term, span: Span) -> bool {
        let meet = self.terms.unify(found, wanted);
        if !meet {
            let [found, wanted] = [found, wanted].map(|term| self.words(term));
            self.report_at(
                span,
                format!("this is {found}, but {wanted} is needed here"),
            );
        }
        meet
    }

    fn words(&self, term: Term) -> String {
        let path = self.terms.path(term);
        match path.is_empty() {
            true => "in all cycles".to_owned(),
            false => format!("`{}`", super::print(self.unit, &path)),
        }
    }

    fn report_at(&mut self, span: Span, text: String) {
        self.report_with(span, text, SAMPLE_OR_HOLD.to_owned());
    }

    pub(super) fn report_with(&mut self, span: Span, text: String, help: String) {
        if self.reported.insert(span) {
            let finding = Finding::new(Code::RPI3007, APART).at(span, text);
            self.findings.push(finding.help(help));
        }
    }

    /// `current` of what is there in all cycles, maybe because values of different clocks meet in it.
    fn not_sampled(&mut self, id: ExprId, operand: ExprId) {
        let span = self.unit.expr(id).span;
        if !self.reported.insert(span) {
            return;
        }
        let told = "`current` of a flow that is not sampled";
        let mut finding = Finding::new(Code::RPI3007, APART).at(span, told);
        let mut parts = Vec::new();
        let kind = &self.unit.expr(operand).kind;
        kind.operands(&mut |part| parts.push(part));
        parts.retain(|part| self.lifted.contains_key(part));
        for part in parts {
            let clock = self.one(part);
            let text = format!("this is {}", self.words(clock));
            finding = finding.also(self.unit.expr(part).span, text);
        }
        self.findings.push(match self.sampled_currents.get(&id) {
            Some(whole) => finding
                .help("`current` binds before `when`: `current (x when c)` holds what is sampled")
                .fix(
                    Fix::maybe("hold what is sampled")
                        .insert_before(self.unit.expr(operand).span, "(")
                        .insert_after(*whole, ")"),
                ),
            None => finding.help(SAMPLE_OR_HOLD),
        });
    }

    /// The equation of which an expression is the whole right side.
    pub(super) fn is_bound_to(&self, id: ExprId) -> Option<&'u Equation> {
        self.bound.filter(|equation| equation.value == id)
    }

    pub(super) fn place(&mut self, id: ExprId, term: Term) {
        self.places[id.0 as usize] = term;
    }

    /// What `current` leads back to, then all clocks as they are.
    fn finish(mut self) -> (Clocks, Vec<Finding>) {
        let told = Covered::by(&self.reported);
        for (id, operand, result) in std::mem::take(&mut self.currents) {
            let span = self.unit.expr(id).span;
            let inner = self.one(operand);
            match self.terms.parent(inner) {
                Some((parent, _)) => {
                    self.meet(result, parent, span);
                }
                None if self.terms.is_open(inner) => {}
                // What is around it has been told not to fit.
                None if told.contain(span) => {}
                None => self.not_sampled(id, operand),
            }
        }
        let path = |term: &Term| self.terms.path(*term);
        let of_lift = |lift: &Lift| Lifted {
            leaves: lift.leaves.clone(),
            own: path(&lift.own),
            outer: path(&lift.read).len(),
        };
        let of_lifts = |(id, lifts): (&ExprId, &Vec<Lift>)| {
            let lifts = lifts.iter().map(of_lift);
            (*id, lifts.collect())
        };
        let clocks = Clocks {
            exprs: self.places.iter().map(path).collect(),
            values: self
                .values
                .iter()
                .map(|value| path(&value.first()))
                .collect(),
            flows: self.flows.iter().map(path).collect(),
            lifted: self.lifted.iter().map(of_lifts).collect(),
        };
        (clocks, self.findings)
    }
}

/// The flow that an expression is.
pub(super) fn flow_of(unit: &Unit, id: ExprId) -> Option<FlowId> {
    match unit.expr(id).kind {
        Kind::Flow(flow) => Some(flow),
        _ => None,
    }
}
