//! Execution of a cycle: every active expression is evaluated once (M1.2), then the memory for the next cycle is
//! updated.

use std::collections::BTreeSet;
use std::rc::Rc;

use rpi_sema::typed::{
    self, BlockId, ElementwiseOp, Equation, ExprId, FlowId, FlowRole, PrimCall, TypedKind, Unit,
    UnitId,
};
use rpi_syntax::ast::CommandEndKind;

use crate::clock::{self, Clocks};
use crate::instance::{CycleValues, EvalContext, Instance, InstanceId, LeafId, State};
use crate::time::Period;
use crate::value::{EvalError, Leaf};
use crate::{block, call, flow, leaf, sampling};

/// Interpreter that defines the semantics of programs: it runs a program cycle by cycle, and keeps its state.
pub struct Interpreter<'p> {
    pub(crate) units: &'p [Unit],
    /// Clocks of each unit.
    pub(crate) clocks: Vec<Rc<Clocks>>,
    /// All instances ever created; instances dropped by a reset remain here unused.
    pub(crate) instances: Vec<Instance<'p>>,
    /// Number of the cycle that is evaluated, counted from 1.
    pub(crate) cycle: u64,
    pub(crate) period: Period,
    /// Values of the inputs in the evaluated cycle, one for each scalar part.
    pub(crate) inputs: Vec<Leaf>,
    /// Updates of the memory for the next cycle.
    pub(crate) updates: Vec<(EvalContext, MemoryUpdate)>,
}

/// Update of the memory for the next cycle.
pub(crate) enum MemoryUpdate {
    /// Stores the value of the leaf of an expression, the second one, for a delay, the first one. It is evaluated at
    /// the end of the cycle.
    Delayed(ExprId, usize, ExprId),
    /// Stores this value for the leaf of an expression that keeps state.
    Leaf(ExprId, usize, Leaf),
    /// Stores the leaf of a flow shared by states, for `last`. It is evaluated at the end of the cycle.
    Last(FlowId, usize),
    /// Stores this value for the leaf of a flow shared by states.
    LastLeaf(FlowId, usize, Leaf),
    /// Records that a leaf of `a -> b` or `first` has had its first cycle.
    Begun(ExprId, usize),
    /// Records whether a block was active.
    Active(BlockId, bool),
    /// Stores the state of an automaton for the next cycle, and the states that must still restart.
    State(usize, State, BTreeSet<u32>),
}

/// Observable result of a cycle.
#[derive(Clone, PartialEq, Debug)]
pub struct CycleOutput {
    /// Out-ports, by leaf.
    pub outputs: Vec<Leaf>,
    /// Exported flows, by leaf, in source order.
    pub exports: Vec<Leaf>,
    /// Result with which a command ends, by its index in source order. `yield` is not supported.
    pub end: Option<usize>,
}

impl<'p> Interpreter<'p> {
    /// Creates an interpreter for a unit that runs on its own. `dt` is the period in seconds.
    #[must_use]
    pub fn new(units: &'p [Unit], root: UnitId, dt: f64) -> Interpreter<'p> {
        Interpreter {
            units,
            clocks: clock::clocks(units),
            instances: vec![Instance::new(&units[root.0 as usize], root, None)],
            cycle: 0,
            period: Period::from_seconds(dt),
            inputs: Vec::new(),
            updates: Vec::new(),
        }
    }

    /// Runs a cycle. `inputs` contains the leaves of all in-ports.
    ///
    /// # Errors
    /// If the cycle faults; no further cycle may be run then.
    pub fn cycle(&mut self, inputs: &[Leaf]) -> Result<CycleOutput, EvalError> {
        self.cycle += 1;
        self.inputs = inputs.to_vec();
        self.enter(0, true);
        self.body(0)?;
        let unit = self.instances[0].unit;
        let mut outputs = Vec::new();
        for flow in &unit.outputs {
            let ty = &unit.flow(*flow).ty;
            for k in 0..ty.leaf_count() {
                let leaf = flow::evaluate(self, 0, *flow, k)?;
                outputs.push(self.period.to_external(leaf, ty, k));
            }
        }
        let output = CycleOutput {
            outputs,
            exports: self.exports()?,
            end: self.end()?,
        };
        self.update_memory()?;
        Ok(output)
    }

    /// Prepares an instance for the current cycle: clears the values of the last one. `chosen` is whether the enclosing
    /// `if`s need the call.
    pub(crate) fn enter(&mut self, instance: InstanceId, chosen: bool) {
        self.instances[instance].current = CycleValues {
            chosen,
            ..CycleValues::default()
        };
    }

    /// Evaluates all active expressions of an instance.
    pub(crate) fn body(&mut self, instance: InstanceId) -> Result<(), EvalError> {
        let unit = self.instances[instance].unit;
        self.ports(instance)?;
        for (id, block) in (0..).map(BlockId).zip(&unit.blocks) {
            block::condition(self, instance, id)?;
            if !block::is_active(self, instance, id)? {
                continue;
            }
            let here = self.inside(instance, id);
            for equation in &block.equations {
                self.evaluate(here, equation.value)?;
                self.targets(instance, equation)?;
            }
            for claim in &block.claims {
                self.evaluate(here, claim.condition)?;
            }
            for k in 0..block.automata.len() {
                block::transitions(self, here, id, k)?;
            }
            for export in &block.exports {
                self.evaluate(here, export.value)?;
            }
            for end in &block.ends {
                self.evaluate(here, end.condition)?;
            }
        }
        Ok(())
    }

    /// Checks that the values of an equation lie in the subranges of the flows that it defines.
    fn targets(&mut self, instance: InstanceId, equation: &Equation) -> Result<(), EvalError> {
        for target in &equation.targets {
            if let typed::TargetPlace::Flow { flow, at } = target.place {
                for (k, _) in target.ty.subranges(false) {
                    flow::evaluate(self, instance, flow, at as usize + k)?;
                }
            }
        }
        Ok(())
    }

    /// Checks that the inputs of an instance lie in the subranges of its in-ports.
    fn ports(&mut self, instance: InstanceId) -> Result<(), EvalError> {
        let unit = self.instances[instance].unit;
        let from_outside = self.instances[instance].caller.is_none();
        for flow in &unit.inputs {
            for (k, _) in unit.flow(*flow).ty.subranges(from_outside) {
                flow::evaluate(self, instance, *flow, k)?;
            }
        }
        Ok(())
    }

    /// Returns the evaluation context inside a block.
    pub(crate) fn inside(&self, instance: InstanceId, block: BlockId) -> EvalContext {
        EvalContext {
            instance,
            block: Some(block),
            chosen: self.instances[instance].current.chosen,
        }
    }

    /// Evaluates all leaves of an expression and of its operands, because an expression whose value is not used may
    /// still fault or have state.
    pub(crate) fn evaluate(&mut self, here: EvalContext, id: ExprId) -> Result<(), EvalError> {
        if !self.instances[here.instance].current.visited.insert(id) {
            return Ok(());
        }
        let expr = self.instances[here.instance].unit.expr(id);
        for k in 0..expr.ty.leaf_count() {
            leaf::evaluate(self, here, id, k)?;
        }
        if let TypedKind::Call(call) = &expr.kind
            && sampling::runs(self, here, id)?
            && let Some(instance) = call::active_instance(self, here, id, call)?
        {
            self.body(instance)?;
        }
        let mut operands = Vec::new();
        expr.kind.operands(&mut |operand| operands.push(operand));
        if let TypedKind::Each(ElementwiseOp::Coalesce, of) = &expr.kind {
            self.evaluate_if_absent(here, id, of[0], of[1])?;
        }
        for (k, operand) in operands.into_iter().enumerate() {
            if self.is_text(here, id, k)? {
                let there = self.operand(here, (id, 0), k)?;
                self.evaluate(there, operand)?;
            }
        }
        Ok(())
    }

    /// Evaluates the parts of y that `x ?? y` needs: for an array or struct literal only the parts with an absent leaf
    /// in x, for any other expression everything if any leaf of x is absent (M6.7).
    fn evaluate_if_absent(
        &mut self,
        here: EvalContext,
        id: ExprId,
        x: ExprId,
        y: ExprId,
    ) -> Result<(), EvalError> {
        let unit = self.instances[here.instance].unit;
        let mut absent = Vec::new();
        for k in 0..unit.expr(id).ty.leaf_count() {
            absent.push(leaf::evaluate(self, here, x, k)?.is_none());
        }
        self.where_absent(here, y, &absent)
    }

    fn where_absent(
        &mut self,
        here: EvalContext,
        y: ExprId,
        absent: &[bool],
    ) -> Result<(), EvalError> {
        let unit = self.instances[here.instance].unit;
        if let TypedKind::Build(parts) = &unit.expr(y).kind
            && !sampling::clocks(self, here).are_sampled()
        {
            let mut first = 0;
            for part in parts {
                let size = unit.expr(*part).ty.leaf_count();
                self.where_absent(here, *part, &absent[first..first + size])?;
                first += size;
            }
            return Ok(());
        }
        match absent.contains(&true) {
            true => self.evaluate(here, y),
            false => Ok(()),
        }
    }

    /// Returns whether an operand is part of the instance at all: a branch excluded by static parameters is not (M5.4).
    fn is_text(&mut self, here: EvalContext, id: ExprId, number: usize) -> Result<bool, EvalError> {
        let unit = self.instances[here.instance].unit;
        Ok(match &unit.expr(id).kind {
            TypedKind::Each(ElementwiseOp::If, operands)
                if number > 0 && unit.static_conditions.contains(&operands[0]) =>
            {
                leaf::truth(self, here, operands[0])? == Some(number == 1)
            }
            _ => true,
        })
    }

    /// Returns the context in which an operand of an expression is evaluated for a leaf. An operand is chosen if the
    /// operator needs its value (M6.7).
    pub(crate) fn operand(
        &mut self,
        here: EvalContext,
        (id, k): LeafId,
        number: usize,
    ) -> Result<EvalContext, EvalError> {
        let unit = self.instances[here.instance].unit;
        Ok(match &unit.expr(id).kind {
            TypedKind::Each(ElementwiseOp::If, operands) if number > 0 => {
                let condition = leaf::truth(self, here, operands[0])?;
                EvalContext {
                    chosen: here.chosen && condition == Some(number == 1),
                    ..here
                }
            }
            TypedKind::Each(ElementwiseOp::Arrow, _) => EvalContext {
                chosen: here.chosen && leaf::is_first(self, here, (id, k)) == (number == 0),
                ..here
            },
            TypedKind::Each(ElementwiseOp::Pre | ElementwiseOp::Last | ElementwiseOp::Hold, _)
            | TypedKind::Current(_) => here.unguarded(),
            // The leaves of the right operand that are needed were evaluated before.
            TypedKind::Each(ElementwiseOp::Coalesce, _) if number == 1 => EvalContext {
                chosen: false,
                ..here
            },
            TypedKind::Prim(call) if number == 1 && is_lazy(call) => {
                self.right_operand_context(here, call)?
            }
            TypedKind::Prim(call) if has_state(call) => here.unguarded(),
            TypedKind::Call(call) if !call::is_stateless_call(self, call) => here.unguarded(),
            _ => here,
        })
    }

    /// Returns the context of the right operand of `and`, `or` and `=>`: chosen unless the left one decides. An absent
    /// left operand does not decide (M4.4).
    fn right_operand_context(
        &mut self,
        here: EvalContext,
        call: &PrimCall,
    ) -> Result<EvalContext, EvalError> {
        let left = match call.inputs[0] {
            Some(left) => leaf::truth(self, here, left)?,
            None => None,
        };
        let decides = left == Some(call.prim.desc().name == "Core::BooleanOr");
        Ok(EvalContext {
            chosen: here.chosen && !decides,
            ..here
        })
    }

    fn exports(&mut self) -> Result<Vec<Leaf>, EvalError> {
        let unit = self.instances[0].unit;
        let mut leaves = Vec::new();
        for (id, block) in (0..).map(BlockId).zip(&unit.blocks) {
            for export in &block.exports {
                let here = self.inside(0, id);
                let ty = &unit.expr(export.value).ty;
                for k in 0..ty.leaf_count() {
                    let active = block::is_active(self, 0, id)?;
                    let leaf = if active {
                        leaf::evaluate(self, here, export.value, k)?
                    } else {
                        None
                    };
                    leaves.push(self.period.to_external(leaf, ty, k));
                }
            }
        }
        Ok(leaves)
    }

    /// Returns the result with which the command ends. `fail` takes precedence, then the source order (M10.1).
    fn end(&mut self) -> Result<Option<usize>, EvalError> {
        let ends = &self.instances[0].unit.block(BlockId::ROOT).ends;
        let here = self.inside(0, BlockId::ROOT);
        for fail in [true, false] {
            for (k, end) in ends.iter().enumerate() {
                let is_considered =
                    (end.kind == CommandEndKind::Fail) == fail && end.kind != CommandEndKind::Yield;
                if is_considered && leaf::truth(self, here, end.condition)? == Some(true) {
                    return Ok(Some(k));
                }
            }
        }
        Ok(None)
    }

    /// Updates the memory for the next cycle.
    fn update_memory(&mut self) -> Result<(), EvalError> {
        let mut known = Vec::new();
        // Evaluating a delayed operand may record further updates.
        while !self.updates.is_empty() {
            for (here, keep) in std::mem::take(&mut self.updates) {
                let keep = match keep {
                    MemoryUpdate::Delayed(id, k, operand) => MemoryUpdate::Leaf(
                        id,
                        k,
                        leaf::evaluate(self, here.unguarded(), operand, k)?,
                    ),
                    MemoryUpdate::Last(flow, k) => MemoryUpdate::LastLeaf(
                        flow,
                        k,
                        flow::evaluate(self, here.instance, flow, k)?,
                    ),
                    other => other,
                };
                known.push((here, keep));
            }
        }
        for (here, keep) in known {
            let memory = self.instances[here.instance].memory(here.block);
            match keep {
                MemoryUpdate::Leaf(id, k, leaf) => {
                    memory.delayed_values.insert((id, k), leaf);
                }
                MemoryUpdate::LastLeaf(flow, k, leaf) => drop(memory.last.insert((flow, k), leaf)),
                MemoryUpdate::Begun(id, k) => drop(memory.started.insert((id, k))),
                MemoryUpdate::Active(block, true) => drop(memory.was_active.insert(block)),
                MemoryUpdate::Active(block, false) => drop(memory.was_active.remove(&block)),
                MemoryUpdate::State(k, state, owed) => {
                    memory.states.insert(k, state);
                    memory.pending_restarts.insert(k, owed);
                }
                MemoryUpdate::Delayed(..) | MemoryUpdate::Last(..) => {}
            }
        }
        Ok(())
    }

    /// Returns a leaf of an in-port of the unit that the interpreter runs.
    pub(crate) fn input(&self, port: usize, k: usize) -> Leaf {
        let unit = self.instances[0].unit;
        let from_outside = |id: &&FlowId| unit.flow(**id).role != FlowRole::Param;
        let before = unit.inputs[..port].iter().filter(from_outside);
        let first: usize = before.map(|id| unit.flow(*id).ty.leaf_count()).sum();
        let leaf = self.inputs.get(first + k).copied().flatten();
        self.period
            .internal_leaf(leaf, &unit.flow(unit.inputs[port]).ty, k)
    }
}

/// Returns whether an operator needs its right operand only if the left one does not decide.
fn is_lazy(call: &PrimCall) -> bool {
    let name = call.prim.desc().name;
    ["Core::BooleanAnd", "Core::BooleanOr", "Rpi::BooleanImplies"].contains(&name)
}

/// Returns whether a primitive has state.
fn has_state(call: &PrimCall) -> bool {
    !matches!(call.prim.desc().state, rpi_image::StateSize::None)
}
