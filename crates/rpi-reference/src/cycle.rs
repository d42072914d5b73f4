//! Execution of a cycle: every active expression is evaluated once (M1.2), then the memory for the next cycle is
//! updated.

use std::collections::BTreeSet;
use std::rc::Rc;

use rpi_sema::typed::{
    self, BlockId, Each, Equation, ExprId, FlowId, FlowRole, Kind, PrimCall, Unit, UnitId,
};
use rpi_syntax::ast::EndKind;

use crate::clock::{self, Clocks};
use crate::instance::{Here, Instance, InstanceId, Now, Place, State};
use crate::value::{Leaf, Stop};

/// Interpreter of a program, with its state.
pub struct Reference<'p> {
    pub(crate) units: &'p [Unit],
    /// Clocks of each unit.
    pub(crate) clocks: Vec<Rc<Clocks>>,
    /// All instances ever created; instances dropped by a reset remain here unused.
    pub(crate) instances: Vec<Instance<'p>>,
    /// Number of the current cycle, from 1.
    pub(crate) cycle: u64,
    /// Period of a cycle in seconds.
    pub(crate) dt: f64,
    /// Inputs of the current cycle, by leaf.
    pub(crate) inputs: Vec<Leaf>,
    /// Updates of the memory for the next cycle.
    pub(crate) keep: Vec<(Here, Keep)>,
}

/// Update of the memory for the next cycle.
pub(crate) enum Keep {
    /// Leaf of a delayed expression; it is evaluated at the end of the cycle.
    Delayed(ExprId, usize, ExprId),
    /// Leaf with a known value.
    Leaf(ExprId, usize, Leaf),
    /// Leaf of a flow shared by states; it is evaluated at the end of the cycle.
    Last(FlowId, usize),
    /// Leaf of a flow shared by states, with a known value.
    LastLeaf(FlowId, usize, Leaf),
    /// Leaf of `a -> b` or `first` that has had its first cycle.
    Begun(ExprId, usize),
    /// Whether a block was active.
    Active(BlockId, bool),
    /// State of an automaton, and the states that must still restart.
    State(usize, State, BTreeSet<u32>),
}

/// Observable result of a cycle.
#[derive(Clone, PartialEq, Debug)]
pub struct Cycle {
    /// Out-ports, by leaf.
    pub outputs: Vec<Leaf>,
    /// Exported flows, by leaf, in source order.
    pub exports: Vec<Leaf>,
    /// Result with which a command ends, by its index in source order. `yield` is not supported.
    pub end: Option<usize>,
}

impl<'p> Reference<'p> {
    /// Creates an interpreter for a unit that runs on its own. `dt` is the period in seconds.
    #[must_use]
    pub fn new(units: &'p [Unit], root: UnitId, dt: f64) -> Reference<'p> {
        Reference {
            units,
            clocks: clock::clocks(units),
            instances: vec![Instance::new(&units[root.0 as usize], root, None)],
            cycle: 0,
            dt,
            inputs: Vec::new(),
            keep: Vec::new(),
        }
    }

    /// Runs a cycle. `inputs` contains the leaves of all in-ports.
    ///
    /// # Errors
    /// If the cycle faults; no further cycle may be run then.
    pub fn cycle(&mut self, inputs: &[Leaf]) -> Result<Cycle, Stop> {
        self.cycle += 1;
        self.inputs = inputs.to_vec();
        self.enter(0, true);
        self.body(0)?;
        let unit = self.instances[0].unit;
        let mut outputs = Vec::new();
        for flow in &unit.outputs {
            let ty = &unit.flow(*flow).ty;
            for k in 0..ty.leaf_count() {
                let leaf = self.flow(0, *flow, k)?;
                outputs.push(self.as_seen(leaf, ty, k));
            }
        }
        let seen = Cycle {
            outputs,
            exports: self.exports()?,
            end: self.end()?,
        };
        self.remember()?;
        Ok(seen)
    }

    /// Begins a cycle of an instance.
    pub(crate) fn enter(&mut self, instance: InstanceId, chosen: bool) {
        self.instances[instance].now = Now {
            chosen,
            ..Now::default()
        };
    }

    /// Evaluates all active expressions of an instance.
    pub(crate) fn body(&mut self, instance: InstanceId) -> Result<(), Stop> {
        let unit = self.instances[instance].unit;
        self.ports(instance)?;
        for (id, block) in (0..).map(BlockId).zip(&unit.blocks) {
            self.condition(instance, id)?;
            if !self.is_active(instance, id)? {
                continue;
            }
            let here = self.inside(instance, id);
            for equation in &block.equations {
                self.visit(here, equation.value)?;
                self.targets(instance, equation)?;
            }
            for claim in &block.claims {
                self.visit(here, claim.condition)?;
            }
            for k in 0..block.automata.len() {
                self.transitions(here, id, k)?;
            }
            for export in &block.exports {
                self.visit(here, export.value)?;
            }
            for end in &block.ends {
                self.visit(here, end.condition)?;
            }
        }
        Ok(())
    }

    /// Checks that the values defined by an equation lie in the subranges of the flows.
    fn targets(&mut self, instance: InstanceId, equation: &Equation) -> Result<(), Stop> {
        for target in &equation.targets {
            if let typed::Place::Flow { flow, at } = target.place {
                for (k, _) in target.ty.subranges(false) {
                    self.flow(instance, flow, at as usize + k)?;
                }
            }
        }
        Ok(())
    }

    /// Checks that the inputs lie in the subranges of the in-ports.
    fn ports(&mut self, instance: InstanceId) -> Result<(), Stop> {
        let unit = self.instances[instance].unit;
        let from_outside = self.instances[instance].caller.is_none();
        for flow in &unit.inputs {
            for (k, _) in unit.flow(*flow).ty.subranges(from_outside) {
                self.flow(instance, *flow, k)?;
            }
        }
        Ok(())
    }

    /// Returns the evaluation context inside a block.
    pub(crate) fn inside(&self, instance: InstanceId, block: BlockId) -> Here {
        Here {
            instance,
            block: Some(block),
            chosen: self.instances[instance].now.chosen,
        }
    }

    /// Evaluates all leaves of an expression and of its operands, because an expression whose value is not used may
    /// still fault or have state.
    pub(crate) fn visit(&mut self, here: Here, id: ExprId) -> Result<(), Stop> {
        if !self.instances[here.instance].now.visited.insert(id) {
            return Ok(());
        }
        let expr = self.instances[here.instance].unit.expr(id);
        for k in 0..expr.ty.leaf_count() {
            self.leaf(here, id, k)?;
        }
        if let Kind::Call(call) = &expr.kind
            && self.runs(here, id)?
            && let Some(instance) = self.called(here, id, call)?
        {
            self.body(instance)?;
        }
        let mut operands = Vec::new();
        expr.kind.operands(&mut |operand| operands.push(operand));
        if let Kind::Each(Each::Coalesce, of) = &expr.kind {
            self.needed(here, id, of[0], of[1])?;
        }
        for (k, operand) in operands.into_iter().enumerate() {
            if self.is_text(here, id, k)? {
                let there = self.operand(here, (id, 0), k)?;
                self.visit(there, operand)?;
            }
        }
        Ok(())
    }

    /// Evaluates the parts of y that `x ?? y` needs: for an array or struct literal only the parts with an absent leaf
    /// in x, for any other expression everything if any leaf of x is absent (M6.7).
    fn needed(&mut self, here: Here, id: ExprId, x: ExprId, y: ExprId) -> Result<(), Stop> {
        let unit = self.instances[here.instance].unit;
        let mut absent = Vec::new();
        for k in 0..unit.expr(id).ty.leaf_count() {
            absent.push(self.leaf(here, x, k)?.is_none());
        }
        self.where_absent(here, y, &absent)
    }

    fn where_absent(&mut self, here: Here, y: ExprId, absent: &[bool]) -> Result<(), Stop> {
        let unit = self.instances[here.instance].unit;
        if let Kind::Build(parts) = &unit.expr(y).kind
            && !self.clocks(here).are_sampled()
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
            true => self.visit(here, y),
            false => Ok(()),
        }
    }

    /// Returns whether the operand of this number is part of the instance: a branch excluded by static parameters is
    /// not (M5.4).
    fn is_text(&mut self, here: Here, id: ExprId, number: usize) -> Result<bool, Stop> {
        let unit = self.instances[here.instance].unit;
        Ok(match &unit.expr(id).kind {
            Kind::Each(Each::If, operands) if number > 0 && unit.chosen.contains(&operands[0]) => {
                self.truth(here, operands[0])? == Some(number == 1)
            }
            _ => true,
        })
    }

    /// Returns the context in which the operand of this number is evaluated for a leaf. An operand is chosen if the
    /// operator needs its value (M6.7).
    pub(crate) fn operand(
        &mut self,
        here: Here,
        (id, k): Place,
        number: usize,
    ) -> Result<Here, Stop> {
        let unit = self.instances[here.instance].unit;
        Ok(match &unit.expr(id).kind {
            Kind::Each(Each::If, operands) if number > 0 => {
                let condition = self.truth(here, operands[0])?;
                Here {
                    chosen: here.chosen && condition == Some(number == 1),
                    ..here
                }
            }
            Kind::Each(Each::Arrow, _) => Here {
                chosen: here.chosen && self.is_first(here, (id, k)) == (number == 0),
                ..here
            },
            Kind::Each(Each::Pre | Each::Last | Each::Hold, _) | Kind::Current(_) => {
                here.unguarded()
            }
            // The leaves of the right operand that are needed were evaluated before.
            Kind::Each(Each::Coalesce, _) if number == 1 => Here {
                chosen: false,
                ..here
            },
            Kind::Prim(call) if number == 1 && is_lazy(call) => self.second(here, call)?,
            Kind::Prim(call) if remembers(call) => here.unguarded(),
            Kind::Call(call) if !self.follows_choice(call) => here.unguarded(),
            _ => here,
        })
    }

    /// Returns the context of the right operand of `and`, `or` and `=>`: chosen unless the left one decides. An absent
    /// left operand does not decide (M4.4).
    fn second(&mut self, here: Here, call: &PrimCall) -> Result<Here, Stop> {
        let left = match call.inputs[0] {
            Some(left) => self.truth(here, left)?,
            None => None,
        };
        let decides = left == Some(call.prim.desc().name == "Core::BooleanOr");
        Ok(Here {
            chosen: here.chosen && !decides,
            ..here
        })
    }

    fn exports(&mut self) -> Result<Vec<Leaf>, Stop> {
        let unit = self.instances[0].unit;
        let mut leaves = Vec::new();
        for (id, block) in (0..).map(BlockId).zip(&unit.blocks) {
            for export in &block.exports {
                let here = self.inside(0, id);
                let ty = &unit.expr(export.value).ty;
                for k in 0..ty.leaf_count() {
                    let active = self.is_active(0, id)?;
                    let leaf = if active {
                        self.leaf(here, export.value, k)?
                    } else {
                        None
                    };
                    leaves.push(self.as_seen(leaf, ty, k));
                }
            }
        }
        Ok(leaves)
    }

    /// Returns the result with which the command ends. `fail` takes precedence, then the source order (M10.1).
    fn end(&mut self) -> Result<Option<usize>, Stop> {
        let ends = &self.instances[0].unit.block(BlockId::ROOT).ends;
        let here = self.inside(0, BlockId::ROOT);
        for fail in [true, false] {
            for (k, end) in ends.iter().enumerate() {
                let asked = (end.kind == EndKind::Fail) == fail && end.kind != EndKind::Yield;
                if asked && self.truth(here, end.condition)? == Some(true) {
                    return Ok(Some(k));
                }
            }
        }
        Ok(None)
    }

    /// Updates the memory for the next cycle.
    fn remember(&mut self) -> Result<(), Stop> {
        let mut known = Vec::new();
        // Evaluating a delayed operand may record further updates.
        while !self.keep.is_empty() {
            for (here, keep) in std::mem::take(&mut self.keep) {
                let keep = match keep {
                    Keep::Delayed(id, k, operand) => {
                        Keep::Leaf(id, k, self.leaf(here.unguarded(), operand, k)?)
                    }
                    Keep::Last(flow, k) => {
                        Keep::LastLeaf(flow, k, self.flow(here.instance, flow, k)?)
                    }
                    other => other,
                };
                known.push((here, keep));
            }
        }
        for (here, keep) in known {
            let memory = self.instances[here.instance].memory(here.block);
            match keep {
                Keep::Leaf(id, k, leaf) => drop(memory.kept.insert((id, k), leaf)),
                Keep::LastLeaf(flow, k, leaf) => drop(memory.last.insert((flow, k), leaf)),
                Keep::Begun(id, k) => drop(memory.begun.insert((id, k))),
                Keep::Active(block, true) => drop(memory.was_active.insert(block)),
                Keep::Active(block, false) => drop(memory.was_active.remove(&block)),
                Keep::State(k, state, owed) => {
                    memory.states.insert(k, state);
                    memory.owed.insert(k, owed);
                }
                Keep::Delayed(..) | Keep::Last(..) => {}
            }
        }
        Ok(())
    }

    /// Returns a leaf of an in-port of the whole program.
    pub(crate) fn input(&self, port: usize, k: usize) -> Leaf {
        let unit = self.instances[0].unit;
        let from_outside = |id: &&FlowId| unit.flow(**id).role != FlowRole::Param;
        let before = unit.inputs[..port].iter().filter(from_outside);
        let first: usize = before.map(|id| unit.flow(*id).ty.leaf_count()).sum();
        let leaf = self.inputs.get(first + k).copied().flatten();
        self.as_counted(leaf, &unit.flow(unit.inputs[port]).ty, k)
    }
}

/// Returns whether an operator needs its right operand only if the left one does not decide.
fn is_lazy(call: &PrimCall) -> bool {
    let name = call.prim.desc().name;
    ["Core::BooleanAnd", "Core::BooleanOr", "Rpi::BooleanImplies"].contains(&name)
}

/// Returns whether a primitive has state.
fn remembers(call: &PrimCall) -> bool {
    !matches!(call.prim.desc().state, rpi_image::State::None)
}
