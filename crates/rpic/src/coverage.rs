//! Coverage of a file by all its tests together, and its report.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use rpi_diag::{FileId, SourceMap, Span};
use rpi_driver::Marks;
use rpi_replay::testing::Coverage;

/// Covered source locations. Several instances of a node share one location and count once.
#[derive(Default)]
pub(crate) struct Seen {
    called: BTreeSet<Span>,
    /// For each fragment its path, and whether any instance was active.
    fragments: BTreeMap<Span, (String, bool)>,
    branches: BTreeMap<Span, [bool; 2]>,
    transitions: BTreeMap<Span, bool>,
}

/// Number of items, and how many of them were covered.
#[derive(Default)]
struct Count {
    seen: usize,
    all: usize,
}

/// Coverage counts of the reachable items, and a line for each item that was not covered.
#[derive(Default)]
struct Account {
    fragments: Count,
    branches: Count,
    transitions: Count,
    missing: String,
}

impl Seen {
    /// Adds the coverage of one test.
    pub(crate) fn add(&mut self, coverage: &Coverage) {
        self.called.extend(&coverage.called);
        for (place, path, active) in &coverage.fragments {
            let seen = self.fragments.entry(*place);
            seen.or_insert((path.clone(), false)).1 |= active;
        }
        for (place, ways) in &coverage.branches {
            let seen = self.branches.entry(*place).or_default();
            (0..2).for_each(|way| seen[way] |= ways[way]);
        }
        for (place, taken) in &coverage.transitions {
            *self.transitions.entry(*place).or_default() |= taken;
        }
    }

    /// Returns a summary line and one line per uncovered item. The standard library is excluded, because it has its own
    /// tests; so are nodes of other modules that no test calls.
    pub(crate) fn text(&self, marks: &[Marks], sources: &SourceMap) -> String {
        let mut account = Account::default();
        let own = |place: &Span| is_own(sources, *place);
        for (_, (path, active)) in self.fragments.iter().filter(|(place, _)| own(place)) {
            account.fragments.add(*active);
            if !active {
                let _ = writeln!(account.missing, "  never active: {path}");
            }
        }
        for declared in marks.iter().filter(|declared| own(&declared.span)) {
            if self.called.contains(&declared.span) {
                self.called(declared, sources, &mut account);
            } else if declared.is_own {
                account.uncalled(declared, sources);
            }
        }
        let Account {
            fragments,
            branches,
            transitions,
            missing,
        } = account;
        format!(
            "coverage: {} fragments, {} branches, {} transitions\n{missing}",
            fragments.text(),
            branches.text(),
            transitions.text()
        )
    }

    /// Adds the counts of a unit that at least one test calls.
    fn called(&self, declared: &Marks, sources: &SourceMap, account: &mut Account) {
        for place in &declared.choices {
            let ways = self.branches.get(place).copied().unwrap_or_default();
            for (seen, branch) in [(ways[1], "then"), (ways[0], "else")] {
                account.branches.add(seen);
                if !seen {
                    let place = located(sources, *place);
                    let _ = writeln!(account.missing, "  `{branch}` never taken: {place}");
                }
            }
        }
        for place in &declared.transitions {
            let taken = self.transitions.get(place).copied().unwrap_or_default();
            account.transitions.add(taken);
            if !taken {
                let (transition, place) = (sources.slice(*place), located(sources, *place));
                let _ = writeln!(account.missing, "  `{transition}` never taken: {place}");
            }
        }
    }
}

impl Account {
    /// Adds the counts of a unit that no test calls; none of its items is covered.
    fn uncalled(&mut self, declared: &Marks, sources: &SourceMap) {
        self.fragments.all += declared.fragments;
        self.branches.all += 2 * declared.choices.len();
        self.transitions.all += declared.transitions.len();
        let (what, place) = (&declared.what, located(sources, declared.span));
        let _ = writeln!(self.missing, "  never called: {what}: {place}");
    }
}

impl Count {
    fn add(&mut self, seen: bool) {
        self.all += 1;
        self.seen += usize::from(seen);
    }

    fn text(&self) -> String {
        format!("{} of {}", self.seen, self.all)
    }
}

fn located(sources: &SourceMap, place: Span) -> String {
    let (file, at) = (sources.name(place.file), sources.line_col(place));
    format!("{file}:{}:{}", at.line, at.col)
}

fn is_own(sources: &SourceMap, place: Span) -> bool {
    place.file == FileId(0) || !sources.name(place.file).starts_with("stdlib/")
}
