//! Log of the reports of an arm that nobody has read yet.

use crate::device::Report;

/// Maximum number of reports in the log.
const CAPACITY: usize = 64;

/// Bounded log of the reports of an arm. If it is full, new reports are counted and lost.
#[derive(Clone, Debug)]
pub(super) struct ReportLog {
    pending: Vec<Report>,
    lost: u64,
}

impl ReportLog {
    pub(super) fn new() -> Self {
        Self {
            pending: Vec::with_capacity(CAPACITY),
            lost: 0,
        }
    }

    pub(super) fn push(&mut self, report: Report) {
        if self.pending.len() == CAPACITY {
            self.lost += 1;
            return;
        }
        self.pending.push(report);
    }

    /// Passes all reports in the log to `each` and removes them. Returns the number of reports lost since the last
    /// call.
    pub(super) fn drain(&mut self, each: &mut dyn FnMut(Report)) -> u64 {
        self.pending.drain(..).for_each(each);
        core::mem::take(&mut self.lost)
    }
}
