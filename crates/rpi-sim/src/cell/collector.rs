//! Collector of the errors that are found while a description is parsed.

use super::error::{CellError, CellErrors};
use super::robot::RobotDescription;
use core::ops::Range;
use std::cell::RefCell;
use std::collections::BTreeMap;

/// Collector of the errors that are found while a description is parsed, with the robot descriptions that its devices
/// name.
#[derive(Default)]
pub(super) struct ErrorCollector {
    errors: RefCell<Vec<CellError>>,
    /// Robot descriptions, by the path that the cell names.
    robots: BTreeMap<String, RobotDescription>,
}

impl ErrorCollector {
    pub(super) fn add(&self, span: Range<usize>, message: String, help: Option<String>) {
        self.errors.borrow_mut().push(CellError {
            span,
            message,
            help,
        });
    }

    /// Adds robot descriptions, by the paths with which devices name them.
    pub(super) fn with_robots(self, robots: BTreeMap<String, RobotDescription>) -> Self {
        Self { robots, ..self }
    }

    /// Returns the robot description at `path`; `None` if it has errors, which have already been reported.
    pub(super) fn robot(&self, path: &str) -> Option<&RobotDescription> {
        self.robots.get(path)
    }

    /// Reports the errors of another file, all at the place `span` of this one.
    pub(super) fn add_nested(&self, span: Range<usize>, nested: &CellErrors) {
        for error in &nested.errors {
            self.add(span.clone(), nested.located(error), error.help.clone());
        }
    }

    /// Returns all errors, in the order of their positions.
    pub(super) fn sorted(self) -> Vec<CellError> {
        let mut all = self.errors.into_inner();
        all.sort_by_key(|fault| (fault.span.start, fault.span.end));
        all
    }
}
