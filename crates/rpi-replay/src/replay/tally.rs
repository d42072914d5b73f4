//! Counters of a replay: agreeing, deviating and explained values.

use super::recorded::Recorded;
use super::report::{Explained, PortTally, Report, Worst};

/// A port in a cycle.
#[derive(Clone, Copy)]
pub(super) struct Occasion<'a> {
    pub(super) cycle: u64,
    pub(super) port: &'a str,
    pub(super) primitive: &'a str,
}

/// A report that is being filled.
#[derive(Default)]
pub(super) struct Tally {
    pub(super) report: Report,
    worst: f64,
}

impl Tally {
    pub(super) fn new(net: &str) -> Tally {
        let mut tally = Tally::default();
        net.clone_into(&mut tally.report.net);
        tally
    }

    /// Counts a compared value.
    pub(super) fn compared(&mut self, recorded: &Recorded) {
        let compared = &mut self.report.compared;
        match recorded {
            Recorded::Absent => compared.absences += 1,
            _ => compared.values += 1,
        }
    }

    /// Counts an agreeing value. `texts` returns the computed and recorded texts; it is only called for the largest
    /// deviation so far.
    pub(super) fn agrees(
        &mut self,
        at: Occasion<'_>,
        deviation: f64,
        texts: impl FnOnce() -> (String, String),
    ) {
        if deviation > self.worst {
            self.worst = deviation;
            let (computed, recorded) = texts();
            self.report.worst = Some(Worst {
                cycle: at.cycle,
                port: at.port.to_owned(),
                deviation,
                computed,
                recorded,
            });
        }
    }

    /// Counts a deviating value without an explanation. Returns true for the first one.
    pub(super) fn differs(&mut self, at: Occasion<'_>, deviation: Option<f64>) -> bool {
        self.report.differing += 1;
        let ports = &mut self.report.ports;
        match ports.iter_mut().find(|p| p.port == at.port) {
            Some(port) => {
                port.values += 1;
                port.worst = larger(port.worst, deviation);
            }
            None => ports.push(PortTally {
                port: at.port.to_owned(),
                primitive: at.primitive.to_owned(),
                values: 1,
                first_cycle: at.cycle,
                worst: deviation,
            }),
        }
        self.report.differing == 1
    }

    /// Counts a deviating value that a documented difference explains.
    pub(super) fn explained(&mut self, at: Occasion<'_>, entry: &'static str, why: &'static str) {
        let explained = &mut self.report.explained;
        let known = explained.iter().position(|e| e.entry == entry);
        let k = known.unwrap_or_else(|| {
            explained.push(Explained {
                entry,
                why,
                values: 0,
                ports: Vec::new(),
            });
            explained.len() - 1
        });
        explained[k].values += 1;
        if !explained[k].ports.iter().any(|p| p == at.port) {
            explained[k].ports.push(at.port.to_owned());
        }
    }
}

fn larger(a: Option<f64>, b: Option<f64>) -> Option<f64> {
    match (a, b) {
        (Some(a), Some(b)) => Some(a.max(b)),
        (a, b) => a.or(b),
    }
}
