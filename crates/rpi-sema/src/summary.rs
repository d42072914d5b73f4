//! Summary of the checker's results for a unit, for users who ask what was checked.

use crate::ty::Ty;
use crate::typed::{BlockId, ExprId, Unit, UnitId, UnitKind};
use crate::typed::{Expr, TypedKind};
use rpi_syntax::ast::CommandEndKind;
use std::collections::BTreeSet;
use std::rc::Rc;

/// Names of the primitives for integer division and modulo.
const DIVISION_PRIMS: [&str; 2] = ["Core::IntDivide", "Rpi::IntModulo"];

/// Returns one line for each analysis, with the name of the analysis, about a unit and all units that it calls.
#[must_use]
pub fn summary(units: &[Rc<Unit>], id: UnitId) -> Vec<(&'static str, String)> {
    if units[id.0 as usize].kind == UnitKind::Task {
        return task_summary(units, &units[id.0 as usize]);
    }
    let all = transitive_callees(units, id);
    let all: Vec<&Unit> = all.iter().map(|id| &*units[id.0 as usize]).collect();
    vec![
        ("units", dimensions(&all)),
        ("clocks", clocks(&all)),
        ("bounds", bounds(&all)),
        ("division", divisions(&all)),
    ]
}

/// Returns the lines about a task for `rpic check --explain-analysis`: the name of each check and its result.
fn task_summary(units: &[Rc<Unit>], task: &Unit) -> Vec<(&'static str, String)> {
    let run = task.steps.iter().map(|step| &units[step.unit.0 as usize]);
    let commands = run.filter(|unit| unit.kind == UnitKind::Command);
    let commands: Vec<&Unit> = commands.map(Rc::as_ref).collect();
    let ends = commands
        .iter()
        .flat_map(|unit| &unit.block(BlockId::ROOT).ends);
    let count = |kind: CommandEndKind| ends.clone().filter(|end| end.kind == kind).count();
    let [finish, give, fail] = [
        CommandEndKind::Finish,
        CommandEndKind::Yield,
        CommandEndKind::Fail,
    ]
    .map(count);
    let (steps, run) = (task.steps.len(), commands.len());
    vec![
        (
            "arguments",
            format!("the arguments of {steps} steps match their parameters"),
        ),
        (
            "branches",
            format!(
                "{run} steps run commands with {} results; each result has a branch",
                finish + give + fail
            ),
        ),
        (
            "takeover",
            format!("{give} results may leave a device in motion; the next command takes it over"),
        ),
    ]
}

/// Returns a unit and all units that it calls, directly or through other units.
fn transitive_callees(units: &[Rc<Unit>], id: UnitId) -> BTreeSet<UnitId> {
    let (mut seen, mut open) = (BTreeSet::new(), vec![id]);
    while let Some(id) = open.pop() {
        if !seen.insert(id) {
            continue;
        }
        let calls = units[id.0 as usize].exprs.iter();
        open.extend(calls.filter_map(|expr| match &expr.kind {
            TypedKind::Call(call) => Some(call.unit),
            _ => None,
        }));
    }
    seen
}

fn exprs<'u>(units: &'u [&Unit]) -> impl Iterator<Item = (&'u Unit, &'u Expr)> {
    let of = |unit: &'u &Unit| unit.exprs.iter().map(move |expr| (*unit, expr));
    units.iter().flat_map(of)
}

fn dimensions(units: &[&Unit]) -> String {
    let (mut reals, mut with_unit, mut known, mut last) = (0, 0, BTreeSet::new(), None);
    for (_, expr) in exprs(units) {
        if let Ty::Real(dim) = &expr.ty {
            reals += 1;
            if !dim.is_dimensionless() {
                with_unit += 1;
                // Successive expressions often have the same dimension.
                if last.replace(*dim) != Some(*dim) {
                    known.insert(*dim);
                }
            }
        }
    }
    let known: BTreeSet<String> = known.iter().map(ToString::to_string).collect();
    let known: Vec<String> = known.into_iter().collect();
    match known.is_empty() {
        true => format!("{reals} real expressions, none with a unit"),
        false => format!(
            "{with_unit} of {reals} real expressions in {}",
            known.join(", ")
        ),
    }
}

fn clocks(units: &[&Unit]) -> String {
    let on = |unit: &&Unit| {
        let flows = unit
            .flows
            .iter()
            .filter(|flow| flow.clock.is_some())
            .count();
        let sampled = |expr: &&Expr| matches!(expr.kind, TypedKind::When { .. });
        (flows, unit.exprs.iter().filter(sampled).count())
    };
    let (flows, sampled) = units
        .iter()
        .map(on)
        .fold((0, 0), |a, b| (a.0 + b.0, a.1 + b.1));
    match flows + sampled {
        0 => "no flow is sampled".to_owned(),
        _ => format!("{flows} flows declared on a clock, {sampled} samplings; no clock mismatch"),
    }
}

fn bounds(units: &[&Unit]) -> String {
    let is_array = |unit: &Unit, id: ExprId| matches!(unit.expr(id).ty, Ty::Array(..));
    let (mut fixed, mut computed) = (0, 0);
    for (unit, expr) in exprs(units) {
        match &expr.kind {
            TypedKind::Part { base, .. } | TypedKind::Slice { base, .. }
                if is_array(unit, *base) =>
            {
                fixed += 1;
            }
            TypedKind::Select { .. } => computed += 1,
            _ => {}
        }
    }
    format!("{fixed} array indices are constant and in bounds, {computed} are checked at run time")
}

fn divisions(units: &[&Unit]) -> String {
    let (mut constant, mut computed) = (0, 0);
    for (unit, expr) in exprs(units) {
        let TypedKind::Prim(call) = &expr.kind else {
            continue;
        };
        if !DIVISION_PRIMS.contains(&call.prim.desc().name) {
            continue;
        }
        let divisor = call.inputs.get(1).copied().flatten();
        let divisor = divisor.map(|id| &unit.expr(id).kind);
        match divisor {
            Some(TypedKind::Literal(_) | TypedKind::Const(_)) => constant += 1,
            _ => computed += 1,
        }
    }
    format!("{constant} integer divisions by a non-zero constant, {computed} checked at run time")
}
