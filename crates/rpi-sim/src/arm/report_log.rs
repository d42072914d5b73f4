//! Log of the reports of an arm that nobody has read yet.

use crate::device::Report;

/// Number of reports that the log can hold.
const CAPACITY: usize = 64;

/// Bounded log of reports. It keeps the oldest ones and counts those that do not fit.
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

    /// Passes all reports to `each` and returns the number of lost ones since the last call.
    pub(super) fn drain(&mut self, each: &mut dyn FnMut(Report)) -> u64 {
        self.pending.drain(..).for_each(each);
        core::mem::take(&mut self.lost)
    }
}
