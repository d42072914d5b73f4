//! Symbolic domain: computes cycles of a net over literals and terms, for all inputs at once.

use super::domain::{Domain, Flow, Source};
use super::integers::{IntId, Integers};
use super::real_comparison::TermContext;
use super::reals::{RealId, Reals};
use crate::net::{Input, Node, PortRef};
use crate::solver::{Lit, Solver};
use rpi_image::{CommandFlow, Scalar, Type, Value};
use rustc_hash::FxHashMap;
use std::collections::BTreeMap;

/// Symbolic value of a flow: a literal or term of the solver.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub(super) enum Term {
    Bool(Lit),
    Int(IntId),
    Real(RealId),
    /// Value of another type, such as a pose, identified by a number. It can only be tested for identity.
    Uninterpreted(u32),
}

/// Application of a primitive to symbolic inputs, as a key of a table. Equal applications have equal results
/// (uninterpreted functions).
#[derive(Clone, PartialEq, Eq, Hash, Debug)]
struct Operation {
    prim: u16,
    port: usize,
    params: Vec<String>,
    /// For each in-port of the primitive, whether it is connected.
    connected: Vec<bool>,
    ty: Option<Type>,
    inputs: Vec<(Lit, Term)>,
}

/// Symbolic execution of a net over several cycles: the terms of its flows, and the solver with the constraints on
/// them.
pub(super) struct SymbolicDomain {
    pub(super) solver: Solver,
    pub(super) integers: Integers,
    pub(super) reals: Reals,
    /// Index of the cycle that is being translated, counted from 0.
    pub(super) cycle: usize,
    /// Whether cycle 0 is the first cycle of the command instead of an arbitrary later one.
    pub(super) is_from_start: bool,
    /// External values that the net has read, with their types, by source and index of the cycle.
    pub(super) sources: BTreeMap<(Source, usize), (Flow<SymbolicDomain>, Type)>,
    operations: FxHashMap<Operation, Flow<SymbolicDomain>>,
    choices: FxHashMap<(Lit, u32, u32), u32>,
    constants: FxHashMap<String, u32>,
    others: u32,
}

impl SymbolicDomain {
    pub(super) fn new(is_from_start: bool) -> SymbolicDomain {
        SymbolicDomain {
            solver: Solver::new(),
            integers: Integers::default(),
            reals: Reals::default(),
            cycle: 0,
            is_from_start,
            sources: BTreeMap::new(),
            operations: FxHashMap::default(),
            choices: FxHashMap::default(),
            constants: FxHashMap::default(),
            others: 0,
        }
    }

    fn other(&mut self) -> u32 {
        self.others += 1;
        self.others
    }

    /// Creates an unconstrained symbolic value of a type.
    pub(super) fn fresh(&mut self, ty: Type) -> Term {
        match ty {
            Type::Scalar(Scalar::Bool) => Term::Bool(self.solver.new_bool()),
            Type::Scalar(Scalar::Int | Scalar::Time) => {
                Term::Int(self.integers.unconstrained(&mut self.solver))
            }
            Type::Scalar(Scalar::Real) => Term::Real(self.reals.unconstrained(&mut self.solver)),
            _ => Term::Uninterpreted(self.other()),
        }
    }

    /// Returns a literal that is true exactly if `a` is at most `b`.
    pub(super) fn at_most(&mut self, a: IntId, b: IntId) -> Lit {
        self.integers.at_most(&mut self.solver, a, b)
    }

    pub(super) fn equal(&mut self, a: IntId, b: IntId) -> Lit {
        self.integers.equal(&mut self.solver, a, b)
    }

    pub(super) fn compare(&mut self, a: RealId, b: RealId, is_strict: bool) -> Lit {
        let mut around = TermContext {
            integers: &mut self.integers,
            solver: &mut self.solver,
        };
        self.reals.compare(&mut around, a, b, is_strict)
    }

    /// Adds constraints between the values of a flow of the control core in successive cycles: the time increases, and
    /// a cancel request persists.
    fn constrain_over_time(&mut self, flow: CommandFlow, value: &Flow<SymbolicDomain>) {
        let before = self.cycle.checked_sub(1).and_then(|before| {
            let key = (Source::Core(flow), before);
            self.sources.get(&key).map(|(flow, _)| flow.value)
        });
        match (flow, before, value.value) {
            (CommandFlow::Time, Some(Term::Real(before)), Term::Real(now)) => {
                let later = self.compare(before, now, true);
                self.solver.add_clause(&[later]);
            }
            (CommandFlow::Time, None, Term::Real(now)) if self.is_from_start => {
                let zero = self.reals.constant(0.0);
                let at_start = self.compare(now, zero, false);
                if self.cycle == 0 {
                    self.solver.add_clause(&[at_start]);
                }
            }
            (CommandFlow::Cancel, Some(Term::Bool(before)), Term::Bool(now)) => {
                self.solver.add_clause(&[!before, now]);
            }
            _ => {}
        }
    }

    /// Creates a symbolic value for an external source. Time, period and speed override are finite and not negative.
    fn external_value(&mut self, source: &Source, ty: Type) -> Term {
        match source {
            Source::Core(CommandFlow::Time | CommandFlow::Period | CommandFlow::SpeedOverride)
                if ty == Type::Scalar(Scalar::Real) =>
            {
                Term::Real(self.reals.unconstrained_nonnegative(&mut self.solver))
            }
            _ => self.fresh(ty),
        }
    }

    fn operation(&self, node: &Node, port: usize, inputs: Vec<(Lit, Term)>) -> Operation {
        Operation {
            prim: node.prim.0,
            port,
            params: node.params.iter().map(|p| format!("{p:?}")).collect(),
            connected: node
                .inputs
                .iter()
                .map(|i| !matches!(i, Input::Unconnected))
                .collect(),
            ty: node.outputs.get(port).copied(),
            inputs,
        }
    }
}

/// Returns whether an external source has the same value in all cycles.
fn is_constant(source: &Source) -> bool {
    matches!(
        source,
        Source::Core(CommandFlow::Period | CommandFlow::Predecessor)
    )
}

impl Domain for SymbolicDomain {
    type Bool = Lit;
    type Value = Term;

    fn bit(&self, value: bool) -> Lit {
        Lit::constant(value)
    }

    fn not(&mut self, a: Lit) -> Lit {
        !a
    }

    fn and(&mut self, a: Lit, b: Lit) -> Lit {
        self.solver.and(a, b)
    }

    fn constant(&mut self, value: &Value) -> Term {
        let cell = value.slots().first().copied().unwrap_or_default();
        match value.ty() {
            Some(Type::Scalar(Scalar::Bool)) => Term::Bool(Lit::constant(cell != 0)),
            Some(Type::Scalar(Scalar::Int | Scalar::Time)) => {
                Term::Int(self.integers.constant(cell.cast_signed()))
            }
            Some(Type::Scalar(Scalar::Real)) => {
                Term::Real(self.reals.constant(f64::from_bits(cell)))
            }
            _ => {
                let key = format!("{value:?}");
                if let Some(known) = self.constants.get(&key) {
                    return Term::Uninterpreted(*known);
                }
                let new = self.other();
                self.constants.insert(key, new);
                Term::Uninterpreted(new)
            }
        }
    }

    fn boolean(&mut self, bit: Lit) -> Term {
        Term::Bool(bit)
    }

    fn truth(&mut self, value: &Term) -> Lit {
        match value {
            Term::Bool(lit) => *lit,
            _ => self.solver.new_bool(),
        }
    }

    fn choose(&mut self, condition: Lit, yes: &Term, no: &Term) -> Term {
        match (*yes, *no) {
            (Term::Bool(yes), Term::Bool(no)) => {
                Term::Bool(self.solver.if_then_else(condition, yes, no))
            }
            (Term::Int(yes), Term::Int(no)) => {
                Term::Int(
                    self.integers
                        .if_then_else(&mut self.solver, condition, yes, no),
                )
            }
            (Term::Real(yes), Term::Real(no)) => {
                Term::Real(
                    self.reals
                        .if_then_else(&mut self.solver, condition, yes, no),
                )
            }
            (Term::Uninterpreted(yes), Term::Uninterpreted(no)) => match condition {
                Lit::TRUE => Term::Uninterpreted(yes),
                Lit::FALSE => Term::Uninterpreted(no),
                _ if yes == no => Term::Uninterpreted(yes),
                _ => {
                    let new = self.others + 1;
                    let chosen = *self.choices.entry((condition, yes, no)).or_insert(new);
                    self.others = self.others.max(chosen);
                    Term::Uninterpreted(chosen)
                }
            },
            // A port that is not connected is a Boolean placeholder; it is absent.
            (Term::Bool(_), other) | (other, _) => other,
        }
    }

    fn source(&mut self, source: Source, ty: Type, may_be_absent: bool) -> Flow<SymbolicDomain> {
        let cycle = if is_constant(&source) { 0 } else { self.cycle };
        let key = (source, cycle);
        if let Some((known, _)) = self.sources.get(&key) {
            return known.clone();
        }
        let present = match may_be_absent {
            true => self.solver.new_bool(),
            false => Lit::TRUE,
        };
        let value = self.external_value(&key.0, ty);
        let flow = Flow { present, value };
        if let Source::Core(core) = key.0 {
            self.constrain_over_time(core, &flow);
        }
        self.sources.insert(key, (flow.clone(), ty));
        flow
    }

    fn apply(&mut self, node: &Node, inputs: &[Term], _runs: Lit) -> Vec<Term> {
        if let Some(value) = self.interpret(node, inputs) {
            return vec![value];
        }
        let inputs: Vec<(Lit, Term)> = inputs.iter().map(|value| (Lit::TRUE, *value)).collect();
        let ports = node.outputs.iter().enumerate();
        ports
            .map(|(k, ty)| {
                let operation = self.operation(node, k, inputs.clone());
                if let Some(known) = self.operations.get(&operation) {
                    return known.value;
                }
                let value = self.fresh(*ty);
                let present = Lit::TRUE;
                self.operations.insert(operation, Flow { present, value });
                value
            })
            .collect()
    }

    fn unknown(
        &mut self,
        (port, node): (PortRef, &Node),
        inputs: Option<&[Flow<SymbolicDomain>]>,
        surely: Lit,
        runs: Lit,
    ) -> Flow<SymbolicDomain> {
        let inputs = inputs.map(|flows| flows.iter().map(|f| (f.present, f.value)).collect());
        let operation = inputs.map(|inputs| self.operation(node, usize::from(port.port), inputs));
        let known = operation
            .as_ref()
            .and_then(|o| self.operations.get(o))
            .cloned();
        let flow = known.unwrap_or_else(|| {
            let ty = node.outputs.get(usize::from(port.port)).copied();
            let present = self.solver.new_bool();
            let value = self.fresh(ty.unwrap_or(Type::Scalar(Scalar::Bool)));
            Flow { present, value }
        });
        if let Some(operation) = operation {
            self.operations.insert(operation, flow.clone());
        }
        let present = self.solver.or(surely, flow.present);
        Flow {
            present: self.solver.and(present, runs),
            value: flow.value,
        }
    }
}
