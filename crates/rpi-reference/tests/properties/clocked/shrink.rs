//! Reduction of a model that fails a test.

use super::exprs::Requirement;
use super::forms::form;
use super::model::{Body, Clock, Expr, Kind, Model, Node, Statement};

/// Largest number of attempts.
const ATTEMPTS: usize = 1500;

/// Returns the smallest model found that is still `bad`.
pub(crate) fn shrink(mut model: Model, bad: impl Fn(&Model) -> bool) -> Model {
    let mut left = ATTEMPTS;
    'again: loop {
        let count = changes(&mut model.clone(), usize::MAX);
        for wanted in 0..count {
            let mut candidate = model.clone();
            changes(&mut candidate, wanted);
            if candidate.text().len() >= model.text().len() {
                continue;
            }
            if left == 0 {
                break 'again;
            }
            left -= 1;
            if bad(&candidate) {
                model = candidate;
                continue 'again;
            }
        }
        break;
    }
    model
}

/// Makes the change with this number, and returns the number of possible changes.
fn changes(model: &mut Model, wanted: usize) -> usize {
    let mut k = 0;
    let mut is_next = || {
        k += 1;
        k - 1 == wanted
    };
    for place in (0..model.units.len()).rev() {
        let call = format!("{}(", model.units[place].name);
        let is_called = model.text().matches(&call).count() > 0;
        if is_next() && model.units[place].name != "main" && !is_called {
            model.units.remove(place);
            return k;
        }
    }
    let mut gone = Vec::new();
    for unit in &mut model.units {
        unit.body
            .each_body(&mut |body| remove(body, &mut is_next, &mut gone));
        for k in (1..unit.outputs.len()).rev() {
            if is_next() {
                unit.outputs.remove(k);
            }
        }
    }
    for flow in gone {
        for unit in &mut model.units {
            let clock = &model.flows[flow].clock;
            unit.body.each_expr(&mut |whole| {
                whole.each_mut(&mut |expr| {
                    if matches!(expr.node, Node::Flow(read) if read == flow) {
                        *expr = literal(expr.kind, clock);
                    }
                });
            });
        }
    }
    for unit in &mut model.units {
        unit.body.each_expr(&mut |whole| {
            whole.each_mut(&mut |expr| smaller(expr, &mut is_next));
        });
    }
    k
}

/// Removes statements, transitions and restarts.
fn remove(body: &mut Body, is_next: &mut impl FnMut() -> bool, gone: &mut Vec<usize>) {
    for k in (0..body.statements.len()).rev() {
        if is_next() {
            if let Statement::Equation(equation) = body.statements.remove(k) {
                body.locals
                    .retain(|local| !equation.targets.contains(local));
                gone.extend(equation.targets);
            }
            continue;
        }
        match &mut body.statements[k] {
            Statement::Automaton(states) => {
                for state in states {
                    if !state.unless.is_empty() && is_next() {
                        state.unless.clear();
                    }
                    if !state.until.is_empty() && is_next() {
                        state.until.clear();
                    }
                }
            }
            Statement::Fragment { restart, .. } if *restart && is_next() => *restart = false,
            _ => {}
        }
    }
}

/// Replaces an expression by one of its parts, or by a literal, of the same clock.
fn smaller(expr: &mut Expr, is_next: &mut impl FnMut() -> bool) {
    let Node::Template(_, parts) = &expr.node else {
        return;
    };
    let (parts, kind) = (parts.clone(), expr.kind);
    let clock = expr.clock.clone().unwrap_or_else(|| [].into());
    let may = |part: &&Expr| part.kind == kind && (expr.optional || !part.optional);
    let is_own = |part: &&Expr| may(part) && part.clock.as_ref().is_none_or(|own| *own == clock);
    for part in parts.iter().filter(is_own) {
        if is_next() {
            *expr = part.clone();
            return;
        }
    }
    if expr.size() > 2 && is_next() {
        *expr = literal(kind, &clock);
    }
}

/// Returns a literal on a clock, if the clock can be named.
fn literal(kind: Kind, clock: &Clock) -> Expr {
    let want = Requirement {
        kind,
        clock: [].into(),
        optional: false,
    };
    match clock.last() {
        Some(on) if !on.starts_with('?') => {
            let part = form(kind.literal(), Vec::new(), &want, None);
            form(
                &format!("(@ when {on})"),
                vec![part],
                &want,
                Some(clock.clone()),
            )
        }
        _ => form(kind.literal(), Vec::new(), &want, None),
    }
}
