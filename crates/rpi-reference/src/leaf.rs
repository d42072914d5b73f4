//! Evaluation of expressions: one leaf of one expression in the current cycle.

use rpi_image::Value as Constant;
use rpi_sema::ty::Ty;
use rpi_sema::typed::{ElementwiseOp, Expr, ExprId, PrimCall, TypedKind};

use crate::cycle::{Interpreter, MemoryUpdate};
use crate::instance::{EvalContext, LeafId};
use crate::value::{EvalError, Leaf, Value};
use crate::{call, flow, operator, sampling};

/// Returns leaf (scalar part) number `k` of an expression in the current cycle. A leaf is evaluated only once in a
/// cycle.
pub(crate) fn evaluate(
    interpreter: &mut Interpreter<'_>,
    here: EvalContext,
    id: ExprId,
    k: usize,
) -> Result<Leaf, EvalError> {
    let now = &mut interpreter.instances[here.instance].current;
    match now.leaves.get(&(id, k)) {
        Some(Some(leaf)) => return Ok(*leaf),
        // `None` marks a leaf whose evaluation is in progress.
        Some(None) => return Err(EvalError::DependencyCycle),
        None => drop(now.leaves.insert((id, k), None)),
    }
    let leaf = match sampling::ticks(interpreter, here, id, k)? {
        true => evaluate_leaf(interpreter, here, id, k)?,
        false => None,
    };
    let now = &mut interpreter.instances[here.instance].current;
    now.leaves.insert((id, k), Some(leaf));
    Ok(leaf)
}

/// Returns the value of a Boolean expression; `None` if it is absent in the current cycle.
pub(crate) fn truth(
    interpreter: &mut Interpreter<'_>,
    here: EvalContext,
    id: ExprId,
) -> Result<Option<bool>, EvalError> {
    Ok(match evaluate(interpreter, here, id, 0)? {
        Some(Value::Bool(truth)) => Some(truth),
        _ => None,
    })
}

fn evaluate_leaf(
    interpreter: &mut Interpreter<'_>,
    here: EvalContext,
    id: ExprId,
    k: usize,
) -> Result<Leaf, EvalError> {
    let unit = interpreter.instances[here.instance].unit;
    let expr = unit.expr(id);
    match &expr.kind {
        TypedKind::Error => Err(EvalError::Unsupported("an error in the program".to_owned())),
        TypedKind::Arbitrary | TypedKind::Sensor { .. } => {
            Err(EvalError::Unsupported("an external value".to_owned()))
        }
        TypedKind::Const(leaves) => Ok(constant(interpreter, &leaves[k], &expr.ty, k)),
        TypedKind::Literal(leaf) => Ok(constant(interpreter, leaf, &expr.ty, k)),
        TypedKind::None => Ok(None),
        TypedKind::Flow(flow) => flow::evaluate(interpreter, here.instance, *flow, k),
        TypedKind::Part { base, at } => evaluate(interpreter, here, *base, *at as usize + k),
        TypedKind::Slice { base, from, step } => {
            let size = element_size(&unit.expr(*base).ty);
            let element = i64::from(*from) + (k / size) as i64 * i64::from(*step);
            evaluate(interpreter, here, *base, element as usize * size + k % size)
        }
        TypedKind::Select { base, index } => select(interpreter, here, *base, *index, k),
        TypedKind::Build(parts) => {
            let leaf = array_or_struct(interpreter, here, parts, k)?;
            let is_struct = matches!(expr.ty, Ty::Struct(_));
            in_field(here, leaf, &expr.ty, k, is_struct)
        }
        TypedKind::Repeat(element) => {
            let size = unit.expr(*element).ty.leaf_count();
            evaluate(interpreter, here, *element, k % size)
        }
        TypedKind::Replace { base, at, value } => {
            let at = *at as usize;
            let size = unit.expr(*value).ty.leaf_count();
            match (at..at + size).contains(&k) {
                true => {
                    let leaf = evaluate(interpreter, here, *value, k - at)?;
                    in_field(here, leaf, &expr.ty, k, true)
                }
                false => evaluate(interpreter, here, *base, k),
            }
        }
        TypedKind::Each(op, operands) => each(interpreter, here, id, *op, operands, k),
        TypedKind::Equal { operands, negated } => equal(interpreter, here, *operands, *negated),
        TypedKind::Present(operand) => present(interpreter, here, *operand),
        TypedKind::Prim(call) => operator(interpreter, here, id, call),
        TypedKind::Call(call) => call::result(interpreter, here, id, call, k),
        TypedKind::When { value, .. } => evaluate(interpreter, here, *value, k),
        TypedKind::Merge { on, cases } => merge(interpreter, here, *on, cases, k),
        TypedKind::Current(operand) => current(interpreter, here, id, *operand, k),
    }
}

/// Returns leaf (scalar part) number `k` of a constant of type `ty`, with a time converted to ticks.
fn constant(interpreter: &Interpreter<'_>, constant: &Constant, ty: &Ty, k: usize) -> Leaf {
    let leaf = Value::from_constant(constant);
    interpreter.period.internal_leaf(leaf, ty, k)
}

/// Returns leaf (scalar part) number `k` of a struct, tuple or array literal. The leaves of all parts are numbered
/// consecutively.
fn array_or_struct(
    interpreter: &mut Interpreter<'_>,
    here: EvalContext,
    parts: &[ExprId],
    mut k: usize,
) -> Result<Leaf, EvalError> {
    let unit = interpreter.instances[here.instance].unit;
    for part in parts {
        let size = unit.expr(*part).ty.leaf_count();
        if k < size {
            return evaluate(interpreter, here, *part, k);
        }
        k -= size;
    }
    Err(EvalError::Unsupported("a missing part".to_owned()))
}

/// Returns leaf (scalar part) number `k` of `base[index]`, an array element whose index is computed in the cycle. An
/// index out of range is a fault if the value is needed.
fn select(
    interpreter: &mut Interpreter<'_>,
    here: EvalContext,
    base: ExprId,
    index: ExprId,
    k: usize,
) -> Result<Leaf, EvalError> {
    let unit = interpreter.instances[here.instance].unit;
    let ty = &unit.expr(base).ty;
    let size = element_size(ty);
    let count = ty.leaf_count() / size;
    let Some(Value::Int(index)) = evaluate(interpreter, here, index, 0)? else {
        return Ok(None);
    };
    match usize::try_from(index) {
        Ok(index) if index < count => evaluate(interpreter, here, base, index * size + k),
        _ if here.chosen => Err(EvalError::Fault("index")),
        _ => evaluate(interpreter, here, base, k),
    }
}

/// Evaluates leaf number `k` of an operator that is applied to each leaf (scalar part) of its operands separately.
fn each(
    interpreter: &mut Interpreter<'_>,
    here: EvalContext,
    id: ExprId,
    each: ElementwiseOp,
    operands: &[ExprId],
    k: usize,
) -> Result<Leaf, EvalError> {
    match (each, operands) {
        // Without a condition the result is absent, and the branch that is not taken does not matter (M4.5).
        (ElementwiseOp::If, [condition, ..]) => match truth(interpreter, here, *condition)? {
            None => Ok(None),
            Some(chosen) => {
                let number = if chosen { 1 } else { 2 };
                let branch = interpreter.operand(here, (id, k), number)?;
                evaluate(interpreter, branch, operands[number], k)
            }
        },
        (ElementwiseOp::Pre, [x]) => pre(interpreter, here, id, *x, k),
        (ElementwiseOp::Last, [x]) => last(interpreter, here, *x, k),
        (ElementwiseOp::Arrow, [a, b]) => {
            let is_first = first(interpreter, here, (id, k));
            let (side, number) = if is_first { (a, 0) } else { (b, 1) };
            let there = interpreter.operand(here, (id, k), number)?;
            evaluate(interpreter, there, *side, k)
        }
        (ElementwiseOp::Coalesce, [a, b]) => match evaluate(interpreter, here, *a, k)? {
            None => evaluate(interpreter, here, *b, k),
            present => Ok(present),
        },
        (ElementwiseOp::Hold, [x, init]) => {
            let x = evaluate(interpreter, here.unguarded(), *x, k)?;
            held(interpreter, here, id, k, x, *init)
        }
        _ => Err(EvalError::Unsupported(format!("{each:?}"))),
    }
}

/// Evaluates leaf number `k` of `pre x`: the value of `x` at the previous tick of its clock in its fragment (M5.1). In
/// the first cycle it is absent; if `x` is never absent, the checker has proved that this value is not read (M5.3).
fn pre(
    interpreter: &mut Interpreter<'_>,
    here: EvalContext,
    id: ExprId,
    x: ExprId,
    k: usize,
) -> Result<Leaf, EvalError> {
    interpreter
        .updates
        .push((here, MemoryUpdate::Delayed(id, k, x)));
    let memory = interpreter.instances[here.instance].memory(here.block);
    Ok(memory.delayed_values.get(&(id, k)).copied().flatten())
}

/// Evaluates leaf number `k` of `last x`: the value in the previous cycle of a flow that the states of an automaton
/// share, whichever state was active.
fn last(
    interpreter: &mut Interpreter<'_>,
    here: EvalContext,
    x: ExprId,
    k: usize,
) -> Result<Leaf, EvalError> {
    let instance = &mut interpreter.instances[here.instance];
    let unit = instance.unit;
    match &unit.expr(x).kind {
        TypedKind::Part { base, at } => last(interpreter, here, *base, *at as usize + k),
        TypedKind::Flow(flow) => {
            let memory = instance.memory(Some(unit.flow(*flow).block));
            Ok(memory.last.get(&(*flow, k)).copied().flatten())
        }
        other => Err(EvalError::Unsupported(format!("last of {other:?}"))),
    }
}

/// Evaluates leaf number `k` of `hold(x, init)`: the latest present value of `x`, or `init` before the first one
/// (M4.3). A present value is stored; `init` is evaluated again in each cycle that needs it. The parameter `x` is the
/// leaf of the operand in this cycle.
pub(crate) fn held(
    interpreter: &mut Interpreter<'_>,
    here: EvalContext,
    id: ExprId,
    k: usize,
    x: Leaf,
    init: ExprId,
) -> Result<Leaf, EvalError> {
    let memory = interpreter.instances[here.instance].memory(here.block);
    let latest = x.or(memory.delayed_values.get(&(id, k)).copied().flatten());
    if latest.is_some() {
        interpreter
            .updates
            .push((here, MemoryUpdate::Leaf(id, k, latest)));
    }
    match latest {
        None => evaluate(interpreter, here.unguarded(), init, k),
        latest => Ok(latest),
    }
}

/// Returns whether a leaf (scalar part) of `a -> b` or `first` is in its first cycle. Records that the first cycle is
/// over from the next cycle on.
pub(crate) fn first(interpreter: &mut Interpreter<'_>, here: EvalContext, place: LeafId) -> bool {
    interpreter
        .updates
        .push((here, MemoryUpdate::Begun(place.0, place.1)));
    is_first(interpreter, here, place)
}

/// Returns whether a leaf (scalar part) of `a -> b` or `first` is in its first cycle, or has not had it so far because
/// its clock has not ticked.
pub(crate) fn is_first(
    interpreter: &mut Interpreter<'_>,
    here: EvalContext,
    place: LeafId,
) -> bool {
    let memory = interpreter.instances[here.instance].memory(here.block);
    !memory.started.contains(&place)
}

/// Evaluates `a = b`, or `a <> b` if `negated`: true if all leaves (scalar parts) are equal. An absent leaf makes the
/// result absent unless another pair of leaves differs.
fn equal(
    interpreter: &mut Interpreter<'_>,
    here: EvalContext,
    [a, b]: [ExprId; 2],
    negated: bool,
) -> Result<Leaf, EvalError> {
    let unit = interpreter.instances[here.instance].unit;
    let mut all = Some(Value::Bool(true));
    for k in 0..unit.expr(a).ty.leaf_count() {
        let (a, b) = (
            evaluate(interpreter, here, a, k)?,
            evaluate(interpreter, here, b, k)?,
        );
        let so_far = all.map(|all| all == Value::Bool(true));
        all = operator::and(so_far, operator::equal(a, b));
    }
    match negated {
        true => operator::apply("Core::BooleanNot", &[all], here.chosen),
        false => Ok(all),
    }
}

/// Evaluates `present(x)`: true if all leaves (scalar parts) of `x` have a value in the current cycle.
fn present(
    interpreter: &mut Interpreter<'_>,
    here: EvalContext,
    operand: ExprId,
) -> Result<Leaf, EvalError> {
    let unit = interpreter.instances[here.instance].unit;
    let mut all = true;
    for k in 0..unit.expr(operand).ty.leaf_count() {
        all &= evaluate(interpreter, here, operand, k)?.is_some();
    }
    Ok(Some(Value::Bool(all)))
}

fn operator(
    interpreter: &mut Interpreter<'_>,
    here: EvalContext,
    id: ExprId,
    call: &PrimCall,
) -> Result<Leaf, EvalError> {
    let mut operands = Vec::with_capacity(call.inputs.len());
    for (number, input) in call.inputs.iter().flatten().enumerate() {
        let there = interpreter.operand(here, (id, 0), number)?;
        operands.push(evaluate(interpreter, there, *input, 0)?);
    }
    let name = call.prim.desc().name;
    if name == "Rpi::First" {
        return Ok(Some(Value::Bool(first(interpreter, here, (id, 0)))));
    }
    match interpreter
        .period
        .time_operator(interpreter.cycle, name, &operands, here.chosen)
    {
        Some(leaf) => leaf,
        None => operator::apply(name, &operands, here.chosen),
    }
}

/// Evaluates leaf number `k` of `merge c (...)`: the case that the value of `c` selects. The other cases are absent in
/// that cycle (M4.7).
fn merge(
    interpreter: &mut Interpreter<'_>,
    here: EvalContext,
    on: ExprId,
    cases: &[(u32, ExprId)],
    k: usize,
) -> Result<Leaf, EvalError> {
    let Some(on) = evaluate(interpreter, here, on, 0)? else {
        return Ok(None);
    };
    let case = cases.iter().find(|(value, _)| equals_value(on, *value));
    case.map_or(Ok(None), |(_, case)| evaluate(interpreter, here, *case, k))
}

/// Evaluates leaf number `k` of `current x`: the value of `x` at the latest tick of its clock (M4.7).
fn current(
    interpreter: &mut Interpreter<'_>,
    here: EvalContext,
    id: ExprId,
    operand: ExprId,
    k: usize,
) -> Result<Leaf, EvalError> {
    let clocks = sampling::clocks(interpreter, here).exprs[operand.0 as usize][k].clone();
    let Some(on) = clocks.iter().flat_map(|clock| clock.last()).next() else {
        return evaluate(interpreter, here, operand, k);
    };
    let instance = &mut interpreter.instances[here.instance];
    let unread = zero_value(instance.unit.expr(id), k).filter(|_| instance.unit.is_lustre);
    let kept = instance
        .memory(here.block)
        .delayed_values
        .get(&(id, k))
        .copied();
    let leaf = match sampling::is_on(interpreter, here, on)? {
        Some(true) => evaluate(interpreter, here.unguarded(), operand, k)?,
        Some(false) => kept.unwrap_or(unread),
        None => None,
    };
    interpreter
        .updates
        .push((here, MemoryUpdate::Leaf(id, k, leaf)));
    Ok(leaf)
}

/// Checks that a leaf of a struct literal lies in the integer subrange of its field (M2.4), and returns the leaf.
/// `is_made` is false for other literals, which need no check.
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

/// Returns whether a leaf is the value with this number: 0 or 1 for a Boolean, the index for an enum. A real never is.
pub(crate) fn equals_value(leaf: Value, value: u32) -> bool {
    match leaf {
        Value::Bool(truth) => u32::from(truth) == value,
        Value::Int(place) => place == i64::from(value),
        Value::Real(_) => false,
    }
}

/// Returns the number of leaves (scalar parts) of one element of an array type; 1 for other types.
fn element_size(array: &Ty) -> usize {
    match array {
        Ty::Array(element, _) => element.leaf_count().max(1),
        _ => 1,
    }
}

/// Returns false or 0 for leaf number `k` of an expression, as a placeholder for a value that is never read.
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
