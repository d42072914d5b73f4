//! In which order equations are checked: a local flow without declared type has that of its equation, wherever in the
//! text it stands, and flows may need each other through `pre`.
//!
//! An equation that reads a flow of which nothing is known yet is put back until that flow's equation has been looked
//! at. Where they need each other, what the rest of the equation says is taken as a guess (`t = 0[s] -> pre t + dt` is
//! a time, whatever `pre t` is); guesses are checked when all types are known. What nothing tells even then is taken
//! as what its numbers are (`n = pre n + 1` is an integer), so that its real fault is told, and nothing else.
//! The search keeps its own stack, so that a chain of any length does no harm.

use super::body::Body;
use super::spread;
use crate::ty::Ty;
use crate::typed::{BlockId, ExprId, FlowId};
use rpi_diag::Span;
use rpi_syntax::ast;
use smallvec::SmallVec;

/// An equation that is waiting to be checked.
pub(super) struct Pending<'a> {
    pub(super) block: BlockId,
    pub(super) goal: Goal<'a>,
    pub(super) value: &'a ast::Expr,
    pub(super) span: Span,
    /// The flows that it introduces, by target.
    pub(super) introduces: SmallVec<[Option<FlowId>; 1]>,
    pub(super) state: State,
    /// The index of the element that is defined, by the names on the left side.
    pub(super) indices: Vec<(ast::Ident, i64)>,
}

/// A flow that was read before its type was known.
#[derive(Clone, Copy)]
pub(super) struct Missing {
    /// The equation that defines it.
    pub(super) equation: usize,
    pub(super) span: Span,
    /// Whether it is read in this very cycle, not through `pre`.
    pub(super) now: bool,
}

/// Which number tells the type of an operation on it and on something unknown.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) enum Guess {
    /// None: an integer may be meant as a real, a factor changes the unit.
    Nothing,
    /// An integer.
    Integers,
    /// An integer, and a factor without a unit.
    Factors,
}

/// What an equation defines.
#[derive(Clone, Copy)]
pub(super) enum Goal<'a> {
    /// What stands on its left.
    Targets(&'a [ast::Target]),
    /// A variable with a value where it is declared.
    Var(FlowId),
}

/// How far an equation is.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) enum State {
    /// Not looked at.
    Open,
    /// Waits for what it reads.
    Busy,
    /// Looked at, but it reads flows of which nothing was known.
    Guessed,
    /// It has been reported that nothing tells the type of its flows.
    Told,
    /// Its value is checked.
    Done(ExprId),
}

impl Pending<'_> {
    pub(super) fn infers(&self) -> bool {
        self.introduces.iter().any(Option::is_some)
    }
}

/// Where a table stood, to put it back.
pub(super) struct Mark {
    exprs: usize,
    findings: usize,
    state_at: Option<Span>,
}

impl<'a> Body<'_, 'a> {
    /// Finds the types of all flows that have none declared.
    pub(super) fn infer(&mut self) {
        self.inferring = true;
        for index in 0..self.pending.len() {
            if self.pending[index].infers() && self.pending[index].state == State::Open {
                self.settle(index);
            }
        }
        while self.guess_again() {}
        self.inferring = false;
        self.guess_by(Guess::Integers);
    }

    /// Takes what only operations on numbers tell something of as what these numbers are.
    pub(super) fn guess_by(&mut self, numbers: Guess) {
        self.inferring = true;
        self.guesses = numbers;
        while self.guess_again() {}
        self.guesses = Guess::Nothing;
        self.inferring = false;
    }

    /// The value of an equation, checked now if it has not been.
    pub(super) fn value_of(&mut self, index: usize) -> ExprId {
        match self.pending[index].state {
            State::Done(value) => value,
            _ => {
                let value = self.value_at(index);
                self.pending[index].state = State::Done(value);
                value
            }
        }
    }

    /// Checks an equation's value where it stands.
    pub(super) fn value_at(&mut self, index: usize) -> ExprId {
        let (block, value) = (self.pending[index].block, self.pending[index].value);
        self.within(block, |body| {
            body.with_indices(index, |body| body.expr(value))
        })
    }

    /// Called when an undeclared flow is read whose type is not known yet.
    pub(super) fn is_missing(&mut self, flow: FlowId, span: Span) {
        let known = !self.unit.flow(flow).ty.has_unknown();
        let Some(equation) = self.defined_by[flow.0 as usize].filter(|_| !known) else {
            return;
        };
        if !matches!(self.pending[equation].state, State::Done(_)) {
            let now = self.past == 0;
            self.missing.push(Missing {
                equation,
                span,
                now,
            });
        }
    }

    fn settle(&mut self, index: usize) {
        let mut stack = vec![index];
        while let Some(&top) = stack.last() {
            if !matches!(self.pending[top].state, State::Open | State::Busy) || self.attempt(top) {
                stack.pop();
                continue;
            }
            let open = |k: &usize| self.pending[*k].state == State::Open;
            let needs = self.missing.iter().map(|missing| missing.equation);
            let needs: Vec<usize> = needs.filter(open).collect();
            if needs.is_empty() {
                self.pending[top].state = State::Guessed;
                stack.pop();
            } else {
                self.pending[top].state = State::Busy;
                stack.extend(needs.into_iter().rev());
            }
        }
    }

    /// Checks an equation's value. If it reads what is not known yet nothing of it is kept but a first guess.
    fn attempt(&mut self, index: usize) -> bool {
        let mark = self.mark();
        self.missing.clear();
        let value = self.value_at(index);
        let ty = self.ty_of(value).clone();
        if self.missing.is_empty() && ty.has_unknown() {
            self.ask_other_states(index);
        }
        let complete = self.missing.is_empty();
        if complete {
            self.pending[index].state = State::Done(value);
        } else {
            self.put_back(mark);
        }
        self.guess(index, &ty);
        complete
    }

    /// Takes what is known of a value's type for the flows that it defines.
    fn guess(&mut self, index: usize, ty: &Ty) {
        let flows = self.pending[index].introduces.clone();
        let types: SmallVec<[Ty; 1]> = match flows.len() {
            1 => SmallVec::from([ty.clone()]),
            count => {
                let pieces = spread::pieces(std::slice::from_ref(ty), &vec![None; count]);
                pieces.into_iter().map(|piece| piece.ty).collect()
            }
        };
        let types = types.into_iter().chain(std::iter::repeat(Ty::Unknown));
        for (flow, ty) in flows.iter().zip(types) {
            let Some(flow) = *flow else {
                continue;
            };
            let around: Vec<FlowId> = self.shared_around(flow).collect();
            let told = around.iter().map(|outer| &self.unit.flow(*outer).ty);
            let mut told = std::iter::once(&ty).chain(told);
            let told = told.find(|ty| !ty.has_unknown());
            let ty = told.unwrap_or(&ty).clone();
            for flow in std::iter::once(flow).chain(around) {
                let known = &mut self.unit.flows[flow.0 as usize].ty;
                if known.has_unknown() {
                    *known = ty.clone();
                }
            }
        }
    }

    /// Of a flow of which one state only says that it is absent, `v = none`, another one may tell the type.
    fn ask_other_states(&mut self, index: usize) {
        for flow in self.pending[index].introduces.clone().into_iter().flatten() {
            if let Some(equation) = self.open_in_other_state(flow, index) {
                let span = self.pending[index].span;
                self.missing.push(Missing {
                    equation,
                    span,
                    now: false,
                });
            }
        }
    }

    /// An equation that is still open and defines in another state what this one does in its own.
    fn open_in_other_state(&self, flow: FlowId, index: usize) -> Option<usize> {
        let outer = self.shared_around(flow);
        let versions = outer.filter_map(|outer| self.versions.get(&outer));
        let mut equations = versions
            .flatten()
            .filter_map(|other| self.defined_by[other.0 as usize]);
        equations.find(|other| *other != index && self.pending[*other].state == State::Open)
    }

    /// Looks once more at what could only be guessed; true if something became known by it.
    fn guess_again(&mut self) -> bool {
        let before = self.unknown_flows();
        for index in 0..self.pending.len() {
            if self.pending[index].state == State::Guessed && self.pending[index].infers() {
                self.attempt(index);
            }
        }
        self.unknown_flows() < before
    }

    fn unknown_flows(&self) -> usize {
        let guessed = self.pending.iter().filter(|p| p.state == State::Guessed);
        let flows = guessed.flat_map(|p| p.introduces.iter().flatten());
        flows
            .filter(|f| self.unit.flow(**f).ty.has_unknown())
            .count()
    }

    pub(super) fn mark(&self) -> Mark {
        Mark {
            exprs: self.unit.exprs.len(),
            findings: self.findings.len(),
            state_at: self.state_at,
        }
    }

    pub(super) fn put_back(&mut self, mark: Mark) {
        self.unit.exprs.truncate(mark.exprs);
        let is_kept = |id: &ExprId| (id.0 as usize) < mark.exprs;
        let kept = self.unit.chosen.partition_point(is_kept);
        self.unit.chosen.truncate(kept);
        self.findings.truncate(mark.findings);
        self.unknown.forget_from(mark.findings);
        self.no_clocks.forget_from(mark.findings);
        self.made_real = self.made_real.filter(|at| *at < mark.findings);
        self.state_at = mark.state_at;
    }
}
