//! Unrolling: several consecutive cycles as one problem for the solver.

use super::concrete::Script;
use super::cone::{Cone, Register};
use super::cycle::{Cycle, State, first_state};
use super::domain::{Domain, Flow};
use super::doubles;
use super::integers::IntTerm;
use super::question::Question;
use super::symbolic::{Symbolic, Term};
use crate::solver::{Answer, Lit};
use rpi_image::{Type, Value};

/// Consecutive cycles from the start of the command or from an arbitrary state.
pub(super) struct Unrolled<'a> {
    question: &'a Question<'a>,
    pub(super) domain: Symbolic,
    /// Registers at the start of each cycle, and after the last one.
    pub(super) states: Vec<State<Symbolic>>,
    /// For each cycle and query, whether the cycle satisfies the query.
    together: Vec<Vec<Lit>>,
    /// For each cycle, whether the command ends in it.
    over: Vec<Lit>,
}

impl<'a> Unrolled<'a> {
    pub(super) fn from_start(question: &'a Question<'a>) -> Self {
        let mut domain = Symbolic::new(true);
        let state = first_state(&mut domain, &question.cone);
        Unrolled::new(question, domain, state)
    }

    /// Starts from arbitrary contents of the registers, reachable or not.
    pub(super) fn from_anywhere(question: &'a Question<'a>) -> Self {
        let mut domain = Symbolic::new(false);
        let state = any_state(&mut domain, &question.cone);
        Unrolled::new(question, domain, state)
    }

    fn new(question: &'a Question<'a>, domain: Symbolic, state: State<Symbolic>) -> Self {
        Unrolled {
            question,
            domain,
            states: vec![state],
            together: Vec::new(),
            over: Vec::new(),
        }
    }

    /// Adds a cycle.
    pub(super) fn extend(&mut self) {
        let Some(state) = self.states.last() else {
            return;
        };
        self.domain.cycle = self.together.len();
        let mut cycle = Cycle::new(&mut self.domain, &self.question.cone, state);
        let mut together = Vec::with_capacity(self.question.events.len());
        for event in &self.question.events {
            together.push(event.is(&mut cycle));
        }
        let mut over = Lit::FALSE;
        for port in &self.question.ends {
            let end = cycle.is_true(*port);
            over = cycle.domain.or(over, end);
        }
        let next = cycle.next();
        self.states.push(next);
        self.together.push(together);
        self.over.push(over);
    }

    /// Whether a query can be satisfied in the last cycle and, if `only_there`, in no earlier one.
    pub(super) fn happens(&mut self, pair: usize, only_there: bool, steps: &mut u64) -> Answer {
        let Some((last, before)) = self.together.split_last() else {
            return Answer::Unknown;
        };
        let mut assumptions: Vec<Lit> = self.going_on(before.len());
        if only_there {
            assumptions.extend(before.iter().map(|pairs| !pairs[pair]));
        }
        assumptions.push(last[pair]);
        self.domain.solver.solve(&assumptions, steps)
    }

    /// Literals that say that the command does not end in the first `cycles` cycles.
    pub(super) fn going_on(&self, cycles: usize) -> Vec<Lit> {
        self.over[..cycles].iter().map(|over| !*over).collect()
    }

    /// Inputs of the last solution.
    pub(super) fn script(&self) -> Script {
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
                    if let Value::Cells { cells, .. } = &mut value {
                        cells[0] = number(sum).cast_unsigned();
                    }
                    value
                }
                IntTerm::Choice(..) => Value::neutral(ty),
            },
            Term::Real(real) => match self.domain.reals.free(real) {
                Some((_, nan)) if solver.value(nan) == Some(true) => Value::real(f64::NAN),
                Some((place, _)) => Value::real(doubles::at(number(&place))),
                None => Value::neutral(ty),
            },
            Term::Other(_) => Value::neutral(ty),
        }
    }
}

fn any_state(domain: &mut Symbolic, cone: &Cone<'_>) -> State<Symbolic> {
    let any = |domain: &mut Symbolic, register: &Register| Flow {
        present: match register.may_be_absent {
            true => domain.solver.fresh(),
            false => Lit::TRUE,
        },
        value: domain.fresh(register.ty),
    };
    let registers = cone.registers.iter();
    registers.map(|register| any(domain, register)).collect()
}
