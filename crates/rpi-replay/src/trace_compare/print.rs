//! Text output of a replay report.

use std::fmt;

use rpi_diag::with_noun;

use super::report::{CompareReport, Divergence, DivergenceLink};

/// Maximum number of ports that the printed report of a replay lists.
const LISTED: usize = 12;

impl fmt::Display for CompareReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let verdict = if self.agrees() {
            "agrees with"
        } else {
            "DIFFERS from"
        };
        writeln!(
            f,
            "{} {verdict} the trace, {}",
            self.net,
            with_noun(self.cycles, "cycle")
        )?;
        self.counts(f)?;
        self.lists(f)?;
        match &self.first {
            Some(first) => write!(f, "{first}"),
            None => Ok(()),
        }
    }
}

impl CompareReport {
    /// Returns the report as one indented JSON object.
    #[must_use]
    pub fn to_json(&self) -> String {
        // Serialising strings, numbers and lists cannot fail; NaN becomes null.
        serde_json::to_string_pretty(self).unwrap_or_default()
    }

    fn counts(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let compared = self.compared;
        writeln!(
            f,
            "  compared   {:>9} values and {} absences",
            compared.values, compared.absences
        )?;
        writeln!(f, "  differing  {:>9}", self.differing)?;
        for row in &self.explained {
            let ports = with_noun(row.ports.len(), "port");
            writeln!(
                f,
                "  explained  {:>9} at {ports} by `{}`: {}",
                row.values, row.entry, row.why
            )?;
        }
        writeln!(f, "  inputs     {:>9} taken from the trace", self.taken)?;
        for (count, what) in [
            (
                self.unknown,
                "depend on values that are missing in the trace",
            ),
            (self.rewritten, "angles are equal in another notation"),
        ] {
            if count > 0 {
                writeln!(f, "  skipped    {count:>9} {what}")?;
            }
        }
        if let Some(worst) = &self.worst {
            let (off, port, cycle) = (worst.deviation, &worst.port, worst.cycle);
            writeln!(
                f,
                "  largest accepted deviation {off:.2e}: {port} in cycle {cycle}"
            )?;
        }
        Ok(())
    }

    fn lists(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.renumbered != 0 {
            let shift = self.renumbered;
            writeln!(
                f,
                "  the trace is from another run: its generated names are shifted by {shift:+}"
            )?;
        }
        for port in self.unmatched.iter().take(LISTED) {
            writeln!(f, "  the net has no port {port}")?;
        }
        if let Some(fault) = &self.fault {
            let (code, place, cycle) = (&fault.code, &fault.place, fault.cycle);
            writeln!(
                f,
                "  the net ended with fault {code} at {place} in cycle {cycle}"
            )?;
        }
        for port in self.ports.iter().take(LISTED) {
            let worst = port
                .worst
                .map_or("presence".to_owned(), |w| format!("{w:.2e}"));
            let (name, kind) = (&port.port, &port.primitive);
            let (values, first) = (port.values, port.first_cycle);
            writeln!(
                f,
                "  {name} ({kind}): {values} values differ from cycle {first} on, worst {worst}"
            )?;
        }
        match self.ports.len().saturating_sub(LISTED) {
            0 => Ok(()),
            more => writeln!(f, "  and {}", with_noun(more, "more port")),
        }
    }
}

impl fmt::Display for Divergence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "first divergence, in cycle {}:", self.cycle)?;
        for (k, link) in self.path.iter().enumerate() {
            let from = if k == 0 { "  " } else { "  from " };
            write!(f, "{from}{link}")?;
        }
        for (port, from, value) in self.path.last().map_or(&[][..], |root| &root.inputs) {
            writeln!(f, "    {port} = {value}  from {from}")?;
        }
        Ok(())
    }
}

impl fmt::Display for DivergenceLink {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.port)?;
        if !self.primitive.is_empty() {
            write!(f, " ({})", self.primitive)?;
        }
        if let Some(deviation) = self.deviation {
            write!(f, ", off by {deviation:.2e}")?;
        }
        if let Some(cycle) = self.since {
            write!(f, ", off since cycle {cycle}")?;
        }
        writeln!(f, "\n    computed {}", self.computed)?;
        match &self.recorded {
            Some(recorded) => writeln!(f, "    recorded {recorded}"),
            None => Ok(()),
        }
    }
}
