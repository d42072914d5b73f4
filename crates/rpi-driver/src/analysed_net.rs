//! Nets after all passes: the stage between elaboration and lowering.

use std::ops::Deref;

use rpi_lower::Plan;
use rpi_net::passes::{Analysis, Schedule};
use rpi_net::{ExportPort, FragmentId, Net};

/// Net on which all compiler passes have run, with an order of evaluation. The tools lower and print it without another
/// analysis.
#[derive(Clone, Debug)]
pub struct AnalysedNet {
    analysis: Analysis,
    schedule: Schedule,
}

impl AnalysedNet {
    /// Creates the net from the results of the passes; `None` if the net has a dependency cycle and therefore no order
    /// of evaluation.
    #[must_use]
    pub fn from_analysis(mut analysis: Analysis) -> Option<AnalysedNet> {
        let schedule = analysis.schedule.take()?;
        // Both have been copied to the diagnostics and the summary of the program.
        (analysis.diagnostics, analysis.summary) = (Vec::new(), Vec::new());
        Some(AnalysedNet { analysis, schedule })
    }

    /// Returns the results of the passes that the lowering to an image needs: fragments, order of evaluation and
    /// presence of flows.
    #[must_use]
    pub fn plan(&self) -> Plan<'_> {
        Plan {
            tree: &self.analysis.tree,
            schedule: &self.schedule,
            presences: &self.analysis.presences,
        }
    }

    /// Returns the net with the results of the passes. The order of evaluation is in [`AnalysedNet::plan`].
    #[must_use]
    pub fn analysis(&self) -> &Analysis {
        &self.analysis
    }

    /// Returns the upper bound on the work of a cycle in elementary operations. Of mutually exclusive fragments only
    /// the most expensive counts.
    #[must_use]
    pub fn work_bound(&self) -> u64 {
        self.analysis.work.bound(FragmentId::ROOT)
    }

    /// Returns the net under another name.
    pub(crate) fn with_name(mut self, name: String) -> AnalysedNet {
        self.analysis.net.name = name;
        self
    }

    /// Adds ports to the exports of the net, the flows that are visible outside. The results of the passes stay valid,
    /// because none depends on the exports.
    pub(crate) fn export(&mut self, ports: impl IntoIterator<Item = ExportPort>) {
        self.analysis.net.exports.extend(ports);
    }
}

impl Deref for AnalysedNet {
    type Target = Net;

    fn deref(&self) -> &Net {
        &self.analysis.net
    }
}
