//! Reports Lustre programs whose meaning depends on the compiler: quotient and remainder of a negative number.
//!
//! `div` and `mod` truncate here, in Lustre V6 and in C, but are Euclidean in Kind 2. The two agree if the dividend is
//! not negative, and if the divisor is 1 or -1. The check therefore asks whether a dividend can be negative. Each rule
//! has the form "this is not negative if none of these is", so that one backward search covers a unit in linear time.
//! Only the first place of a program is reported. The other difference, the reading of `when`, is syntactic and
//! reported by the parser.

use crate::facts::literal;
use crate::typed::{ElementwiseOp, PrimCall, TypedKind};
use crate::typed::{Equation, ExprId, FlowId, Leaf, TargetPlace, Unit};
use rpi_diag::{Code, Diagnostic, Quote, Span};
use rpi_net::prim;
use rpi_prims::PrimId;
use std::rc::Rc;

/// Integer division: its primitive, its operator, and an example with a negative dividend with its result in this
/// language and in Kind 2.
type Division = (PrimId, &'static str, &'static str, &'static str);

const DIVISIONS: &[Division] = &[
    (prim!("Core::IntDivide"), "div", "-7 div 2 is -3", "-4"),
    (prim!("Rpi::IntModulo"), "mod", "-7 mod 2 is -1", "1"),
];

/// Integer operators whose result is not negative if some of their operands are not negative: the primitive, and how
/// many of its first operands this condition concerns.
const SIGN_PRESERVING: &[(PrimId, usize)] = &[
    (prim!("Core::IntAdd"), 2),
    (prim!("Core::IntMultiply"), 2),
    (prim!("Core::IntDivide"), 2),
    (prim!("Rpi::IntModulo"), 1),
];

/// Comparisons `a > b` and `a >= b`, from which follows that `a` is at least `b`.
const LOWER_BOUND_TESTS: &[PrimId] = &[prim!("Core::IntGreater"), prim!("Rpi::IntGreaterOrEqual")];

/// Returns a warning for the first integer division in Lustre whose dividend may be negative, because the result then
/// differs between Lustre compilers; `None` if there is no such division.
pub(crate) fn check(units: &[Rc<Unit>]) -> Option<Diagnostic> {
    let units = units.iter().filter(|unit| unit.is_lustre);
    let first = units
        .filter_map(|unit| first_negative_dividend(unit))
        .min_by_key(|(at, ..)| *at);
    first.map(|(at, division)| dialect_warning(at, division))
}

fn dialect_warning(at: Span, (_, word, here, elsewhere): &Division) -> Diagnostic {
    let message = format!("Lustre compilers differ in `{word}` of a negative number");
    Diagnostic::new(Code::RPI2015, message)
        .primary(at, "this may be negative")
        .note(format!("here, in Lustre V6 and in C {here}; in Kind 2 it is {elsewhere}"))
        .help(format!(
            "if a negative value is impossible, limit it: `if {0} < 0 then 0 else {0}`; else use only one of these compilers",
            Quote::text(at)
        ))
}

/// Returns the location of the first dividend in a unit that may be negative, and its division; `None` if there is
/// none.
fn first_negative_dividend(unit: &Unit) -> Option<(Span, &'static Division)> {
    let mut search = NegativeSearch::new(unit);
    unit.exprs.iter().find_map(|expr| {
        let TypedKind::Prim(call) = &expr.kind else {
            return None;
        };
        let division = DIVISIONS.iter().find(|(prim, ..)| *prim == call.prim)?;
        let (dividend, divisor) = operands(call)?;
        let matters = !search.is_unit_divisor(divisor) && search.may_be_negative(dividend);
        matters.then(|| (unit.expr(dividend).span, division))
    })
}

/// Returns the two operands of a call of a binary primitive; `None` for other primitives.
fn operands(call: &PrimCall) -> Option<(ExprId, ExprId)> {
    match call.inputs[..] {
        [Some(first), Some(second)] => Some((first, second)),
        _ => None,
    }
}

/// Search for dividends that may be negative, backwards from each dividend to the values on which it depends. An
/// expression that has been visited without success is not visited again.
struct NegativeSearch<'u> {
    unit: &'u Unit,
    /// For each flow, the expressions that define it; `None` until they are computed on first use.
    sources: Option<Vec<Vec<ExprId>>>,
    visited: Vec<bool>,
}

impl<'u> NegativeSearch<'u> {
    fn new(unit: &'u Unit) -> Self {
        NegativeSearch {
            unit,
            sources: None,
            visited: vec![false; unit.exprs.len()],
        }
    }

    /// Whether a dividend, or a value on which its sign depends, may be negative.
    fn may_be_negative(&mut self, dividend: ExprId) -> bool {
        let mut open = vec![dividend];
        while let Some(id) = open.pop() {
            if std::mem::replace(&mut self.visited[id.0 as usize], true) {
                continue;
            }
            match self.sign_dependencies(id) {
                Some(reasons) => open.extend(reasons),
                None => return true,
            }
        }
        false
    }

    /// Returns other expressions such that expression `id` is not negative if none of them is negative. `None` if `id`
    /// may be negative even then.
    fn sign_dependencies(&mut self, id: ExprId) -> Option<Vec<ExprId>> {
        match &self.unit.expr(id).kind {
            TypedKind::Error => Some(Vec::new()),
            TypedKind::Literal(_) | TypedKind::Const(_) => {
                self.constant(id).filter(|n| *n >= 0).map(|_| Vec::new())
            }
            TypedKind::Flow(flow) => self.sources(*flow),
            TypedKind::When { value, .. } | TypedKind::Current(value) => Some(vec![*value]),
            TypedKind::Merge { cases, .. } => Some(cases.iter().map(|(_, case)| *case).collect()),
            TypedKind::Each(ElementwiseOp::If, operands) => self.unproven_branches(operands),
            TypedKind::Each(_, operands) => Some(operands.to_vec()),
            TypedKind::Prim(call) => {
                let (_, count) = SIGN_PRESERVING
                    .iter()
                    .find(|(prim, _)| *prim == call.prim)?;
                call.inputs.iter().take(*count).copied().collect()
            }
            _ => None,
        }
    }

    /// Returns the expressions that define a flow; `None` if no equation defines the flow, as for an in-port.
    fn sources(&mut self, flow: FlowId) -> Option<Vec<ExprId>> {
        let unit = self.unit;
        let sources = self.sources.get_or_insert_with(|| add_sources(unit));
        let of_flow = &sources[flow.0 as usize];
        (!of_flow.is_empty()).then(|| of_flow.clone())
    }

    /// Returns the branches of an `if` that the condition of the `if` does not prove to be non-negative. `operands` are
    /// the condition and the two branches.
    fn unproven_branches(&self, operands: &[ExprId]) -> Option<Vec<ExprId>> {
        let [condition, yes, no] = *operands else {
            return None;
        };
        let open = [(yes, true), (no, false)].into_iter();
        let open = open.filter(|(way, holds)| !self.is_proven_nonnegative(condition, *holds, *way));
        Some(open.map(|(way, _)| way).collect())
    }

    /// Whether the condition of an `if` proves that its branch `way` is not negative, as in `if x >= 0 then x else -x`.
    /// `holds` is whether the branch is taken for a true condition.
    fn is_proven_nonnegative(&self, condition: ExprId, holds: bool, way: ExprId) -> bool {
        let TypedKind::Prim(test) = &self.unit.expr(condition).kind else {
            return false;
        };
        let Some((high, low)) = operands(test).filter(|_| LOWER_BOUND_TESTS.contains(&test.prim))
        else {
            return false;
        };
        // Here high >= low, and high > low if the test is strict and holds, or is not strict and fails.
        let is_strict = test.prim == LOWER_BOUND_TESTS[0];
        let (high, low) = if holds { (high, low) } else { (low, high) };
        let least = -i64::from(holds == is_strict);
        let is_least = |id: ExprId, sign: i64| {
            let n = self.constant(id).and_then(|n| n.checked_mul(sign));
            n.is_some_and(|n| n >= least)
        };
        let is_same = |a: ExprId, b: ExprId| {
            let [a, b] = [a, b].map(|id| literal(self.unit, id, true));
            a.is_some() && a == b
        };
        match self.negated(way) {
            Some(way) => is_same(way, low) && is_least(high, -1),
            None => is_same(way, high) && is_least(low, 1),
        }
    }

    /// Returns the operand of an expression that is a negation; `None` for other expressions.
    fn negated(&self, id: ExprId) -> Option<ExprId> {
        match &self.unit.expr(id).kind {
            TypedKind::Prim(call) if call.prim == prim!("Rpi::IntNegate") => {
                *call.inputs.first()?
            }
            _ => None,
        }
    }

    /// Returns the value of an expression that is an integer constant; `None` for other expressions.
    fn constant(&self, id: ExprId) -> Option<i64> {
        match &self.unit.expr(id).kind {
            TypedKind::Literal(leaf) => leaf.as_int(),
            TypedKind::Const(leaves) => match &leaves[..] {
                [leaf] => Leaf::as_int(leaf),
                _ => None,
            },
            _ => None,
        }
    }

    /// Returns whether a divisor is the constant 1 or -1, for which all compilers compute the same quotient.
    fn is_unit_divisor(&self, divisor: ExprId) -> bool {
        matches!(self.constant(divisor), Some(1 | -1))
    }
}

/// Returns the expressions that define each flow of a unit, indexed by flow.
fn add_sources(unit: &Unit) -> Vec<Vec<ExprId>> {
    let mut sources = vec![Vec::new(); unit.flows.len()];
    for equation in unit.blocks.iter().flat_map(|block| &block.equations) {
        for (k, target) in equation.targets.iter().enumerate() {
            if let TargetPlace::Flow { flow, .. } = target.place {
                sources[flow.0 as usize].push(target_value(unit, equation, k));
            }
        }
    }
    sources
}

/// Returns the value of the target with index `k` of an equation: an element of the value if this is written as a
/// tuple, else the whole value.
fn target_value(unit: &Unit, equation: &Equation, k: usize) -> ExprId {
    match &unit.expr(equation.value).kind {
        TypedKind::Build(parts) if parts.len() == equation.targets.len() => parts[k],
        _ => equation.value,
    }
}
