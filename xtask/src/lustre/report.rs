//! Summary of the verdicts on all programs.

use crate::task_error::TaskError;
use std::collections::BTreeMap;
use std::fmt::Write as _;

use serde_json::Value;

use super::cases::Verdict;
use super::options::Options;

/// Report on a corpus of Lustre programs: the verdicts on all programs, and their groups.
pub(crate) struct Report {
    verdicts: Vec<(String, Verdict)>,
    /// Name of the group of each program, by program name; empty if there are no groups.
    groups: BTreeMap<String, String>,
}

/// Number of programs that reached each stage: all, parsed, checked, run, and with the expected result.
#[derive(Default)]
struct Counts {
    all: usize,
    parsed: usize,
    checked: usize,
    ran: usize,
    good: usize,
}

impl Counts {
    fn add(&mut self, fate: &Verdict) {
        let reached = match fate {
            Verdict::Missing(_) | Verdict::NotParsed(_) | Verdict::Crashed(_) => 0,
            Verdict::Rejected(_) => 1,
            Verdict::Fault(_) => 2,
            Verdict::Mismatch(_) => 3,
            Verdict::Pass(_) => 4,
        };
        let counts = [
            &mut self.parsed,
            &mut self.checked,
            &mut self.ran,
            &mut self.good,
        ];
        self.all += 1;
        counts
            .into_iter()
            .take(reached)
            .for_each(|count| *count += 1);
    }
}

impl Report {
    pub(crate) fn new(
        judged: Vec<(String, Verdict)>,
        options: &Options,
    ) -> Result<Report, TaskError> {
        let mut groups = BTreeMap::new();
        if let Some(path) = &options.groups {
            let bad = |e: &dyn std::fmt::Display| format!("{}: {e}", path.display());
            let text = std::fs::read_to_string(path).map_err(|e| bad(&e))?;
            let listed: Value = serde_json::from_str(&text).map_err(|e| bad(&e))?;
            for (group, names) in listed
                .as_object()
                .ok_or_else(|| bad(&"expected a JSON object"))?
            {
                let names = names.as_array().into_iter().flatten();
                let names = names.filter_map(Value::as_str);
                groups.extend(names.map(|name| (name.to_owned(), group.clone())));
            }
        }
        Ok(Report {
            verdicts: judged,
            groups,
        })
    }

    pub(crate) fn is_good(&self) -> bool {
        self.verdicts
            .iter()
            .all(|(_, fate)| matches!(fate, Verdict::Pass(_)))
    }

    /// Returns the text of the report: a line for each program (all, or only those that fail), then the counts of each
    /// group.
    pub(crate) fn print(&self, list: bool) -> String {
        let mut out = String::new();
        let mut counts: BTreeMap<&str, Counts> = BTreeMap::new();
        for (name, fate) in &self.verdicts {
            let group = self.groups.get(name).map_or("", String::as_str);
            counts.entry("all").or_default().add(fate);
            if !self.groups.is_empty() {
                counts.entry(group).or_default().add(fate);
            }
            if list || !matches!(fate, Verdict::Pass(_)) {
                let (what, why) = label(fate);
                let _ = writeln!(
                    out,
                    "{name}: {what}{}{why}",
                    if why.is_empty() { "" } else { ": " }
                );
            }
        }
        for (group, c) in counts {
            let _ = writeln!(
                out,
                "{group:>5}: {} programs, {} parse, {} check, {} run, {} good",
                c.all, c.parsed, c.checked, c.ran, c.good
            );
        }
        out
    }
}

fn label(fate: &Verdict) -> (&'static str, &str) {
    match fate {
        Verdict::Missing(why) => ("missing", why),
        Verdict::NotParsed(why) => ("not parsed", why),
        Verdict::Rejected(why) => ("refused", why),
        Verdict::Crashed(why) => ("broken", why),
        Verdict::Fault(why) => ("fault", why),
        Verdict::Mismatch(why) => ("differs", why),
        Verdict::Pass(why) => ("good", why),
    }
}
