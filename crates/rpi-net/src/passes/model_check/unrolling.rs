//! Unrolling: several consecutive cycles as one problem for the solver.

use super::concrete::InputScript;
use super::cone::{Cone, Register};
use super::cycle::{Cycle, State, first_state};
use super::domain::{Domain, Flow};
use super::double_order;
use super::integers::IntTerm;
use super::query::Problem;
use super::symbolic::{SymbolicDomain, Term};
use crate::solver::{Lit, SatResult};
use rpi_image::{Type, Value};

/// Symbolic execution of a net over consecutive cycles, from the start of the command or from an arbitrary state.
pub(super) struct Unrolling<'a> {
    question: &'a Problem<'a>,
    pub(super) domain: SymbolicDomain,
    /// Contents of the registers (state elements) at the start of each cycle, and after the last one.
    pub(super) states: Vec<State<SymbolicDomain>>,
    /// For each cycle and query, a literal that is true if the cycle satisfies the query.
    satisfied: Vec<Vec<Lit>>,
    /// For each cycle, a literal that is true if the command ends in it.
    ended: Vec<Lit>,
}

impl<'a> Unrolling<'a> {
    pub(super) fn from_start(question: &'a Problem<'a>) -> Self {
        let mut domain = SymbolicDomain::new(true);
        let state = first_state(&mut domain, &question.cone);
        Unrolling::new(question, domain, state)
    }

    /// Creates an unrolling without cycles whose state is arbitrary, reachable or not.
    pub(super) fn from_anywhere(question: &'a Problem<'a>) -> Self {
        let mut domain = SymbolicDomain::new(false);
        let state = any_state(&mut domain, &question.cone);
        Unrolling::new(question, domain, state)
    }

    fn new(
        question: &'a Problem<'a>,
        domain: SymbolicDomain,
        state: State<SymbolicDomain>,
    ) -> Self {
        Unrolling {
            question,
            domain,
            states: vec![state],
            satisfied: Vec::new(),
            ended: Vec::new(),
        }
    }

    /// Adds one cycle after the last one.
    pub(super) fn extend(&mut self) {
        let Some(state) = self.states.last() else {
            return;
        };
        self.domain.cycle = self.satisfied.len();
        let mut cycle = Cycle::new(&mut self.domain, &self.question.cone, state);
        let mut together = Vec::with_capacity(self.question.events.len());
        for event in &self.question.events {
            together.push(event.is_satisfied(&mut cycle));
        }
        let mut over = Lit::FALSE;
        for port in &self.question.ends {
            let end = cycle.is_true(*port);
            over = cycle.domain.or(over, end);
        }
        let next = cycle.next_state();
        self.states.push(next);
        self.satisfied.push(together);
        self.ended.push(over);
    }

    /// Searches for a run whose last cycle satisfies the query with the index `pair` and, if `only_there` is true,
    /// whose earlier cycles do not. The command does not end before the last cycle. Subtracts the steps taken from
    /// `steps`.
    pub(super) fn solve_last_cycle(
        &mut self,
        pair: usize,
        only_there: bool,
        steps: &mut u64,
    ) -> SatResult {
        let Some((last, before)) = self.satisfied.split_last() else {
            return SatResult::Unknown;
        };
        let mut assumptions: Vec<Lit> = self.not_ended(before.len());
        if only_there {
            assumptions.extend(before.iter().map(|pairs| !pairs[pair]));
        }
        assumptions.push(last[pair]);
        self.domain.solver.solve(&assumptions, steps)
    }

    /// Returns literals that are all true if the command does not end in the first `cycles` cycles.
    pub(super) fn not_ended(&self, cycles: usize) -> Vec<Lit> {
        self.ended[..cycles].iter().map(|over| !*over).collect()
    }

    /// Returns the external inputs of all cycles in the last solution of the solver.
    pub(super) fn script(&self) -> InputScript {
        let solver = &self.domain.solver;
        let sources = self.domain.sources.iter();
        sources
            .map(|(key, (flow, ty))| {
                let is_present = solver.value(flow.present) != Some(false);
                (key.clone(), is_present.then(|| self.value(flow.value, *ty)))
            })
            .collect()
    }

    fn value(&self, term: Term, ty: Type) -> Value {
        let solver = &self.domain.solver;
        let number = |sum| {
            solver
                .sum(sum)
                .and_then(|v| i64::try_from(v).ok())
                .unwrap_or(0)
        };
        match term {
            Term::Bool(lit) => Value::bool(solver.value(lit) == Some(true)),
            Term::Int(int) => match self.domain.integers.term(int) {
                IntTerm::Sum(sum) => {
                    let mut value = Value::neutral(ty);
                    if let Value::Slots { cells, .. } = &mut value {
                        cells[0] = number(sum).cast_unsigned();
                    }
                    value
                }
                IntTerm::Choice(..) => Value::neutral(ty),
            },
            Term::Real(real) => match self.domain.reals.as_variable(real) {
                Some((_, nan)) if solver.value(nan) == Some(true) => Value::real(f64::NAN),
                Some((place, _)) => Value::real(double_order::double_at(number(&place))),
                None => Value::neutral(ty),
            },
            Term::Uninterpreted(_) => Value::neutral(ty),
        }
    }
}

fn any_state(domain: &mut SymbolicDomain, cone: &Cone<'_>) -> State<SymbolicDomain> {
    let any = |domain: &mut SymbolicDomain, register: &Register| Flow {
        present: match register.may_be_absent {
            true => domain.solver.new_bool(),
            false => Lit::TRUE,
        },
        value: domain.fresh(register.ty),
    };
    let registers = cone.registers.iter();
    registers.map(|register| any(domain, register)).collect()
}
