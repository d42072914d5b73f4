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
use rpi_diag::Finding;
use rpi_syntax::Mode;
use rpi_syntax::ast::{Visit, Walk};

/// Returns warnings about unused parts of the first module.
#[must_use]
pub fn needless(program: &Program<'_>, units: &[Unit]) -> Vec<Finding> {
    let mut findings: Vec<Finding> = program.needless_uses().collect();
    // Ports of Lustre programs are often fixed by another tool or model, so they are not checked.
    if program.root().mode == Mode::Rpi {
        findings.extend(flows::unread(program, units));
        for id in &program.root().decls {
            let decl = program.decl(*id);
            findings.extend(params::unread(decl));
            findings.extend(states::unreached(decl.kind));
            if let DeclKind::Task(task) = decl.kind {
                findings.extend(steps::unreached(program, decl.module, task));
            }
        }
    }
    findings
}

/// Visits the parts of a declaration that can contain unused items.
fn walk<'a>(kind: DeclKind<'a>, visitor: &mut dyn Visit<'a>) {
    let mut walk = Walk::new(visitor);
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

/// Returns the unreachable vertices of a graph that are not only successors of other unreachable vertices. `start` is
/// the entry vertex. Vertices for which `counts` is false are ignored.
fn heads(leads: &[&[usize]], start: Option<usize>, counts: impl Fn(usize) -> bool) -> Vec<usize> {
    let reached = reached_from(leads, start.into_iter().collect());
    let all = 0..leads.len();
    let mut left: Vec<usize> = all.filter(|at| !reached[*at] && counts(*at)).collect();
    let mut led = vec![false; leads.len()];
    for at in &left {
        for to in leads[*at].iter().filter(|to| *to != at) {
            led[*to] = true;
        }
    }
    let mut told: Vec<usize> = left.iter().copied().filter(|at| !led[*at]).collect();
    let follow = reached_from(leads, told.clone());
    left.retain(|at| !follow[*at]);
    // The remaining vertices lie on cycles; one vertex of each cycle is enough.
    while let Some(first) = left.first().copied() {
        told.push(first);
        let follow = reached_from(leads, vec![first]);
        left.retain(|at| !follow[*at]);
    }
    told
}

/// Returns for each vertex whether it is in `open` or reachable from it.
fn reached_from(leads: &[&[usize]], mut open: Vec<usize>) -> Vec<bool> {
    let mut reached = vec![false; leads.len()];
    while let Some(at) = open.pop() {
        if !std::mem::replace(&mut reached[at], true) {
            open.extend(leads[at]);
        }
    }
    reached
}
