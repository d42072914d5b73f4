//! Evaluation of expressions: one leaf of one expression in the current cycle.

use rpi_sema::ty::Ty;
use rpi_sema::typed::{Each, Expr, ExprId, Kind, PrimCall};

use crate::clock::{Clock, Clocks, Decider, Sampling, call_of};
use crate::cycle::{Keep, Reference};
use crate::instance::{Here, InstanceId, Place};
use crate::operator;
use crate::value::{Leaf, Stop, Value};

impl<'p> Reference<'p> {
    /// Returns a leaf of an expression. It is evaluated once per cycle.
    pub(crate) fn leaf(&mut self, here: Here, id: ExprId, k: usize) -> Result<Leaf, Stop> {
        let now = &mut self.instances[here.instance].now;
        match now.leaves.get(&(id, k)) {
            Some(Some(leaf)) => return Ok(*leaf),
            // `None` marks a leaf whose evaluation is in progress.
            Some(None) => return Err(Stop::Ring),
            None => drop(now.leaves.insert((id, k), None)),
        }
        let leaf = match self.ticks(here, id, k)? {
            true => self.fresh(here, id, k)?,
            false => None,
        };
        let now = &mut self.instances[here.instance].now;
        now.leaves.insert((id, k), Some(leaf));
        Ok(leaf)
    }

    /// Returns the value of a condition; `None` if it is absent.
    pub(crate) fn truth(&mut self, here: Here, id: ExprId) -> Result<Option<bool>, Stop> {
        Ok(match self.leaf(here, id, 0)? {
            Some(Value::Bool(truth)) => Some(truth),
            _ => None,
        })
    }

    fn fresh(&mut self, here: Here, id: ExprId, k: usize) -> Result<Leaf, Stop> {
        let unit = self.instances[here.instance].unit;
        let expr = unit.expr(id);
        match &expr.kind {
            Kind::Fault => Err(Stop::Beyond("an error in the program".to_owned())),
            Kind::Outside | Kind::Sensor { .. } => {
                Err(Stop::Beyond("an external value".to_owned()))
            }
            Kind::Const(leaves) => Ok(self.as_counted(Value::of(&leaves[k]), &expr.ty, k)),
            Kind::Literal(leaf) => Ok(self.as_counted(Value::of(leaf), &expr.ty, k)),
            Kind::None => Ok(None),
            Kind::Flow(flow) => self.flow(here.instance, *flow, k),
            Kind::Part { base, at } => self.leaf(here, *base, *at as usize + k),
            Kind::Slice { base, from, step } => {
                let size = element_size(&unit.expr(*base).ty);
                let element = i64::from(*from) + (k / size) as i64 * i64::from(*step);
                self.leaf(here, *base, element as usize * size + k % size)
            }
            Kind::Select { base, index } => self.select(here, *base, *index, k),
            Kind::Build(parts) => {
                let leaf = self.built(here, parts, k)?;
                let is_struct = matches!(expr.ty, Ty::Struct(_));
                in_field(here, leaf, &expr.ty, k, is_struct)
            }
            Kind::Repeat(element) => {
                let size = unit.expr(*element).ty.leaf_count();
                self.leaf(here, *element, k % size)
            }
            Kind::Replace { base, at, value } => {
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
            Kind::Each(each, operands) => self.each(here, id, *each, operands, k),
            Kind::Equal { operands, negated } => self.equal(here, *operands, *negated),
            Kind::Present(operand) => self.present(here, *operand),
            Kind::Prim(call) => self.operator(here, id, call),
            Kind::Call(call) => self.result(here, id, call, k),
            Kind::When { value, .. } => self.leaf(here, *value, k),
            Kind::Merge { on, cases } => self.merge(here, *on, cases, k),
            Kind::Current(operand) => self.current(here, id, *operand, k),
        }
    }

    /// Returns a leaf of a struct, tuple or array, whose leaves are numbered consecutively.
    fn built(&mut self, here: Here, parts: &[ExprId], mut k: usize) -> Result<Leaf, Stop> {
        let unit = self.instances[here.instance].unit;
        for part in parts {
            let size = unit.expr(*part).ty.leaf_count();
            if k < size {
                return self.leaf(here, *part, k);
            }
            k -= size;
        }
        Err(Stop::Beyond("a missing part".to_owned()))
    }

    /// Returns a leaf of an element with a computed index.
    fn select(&mut self, here: Here, base: ExprId, index: ExprId, k: usize) -> Result<Leaf, Stop> {
        let unit = self.instances[here.instance].unit;
        let ty = &unit.expr(base).ty;
        let size = element_size(ty);
        let count = ty.leaf_count() / size;
        let Some(Value::Int(index)) = self.leaf(here, index, 0)? else {
            return Ok(None);
        };
        match usize::try_from(index) {
            Ok(index) if index < count => self.leaf(here, base, index * size + k),
            _ if here.chosen => Err(Stop::Fault("index")),
            _ => self.leaf(here, base, k),
        }
    }

    /// Evaluates an operator that works on leaves.
    fn each(
        &mut self,
        here: Here,
        id: ExprId,
        each: Each,
        operands: &[ExprId],
        k: usize,
    ) -> Result<Leaf, Stop> {
        match (each, operands) {
            // Without a condition the result is absent, and the branch that is not taken does not matter (M4.5).
            (Each::If, [condition, ..]) => match self.truth(here, *condition)? {
                None => Ok(None),
                Some(chosen) => {
                    let number = if chosen { 1 } else { 2 };
                    let branch = self.operand(here, (id, k), number)?;
                    self.leaf(branch, operands[number], k)
                }
            },
            (Each::Pre, [x]) => self.pre(here, id, *x, k),
            (Each::Last, [x]) => self.last(here, *x, k),
            (Each::Arrow, [a, b]) => {
                let is_first = self.first(here, (id, k));
                let (side, number) = if is_first { (a, 0) } else { (b, 1) };
                let there = self.operand(here, (id, k), number)?;
                self.leaf(there, *side, k)
            }
            (Each::Coalesce, [a, b]) => match self.leaf(here, *a, k)? {
                None => self.leaf(here, *b, k),
                present => Ok(present),
            },
            (Each::Hold, [x, init]) => {
                let x = self.leaf(here.unguarded(), *x, k)?;
                self.held(here, id, k, x, *init)
            }
            _ => Err(Stop::Beyond(format!("{each:?}"))),
        }
    }

    /// Evaluates `pre x`: x at the previous tick of its clock in its fragment (M5.1). There is no value before; if x is
    /// never absent, the checker has proved that the missing value is not read (M5.3).
    fn pre(&mut self, here: Here, id: ExprId, x: ExprId, k: usize) -> Result<Leaf, Stop> {
        self.keep.push((here, Keep::Delayed(id, k, x)));
        let memory = self.instances[here.instance].memory(here.block);
        Ok(memory.kept.get(&(id, k)).copied().flatten())
    }

    /// Evaluates `last x`: the previous value of a flow shared by states, whatever the state was.
    fn last(&mut self, here: Here, x: ExprId, k: usize) -> Result<Leaf, Stop> {
        let instance = &mut self.instances[here.instance];
        let unit = instance.unit;
        match &unit.expr(x).kind {
            Kind::Part { base, at } => self.last(here, *base, *at as usize + k),
            Kind::Flow(flow) => {
                let memory = instance.memory(Some(unit.flow(*flow).block));
                Ok(memory.last.get(&(*flow, k)).copied().flatten())
            }
            other => Err(Stop::Beyond(format!("last of {other:?}"))),
        }
    }

    /// Returns the latest present value, or `init` before the first one (M4.3). A present value is kept; `init` is
    /// evaluated again when needed.
    pub(crate) fn held(
        &mut self,
        here: Here,
        id: ExprId,
        k: usize,
        x: Leaf,
        init: ExprId,
    ) -> Result<Leaf, Stop> {
        let memory = self.instances[here.instance].memory(here.block);
        let latest = x.or(memory.kept.get(&(id, k)).copied().flatten());
        if latest.is_some() {
            self.keep.push((here, Keep::Leaf(id, k, latest)));
        }
        match latest {
            None => self.leaf(here.unguarded(), init, k),
            latest => Ok(latest),
        }
    }

    /// Returns whether this is the first cycle at this leaf, and records that it has passed.
    pub(crate) fn first(&mut self, here: Here, place: Place) -> bool {
        self.keep.push((here, Keep::Begun(place.0, place.1)));
        self.is_first(here, place)
    }

    /// Returns the same as [`Self::first`] without recording: a leaf that does not tick in this cycle has not had its
    /// first one.
    pub(crate) fn is_first(&mut self, here: Here, place: Place) -> bool {
        let memory = self.instances[here.instance].memory(here.block);
        !memory.begun.contains(&place)
    }

    /// Evaluates `x = y`: whether all leaves are equal.
    fn equal(&mut self, here: Here, [a, b]: [ExprId; 2], negated: bool) -> Result<Leaf, Stop> {
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
    fn present(&mut self, here: Here, operand: ExprId) -> Result<Leaf, Stop> {
        let unit = self.instances[here.instance].unit;
        let mut all = true;
        for k in 0..unit.expr(operand).ty.leaf_count() {
            all &= self.leaf(here, operand, k)?.is_some();
        }
        Ok(Some(Value::Bool(all)))
    }

    fn operator(&mut self, here: Here, id: ExprId, call: &PrimCall) -> Result<Leaf, Stop> {
        let mut operands = Vec::with_capacity(call.inputs.len());
        for (number, input) in call.inputs.iter().flatten().enumerate() {
            let there = self.operand(here, (id, 0), number)?;
            operands.push(self.leaf(there, *input, 0)?);
        }
        let name = call.prim.desc().name;
        if name == "Rpi::First" {
            return Ok(Some(Value::Bool(self.first(here, (id, 0)))));
        }
        match self.of_time(name, &operands, here.chosen) {
            Some(leaf) => leaf,
            None => operator::apply(name, &operands, here.chosen),
        }
    }

    /// Evaluates `merge c (...)`: the case selected by c; the other cases are absent (M4.7).
    fn merge(
        &mut self,
        here: Here,
        on: ExprId,
        cases: &[(u32, ExprId)],
        k: usize,
    ) -> Result<Leaf, Stop> {
        let Some(on) = self.leaf(here, on, 0)? else {
            return Ok(None);
        };
        let case = cases.iter().find(|(value, _)| has(on, *value));
        case.map_or(Ok(None), |(_, case)| self.leaf(here, *case, k))
    }

    /// Evaluates `current x`: x at the latest tick of its clock (M4.7).
    fn current(&mut self, here: Here, id: ExprId, operand: ExprId, k: usize) -> Result<Leaf, Stop> {
        let clocks = self.clocks(here).exprs[operand.0 as usize][k].clone();
        let Some(on) = clocks.iter().flat_map(|clock| clock.last()).next() else {
            return self.leaf(here, operand, k);
        };
        let instance = &mut self.instances[here.instance];
        let unread = neutral(instance.unit.expr(id), k).filter(|_| instance.unit.is_lustre);
        let kept = instance.memory(here.block).kept.get(&(id, k)).copied();
        let leaf = match self.is_on(here, on)? {
            Some(true) => self.leaf(here.unguarded(), operand, k)?,
            Some(false) => kept.unwrap_or(unread),
            None => None,
        };
        self.keep.push((here, Keep::Leaf(id, k, leaf)));
        Ok(leaf)
    }

    /// Returns whether the clock of a leaf ticks (M4.7).
    fn ticks(&mut self, here: Here, id: ExprId, k: usize) -> Result<bool, Stop> {
        let clock = self.clocks(here).exprs[id.0 as usize][k].clone();
        self.is_running(here, &clock)
    }

    /// Returns whether the clock of a call ticks.
    pub(crate) fn runs(&mut self, here: Here, id: ExprId) -> Result<bool, Stop> {
        let clock = self.clocks(here).calls[id.0 as usize].clone();
        self.is_running(here, &clock)
    }

    fn is_running(&mut self, here: Here, clock: &Clock) -> Result<bool, Stop> {
        for on in clock.iter().flat_map(|clock| clock.iter()) {
            if self.is_on(here, on)? != Some(true) {
                return Ok(false);
            }
        }
        Ok(true)
    }

    pub(crate) fn clocks(&self, here: Here) -> &Clocks {
        &self.clocks[self.instances[here.instance].id.0 as usize]
    }

    /// Returns whether the condition of a sampling has its value.
    fn is_on(&mut self, here: Here, on: &Sampling) -> Result<Option<bool>, Stop> {
        let leaf = self.decider(here.instance, &on.by)?;
        Ok(leaf.map(|leaf| has(leaf, on.value)))
    }

    /// Returns the value of a clock condition: a flow, or a condition inside a call, possibly of another block.
    fn decider(&mut self, instance: InstanceId, by: &Decider) -> Result<Leaf, Stop> {
        let (id, inner) = match by {
            Decider::Flow(flow) => return self.flow(instance, *flow, 0),
            Decider::Behind(id, inner) => (*id, inner),
        };
        let it = &self.instances[instance];
        let (unit, block) = (it.unit, self.clocks[it.id.0 as usize].block(id));
        let Some(call) = call_of(&unit.expr(id).kind) else {
            return Ok(None);
        };
        if !self.is_active(instance, block)? {
            return Ok(None);
        }
        match self.called(self.inside(instance, block), id, call)? {
            Some(behind) => self.decider(behind, inner),
            None => Ok(None),
        }
    }
}

/// Checks a leaf of a struct built here against the subrange of its field (M2.4).
fn in_field(here: Here, leaf: Leaf, ty: &Ty, k: usize, is_made: bool) -> Result<Leaf, Stop> {
    let Some(Value::Int(number)) = leaf.filter(|_| here.chosen && is_made) else {
        return Ok(leaf);
    };
    let mut ranges = ty.subranges(true).into_iter();
    match ranges.any(|(of, range)| of == k && !range.contains(number)) {
        true => Err(Stop::Fault("subrange")),
        false => Ok(leaf),
    }
}

/// Returns whether a Boolean or enum value is the one with this number.
fn has(leaf: Value, value: u32) -> bool {
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
fn neutral(expr: &Expr, k: usize) -> Leaf {
    let mut leaves = Vec::new();
    expr.ty.leaves(&mut |_, leaf| {
        leaves.push(match leaf {
            Ty::Bool => Value::Bool(false),
            Ty::Real(_) => Value::Real(0.0),
            _ => Value::Int(0),
        });
    });
    leaves.get(k).copied()
}
