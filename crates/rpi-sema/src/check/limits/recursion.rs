//! Infinite recursion: calls are inlined, so that a dependency cycle of calls never ends.
//!
//! A recursion over static parameters has a unit for each choice of static arguments, and so no dependency cycle of
//! units.

use crate::typed::TypedKind;
use crate::typed::{Unit, UnitId, UnitKind};
use rpi_diag::{Code, Diagnostic, Span};
use std::rc::Rc;

/// Call of a unit, or step of a task that runs a unit: the called unit, and the location of the call.
#[derive(Clone, Copy)]
struct CallEdge {
    to: UnitId,
    span: Span,
}

/// Returns a diagnostic for each dependency cycle of calls, including units that call themselves.
pub(crate) fn check(units: &[Rc<Unit>]) -> Vec<Diagnostic> {
    let calls: Vec<Vec<CallEdge>> = units.iter().map(|unit| call_edges(unit)).collect();
    let mut diagnostics = Vec::new();
    let mut reported = vec![false; units.len()];
    for start in cyclic_units(&calls) {
        if reported[start] {
            continue;
        }
        let ring = shortest_cycle(&calls, start);
        for step in &ring {
            reported[step.to.0 as usize] = true;
        }
        if !ring.is_empty() {
            diagnostics.push(recursion_diagnostic(units, start, &ring));
        }
    }
    diagnostics
}

fn call_edges(unit: &Unit) -> Vec<CallEdge> {
    let calls = unit.exprs.iter().filter_map(|expr| match &expr.kind {
        TypedKind::Call(call) => Some(CallEdge {
            to: call.unit,
            span: expr.span,
        }),
        _ => None,
    });
    let run = unit.steps.iter().map(|step| CallEdge {
        to: step.unit,
        span: step.span,
    });
    calls.chain(run).collect()
}

/// Returns the indices of the units on dependency cycles of calls, and of those that call such a unit. Units without
/// calls of remaining units are removed repeatedly, as in Kahn's topological sort.
fn cyclic_units(calls: &[Vec<CallEdge>]) -> Vec<usize> {
    let mut open: Vec<usize> = calls.iter().map(Vec::len).collect();
    let mut callers: Vec<Vec<usize>> = vec![Vec::new(); calls.len()];
    for (from, steps) in calls.iter().enumerate() {
        steps
            .iter()
            .for_each(|step| callers[step.to.0 as usize].push(from));
    }
    let mut done: Vec<usize> = (0..calls.len()).filter(|unit| open[*unit] == 0).collect();
    while let Some(unit) = done.pop() {
        for caller in &callers[unit] {
            open[*caller] -= 1;
            if open[*caller] == 0 {
                done.push(*caller);
            }
        }
    }
    (0..calls.len()).filter(|unit| open[*unit] > 0).collect()
}

/// Returns the shortest path of calls from the unit with index `start` back to itself, by breadth-first search; empty
/// if there is none. `calls` has the calls of each unit.
fn shortest_cycle(calls: &[Vec<CallEdge>], start: usize) -> Vec<CallEdge> {
    let mut reached: Vec<Option<(usize, CallEdge)>> = vec![None; calls.len()];
    let mut queue = std::collections::VecDeque::from([start]);
    while let Some(from) = queue.pop_front() {
        for step in &calls[from] {
            let to = step.to.0 as usize;
            if reached[to].is_none() {
                reached[to] = Some((from, *step));
                queue.push_back(to);
            }
        }
        if reached[start].is_some() {
            break;
        }
    }
    let mut ring = Vec::new();
    let mut at = start;
    while let Some((from, step)) = reached[at] {
        ring.push(step);
        at = from;
        if at == start {
            break;
        }
    }
    ring.reverse();
    ring
}

/// Returns the advice for a node that calls itself.
fn call_help(node: &str) -> String {
    format!(
        "calls are inlined, so that none may lead back: read the value of the previous cycle by `pre`, or count a static parameter down: `with n = 0 then ... else {node}<<n - 1>>(...)`"
    )
}

const TASK_HELP: &str = "tasks are inlined: use `repeat let ... tel` to repeat steps without end, or go back to a named step by a branch: `on any then ...`";

/// Maximum number of calls of a dependency cycle that a diagnostic shows.
const MAX_SHOWN_CALLS: usize = 20;

fn recursion_diagnostic(units: &[Rc<Unit>], start: usize, ring: &[CallEdge]) -> Diagnostic {
    let name = |step: &CallEdge| units[step.to.0 as usize].name.clone();
    let first = units[start].name.clone();
    // A contract has no equations: its calls are imports of other contracts.
    let is_contract = units[start].is_contract;
    let (verb, participle) = match is_contract {
        true => ("imports", "imported"),
        false => ("calls", "called"),
    };
    let message = match ring {
        [_] => format!("`{first}` {verb} itself"),
        _ => {
            let way: Vec<String> = ring
                .iter()
                .take(MAX_SHOWN_CALLS)
                .map(|step| format!("`{}`", name(step)))
                .collect();
            format!("`{first}` {verb} itself: `{first}` -> {}", way.join(" -> "))
        }
    };
    let mut diagnostic = Diagnostic::new(Code::RPI1011, message).help(match units[start].kind {
        UnitKind::Task => TASK_HELP.to_owned(),
        _ if is_contract => "delete one of these imports; clauses that several contracts need can stand in a contract of their own, which imports none of them".to_owned(),
        _ => call_help(&first),
    });
    for (k, step) in ring.iter().take(MAX_SHOWN_CALLS).enumerate() {
        let text = format!("`{}` is {participle} here", name(step));
        diagnostic = match k {
            0 => diagnostic.primary(step.span, text),
            _ => diagnostic.secondary(step.span, text),
        };
    }
    diagnostic
}
