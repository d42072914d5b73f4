//! Interpreted primitives: their outputs as literals and terms. All others are uninterpreted functions.

use super::integers::IntId;
use super::real_functions::{Binary, Unary};
use super::reals::RealId;
use super::symbolic::{SymbolicDomain, Term};
use crate::net::Node;
use crate::solver::Lit;

impl SymbolicDomain {
    /// Returns the output of a primitive for symbolic inputs if the symbolic domain knows its function; `None` for
    /// other primitives.
    pub(super) fn interpret(&mut self, node: &Node, inputs: &[Term]) -> Option<Term> {
        let name = node.desc().name.split_once("::")?.1;
        if let Some(operation) = name.strip_prefix("GuardedInt") {
            // An inactive guarded operation returns 0.
            let (Term::Bool(active), rest) = inputs.split_first()? else {
                return None;
            };
            let Term::Int(value) = self.integer_operation(operation, rest)? else {
                return None;
            };
            let zero = self.integers.constant(0);
            let chosen = self
                .integers
                .if_then_else(&mut self.solver, *active, value, zero);
            return Some(Term::Int(chosen));
        }
        if let Some(operation) = name.strip_prefix("Boolean") {
            return self.boolean_operation(operation, inputs);
        }
        let slack = node.params.first();
        if let Some(operation) = name.strip_prefix("Int") {
            return match operation {
                "Equals" => self.equal_within_slack(inputs, slack?.as_int()?),
                _ => self.integer_operation(operation, inputs),
            };
        }
        match (name.strip_prefix("Double")?, inputs) {
            ("Equals", [Term::Real(a), Term::Real(b)]) => {
                self.near_reals(*a, *b, slack?.as_real()?)
            }
            ("FromInt", [Term::Int(a)]) => Some(Term::Real(self.reals.real_of_int(*a))),
            (operation, _) => self.real_operation(operation, inputs),
        }
    }

    fn boolean_operation(&mut self, operation: &str, inputs: &[Term]) -> Option<Term> {
        let lit = match (operation, inputs) {
            ("Not", [Term::Bool(a)]) => !*a,
            ("Xor", [Term::Bool(a), Term::Bool(b)]) => self.solver.xor(*a, *b),
            ("Equals", [Term::Bool(a), Term::Bool(b)]) => !self.solver.xor(*a, *b),
            _ => return None,
        };
        Some(Term::Bool(lit))
    }

    fn integer_operation(&mut self, operation: &str, inputs: &[Term]) -> Option<Term> {
        let solver = &mut self.solver;
        let integers = &mut self.integers;
        Some(match (operation, inputs) {
            ("Negate", [Term::Int(a)]) => Term::Int(integers.scaled(solver, *a, -1)),
            ("Absolute", [Term::Int(a)]) => {
                let negated = integers.scaled(solver, *a, -1);
                let is_low = integers.at_most_zero(solver, *a);
                Term::Int(integers.if_then_else(solver, is_low, negated, *a))
            }
            (_, [Term::Int(a), Term::Int(b)]) => return self.binary_integer(operation, *a, *b),
            _ => return None,
        })
    }

    fn binary_integer(&mut self, operation: &str, a: IntId, b: IntId) -> Option<Term> {
        let solver = &mut self.solver;
        let integers = &mut self.integers;
        Some(match operation {
            "Add" => Term::Int(integers.add_scaled(solver, a, b, 1)),
            "Subtract" => Term::Int(integers.add_scaled(solver, a, b, -1)),
            "Multiply" => Term::Int(integers.times(solver, a, b)?),
            "Divide" | "Modulo" => {
                let divisor = integers.as_constant(b).filter(|b| *b != 0)?;
                let [quotient, rest] = integers.div_rem(solver, a, divisor)?;
                Term::Int(if operation == "Divide" {
                    quotient
                } else {
                    rest
                })
            }
            "Minimum" => Term::Int(integers.minimum(solver, a, b)),
            "Maximum" => Term::Int(integers.maximum(solver, a, b)),
            "Greater" => Term::Bool(!integers.at_most(solver, a, b)),
            "GreaterOrEqual" => Term::Bool(integers.at_most(solver, b, a)),
            _ => return None,
        })
    }

    /// Returns a Boolean term that is true exactly if two integers differ by at most `slack`; `None` if the inputs are
    /// not two integers.
    fn equal_within_slack(&mut self, inputs: &[Term], slack: i64) -> Option<Term> {
        let [Term::Int(a), Term::Int(b)] = inputs else {
            return None;
        };
        if slack < 0 {
            return Some(Term::Bool(Lit::FALSE));
        }
        let slack = self.integers.constant(slack);
        let sides = [(*a, *b), (*b, *a)].map(|(low, high)| {
            let reach = self.integers.add_scaled(&mut self.solver, high, slack, 1);
            self.at_most(low, reach)
        });
        Some(Term::Bool(self.solver.all(sides)))
    }

    fn near_reals(&mut self, a: RealId, b: RealId, slack: f64) -> Option<Term> {
        let sides = [self.compare(a, b, false), self.compare(b, a, false)];
        let equal = self.solver.all(sides);
        if slack == 0.0 {
            return Some(Term::Bool(equal));
        }
        let difference = self.reals.binary(Binary::Subtract, a, b);
        let size = self.reals.unary(Unary::Absolute, difference);
        let slack = self.reals.constant(slack);
        let near = self.compare(size, slack, false);
        Some(Term::Bool(self.solver.or(equal, near)))
    }

    fn real_operation(&mut self, operation: &str, inputs: &[Term]) -> Option<Term> {
        let unary = match operation {
            "Negate" => Some(Unary::Negate),
            "Absolute" => Some(Unary::Absolute),
            "Floor" => Some(Unary::Floor),
            "Ceiling" => Some(Unary::Ceiling),
            "Round" => Some(Unary::Round),
            _ => None,
        };
        let binary = match operation {
            "Add" => Some(Binary::Add),
            "Subtract" => Some(Binary::Subtract),
            "Multiply" => Some(Binary::Multiply),
            "Divide" => Some(Binary::Divide),
            "Minimum" => Some(Binary::Minimum),
            "Maximum" => Some(Binary::Maximum),
            _ => None,
        };
        match (unary, binary, operation, inputs) {
            (Some(op), _, _, [Term::Real(a)]) => Some(Term::Real(self.reals.unary(op, *a))),
            (_, Some(op), _, [Term::Real(a), Term::Real(b)]) => {
                Some(Term::Real(self.reals.binary(op, *a, *b)))
            }
            (_, _, "Greater", [Term::Real(a), Term::Real(b)]) => {
                Some(Term::Bool(self.compare(*b, *a, true)))
            }
            (_, _, "GreaterOrEqual", [Term::Real(a), Term::Real(b)]) => {
                Some(Term::Bool(self.compare(*b, *a, false)))
            }
            _ => None,
        }
    }
}
