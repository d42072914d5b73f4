//! Constants take the clock of their readers. In Lustre, so do initialisations of constants.

use super::canonical_condition;
use crate::clocks::clock::{Clock, Sampling};
use crate::clocks::leaf_clocks::LeafClocks;
use crate::clocks::solve::Solver;
use crate::facts::Definition;
use crate::typed::{Call, ElementwiseOp, TypedKind};
use crate::typed::{ExprId, TargetPlace};

/// Gives every expression without a clock of its own, such as a constant, the clock of the expressions that read it.
pub(super) fn settle_constants(solver: &mut Solver<'_>) {
    let mut open = Undetermined(vec![false; solver.unit.exprs.len()]);
    for (k, row) in solver.exprs.iter().enumerate() {
        open.0[k] = row.iter().any(|clock| clock == Clock::ANY);
    }
    let reached = vec![false; solver.unit.exprs.len()];
    let mut placing = ConstantClocks {
        solver,
        open,
        reached,
    };
    placing.equations();
    // An expression stands after its operands in the table, so in reverse order readers come first.
    for id in (0..)
        .map(ExprId)
        .take(placing.solver.unit.exprs.len())
        .collect::<Vec<_>>()
        .into_iter()
        .rev()
    {
        if placing.open.0[id.0 as usize] && !placing.reached[id.0 as usize] {
            placing.set_prim_arg(id, &LeafClocks::Uniform(Clock::BASE));
        }
        placing.operands(id);
    }
}

/// For each expression, whether inference has not determined its clock, because it consists of constants.
struct Undetermined(Vec<bool>);

struct ConstantClocks<'s, 'u> {
    solver: &'s mut Solver<'u>,
    open: Undetermined,
    /// For each expression, whether an expression that reads it has been visited.
    reached: Vec<bool>,
}

impl<'u> ConstantClocks<'_, 'u> {
    /// Gives an expression without a clock of its own the clock `wanted` on which an expression reads it. If several
    /// expressions read it, it gets their common clock.
    fn set_prim_arg(&mut self, id: ExprId, wanted: &LeafClocks<Clock>) {
        let k = id.0 as usize;
        if !self.open.0[k] {
            return;
        }
        let (solver, is_again) = (&mut *self.solver, self.reached[k]);
        let row = solver.exprs[k].clone();
        let count = solver.unit.expr(id).ty.leaf_count();
        let leaf = |n: usize| match (row.leaf(n), wanted.leaf(n)) {
            (Clock::ANY, Clock::ANY) => Clock::BASE,
            (Clock::ANY, clock) => clock,
            (own, clock) if is_again => solver.meet(own, clock),
            (own, _) => own,
        };
        let filled = match (&row, wanted) {
            (LeafClocks::Uniform(_), LeafClocks::Uniform(_)) => LeafClocks::Uniform(leaf(0)),
            _ => LeafClocks::from_leaves((0..count).map(leaf), Clock::BASE),
        };
        if let Some(base) = solver.calls.get(&id)
            && (*base == Clock::ANY || is_again)
        {
            let base = filled.uniform().unwrap_or(Clock::BASE);
            solver.calls.insert(id, base);
        }
        solver.exprs[k] = filled;
        self.reached[k] = true;
    }

    fn equations(&mut self) {
        let count = self.solver.reads.definitions.len();
        for k in 0..count {
            let Definition::Equation(_, equation) = self.solver.reads.definitions[k] else {
                continue;
            };
            if !self.open.0[equation.value.0 as usize] {
                continue;
            }
            let mut wanted = Vec::new();
            for target in &equation.targets {
                let leaves = 0..target.ty.leaf_count();
                let clock = |k: usize| match target.place {
                    TargetPlace::Flow { flow, at } => {
                        self.solver.flows[flow.0 as usize].leaf(at as usize + k)
                    }
                    _ => Clock::BASE,
                };
                wanted.extend(leaves.map(clock));
            }
            let wanted = LeafClocks::from_leaves(wanted.into_iter(), Clock::BASE);
            self.set_prim_arg(equation.value, &wanted);
        }
    }

    fn operands(&mut self, id: ExprId) {
        let unit = self.solver.unit;
        let own = self.solver.exprs[id.0 as usize].clone();
        match &unit.expr(id).kind {
            TypedKind::Build(parts) => {
                let mut at = 0;
                for part in parts {
                    let count = unit.expr(*part).ty.leaf_count();
                    self.set_prim_arg(*part, &own.part(at, count));
                    at += count;
                }
            }
            TypedKind::Replace { base, at, value } => {
                let count = unit.expr(*value).ty.leaf_count();
                self.set_prim_arg(*base, &own);
                self.set_prim_arg(*value, &own.part(*at as usize, count));
            }
            TypedKind::Each(each, operands) => {
                for (n, operand) in operands.iter().enumerate() {
                    match (each, n) {
                        (ElementwiseOp::If, 0) => {
                            let clocks = own.iter().reduce(|a, b| self.solver.meet(a, b));
                            self.set_prim_arg(
                                *operand,
                                &LeafClocks::Uniform(clocks.unwrap_or(Clock::BASE)),
                            );
                        }
                        _ => self.set_prim_arg(*operand, &own),
                    }
                }
            }
            TypedKind::When { value, .. } => {
                let parent = self.solver.parent(own.leaf(0)).unwrap_or(Clock::BASE);
                self.set_prim_arg(*value, &LeafClocks::Uniform(parent));
            }
            TypedKind::Merge { on, cases } => {
                self.set_prim_arg(*on, &own);
                for (value, case) in cases {
                    let clock = case_clock(self.solver, *on, *value).unwrap_or(own.leaf(0));
                    self.set_prim_arg(*case, &LeafClocks::Uniform(clock));
                }
            }
            TypedKind::Call(call) => self.arguments(id, call),
            kind => {
                let wanted = LeafClocks::Uniform(own.leaf(0));
                let mut operands = Vec::new();
                kind.operands(&mut |operand| operands.push(operand));
                for operand in operands {
                    self.set_prim_arg(operand, &wanted);
                }
            }
        }
    }

    fn arguments(&mut self, id: ExprId, call: &'u Call) {
        let units = self.solver.units;
        let callee = &units[call.unit.0 as usize];
        let base = self.solver.calls.get(&id).copied().unwrap_or(Clock::BASE);
        for (formal, arg) in callee.inputs.iter().zip(&call.args) {
            if let Some(arg) = arg {
                let path = self.solver.port_path(call, callee, *formal, 0);
                let wanted = self.solver.translate_clock(id, call, &path, base);
                self.set_prim_arg(*arg, &LeafClocks::Uniform(wanted));
            }
        }
        let mut deciding = Vec::new();
        call.activation.operands(&mut |id| deciding.push(id));
        for operand in deciding {
            self.set_prim_arg(operand, &LeafClocks::Uniform(base));
        }
    }
}

/// Returns the clock of the case of a `merge` for the value `value` of `on`; `None` if `on` is not a flow.
pub(super) fn case_clock(solver: &mut Solver<'_>, on: ExprId, value: u32) -> Option<Clock> {
    let by = canonical_condition::condition(solver, on, 0)?;
    Some(solver.ticks.intern(Sampling {
        condition: by,
        value,
    }))
}
