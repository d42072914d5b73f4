//! Diagnostics of the instances of each unit, and their merging into diagnostics of the unit.

use std::collections::BTreeMap;

use rpi_diag::{Code, Finding, Span};
use rpi_net::passes::{is_endless, is_unreachable};
use rpi_sema::typed::UnitId;

/// Instance of a command for the arguments of a task: its name, and the location of the call. `None` for the unit with
/// its default arguments.
type Run = Option<(String, Span)>;

/// Diagnostics by instance. A unit has one instance with its default arguments, and one for each argument list of the
/// tasks.
#[derive(Default)]
pub(crate) struct Found(Vec<(UnitId, Run, Vec<Finding>)>);

/// Key by which equal diagnostics of several instances are merged.
type Key = (UnitId, Code, Span);

impl Found {
    /// Adds an instance of a unit and returns the list for its diagnostics.
    pub(crate) fn net_of(&mut self, unit: UnitId, run: Run) -> &mut Vec<Finding> {
        self.0.push((unit, run, Vec::new()));
        let at = self.0.len() - 1;
        &mut self.0[at].2
    }

    /// Merges the diagnostics of all instances. A diagnostic about unused or unreachable text is kept only if all
    /// instances of the unit report it, because the text may be used for other arguments. An error of some instances
    /// only is kept, with labels at the calls of these instances.
    pub(crate) fn agreed(self) -> Vec<Finding> {
        let mut nets: BTreeMap<UnitId, usize> = BTreeMap::new();
        let mut runs: BTreeMap<Key, Vec<Run>> = BTreeMap::new();
        for (unit, run, found) in &self.0 {
            *nets.entry(*unit).or_default() += 1;
            let counted = found.iter().filter(|f| denies(f) || is_endless(f));
            let mut places: Vec<(Code, Span)> = counted.map(|f| (f.code, f.span())).collect();
            places.sort_unstable();
            places.dedup();
            for (code, span) in places {
                runs.entry((*unit, code, span))
                    .or_default()
                    .push(run.clone());
            }
        }
        let all = self.0.into_iter();
        let all = all.flat_map(|(unit, _, found)| found.into_iter().map(move |f| (unit, f)));
        let told = all.filter_map(|(unit, finding)| {
            let key = (unit, finding.code, finding.span());
            match runs.get_mut(&key) {
                None => Some(finding),
                Some(of) if of.len() == nets[&unit] => Some(finding),
                Some(_) if denies(&finding) => None,
                Some(of) => of_runs(finding, std::mem::take(of)),
            }
        });
        told.collect()
    }
}

/// Largest number of instances shown in one diagnostic.
const SHOWN: usize = 3;

/// Adds labels for the instances to a diagnostic; returns `None` if the diagnostic was already reported.
fn of_runs(finding: Finding, runs: Vec<Run>) -> Option<Finding> {
    if runs.is_empty() {
        return None;
    }
    let runs = runs.into_iter().flatten().take(SHOWN);
    Some(runs.fold(finding, |finding, (name, span)| {
        finding.also(span, format!("as `{name}`, run here"))
    }))
}

/// Returns whether a diagnostic is about unused or unreachable text.
fn denies(finding: &Finding) -> bool {
    is_unreachable(finding) || finding.code.is_about_needless_text()
}
