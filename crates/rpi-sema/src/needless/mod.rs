//! What a program says and nothing needs.
//!
//! This is asked of a program without faults: what has one may have been meant to need it.
//!
//! | file | idea |
//! |---|---|
//! | `params.rs` | parameters and in-ports that nothing reads |
//! | `steps.rs` | steps of tasks to which nothing leads |

mod params;
mod steps;

use crate::program::{DeclKind, Program};
use rpi_diag::Finding;
use rpi_syntax::Mode;

/// Warnings about what the first module says and nothing in it needs.
#[must_use]
pub fn needless(program: &Program<'_>) -> Vec<Finding> {
    let mut findings: Vec<Finding> = program.needless_uses().collect();
    // In Lustre ports are mostly those of something else: a tool wrote them, or another model has them.
    if program.root().mode == Mode::Rpi {
        for id in &program.root().decls {
            let decl = program.decl(*id);
            findings.extend(params::unread(decl));
            if let DeclKind::Task(task) = decl.kind {
                findings.extend(steps::unreached(program, decl.module, task));
            }
        }
    }
    findings
}
