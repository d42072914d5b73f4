//! Clocks while they are being inferred: terms, made equal by unification (Robinson).

use crate::typed::{ClockOn, FlowId};

/// Index of a term.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(super) struct Term(u32);

#[derive(Clone, Copy, PartialEq, Debug)]
enum Shape {
    /// Not known.
    Open,
    /// The same as another.
    Same(Term),
    /// All cycles of the unit.
    Base,
    /// Those cycles of another clock in which a flow has a value.
    On(Term, ClockOn),
}

/// All terms of a unit.
#[derive(Debug)]
pub(super) struct Terms {
    shapes: Vec<Shape>,
}

impl Terms {
    /// The clock of all cycles of the unit.
    pub(super) const BASE: Term = Term(0);

    pub(super) fn new() -> Self {
        Terms {
            shapes: vec![Shape::Base],
        }
    }

    fn add(&mut self, shape: Shape) -> Term {
        self.shapes.push(shape);
        Term(u32::try_from(self.shapes.len() - 1).unwrap_or(u32::MAX))
    }

    /// A clock that is not known yet.
    pub(super) fn open(&mut self) -> Term {
        self.add(Shape::Open)
    }

    /// Those cycles of a clock in which a flow has a value.
    pub(super) fn on(&mut self, of: Term, on: ClockOn) -> Term {
        self.add(Shape::On(of, on))
    }

    fn found(&self, mut term: Term) -> Term {
        while let Shape::Same(next) = self.shapes[term.0 as usize] {
            term = next;
        }
        term
    }

    fn shape(&self, term: Term) -> Shape {
        self.shapes[self.found(term).0 as usize]
    }

    /// The clock that a sampled clock is taken from.
    pub(super) fn parent(&self, term: Term) -> Option<(Term, ClockOn)> {
        match self.shape(term) {
            Shape::On(parent, on) => Some((parent, on)),
            _ => None,
        }
    }

    pub(super) fn is_open(&self, term: Term) -> bool {
        self.shape(term) == Shape::Open
    }

    /// Whether two clocks are known to be the same without a look at what they are sampled from.
    pub(super) fn are_same(&self, a: Term, b: Term) -> bool {
        self.found(a) == self.found(b)
    }

    /// The slowest clock that both are sampled from.
    pub(super) fn common(&self, a: Term, b: Term) -> Term {
        if self.are_same(a, b) {
            return a;
        }
        let (way, other) = (self.path(a), self.path(b));
        let both = way.iter().zip(&other).take_while(|(a, b)| a == b).count();
        let mut at = a;
        for _ in both..way.len() {
            at = self.parent(at).map_or(at, |(parent, _)| parent);
        }
        at
    }

    /// Makes two clocks the same. False if they are not.
    pub(super) fn unify(&mut self, a: Term, b: Term) -> bool {
        let (mut a, mut b) = (self.found(a), self.found(b));
        while a != b {
            match (self.shapes[a.0 as usize], self.shapes[b.0 as usize]) {
                (Shape::Open, _) => return self.bind(a, b),
                (_, Shape::Open) => return self.bind(b, a),
                (Shape::On(of, on), Shape::On(other, otherwise)) if on == otherwise => {
                    (a, b) = (self.found(of), self.found(other));
                }
                _ => return false,
            }
        }
        true
    }

    fn bind(&mut self, open: Term, to: Term) -> bool {
        let mut at = to;
        while let Some((parent, _)) = self.parent(at) {
            at = self.found(parent);
            if at == open {
                return false;
            }
        }
        self.shapes[open.0 as usize] = Shape::Same(to);
        true
    }

    /// Whether a clock is another, or one that it is sampled from.
    pub(super) fn leads_to(&self, clock: Term, other: Term) -> bool {
        let other = self.path(other);
        let path = self.path(clock);
        path.starts_with(&other)
    }

    /// The way from all cycles of the unit to a clock; what is not known ticks in all.
    pub(super) fn path(&self, term: Term) -> Vec<ClockOn> {
        let mut path = Vec::new();
        let mut at = term;
        while let Some((parent, on)) = self.parent(at) {
            path.push(on);
            at = parent;
        }
        path.reverse();
        path
    }
}

/// The clock of a flow that decides, for what is sampled by it.
pub(super) type FlowTerms = Vec<Term>;

/// The term of a flow.
pub(super) fn of(flows: &FlowTerms, flow: FlowId) -> Term {
    flows.get(flow.0 as usize).copied().unwrap_or(Terms::BASE)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn on(flow: u32) -> ClockOn {
        ClockOn {
            flow: FlowId(flow),
            value: 1,
        }
    }

    #[test]
    fn samplings_by_the_same_flow_meet() {
        let mut terms = Terms::new();
        let open = terms.open();
        let (a, b) = (terms.on(Terms::BASE, on(1)), terms.on(open, on(1)));
        assert!(terms.unify(a, b));
        assert_eq!(terms.path(b), [on(1)]);
        assert!(!terms.is_open(open));
    }

    #[test]
    fn samplings_by_other_flows_do_not() {
        let mut terms = Terms::new();
        let (a, b) = (terms.on(Terms::BASE, on(1)), terms.on(Terms::BASE, on(2)));
        assert!(!terms.unify(a, b));
        assert!(!terms.unify(a, Terms::BASE));
    }

    #[test]
    fn no_clock_is_sampled_from_itself() {
        let mut terms = Terms::new();
        let open = terms.open();
        let inner = terms.on(open, on(1));
        assert!(!terms.unify(open, inner));
    }
}
