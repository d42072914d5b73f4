//! Results of a replay, by type and port.

use std::collections::BTreeMap;
use std::fmt;

/// Counters of one out-port of one type.
#[derive(Default)]
pub(crate) struct Count {
    pub(crate) compared: u64,
    pub(crate) explained: u64,
    pub(crate) differing: u64,
    pub(crate) first: Option<String>,
}

/// Compared values and differences.
#[derive(Default)]
pub(crate) struct Report {
    pub(crate) nets: u32,
    pub(crate) ports: BTreeMap<(String, &'static str), Count>,
    pub(crate) explained: BTreeMap<&'static str, u64>,
    pub(crate) errors: Vec<String>,
}

impl Report {
    /// Records a net that could not be laid out.
    pub(crate) fn error(&mut self, error: String) {
        self.errors.push(error);
    }

    /// Counts a value that an entry of the table of differences explains.
    pub(crate) fn explain(&mut self, difference: &'static str) {
        *self.explained.entry(difference).or_default() += 1;
    }

    /// Returns the counters of an out-port.
    pub(crate) fn count(&mut self, ty: &str, port: &'static str) -> &mut Count {
        self.ports.entry((ty.to_owned(), port)).or_default()
    }

    /// Returns whether all differences are explained.
    pub(crate) fn clean(&self) -> bool {
        self.errors.is_empty() && self.ports.values().all(|c| c.differing == 0)
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let compared: u64 = self.ports.values().map(|c| c.compared).sum();
        let explained: u64 = self.ports.values().map(|c| c.explained).sum();
        let types: std::collections::BTreeSet<_> = self.ports.keys().map(|(ty, _)| ty).collect();
        writeln!(
            f,
            "{} nets, {} types, {compared} values compared, {explained} explained",
            self.nets,
            types.len()
        )?;
        for error in &self.errors {
            writeln!(f, "ERROR {error}")?;
        }
        for (what, n) in &self.explained {
            writeln!(f, "explained {n:8}  {what}")?;
        }
        for ((ty, port), c) in self.ports.iter().filter(|(_, c)| c.differing > 0) {
            let first = c.first.as_deref().unwrap_or("");
            writeln!(
                f,
                "{ty}.{port}: {} of {} differ; {first}",
                c.differing, c.compared
            )?;
        }
        Ok(())
    }
}
