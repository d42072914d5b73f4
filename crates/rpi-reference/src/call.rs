//! Calls. Each call has its own instance, which lives as long as the calling block is not reset (M6.5).

use rpi_sema::typed::{Activation, Call, ElementwiseOp, ExprId, TypedKind, UnitId, UnitKind};

use crate::cycle::{Interpreter, MemoryUpdate};
use crate::instance::{EvalContext, Instance, InstanceId};
use crate::value::{EvalError, Leaf};

impl<'p> Interpreter<'p> {
    /// Returns a leaf of the result of a call.
    pub(crate) fn result(
        &mut self,
        here: EvalContext,
        id: ExprId,
        call: &'p Call,
        k: usize,
    ) -> Result<Leaf, EvalError> {
        let leaf = match self.active_instance(here, id, call)? {
            Some(instance) => Some(self.output(instance, k)?),
            None => None,
        };
        match &call.activation {
            Activation::Condact { default, .. } => self.held_result(here, id, k, leaf, *default),
            _ => Ok(leaf.flatten()),
        }
    }

    /// Returns the result of a conditionally activated call. While the call does not run, this is the result of its
    /// last run, which may be absent; before the first run it is the default of the first cycle.
    fn held_result(
        &mut self,
        here: EvalContext,
        id: ExprId,
        k: usize,
        ran: Option<Leaf>,
        default: Option<ExprId>,
    ) -> Result<Leaf, EvalError> {
        let memory = self.instances[here.instance].memory(here.block);
        let kept = memory.delayed_values.get(&(id, k)).copied();
        let leaf = match (ran.or(kept), default) {
            (Some(leaf), _) => leaf,
            (None, Some(default)) => self.leaf(here.unguarded(), default, k)?,
            (None, None) => None,
        };
        self.updates.push((here, MemoryUpdate::Leaf(id, k, leaf)));
        Ok(leaf)
    }

    /// Returns the instance of a call, or `None` if the call does not run in this cycle.
    pub(crate) fn active_instance(
        &mut self,
        here: EvalContext,
        id: ExprId,
        call: &'p Call,
    ) -> Result<Option<InstanceId>, EvalError> {
        if let Some(known) = self.instances[here.instance].current.entered.get(&id) {
            return Ok(*known);
        }
        let (runs, afresh) = self.activation(here, &call.activation)?;
        let entered = runs.then(|| self.instance(here, id, call, afresh));
        let now = &mut self.instances[here.instance].current;
        now.entered.insert(id, entered);
        Ok(entered)
    }

    /// Returns whether a call runs, and whether it restarts.
    fn activation(
        &mut self,
        here: EvalContext,
        activation: &Activation,
    ) -> Result<(bool, bool), EvalError> {
        let here = here.unguarded();
        Ok(match activation {
            Activation::Always => (true, false),
            Activation::Restart { every } => (true, self.truth(here, *every)? == Some(true)),
            Activation::Condact { every, restart, .. } => {
                let runs = self.truth(here, *every)? == Some(true);
                let afresh = match restart {
                    Some(restart) => self.truth(here, *restart)? == Some(true),
                    None => false,
                };
                (runs, afresh)
            }
        })
    }

    fn instance(
        &mut self,
        here: EvalContext,
        id: ExprId,
        call: &'p Call,
        afresh: bool,
    ) -> InstanceId {
        let around = match self.is_stateless_call(call) {
            true => here,
            false => here.unguarded(),
        };
        let caller = Some((around, &call.args[..]));
        let calls = &self.instances[here.instance].memory(here.block).calls;
        let known = calls.get(&id).copied().filter(|_| !afresh);
        let instance = known.unwrap_or_else(|| {
            let unit = &self.units[call.unit.0 as usize];
            self.instances.push(Instance::new(unit, call.unit, caller));
            self.instances.len() - 1
        });
        let memory = self.instances[here.instance].memory(here.block);
        memory.calls.insert(id, instance);
        self.instances[instance].caller = caller;
        self.enter(instance, around.chosen);
        instance
    }

    /// Returns a leaf of the out-ports of an instance, numbered consecutively.
    fn output(&mut self, instance: InstanceId, mut k: usize) -> Result<Leaf, EvalError> {
        let unit = self.instances[instance].unit;
        for flow in &unit.outputs {
            let size = unit.flow(*flow).ty.leaf_count();
            if k < size {
                return self.flow(instance, *flow, k);
            }
            k -= size;
        }
        Err(EvalError::Unsupported("a missing out-port".to_owned()))
    }

    /// Returns whether the evaluation of a call is needed only where its value is needed: neither the callee nor
    /// anything that it calls has state (M6.7).
    pub(crate) fn is_stateless_call(&self, call: &Call) -> bool {
        matches!(call.activation, Activation::Always) && self.is_stateless(call.unit)
    }

    fn is_stateless(&self, id: UnitId) -> bool {
        let unit = &self.units[id.0 as usize];
        match unit.kind {
            UnitKind::Function => return true,
            UnitKind::Node => {}
            _ => return false,
        }
        // Blocks other than the body are fragments and states. Contracts do not count.
        let mut inner = unit.blocks.iter().skip(1);
        let has_parts = inner.any(|block| !block.is_contract)
            || unit.blocks.iter().any(|block| !block.automata.is_empty());
        !has_parts && !unit.exprs.iter().any(|expr| self.is_state(&expr.kind))
    }

    fn is_state(&self, kind: &TypedKind) -> bool {
        match kind {
            TypedKind::Each(each, _) => matches!(
                each,
                ElementwiseOp::Pre | ElementwiseOp::Last | ElementwiseOp::Hold
            ),
            TypedKind::Current(_) => true,
            TypedKind::Prim(call) => !matches!(call.prim.desc().state, rpi_image::StateSize::None),
            TypedKind::Call(call) => !self.is_stateless_call(call),
            _ => false,
        }
    }
}
