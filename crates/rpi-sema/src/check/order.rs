//! Order of type inference. A local flow without a declared type gets the type of its equation, wherever that is in the
//! text, and flows may depend on each other through `pre`.
//!
//! An equation that reads a flow of unknown type is postponed until that flow's equation has been checked. If the
//! equations depend on each other, the rest of the equation gives a guess (`t = 0[s] -> pre t + dt` is a time, whatever
//! `pre t` is); guesses are verified when all types are known. Types that are still unknown are guessed from the
//! numbers in the equation (`n = pre n + 1` is an integer), so that only its actual error is reported. The search keeps
//! its own stack, so that a long chain of equations cannot overflow the call stack.

use super::body::Body;
use super::spread;
use crate::ty::Ty;
use crate::typed::{BlockId, ExprId, FlowId};
use rpi_diag::Span;
use rpi_syntax::ast;
use smallvec::SmallVec;

/// An equation that waits to be checked.
pub(super) struct Pending<'a> {
    pub(super) block: BlockId,
    pub(super) goal: Goal<'a>,
    pub(super) value: &'a ast::Expr,
    pub(super) span: Span,
    /// For each target the flow whose type this equation decides; `None` for other targets.
    pub(super) introduces: SmallVec<[Option<FlowId>; 1]>,
    /// Progress of the check.
    pub(super) state: State,
    /// Index variables of the left side with their values, if the equation defines one array element.
    pub(super) indices: Vec<(ast::Ident, i64)>,
}

/// A read of a flow whose type was not known yet.
#[derive(Clone, Copy)]
pub(super) struct Missing {
    /// Index of the equation that defines the flow.
    pub(super) equation: usize,
    pub(super) span: Span,
    /// Whether the flow is read in the current cycle, not through `pre`.
    pub(super) now: bool,
}

/// Policy for guessing the type of an operation on a number and an operand of unknown type.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) enum Guess {
    /// No guess: an integer may be meant as a real, and a factor changes the unit.
    Nothing,
    /// Guess from integers.
    Integers,
    /// Guess from integers, and from factors without a unit.
    Factors,
}

/// Left side of an equation.
#[derive(Clone, Copy)]
pub(super) enum Goal<'a> {
    /// Targets of an equation.
    Targets(&'a [ast::Target]),
    /// Variable with a value in its declaration.
    Var(FlowId),
}

/// Progress of an equation.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) enum State {
    /// Not checked yet.
    Open,
    /// Waits for the equations of the flows that it reads.
    Busy,
    /// Checked, but it reads flows of unknown type.
    Guessed,
    /// The types of its flows cannot be inferred, which has been reported.
    Told,
    /// Checked; this is its value.
    Done(ExprId),
}

impl Pending<'_> {
    /// Whether it decides the type of a flow.
    pub(super) fn infers(&self) -> bool {
        self.introduces.iter().any(Option::is_some)
    }
}

/// Sizes of the body's tables before a trial check.
pub(super) struct Mark {
    exprs: usize,
    findings: usize,
    state_at: Option<Span>,
}

impl<'a> Body<'_, 'a> {
    /// Infers the types of all flows without a declared type.
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

    /// Guesses the types that only operations on numbers determine, from the types of these numbers.
    pub(super) fn guess_by(&mut self, numbers: Guess) {
        self.inferring = true;
        self.guesses = numbers;
        while self.guess_again() {}
        self.guesses = Guess::Nothing;
        self.inferring = false;
    }

    /// Returns the value of an equation; checks it now if it is not checked yet.
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

    /// Checks the value of an equation in its block.
    pub(super) fn value_at(&mut self, index: usize) -> ExprId {
        let (block, value) = (self.pending[index].block, self.pending[index].value);
        self.within(block, |body| {
            body.with_indices(index, |body| body.expr(value))
        })
    }

    /// Records the read of an undeclared flow if its type is not known yet.
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

    /// Checks the value of an equation. If it reads flows of unknown type, only a first guess of its type is kept.
    /// Returns whether the check is complete.
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

    /// Sets the types of the flows that an equation defines, as far as the type of its value is known.
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

    /// Postpones an equation such as `v = none`, of unknown type, until another state has determined the type of `v`.
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

    /// Returns an unchecked equation that defines the flow of this equation in another state.
    fn open_in_other_state(&self, flow: FlowId, index: usize) -> Option<usize> {
        let outer = self.shared_around(flow);
        let versions = outer.filter_map(|outer| self.versions.get(&outer));
        let mut equations = versions
            .flatten()
            .filter_map(|other| self.defined_by[other.0 as usize]);
        equations.find(|other| *other != index && self.pending[*other].state == State::Open)
    }

    /// Checks all guessed equations again; returns whether a type became known.
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

    /// Returns the current sizes of the body's tables.
    pub(super) fn mark(&self) -> Mark {
        Mark {
            exprs: self.unit.exprs.len(),
            findings: self.findings.len(),
            state_at: self.state_at,
        }
    }

    /// Undoes all additions to the body's tables since `mark`.
    pub(super) fn put_back(&mut self, mark: Mark) {
        self.unit.exprs.truncate(mark.exprs);
        // `chosen` is sorted by expression, so that the undone ones are at its end.
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
