//! Warnings about unused parts of a program.
//!
//! Runs only on programs without errors. An erroneous part of a program may have been meant to use the part in
//! question.
//!
//! | file | idea |
//! |---|---|
//! | `flows.rs` | unused local flows |
//! | `params.rs` | unused parameters and in-ports |
//! | `states.rs` | unreachable states of automata |
//! | `steps.rs` | unreachable steps of tasks |

mod flows;
mod params;
mod states;
mod steps;

use crate::program::{DeclKind, Program};
use crate::typed::Unit;
use rpi_diag::Diagnostic;
use rpi_syntax::Dialect;
use rpi_syntax::ast::{Visitor, Walker};
use std::rc::Rc;

/// Returns warnings about unused parts of the first module: modules, local flows, parameters, states and steps.
#[must_use]
pub fn unused_warnings(program: &Program<'_>, units: &[Rc<Unit>]) -> Vec<Diagnostic> {
    let mut diagnostics: Vec<Diagnostic> = program.unused_module_warnings().collect();
    // Ports of Lustre programs are often fixed by another tool or model, so they are not checked.
    if program.root().mode == Dialect::Rpi {
        diagnostics.extend(flows::unread(program, units));
        for id in &program.root().decls {
            let decl = program.decl(*id);
            diagnostics.extend(params::unread(decl));
            diagnostics.extend(states::unreached(decl.kind));
            if let DeclKind::Task(task) = decl.kind {
                diagnostics.extend(steps::unreached(program, decl.module, task));
            }
        }
    }
    diagnostics
}

/// Visits the parts of a declaration, such as expressions and statements, that can use names or contain unused items.
fn walk<'a>(kind: DeclKind<'a>, visitor: &mut dyn Visitor<'a>) {
    let mut walk = Walker::new(visitor);
    match kind {
        DeclKind::Node(node) => walk.node(node),
        DeclKind::Fragment(fragment) => walk.fragment(fragment),
        DeclKind::Device(device) => walk.device(device),
        DeclKind::Command(command) => walk.command(command),
        DeclKind::Task(task) => walk.task(task),
        DeclKind::Test(test) => walk.test(test),
        _ => {}
    }
}

/// Returns the unreachable vertices of a graph, without those that only follow other unreachable vertices. `leads` has
/// the successors of each vertex, and `start` is the entry vertex. Vertices for which `counts` is false are ignored.
fn unreachable_heads(
    leads: &[&[usize]],
    start: Option<usize>,
    counts: impl Fn(usize) -> bool,
) -> Vec<usize> {
    let reached = reached_from(leads, start.into_iter().collect());
    let all = 0..leads.len();
    let mut left: Vec<usize> = all.filter(|at| !reached[*at] && counts(*at)).collect();
    let mut led = vec![false; leads.len()];
    for at in &left {
        for to in leads[*at].iter().filter(|to| *to != at) {
            led[*to] = true;
        }
    }
    let mut heads: Vec<usize> = left.iter().copied().filter(|at| !led[*at]).collect();
    let follow = reached_from(leads, heads.clone());
    left.retain(|at| !follow[*at]);
    // The remaining vertices lie on cycles; one vertex of each cycle is enough.
    while let Some(first) = left.first().copied() {
        heads.push(first);
        let follow = reached_from(leads, vec![first]);
        left.retain(|at| !follow[*at]);
    }
    heads
}

/// Returns for each vertex of a graph whether it is in `open` or reachable from a vertex in `open`. `leads` has the
/// successors of each vertex.
fn reached_from(leads: &[&[usize]], mut open: Vec<usize>) -> Vec<bool> {
    let mut reached = vec![false; leads.len()];
    while let Some(at) = open.pop() {
        if !std::mem::replace(&mut reached[at], true) {
            open.extend(leads[at]);
        }
    }
    reached
}
