//! Size limit for all nets of a program together. Each net has its own limit, but a short program can have many nets.

use crate::program::Program;
use crate::typed::Unit;
use rpi_diag::{Code, Diagnostic, Span};
use std::cell::Cell;
use std::rc::Rc;

/// Number of net nodes that every program may have, in addition to those that the length of its text allows.
const BASE_BUDGET: usize = 240_000;

/// Number of further net nodes that a program may have for each byte of its text.
const NODES_PER_BYTE: usize = 2;

/// Number of further net nodes for each step of a task. The command of a step may have a net of its own for its
/// arguments.
const NODES_PER_STEP: usize = 2_000;

/// Maximum number of steps of all tasks of a program together, after expansion. A task is expanded wherever another
/// task runs it.
pub const MAX_STEPS: usize = 20_000;

/// Maximum depth of tasks that run one another.
pub const MAX_TASK_DEPTH: usize = 400;

/// Number of net nodes that a program may still have, over all its nets.
#[derive(Debug)]
pub struct SizeBudget {
    remaining: Cell<usize>,
    is_reported: Cell<bool>,
}

impl SizeBudget {
    /// Creates the budget of a program from the length of its text and the number of its steps.
    #[must_use]
    pub fn for_program(program: &Program<'_>, units: &[Rc<Unit>]) -> SizeBudget {
        let steps: usize = units.iter().map(|unit| unit.steps.len()).sum();
        SizeBudget {
            remaining: Cell::new(
                BASE_BUDGET + NODES_PER_BYTE * program.text_len() + NODES_PER_STEP * steps,
            ),
            is_reported: Cell::new(false),
        }
    }

    /// Returns whether any nodes remain in the budget.
    #[must_use]
    pub fn has_remaining(&self) -> bool {
        self.remaining.get() > 0
    }

    /// Subtracts the number of nodes of a net from the budget.
    pub fn extract_element(&self, nodes: usize) {
        self.remaining
            .set(self.remaining.get().saturating_sub(nodes));
    }

    /// Returns the error for the first net that exceeds the budget; `None` for later nets. `span` is the location of
    /// the declaration of the net.
    #[must_use]
    pub fn report_exhausted(&self, span: Span) -> Option<Diagnostic> {
        let message = "program is too large after all calls are expanded";
        (!self.is_reported.replace(true)).then(|| {
            Diagnostic::new(Code::RPI1011, message)
                .primary(span, "the limit is reached before this")
                .help("divide the program into several files")
        })
    }
}

/// Returns the error for a task with which the expanded tasks have more than [`MAX_STEPS`] steps, or in which more than
/// [`MAX_TASK_DEPTH`] tasks run one another.
#[must_use]
pub fn task_too_large(task: &Unit) -> Diagnostic {
    let message = format!("task `{}` is too large after expansion", task.name);
    let what = format!(
        "the tasks up to this one have more than {MAX_STEPS} steps, or nest more than {MAX_TASK_DEPTH} deep"
    );
    Diagnostic::new(Code::RPI1011, message)
        .primary(task.span, what)
        .help("a task is expanded wherever another task runs it; `repeat n times let ... tel` is expanded once")
}
