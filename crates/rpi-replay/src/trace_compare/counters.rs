//! Counters of a replay: agreeing, deviating and explained values.

use super::report::{CompareReport, ExplainedDifference, LargestDeviation, PortDeviations};
use super::trace_view::RecordedValue;

/// Place of a compared value: the number of the cycle, the port, and the primitive of its node.
#[derive(Clone, Copy)]
pub(super) struct PortInCycle<'a> {
    pub(super) cycle: u64,
    pub(super) port: &'a str,
    pub(super) primitive: &'a str,
}

/// Report of a comparison with a trace while it is being filled.
#[derive(Default)]
pub(super) struct ReportBuilder {
    pub(super) report: CompareReport,
    worst: f64,
}

impl ReportBuilder {
    pub(super) fn new(net: &str) -> ReportBuilder {
        let mut tally = ReportBuilder::default();
        net.clone_into(&mut tally.report.net);
        tally
    }

    /// Counts one recorded value that was compared, either as present or as absent.
    pub(super) fn count_compared(&mut self, recorded: &RecordedValue) {
        let compared = &mut self.report.compared;
        match recorded {
            RecordedValue::Absent => compared.absences += 1,
            _ => compared.values += 1,
        }
    }

    /// Counts a computed value that agrees with the recorded one. `texts` returns both as text; it is only called for
    /// the largest deviation so far.
    pub(super) fn count_agreeing(
        &mut self,
        at: PortInCycle<'_>,
        deviation: f64,
        texts: impl FnOnce() -> (String, String),
    ) {
        if deviation > self.worst {
            self.worst = deviation;
            let (computed, recorded) = texts();
            self.report.worst = Some(LargestDeviation {
                cycle: at.cycle,
                port: at.port.to_owned(),
                deviation,
                computed,
                recorded,
            });
        }
    }

    /// Counts a computed value that differs from the recorded one for no known reason. `deviation` is `None` if one of
    /// them is absent. Returns true for the first such value.
    pub(super) fn count_differing(&mut self, at: PortInCycle<'_>, deviation: Option<f64>) -> bool {
        self.report.differing += 1;
        let ports = &mut self.report.ports;
        match ports.iter_mut().find(|p| p.port == at.port) {
            Some(port) => {
                port.values += 1;
                port.worst = max_option(port.worst, deviation);
            }
            None => ports.push(PortDeviations {
                port: at.port.to_owned(),
                primitive: at.primitive.to_owned(),
                values: 1,
                first_cycle: at.cycle,
                worst: deviation,
            }),
        }
        self.report.differing == 1
    }

    /// Counts a computed value that differs from the recorded one because of a documented difference. `entry` is the
    /// name of the difference, `why` its cause.
    pub(super) fn count_explained(
        &mut self,
        at: PortInCycle<'_>,
        entry: &'static str,
        why: &'static str,
    ) {
        let explained = &mut self.report.explained;
        let known = explained.iter().position(|e| e.entry == entry);
        let k = known.unwrap_or_else(|| {
            explained.push(ExplainedDifference {
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

fn max_option(a: Option<f64>, b: Option<f64>) -> Option<f64> {
    match (a, b) {
        (Some(a), Some(b)) => Some(a.max(b)),
        (a, b) => a.or(b),
    }
}
