//! What a program says and nothing needs.
//!
//! This is asked of a program without faults: what has one may have been meant to need it.
//!
//! | file | idea |
//! |---|---|
//! | `flows.rs` | local flows that nothing reads |
//! | `params.rs` | parameters and in-ports that nothing reads |
//! | `states.rs` | states of automata to which nothing leads |
//! | `steps.rs` | steps of tasks to which nothing leads |

mod flows;
mod params;
mod states;
mod steps;

use crate::program::{DeclKind, Program};
use crate::typed::Unit;
use rpi_diag::Finding;
use rpi_syntax::Mode;
use rpi_syntax::ast::{Visit, Walk};

/// Warnings about what the first module says and nothing in it needs.
#[must_use]
pub fn needless(program: &Program<'_>, units: &[Unit]) -> Vec<Finding> {
    let mut findings: Vec<Finding> = program.needless_uses().collect();
    // In Lustre ports are mostly those of something else: a tool wrote them, or another model has them.
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

/// Shows all of a declaration that can hold anything needless.
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

/// Of things that lead to one another those to which nothing leads from the `start`, but not what only follows them. Things
/// that do not count are passed over.
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
    // Those left lead to one another in turn.
    while let Some(first) = left.first().copied() {
        told.push(first);
        let follow = reached_from(leads, vec![first]);
        left.retain(|at| !follow[*at]);
    }
    told
}

/// For each thing whether it is one of these or comes after one.
fn reached_from(leads: &[&[usize]], mut open: Vec<usize>) -> Vec<bool> {
    let mut reached = vec![false; leads.len()];
    while let Some(at) = open.pop() {
        if !std::mem::replace(&mut reached[at], true) {
            open.extend(leads[at]);
        }
    }
    reached
}
