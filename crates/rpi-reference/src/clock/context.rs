//! Expressions without a clock of their own, which adopt the clock of their reader.

use std::rc::Rc;

use rpi_sema::typed::{Block, BlockId, ExprId, TargetPlace, TypedKind, Unit};

use super::{Clock, ClockSolver, base, common_prefix, sampled};

/// Returns, for each expression of a unit (function, node, command), the block that contains it: body, fragment or
/// state. The activation condition of a block belongs to the enclosing block.
pub(super) fn blocks(unit: &Unit) -> Vec<BlockId> {
    let mut blocks = vec![BlockId::ROOT; unit.exprs.len()];
    for (id, block) in (0..).map(BlockId).zip(&unit.blocks) {
        let roots = roots(unit, block);
        roots
            .into_iter()
            .for_each(|root| blocks[root.0 as usize] = id);
        for automaton in &block.automata {
            for state in &automaton.states {
                let inside = state.until.iter().filter_map(|one| one.condition);
                inside.for_each(|root| blocks[root.0 as usize] = state.block);
            }
        }
    }
    // Operands have smaller indices than their readers.
    for id in (0..unit.exprs.len()).rev() {
        let own = blocks[id];
        unit.exprs[id]
            .kind
            .operands(&mut |operand| blocks[operand.0 as usize] = own);
    }
    blocks
}

/// Returns the outermost expressions directly in a block, such as the right sides of its equations. Their operands are
/// not listed.
fn roots(unit: &Unit, block: &Block) -> Vec<ExprId> {
    let mut roots: Vec<ExprId> = block.equations.iter().map(|one| one.value).collect();
    roots.extend(block.claims.iter().map(|claim| claim.condition));
    roots.extend(block.ends.iter().map(|end| end.condition));
    roots.extend(block.exports.iter().map(|export| export.value));
    for automaton in &block.automata {
        let strong = automaton.states.iter().flat_map(|state| &state.unless);
        roots.extend(strong.filter_map(|one| one.condition));
    }
    let own = |inner: &&Block| {
        inner
            .parent
            .is_some_and(|id| std::ptr::eq(unit.block(id), block))
    };
    roots.extend(
        unit.blocks
            .iter()
            .filter(own)
            .filter_map(|inner| inner.when),
    );
    roots
}

impl ClockSolver<'_> {
    /// Assigns to each expression whose clock is unknown, such as a literal, the clock on which its reader reads it.
    pub(super) fn adopt_reader_clocks(&mut self) {
        for equation in self.unit.blocks.iter().flat_map(|block| &block.equations) {
            let mut first = 0;
            for target in &equation.targets {
                for k in 0..target.ty.leaf_count() {
                    let clock = match target.place {
                        TargetPlace::Flow { flow, at } => {
                            self.clocks.flows[flow.0 as usize][at as usize + k].clone()
                        }
                        _ => base(),
                    };
                    self.give(equation.value, first + k, clock);
                }
                first += target.ty.leaf_count();
            }
        }
        for id in (0..)
            .map(ExprId)
            .take(self.unit.exprs.len())
            .collect::<Vec<_>>()
            .into_iter()
            .rev()
        {
            for leaf in &mut self.clocks.exprs[id.0 as usize] {
                leaf.get_or_insert_with(|| Rc::new([]));
            }
            self.propagate_to_operands(id);
        }
    }

    /// Assigns to the operands of an expression whose clocks are unknown the clock on which the expression reads them.
    fn propagate_to_operands(&mut self, id: ExprId) {
        let expr = self.unit.expr(id);
        let whole = common_prefix(self.clocks.exprs[id.0 as usize].iter().cloned());
        match &expr.kind {
            TypedKind::Call(call) => {
                self.clocks.calls[id.0 as usize] =
                    self.clocks.calls[id.0 as usize].clone().or(whole.clone());
                for (number, arg) in call.args.iter().enumerate() {
                    let clock = self.argument_clock(id, call, number);
                    arg.iter().for_each(|arg| self.give_all(*arg, &clock));
                }
                let runs = self.clocks.calls[id.0 as usize].clone();
                call.activation
                    .operands(&mut |operand| self.give_all(operand, &runs));
            }
            TypedKind::Merge { on, cases } => {
                self.give_all(*on, &whole);
                if let (TypedKind::Flow(flow), Some(clock)) = (&self.unit.expr(*on).kind, &whole) {
                    for (value, case) in cases {
                        let case_clock = Some(sampled(clock, self.clock_condition(*flow), *value));
                        self.give_all(*case, &case_clock);
                    }
                }
            }
            TypedKind::When { value, clock } => {
                let clock = self.clocks.flows[clock.flow.0 as usize]
                    .first()
                    .cloned()
                    .flatten();
                self.give_all(*value, &clock);
            }
            kind => {
                for k in 0..expr.ty.leaf_count() {
                    let clock = self.clocks.exprs[id.0 as usize][k].clone();
                    let mut read = Vec::new();
                    self.reads(kind, &expr.ty, k, &mut |operand, leaf| {
                        read.push((operand, leaf))
                    });
                    read.into_iter()
                        .for_each(|(operand, leaf)| self.give(operand, leaf, clock.clone()));
                }
            }
        }
    }

    fn give_all(&mut self, id: ExprId, clock: &Clock) {
        for k in 0..self.unit.expr(id).ty.leaf_count() {
            self.give(id, k, clock.clone());
        }
    }

    fn give(&mut self, id: ExprId, k: usize, clock: Clock) {
        let leaf = &mut self.clocks.exprs[id.0 as usize][k];
        *leaf = leaf.take().or(clock);
    }
}
