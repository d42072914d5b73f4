//! Diagnostics of the instances of each unit, and their merging into diagnostics of the unit.

use std::collections::{BTreeMap, BTreeSet};

use rpi_diag::{Code, Diagnostic, Span};
use rpi_net::passes::{is_endless, is_unreachable};
use rpi_sema::typed::UnitId;

/// Instance of a command for the arguments of a task: its name, such as `MoveTo(arm, home)`, and the location of the
/// call. `None` stands for the command, node or test with its default arguments.
type InstanceCall = Option<(String, Span)>;

/// Diagnostics of each net that was compiled from a unit (a node, command or test): one net for the default arguments,
/// and one for each argument list of the tasks.
#[derive(Default)]
pub(crate) struct InstanceDiagnostics(Vec<(UnitId, InstanceCall, Vec<Diagnostic>)>);

/// Key by which equal diagnostics of several instances of a unit are merged: the unit, the code and the location.
type Key = (UnitId, Code, Span);

impl InstanceDiagnostics {
    /// Adds an instance of a unit (a node, command or test) and returns the list to which its diagnostics must be
    /// added.
    pub(crate) fn add_instance(&mut self, unit: UnitId, run: InstanceCall) -> &mut Vec<Diagnostic> {
        self.0.push((unit, run, Vec::new()));
        let at = self.0.len() - 1;
        &mut self.0[at].2
    }

    /// Merges the diagnostics of all instances of each unit (a node, command or test). A diagnostic about unused or
    /// unreachable text remains only if all instances report it, because the text may be used for other arguments. An
    /// error about an endless command that only some instances report remains, with labels at the calls of these
    /// instances.
    pub(crate) fn merge(self) -> Vec<Diagnostic> {
        let mut nets: BTreeMap<UnitId, usize> = BTreeMap::new();
        let mut runs: BTreeMap<Key, Vec<InstanceCall>> = BTreeMap::new();
        for (unit, run, found) in &self.0 {
            *nets.entry(*unit).or_default() += 1;
            for (code, span) in places_to_compare(found) {
                runs.entry((*unit, code, span))
                    .or_default()
                    .push(run.clone());
            }
        }
        let all = self.0.into_iter();
        let all = all.flat_map(|(unit, _, found)| found.into_iter().map(move |f| (unit, f)));
        let merged = all.filter_map(|(unit, diagnostic)| {
            let key = (unit, diagnostic.code, diagnostic.span());
            match runs.get_mut(&key) {
                None => Some(diagnostic),
                Some(of) if of.len() == nets[&unit] => Some(diagnostic),
                Some(_) if is_about_unused_text(&diagnostic) => None,
                Some(of) => with_instance_labels(diagnostic, std::mem::take(of)),
            }
        });
        merged.collect()
    }
}

/// Maximum number of instances whose calls are shown in one diagnostic.
const MAX_INSTANCES_SHOWN: usize = 3;

/// Adds labels at the calls of the instances that report a diagnostic. Returns `None` if `runs` is empty, because an
/// equal diagnostic was already returned for these instances.
fn with_instance_labels(diagnostic: Diagnostic, runs: Vec<InstanceCall>) -> Option<Diagnostic> {
    if runs.is_empty() {
        return None;
    }
    let runs = runs.into_iter().flatten().take(MAX_INSTANCES_SHOWN);
    Some(runs.fold(diagnostic, |diagnostic, (name, span)| {
        diagnostic.secondary(span, format!("as `{name}`, run here"))
    }))
}

/// Returns code and location of those diagnostics whose meaning depends on all instances of the unit, without
/// duplicates: unused or unreachable text, and commands that never end.
fn places_to_compare(found: &[Diagnostic]) -> BTreeSet<(Code, Span)> {
    let compared = found
        .iter()
        .filter(|f| is_about_unused_text(f) || is_endless(f));
    compared.map(|f| (f.code, f.span())).collect()
}

/// Returns whether a diagnostic reports unused or unreachable text.
fn is_about_unused_text(diagnostic: &Diagnostic) -> bool {
    is_unreachable(diagnostic) || diagnostic.code.is_unnecessary()
}
