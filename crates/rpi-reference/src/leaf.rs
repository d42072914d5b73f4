//! Evaluation of expressions: one leaf of one expression in the current cycle.

use rpi_sema::ty::Ty;
use rpi_sema::typed::{ElementwiseOp, Expr, ExprId, PrimCall, TypedKind};

use crate::clock::{Clock, ClockCondition, Clocks, Sampling, call_of};
use crate::cycle::{Interpreter, MemoryUpdate};
use crate::instance::{EvalContext, InstanceId, LeafId};
use crate::operator;
use crate::value::{EvalError, Leaf, Value};

impl<'p> Interpreter<'p> {
    /// Returns a leaf of an expression. It is evaluated once per cycle.
    pub(crate) fn leaf(
        &mut self,
        here: EvalContext,
        id: ExprId,
        k: usize,
    ) -> Result<Leaf, EvalError> {
        let now = &mut self.instances[here.instance].current;
        match now.leaves.get(&(id, k)) {
            Some(Some(leaf)) => return Ok(*leaf),
            // `None` marks a leaf whose evaluation is in progress.
            Some(None) => return Err(EvalError::DependencyCycle),
            None => drop(now.leaves.insert((id, k), None)),
        }
        let leaf = match self.ticks(here, id, k)? {
            true => self.evaluate_leaf(here, id, k)?,
            false => None,
        };
        let now = &mut self.instances[here.instance].current;
        now.leaves.insert((id, k), Some(leaf));
        Ok(leaf)
    }

    /// Returns the value of a condition; `None` if it is absent.
    pub(crate) fn truth(
        &mut self,
        here: EvalContext,
        id: ExprId,
    ) -> Result<Option<bool>, EvalError> {
        Ok(match self.leaf(here, id, 0)? {
            Some(Value::Bool(truth)) => Some(truth),
            _ => None,
        })
    }

    fn evaluate_leaf(
        &mut self,
        here: EvalContext,
        id: ExprId,
        k: usize,
    ) -> Result<Leaf, EvalError> {
        let unit = self.instances[here.instance].unit;
        let expr = unit.expr(id);
        match &expr.kind {
            TypedKind::Error => Err(EvalError::Unsupported("an error in the program".to_owned())),
            TypedKind::Arbitrary | TypedKind::Sensor { .. } => {
                Err(EvalError::Unsupported("an external value".to_owned()))
            }
            TypedKind::Const(leaves) => {
                Ok(self.internal_leaf(Value::from_constant(&leaves[k]), &expr.ty, k))
            }
            TypedKind::Literal(leaf) => {
                Ok(self.internal_leaf(Value::from_constant(leaf), &expr.ty, k))
            }
            TypedKind::None => Ok(None),
            TypedKind::Flow(flow) => self.flow(here.instance, *flow, k),
            TypedKind::Part { base, at } => self.leaf(here, *base, *at as usize + k),
            TypedKind::Slice { base, from, step } => {
                let size = element_size(&unit.expr(*base).ty);
                let element = i64::from(*from) + (k / size) as i64 * i64::from(*step);
                self.leaf(here, *base, element as usize * size + k % size)
            }
            TypedKind::Select { base, index } => self.select(here, *base, *index, k),
            TypedKind::Build(parts) => {
                let leaf = self.array_or_struct(here, parts, k)?;
                let is_struct = matches!(expr.ty, Ty::Struct(_));
                in_field(here, leaf, &expr.ty, k, is_struct)
            }
            TypedKind::Repeat(element) => {
                let size = unit.expr(*element).ty.leaf_count();
                self.leaf(here, *element, k % size)
            }
            TypedKind::Replace { base, at, value } => {
                let at = *at as usize;
                let size = unit.expr(*value).ty.leaf_count();
                match (at..at + size).contains(&k) {
                    true => {
                        let leaf = self.leaf(here, *value, k - at)?;
                        in_field(here, leaf, &expr.ty, k, true)
                    }
                    false => self.leaf(here, *base, k),
                }
            }
            TypedKind::Each(each, operands) => self.each(here, id, *each, operands, k),
            TypedKind::Equal { operands, negated } => self.equal(here, *operands, *negated),
            TypedKind::Present(operand) => self.present(here, *operand),
            TypedKind::Prim(call) => self.operator(here, id, call),
            TypedKind::Call(call) => self.result(here, id, call, k),
            TypedKind::When { value, .. } => self.leaf(here, *value, k),
            TypedKind::Merge { on, cases } => self.merge(here, *on, cases, k),
            TypedKind::Current(operand) => self.current(here, id, *operand, k),
        }
    }

    /// Returns a leaf of a struct, tuple or array, whose leaves are numbered consecutively.
    fn array_or_struct(
        &mut self,
        here: EvalContext,
        parts: &[ExprId],
        mut k: usize,
    ) -> Result<Leaf, EvalError> {
        let unit = self.instances[here.instance].unit;
        for part in parts {
            let size = unit.expr(*part).ty.leaf_count();
            if k < size {
                return self.leaf(here, *part, k);
            }
            k -= size;
        }
        Err(EvalError::Unsupported("a missing part".to_owned()))
    }

    /// Returns a leaf of an element with a computed index.
    fn select(
        &mut self,
        here: EvalContext,
        base: ExprId,
        index: ExprId,
        k: usize,
    ) -> Result<Leaf, EvalError> {
        let unit = self.instances[here.instance].unit;
        let ty = &unit.expr(base).ty;
        let size = element_size(ty);
        let count = ty.leaf_count() / size;
        let Some(Value::Int(index)) = self.leaf(here, index, 0)? else {
            return Ok(None);
        };
        match usize::try_from(index) {
            Ok(index) if index < count => self.leaf(here, base, index * size + k),
            _ if here.chosen => Err(EvalError::Fault("index")),
            _ => self.leaf(here, base, k),
        }
    }

    /// Evaluates an operator that works on leaves.
    fn each(
        &mut self,
        here: EvalContext,
        id: ExprId,
        each: ElementwiseOp,
        operands: &[ExprId],
        k: usize,
    ) -> Result<Leaf, EvalError> {
        match (each, operands) {
            // Without a condition the result is absent, and the branch that is not taken does not matter (M4.5).
            (ElementwiseOp::If, [condition, ..]) => match self.truth(here, *condition)? {
                None => Ok(None),
                Some(chosen) => {
                    let number = if chosen { 1 } else { 2 };
                    let branch = self.operand(here, (id, k), number)?;
                    self.leaf(branch, operands[number], k)
                }
            },
            (ElementwiseOp::Pre, [x]) => self.pre(here, id, *x, k),
            (ElementwiseOp::Last, [x]) => self.last(here, *x, k),
            (ElementwiseOp::Arrow, [a, b]) => {
                let is_first = self.first(here, (id, k));
                let (side, number) = if is_first { (a, 0) } else { (b, 1) };
                let there = self.operand(here, (id, k), number)?;
                self.leaf(there, *side, k)
            }
            (ElementwiseOp::Coalesce, [a, b]) => match self.leaf(here, *a, k)? {
                None => self.leaf(here, *b, k),
                present => Ok(present),
            },
            (ElementwiseOp::Hold, [x, init]) => {
                let x = self.leaf(here.unguarded(), *x, k)?;
                self.held(here, id, k, x, *init)
            }
            _ => Err(EvalError::Unsupported(format!("{each:?}"))),
        }
    }

    /// Evaluates `pre x`: x at the previous tick of its clock in its fragment (M5.1). There is no value before; if x is
    /// never absent, the checker has proved that the missing value is not read (M5.3).
    fn pre(
        &mut self,
        here: EvalContext,
        id: ExprId,
        x: ExprId,
        k: usize,
    ) -> Result<Leaf, EvalError> {
        self.updates.push((here, MemoryUpdate::Delayed(id, k, x)));
        let memory = self.instances[here.instance].memory(here.block);
        Ok(memory.delayed_values.get(&(id, k)).copied().flatten())
    }

    /// Evaluates `last x`: the previous value of a flow shared by states, whatever the state was.
    fn last(&mut self, here: EvalContext, x: ExprId, k: usize) -> Result<Leaf, EvalError> {
        let instance = &mut self.instances[here.instance];
        let unit = instance.unit;
        match &unit.expr(x).kind {
            TypedKind::Part { base, at } => self.last(here, *base, *at as usize + k),
            TypedKind::Flow(flow) => {
                let memory = instance.memory(Some(unit.flow(*flow).block));
                Ok(memory.last.get(&(*flow, k)).copied().flatten())
            }
            other => Err(EvalError::Unsupported(format!("last of {other:?}"))),
        }
    }

    /// Returns the latest present value, or `init` before the first one (M4.3). A present value is kept; `init` is
    /// evaluated again when needed.
    pub(crate) fn held(
        &mut self,
        here: EvalContext,
        id: ExprId,
        k: usize,
        x: Leaf,
        init: ExprId,
    ) -> Result<Leaf, EvalError> {
        let memory = self.instances[here.instance].memory(here.block);
        let latest = x.or(memory.delayed_values.get(&(id, k)).copied().flatten());
        if latest.is_some() {
            self.updates.push((here, MemoryUpdate::Leaf(id, k, latest)));
        }
        match latest {
            None => self.leaf(here.unguarded(), init, k),
            latest => Ok(latest),
        }
    }

    /// Returns whether this is the first cycle at this leaf, and records that it has passed.
    pub(crate) fn first(&mut self, here: EvalContext, place: LeafId) -> bool {
        self.updates
            .push((here, MemoryUpdate::Begun(place.0, place.1)));
        self.is_first(here, place)
    }

    /// Returns the same as [`Self::first`] without recording: a leaf that does not tick in this cycle has not had its
    /// first one.
    pub(crate) fn is_first(&mut self, here: EvalContext, place: LeafId) -> bool {
        let memory = self.instances[here.instance].memory(here.block);
        !memory.started.contains(&place)
    }

    /// Evaluates `x = y`: whether all leaves are equal.
    fn equal(
        &mut self,
        here: EvalContext,
        [a, b]: [ExprId; 2],
        negated: bool,
    ) -> Result<Leaf, EvalError> {
        let unit = self.instances[here.instance].unit;
        let mut all = Some(Value::Bool(true));
        for k in 0..unit.expr(a).ty.leaf_count() {
            let (a, b) = (self.leaf(here, a, k)?, self.leaf(here, b, k)?);
            let so_far = all.map(|all| all == Value::Bool(true));
            all = operator::and(so_far, operator::equal(a, b));
        }
        match negated {
            true => operator::apply("Core::BooleanNot", &[all], here.chosen),
            false => Ok(all),
        }
    }

    /// Evaluates `present(x)`: whether all leaves are present.
    fn present(&mut self, here: EvalContext, operand: ExprId) -> Result<Leaf, EvalError> {
        let unit = self.instances[here.instance].unit;
        let mut all = true;
        for k in 0..unit.expr(operand).ty.leaf_count() {
            all &= self.leaf(here, operand, k)?.is_some();
        }
        Ok(Some(Value::Bool(all)))
    }

    fn operator(
        &mut self,
        here: EvalContext,
        id: ExprId,
        call: &PrimCall,
    ) -> Result<Leaf, EvalError> {
        let mut operands = Vec::with_capacity(call.inputs.len());
        for (number, input) in call.inputs.iter().flatten().enumerate() {
            let there = self.operand(here, (id, 0), number)?;
            operands.push(self.leaf(there, *input, 0)?);
        }
        let name = call.prim.desc().name;
        if name == "Rpi::First" {
            return Ok(Some(Value::Bool(self.first(here, (id, 0)))));
        }
        match self.time_operator(name, &operands, here.chosen) {
            Some(leaf) => leaf,
            None => operator::apply(name, &operands, here.chosen),
        }
    }

    /// Evaluates `merge c (...)`: the case selected by c; the other cases are absent (M4.7).
    fn merge(
        &mut self,
        here: EvalContext,
        on: ExprId,
        cases: &[(u32, ExprId)],
        k: usize,
    ) -> Result<Leaf, EvalError> {
        let Some(on) = self.leaf(here, on, 0)? else {
            return Ok(None);
        };
        let case = cases.iter().find(|(value, _)| equals_value(on, *value));
        case.map_or(Ok(None), |(_, case)| self.leaf(here, *case, k))
    }

    /// Evaluates `current x`: x at the latest tick of its clock (M4.7).
    fn current(
        &mut self,
        here: EvalContext,
        id: ExprId,
        operand: ExprId,
        k: usize,
    ) -> Result<Leaf, EvalError> {
        let clocks = self.clocks(here).exprs[operand.0 as usize][k].clone();
        let Some(on) = clocks.iter().flat_map(|clock| clock.last()).next() else {
            return self.leaf(here, operand, k);
        };
        let instance = &mut self.instances[here.instance];
        let unread = zero_value(instance.unit.expr(id), k).filter(|_| instance.unit.is_lustre);
        let kept = instance
            .memory(here.block)
            .delayed_values
            .get(&(id, k))
            .copied();
        let leaf = match self.is_on(here, on)? {
            Some(true) => self.leaf(here.unguarded(), operand, k)?,
            Some(false) => kept.unwrap_or(unread),
            None => None,
        };
        self.updates.push((here, MemoryUpdate::Leaf(id, k, leaf)));
        Ok(leaf)
    }

    /// Returns whether the clock of a leaf ticks (M4.7).
    fn ticks(&mut self, here: EvalContext, id: ExprId, k: usize) -> Result<bool, EvalError> {
        let clock = self.clocks(here).exprs[id.0 as usize][k].clone();
        self.is_running(here, &clock)
    }

    /// Returns whether the clock of a call ticks.
    pub(crate) fn runs(&mut self, here: EvalContext, id: ExprId) -> Result<bool, EvalError> {
        let clock = self.clocks(here).calls[id.0 as usize].clone();
        self.is_running(here, &clock)
    }

    fn is_running(&mut self, here: EvalContext, clock: &Clock) -> Result<bool, EvalError> {
        for on in clock.iter().flat_map(|clock| clock.iter()) {
            if self.is_on(here, on)? != Some(true) {
                return Ok(false);
            }
        }
        Ok(true)
    }

    pub(crate) fn clocks(&self, here: EvalContext) -> &Clocks {
        &self.clocks[self.instances[here.instance].id.0 as usize]
    }

    /// Returns whether the condition of a sampling has its value.
    fn is_on(&mut self, here: EvalContext, on: &Sampling) -> Result<Option<bool>, EvalError> {
        let leaf = self.decider(here.instance, &on.by)?;
        Ok(leaf.map(|leaf| equals_value(leaf, on.value)))
    }

    /// Returns the value of a clock condition: a flow, or a condition inside a call, possibly of another block.
    fn decider(&mut self, instance: InstanceId, by: &ClockCondition) -> Result<Leaf, EvalError> {
        let (id, inner) = match by {
            ClockCondition::Flow(flow) => return self.flow(instance, *flow, 0),
            ClockCondition::InCall(id, inner) => (*id, inner),
        };
        let it = &self.instances[instance];
        let (unit, block) = (it.unit, self.clocks[it.id.0 as usize].block(id));
        let Some(call) = call_of(&unit.expr(id).kind) else {
            return Ok(None);
        };
        if !self.is_active(instance, block)? {
            return Ok(None);
        }
        match self.active_instance(self.inside(instance, block), id, call)? {
            Some(behind) => self.decider(behind, inner),
            None => Ok(None),
        }
    }
}

/// Checks a leaf of a struct built here against the subrange of its field (M2.4).
fn in_field(
    here: EvalContext,
    leaf: Leaf,
    ty: &Ty,
    k: usize,
    is_made: bool,
) -> Result<Leaf, EvalError> {
    let Some(Value::Int(number)) = leaf.filter(|_| here.chosen && is_made) else {
        return Ok(leaf);
    };
    let mut ranges = ty.subranges(true).into_iter();
    match ranges.any(|(of, range)| of == k && !range.contains(number)) {
        true => Err(EvalError::Fault("subrange")),
        false => Ok(leaf),
    }
}

/// Returns whether a Boolean or enum value is the one with this number.
fn equals_value(leaf: Value, value: u32) -> bool {
    match leaf {
        Value::Bool(truth) => u32::from(truth) == value,
        Value::Int(place) => place == i64::from(value),
        Value::Real(_) => false,
    }
}

/// Returns the number of leaves of an array element.
fn element_size(array: &Ty) -> usize {
    match array {
        Ty::Array(element, _) => element.leaf_count().max(1),
        _ => 1,
    }
}

/// Returns the value used where the result is never read: false or 0.
fn zero_value(expr: &Expr, k: usize) -> Leaf {
    let mut leaves = Vec::new();
    expr.ty.for_each_leaf(&mut |_, leaf| {
        leaves.push(match leaf {
            Ty::Bool => Value::Bool(false),
            Ty::Real(_) => Value::Real(0.0),
            _ => Value::Int(0),
        });
    });
    leaves.get(k).copied()
}
