//! What is found against each net of a unit, and what of it is true of the unit.

use std::collections::BTreeMap;

use rpi_diag::{Code, Finding, Span};
use rpi_net::passes::{is_endless, is_unreachable};
use rpi_sema::typed::UnitId;

/// A net of a command for the arguments of a task: its name, and where it is asked for.
type Run = Option<(String, Span)>;

/// What was found against nets: a unit has one by itself, and one for each list of arguments that tasks give it.
#[derive(Default)]
pub(crate) struct Found(Vec<(UnitId, Run, Vec<Finding>)>);

/// What is found against several nets of a unit is told once.
type Key = (UnitId, Code, Span);

impl Found {
    /// Where findings against one more net of a unit belong.
    pub(crate) fn net_of(&mut self, unit: UnitId, run: Run) -> &mut Vec<Finding> {
        self.0.push((unit, run, Vec::new()));
        let at = self.0.len() - 1;
        &mut self.0[at].2
    }

    /// All of it, but what denies the text any use only where all nets of the unit agree: what is needless for some
    /// arguments is there for others. What is an error for some arguments only names where they are given.
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

/// So many runs are shown.
const SHOWN: usize = 3;

/// A finding with the runs that it is about; [`None`] if it has been told.
fn of_runs(finding: Finding, runs: Vec<Run>) -> Option<Finding> {
    if runs.is_empty() {
        return None;
    }
    let runs = runs.into_iter().flatten().take(SHOWN);
    Some(runs.fold(finding, |finding, (name, span)| {
        finding.also(span, format!("as `{name}`, run here"))
    }))
}

/// Whether it says that text is good for nothing.
fn denies(finding: &Finding) -> bool {
    is_unreachable(finding) || finding.code.is_about_needless_text()
}
