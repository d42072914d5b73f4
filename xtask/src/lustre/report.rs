//! Summary of the verdicts on all programs.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use serde_json::Value;

use super::judge::Fate;
use super::options::Options;

/// Verdicts on all programs.
pub(crate) struct Report {
    judged: Vec<(String, Fate)>,
    /// The group of each program.
    groups: BTreeMap<String, String>,
}

/// Number of programs that reached each stage.
#[derive(Default)]
struct Counts {
    all: usize,
    parsed: usize,
    checked: usize,
    ran: usize,
    good: usize,
}

impl Counts {
    fn add(&mut self, fate: &Fate) {
        let reached = match fate {
            Fate::Missing(_) | Fate::NotParsed(_) | Fate::Broken(_) => 0,
            Fate::Refused(_) => 1,
            Fate::Fault(_) => 2,
            Fate::Differs(_) => 3,
            Fate::Good(_) => 4,
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
    pub(crate) fn new(judged: Vec<(String, Fate)>, options: &Options) -> Result<Report, String> {
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
        Ok(Report { judged, groups })
    }

    pub(crate) fn is_good(&self) -> bool {
        self.judged
            .iter()
            .all(|(_, fate)| matches!(fate, Fate::Good(_)))
    }

    /// Lists the programs (all, or those that fail), then the counts.
    pub(crate) fn print(&self, list: bool) -> String {
        let mut out = String::new();
        let mut counts: BTreeMap<&str, Counts> = BTreeMap::new();
        for (name, fate) in &self.judged {
            let group = self.groups.get(name).map_or("", String::as_str);
            counts.entry("all").or_default().add(fate);
            if !self.groups.is_empty() {
                counts.entry(group).or_default().add(fate);
            }
            if list || !matches!(fate, Fate::Good(_)) {
                let (what, why) = words(fate);
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

fn words(fate: &Fate) -> (&'static str, &str) {
    match fate {
        Fate::Missing(why) => ("missing", why),
        Fate::NotParsed(why) => ("not parsed", why),
        Fate::Refused(why) => ("refused", why),
        Fate::Broken(why) => ("broken", why),
        Fate::Fault(why) => ("fault", why),
        Fate::Differs(why) => ("differs", why),
        Fate::Good(why) => ("good", why),
    }
}
