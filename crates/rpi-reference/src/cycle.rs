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

/// Interpreter that defines the semantics of programs. It executes a program cycle by cycle, and its state is that of
/// the program.
pub struct Interpreter<'p> {
    pub(crate) units: &'p [Unit],
    /// For each unit (function, node, command) of the program, the clocks of its flows and expressions: the cycles in
    /// which each has a value.
    pub(crate) clocks: Vec<Rc<Clocks>>,
    /// Instances of units: the whole program at index 0, and one for each call. Instances that a reset replaces remain
    /// in the list, unused.
    pub(crate) instances: Vec<Instance<'p>>,
    /// Number of the cycle that is evaluated, counted from 1.
    pub(crate) cycle: u64,
    pub(crate) period: Period,
    /// Values of the in-ports of the program in the current cycle, one for each leaf (scalar part).
    pub(crate) inputs: Vec<Leaf>,
    /// Updates of the memory that the end of the cycle applies, each with the context whose memory it changes.
    pub(crate) updates: Vec<(EvalContext, MemoryUpdate)>,
}

/// Update of the memory of a block, applied at the end of a cycle for the next one.
pub(crate) enum MemoryUpdate {
    /// For a leaf (scalar part) of a delay, stores the value of the operand of the delay. The fields are the delay, the
    /// index of the leaf, and the operand, which is evaluated at the end of the cycle.
    Delayed(ExprId, usize, ExprId),
    /// Stores a value for a leaf (scalar part) of an expression with state. The fields are the expression, the index of
    /// the leaf, and the value.
    Leaf(ExprId, usize, Leaf),
    /// Stores the current value of a leaf (scalar part) of a flow that the states of an automaton share, for the
    /// operator `last`. The fields are the flow and the index of the leaf, which is evaluated at the end of the cycle.
    Last(FlowId, usize),
    /// Stores a value for a leaf (scalar part) of a flow that the states of an automaton share. The fields are the
    /// flow, the index of the leaf, and the value.
    LastLeaf(FlowId, usize, Leaf),
    /// Records that a leaf (scalar part) of `a -> b` or `first` has had its first cycle. The fields are the expression
    /// and the index of the leaf.
    Begun(ExprId, usize),
    /// Records whether a block (fragment) was active in the cycle.
    Active(BlockId, bool),
    /// Stores the state of an automaton for the next cycle. The fields are the index of the automaton in its block, the
    /// state, and the indices of the states that must restart when they run next.
    State(usize, State, BTreeSet<u32>),
}

/// Observable values of a cycle: outputs, exports, and the end of the command.
#[derive(Clone, PartialEq, Debug)]
pub struct CycleOutput {
    /// Values of the out-ports, one for each leaf (scalar part), in the order of the declaration.
    pub outputs: Vec<Leaf>,
    /// Values of the exported flows, one for each leaf (scalar part), in source order. A flow of an inactive fragment
    /// is absent.
    pub exports: Vec<Leaf>,
    /// Result with which the command ends after the cycle, as an index in source order; `None` if the command
    /// continues. A `yield` never ends it, because the interpreter has no successor commands.
    pub end: Option<usize>,
}

impl<'p> Interpreter<'p> {
    /// Creates an interpreter for the unit `root` (node or command), which runs on its own. `units` are all units of
    /// the program, and `dt` is the period in seconds.
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

    /// Executes the next cycle. `inputs` contains the values of all in-ports, one for each leaf (scalar part).
    ///
    /// # Errors
    /// Returns an error if the cycle faults, has a dependency cycle or needs an unsupported construct. No further cycle
    /// may be executed then.
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

    /// Prepares an instance for the current cycle by clearing the values of the previous one. `chosen` is true if the
    /// enclosing `if`s need the result of the call that the instance executes.
    pub(crate) fn enter(&mut self, instance: InstanceId, chosen: bool) {
        self.instances[instance].current = CycleValues {
            chosen,
            ..CycleValues::default()
        };
    }

    /// Evaluates all active expressions of an instance: equations, claims, transitions, exports and ends.
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

    /// Checks that the values of an equation lie in the integer subranges of the flows that it defines. A value outside
    /// of its subrange is a fault.
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

    /// Checks that the inputs of an instance lie in the integer subranges of its in-ports. A value outside of its
    /// subrange is a fault.
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

    /// Returns the context in which the expressions directly in a block (body, fragment or state) are evaluated.
    pub(crate) fn inside(&self, instance: InstanceId, block: BlockId) -> EvalContext {
        EvalContext {
            instance,
            block: Some(block),
            chosen: self.instances[instance].current.chosen,
        }
    }

    /// Evaluates all leaves (scalar parts) of an expression and of its operands, because an expression whose value is
    /// not used may still fault or have state.
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

    /// Evaluates the parts of `y` that `x ?? y` needs (M6.7). For an array or struct literal these are the parts where
    /// `x` has an absent leaf (scalar part); any other `y` is evaluated if any leaf of `x` is absent.
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

    /// Returns whether operand number `number` of an expression belongs to the instance. A branch of an `if` that
    /// static parameters exclude does not (M5.4).
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

    /// Returns the context in which operand number `number` of an expression is evaluated for the leaf (scalar part)
    /// `k`. Its field `chosen` is false if the operator does not need the value of the operand (M6.7).
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

    /// Returns the context of the right operand of `and`, `or` or `=>`. The operand is needed (`chosen`) unless the
    /// left operand decides the result. An absent left operand does not decide (M4.4).
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

    /// Returns the index of the result with which the command ends in the current cycle; `None` if it continues. If
    /// several conditions are true, a `fail` takes precedence, then the source order (M10.1).
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

    /// Applies the recorded updates of the memory, so that the next cycle reads the new values.
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

    /// Returns leaf (scalar part) number `k` of an in-port of the executed unit, with times in ticks. `port` is the
    /// index of the in-port.
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

/// Returns whether a primitive is an operator that needs its right operand only if the left one does not decide the
/// result (`and`, `or`, `=>`).
fn is_lazy(call: &PrimCall) -> bool {
    let name = call.prim.desc().name;
    ["Core::BooleanAnd", "Core::BooleanOr", "Rpi::BooleanImplies"].contains(&name)
}

/// Returns whether a primitive stores values from one cycle to the next.
fn has_state(call: &PrimCall) -> bool {
    !matches!(call.prim.desc().state, rpi_image::StateSize::None)
}
