//! How large all nets of a program together may become: each is bounded by itself, and a short text can ask for many.

use crate::check::Checked;
use crate::program::Program;
use crate::typed::Unit;
use rpi_diag::{Code, Finding, Span};
use std::cell::Cell;

/// What every program may have.
const FREE: usize = 240_000;

/// What a byte of text pays for.
const PER_BYTE: usize = 2;

/// What a step of a task pays for: its command may have a net of its own, for its arguments.
const PER_STEP: usize = 2_000;

/// The most steps of all tasks of a program together: a task is written out wherever another one runs it.
pub const MAX_STEPS: usize = 20_000;

/// The most tasks that run one another in a row.
pub const MAX_TASKS_IN_A_ROW: usize = 400;

/// The room for nodes.
#[derive(Debug)]
pub struct Room {
    left: Cell<usize>,
    is_told: Cell<bool>,
}

impl Room {
    /// The room that a program has.
    #[must_use]
    pub fn of(program: &Program<'_>, checked: &Checked) -> Room {
        let steps: usize = checked.units.iter().map(|unit| unit.steps.len()).sum();
        Room {
            left: Cell::new(FREE + PER_BYTE * program.length() + PER_STEP * steps),
            is_told: Cell::new(false),
        }
    }

    /// Whether there is any left.
    #[must_use]
    pub fn is_left(&self) -> bool {
        self.left.get() > 0
    }

    /// A net of so many nodes has been made.
    pub fn take(&self, nodes: usize) {
        self.left.set(self.left.get().saturating_sub(nodes));
    }

    /// What is to be said at the first thing that has no room.
    #[must_use]
    pub fn used_up(&self, span: Span) -> Option<Finding> {
        let message = "written out the whole program is too much to work with";
        (!self.is_told.replace(true)).then(|| {
            Finding::new(Code::RPI1011, message)
                .at(span, "what stands before this uses up the room")
                .help("divide the program into several files")
        })
    }
}

/// What is to be said of a task with which those that are written out have more than [`MAX_STEPS`], or in which more than
/// [`MAX_TASKS_IN_A_ROW`] run one another.
#[must_use]
pub fn task_too_large(task: &Unit) -> Finding {
    let message = format!("written out `{}` is too large", task.name);
    let what = format!(
        "with this one the tasks have more than {MAX_STEPS} steps, or more than {MAX_TASKS_IN_A_ROW} tasks run one another in a row"
    );
    Finding::new(Code::RPI1011, message)
        .at(task.span, what)
        .help("a task is written out wherever another one runs it; `repeat n times let ... tel` is written out once")
}
