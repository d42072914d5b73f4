//! Clocks of expressions and equations.

use super::Clocks;
use super::terms::{FlowTerms, Term, Terms, of};
use crate::typed::{Activation, Each, Equation, ExprId, FlowId, FlowRole, Kind, Place, Unit};
use rpi_diag::{Code, Finding, Fix, Span};
use std::collections::BTreeSet;

/// The clocks of a value: one, or those of the results of a call, each with its number of leaves.
#[derive(Clone, Debug)]
pub(super) enum Of {
    One(Term),
    Each(Vec<(Term, usize)>),
}

impl Of {
    fn first(&self) -> Term {
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
    /// Of each expression the clocks of its value.
    values: Vec<Of>,
    /// Of each expression the clock by which it is computed.
    places: Vec<Term>,
    /// `current`: the clocks of the result and of the operand.
    currents: Vec<(Term, Term, Span)>,
    findings: Vec<Finding>,
    reported: BTreeSet<Span>,
}

pub(super) fn infer(units: &[Unit], unit: &Unit) -> (Clocks, Vec<Finding>) {
    let mut inference = Inference::new(units, unit);
    inference.flows();
    let reached = reached(unit);
    for id in (0..).map(ExprId).take(unit.exprs.len()) {
        let value = match reached[id.0 as usize] {
            true => inference.expr(id),
            false => Of::One(Terms::BASE),
        };
        inference.values.push(value);
    }
    for equation in unit.blocks.iter().flat_map(|block| &block.equations) {
        inference.equation(equation);
    }
    inference.finish()
}

/// The expressions that somebody needs.
fn reached(unit: &Unit) -> Vec<bool> {
    let mut reached = vec![false; unit.exprs.len()];
    let mut open: Vec<ExprId> = Vec::new();
    for block in &unit.blocks {
        open.extend(block.when);
        open.extend(block.equations.iter().map(|equation| equation.value));
        open.extend(block.claims.iter().map(|claim| claim.condition));
        open.extend(block.ends.iter().map(|end| end.condition));
        open.extend(block.exports.iter().map(|export| export.value));
        let states = block
            .automata
            .iter()
            .flat_map(|automaton| &automaton.states);
        let transitions = states.flat_map(|state| state.unless.iter().chain(&state.until));
        open.extend(transitions.filter_map(|transition| transition.condition));
    }
    while let Some(id) = open.pop() {
        if !std::mem::replace(&mut reached[id.0 as usize], true) {
            unit.expr(id)
                .kind
                .operands(&mut |operand| open.push(operand));
        }
    }
    reached
}

impl<'u> Inference<'u> {
    fn new(units: &'u [Unit], unit: &'u Unit) -> Self {
        let terms = Terms::new();
        Inference {
            units,
            unit,
            terms,
            flows: vec![Terms::BASE; unit.flows.len()],
            values: Vec::with_capacity(unit.exprs.len()),
            places: vec![Terms::BASE; unit.exprs.len()],
            currents: Vec::new(),
            findings: Vec::new(),
            reported: BTreeSet::new(),
        }
    }

    /// Flows have the clock that their declaration states; a local one without declaration has that of its equation.
    fn flows(&mut self) {
        for (k, flow) in self.unit.flows.iter().enumerate() {
            let inferred = flow.optional == crate::typed::Optional::Inferred;
            if flow.clock.is_some() || inferred && flow.role == FlowRole::Local {
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

    fn expr(&mut self, id: ExprId) -> Of {
        let expr = self.unit.expr(id);
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
                let of_flow = of(&self.flows, clock.flow);
                self.sampled(*value, of_flow);
                self.terms.on(of_flow, *clock)
            }
            Kind::Merge { on, cases } => self.merge(*on, cases),
            Kind::Current(operand) => {
                let (result, inner) = (self.terms.open(), self.one(*operand));
                self.currents.push((result, inner, expr.span));
                result
            }
            Kind::Call(call) => return self.call(id, call),
            Kind::Present(_) | Kind::Each(Each::Coalesce | Each::Hold, _) => self.terms.open(),
            Kind::Each(Each::If | Each::Arrow | Each::Pre | Each::Last, operands) => {
                return self.leafwise(id, operands);
            }
            kind => {
                let mut operands = Vec::new();
                kind.operands(&mut |operand| operands.push(operand));
                let place = self.together(&operands);
                self.sampled_in_part(id, &operands).unwrap_or(place)
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

    /// The one clock of several values. If they have none the fault is theirs alone: what is done with them fits.
    fn together(&mut self, operands: &[ExprId]) -> Term {
        let place = self.terms.open();
        let mut fit = true;
        for operand in operands {
            fit &= self.all(*operand, place);
        }
        match fit {
            true => place,
            false => self.terms.open(),
        }
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

    /// `s - 1 when c`, of which only the end is sampled, and that does not fit: the whole was meant, it seems.
    fn sampled_in_part(&mut self, id: ExprId, operands: &[ExprId]) -> Option<Term> {
        let (whole, last) = (self.unit.expr(id).span, *operands.last()?);
        let part = self.unit.expr(last);
        let Kind::When { value, .. } = part.kind else {
            return None;
        };
        let is_sampled = |id: &ExprId| matches!(self.unit.expr(*id).kind, Kind::When { .. });
        if operands[..operands.len() - 1].iter().any(is_sampled) {
            return None;
        }
        let told = self.findings.last_mut()?;
        let value = self.unit.expr(value).span;
        if told.span() != part.span || part.span.end != whole.end || value.end > part.span.end {
            return None;
        }
        let fix = Fix::maybe("sample the whole")
            .insert_before(whole, "(")
            .insert_after(value, ")");
        *told = told
            .clone()
            .help("`when` binds before other operators: `(a - b) when c`")
            .fix(fix);
        Some(self.places[last.0 as usize])
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

    fn equation(&mut self, equation: &Equation) {
        let mut parts = match self.values[equation.value.0 as usize].clone() {
            Of::One(term) => vec![(term, usize::MAX)],
            Of::Each(parts) => parts,
        }
        .into_iter();
        let (mut part, mut left) = parts.next().unwrap_or((Terms::BASE, usize::MAX));
        for target in &equation.targets {
            let wanted = match target.place {
                Place::Flow { flow, .. } => of(&self.flows, flow),
                Place::Port { .. } | Place::Nowhere => self.terms.open(),
            };
            let mut leaves = target.ty.leaf_count();
            loop {
                self.meet(part, wanted, self.unit.expr(equation.value).span);
                if leaves < left {
                    left -= leaves;
                    break;
                }
                leaves -= left;
                (part, left) = parts.next().unwrap_or((part, usize::MAX));
                if leaves == 0 {
                    break;
                }
            }
        }
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
        if self.reported.insert(span) {
            self.findings.push(
                Finding::new(Code::RPI3007, "two clocks do not meet")
                    .at(span, text)
                    .help(
                        "sample the faster flow (`x when c`), or hold the slower one (`current x`)",
                    ),
            );
        }
    }

    pub(super) fn is_bound_to(&self, id: ExprId) -> Option<&'u Equation> {
        let mut equations = self.unit.blocks.iter().flat_map(|block| &block.equations);
        equations.find(|equation| equation.value == id)
    }

    pub(super) fn place(&mut self, id: ExprId, term: Term) {
        self.places[id.0 as usize] = term;
    }

    /// What `current` leads back to, then all clocks as they are.
    fn finish(mut self) -> (Clocks, Vec<Finding>) {
        for (result, inner, span) in std::mem::take(&mut self.currents) {
            match self.terms.parent(inner) {
                Some((parent, _)) => {
                    self.meet(result, parent, span);
                }
                None if self.terms.is_open(inner) => {}
                // What is around it has been told not to fit.
                None if self.reported.iter().any(|told| told.contains(span)) => {}
                None => self.report_at(span, "`current` of a flow that is not sampled".to_owned()),
            }
        }
        self.activations();
        let path = |term: &Term| self.terms.path(*term);
        let clocks = Clocks {
            exprs: self.places.iter().map(path).collect(),
            values: self
                .values
                .iter()
                .map(|value| path(&value.first()))
                .collect(),
            flows: self.flows.iter().map(path).collect(),
        };
        (clocks, self.findings)
    }

    /// What decides about a call has the call's clock.
    fn activations(&mut self) {
        for id in (0..).map(ExprId).take(self.unit.exprs.len()) {
            let Kind::Call(call) = &self.unit.expr(id).kind else {
                continue;
            };
            let place = self.places[id.0 as usize];
            let mut deciding: Vec<ExprId> = Vec::new();
            match &call.activation {
                Activation::Always => {}
                Activation::Restart { every } => deciding.push(*every),
                Activation::Condact {
                    every,
                    default,
                    restart,
                } => {
                    deciding.push(*every);
                    deciding.extend(default);
                    deciding.extend(restart);
                }
            }
            for deciding in deciding {
                self.all(deciding, place);
            }
        }
    }
}

/// The flow that an expression is.
pub(super) fn flow_of(unit: &Unit, id: ExprId) -> Option<FlowId> {
    match unit.expr(id).kind {
        Kind::Flow(flow) => Some(flow),
        _ => None,
    }
}
