//! Coverage of a file by all its tests together, and its report.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use rpi_diag::{FileId, SourceMap, Span};
use rpi_driver::CoveragePoints;
use rpi_replay::testing::Coverage;

/// Parts of a program that its tests have covered, by their source locations. Several instances of a node have the same
/// locations and count once.
#[derive(Default)]
pub(crate) struct CoverageTotals {
    called: BTreeSet<Span>,
    /// For each fragment its path in the net, and whether it was active in any cycle of any instance.
    fragments: BTreeMap<Span, (String, bool)>,
    branches: BTreeMap<Span, [bool; 2]>,
    transitions: BTreeMap<Span, bool>,
}

/// Number of parts of one kind (such as fragments), and the number of those that tests have covered.
#[derive(Default)]
struct Count {
    covered: usize,
    total: usize,
}

/// Numbers of all and of covered fragments, branches and transitions, and a line for each part that is not covered.
#[derive(Default)]
struct CoverageReport {
    fragments: Count,
    branches: Count,
    transitions: Count,
    uncovered: String,
}

impl CoverageTotals {
    /// Adds the coverage of one test to the totals of the file.
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

    /// Returns a text: a line with the numbers, then a line for each fragment, branch or transition that is not
    /// covered. `marks` lists the parts of each node and command. The standard library is excluded, because it has its
    /// own tests; so are nodes of other modules that no test calls.
    pub(crate) fn report(&self, marks: &[CoveragePoints], sources: &SourceMap) -> String {
        let mut account = CoverageReport::default();
        let own = |place: &Span| is_own(sources, *place);
        for (_, (path, active)) in self.fragments.iter().filter(|(place, _)| own(place)) {
            account.fragments.add(*active);
            if !active {
                let _ = writeln!(account.uncovered, "  never active: {path}");
            }
        }
        for declared in marks.iter().filter(|declared| own(&declared.span)) {
            if self.called.contains(&declared.span) {
                self.called(declared, sources, &mut account);
            } else if declared.is_own {
                account.uncalled(declared, sources);
            }
        }
        let CoverageReport {
            fragments,
            branches,
            transitions,
            uncovered: missing,
        } = account;
        format!(
            "coverage: {} fragments, {} branches, {} transitions\n{missing}",
            fragments.text(),
            branches.text(),
            transitions.text()
        )
    }

    /// Adds the branches and transitions of a node or command that at least one test calls to the report.
    fn called(&self, declared: &CoveragePoints, sources: &SourceMap, account: &mut CoverageReport) {
        for place in &declared.choices {
            let ways = self.branches.get(place).copied().unwrap_or_default();
            for (seen, branch) in [(ways[1], "then"), (ways[0], "else")] {
                account.branches.add(seen);
                if !seen {
                    let place = format_location(sources, *place);
                    let _ = writeln!(account.uncovered, "  `{branch}` never taken: {place}");
                }
            }
        }
        for place in &declared.transitions {
            let taken = self.transitions.get(place).copied().unwrap_or_default();
            account.transitions.add(taken);
            if !taken {
                let (transition, place) = (sources.slice(*place), format_location(sources, *place));
                let _ = writeln!(account.uncovered, "  `{transition}` never taken: {place}");
            }
        }
    }
}

impl CoverageReport {
    /// Adds the parts of a node or command that no test calls to the report, as not covered.
    fn uncalled(&mut self, declared: &CoveragePoints, sources: &SourceMap) {
        self.fragments.total += declared.fragments;
        self.branches.total += 2 * declared.choices.len();
        self.transitions.total += declared.transitions.len();
        let (what, place) = (&declared.label, format_location(sources, declared.span));
        let _ = writeln!(self.uncovered, "  never called: {what}: {place}");
    }
}

impl Count {
    fn add(&mut self, seen: bool) {
        self.total += 1;
        self.covered += usize::from(seen);
    }

    fn text(&self) -> String {
        format!("{} of {}", self.covered, self.total)
    }
}

fn format_location(sources: &SourceMap, place: Span) -> String {
    let (file, at) = (sources.name(place.file), sources.line_col(place));
    format!("{file}:{}:{}", at.line, at.col)
}

fn is_own(sources: &SourceMap, place: Span) -> bool {
    place.file == FileId(0) || !sources.name(place.file).starts_with("stdlib/")
}
