//! What the tests of a file have seen of it, all together, and how that is told.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use rpi_diag::{FileId, SourceMap, Span};
use rpi_host::testing::Coverage;

/// What was seen, by places in the text: what is instantiated several times counts once.
#[derive(Default)]
pub(crate) struct Seen {
    /// A path, and whether any instance was active.
    fragments: BTreeMap<Span, (String, bool)>,
    branches: BTreeMap<Span, [bool; 2]>,
    transitions: BTreeMap<Span, bool>,
}

impl Seen {
    /// Adds what one test has seen.
    pub(crate) fn add(&mut self, coverage: &Coverage) {
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

    /// A line that counts, and one for each thing that was not seen. What stands in the standard library is left out: that
    /// has tests of its own.
    pub(crate) fn text(mut self, sources: &SourceMap) -> String {
        self.fragments.retain(|place, _| is_own(sources, *place));
        self.branches.retain(|place, _| is_own(sources, *place));
        self.transitions.retain(|place, _| is_own(sources, *place));
        format!("coverage: {}\n{}", self.counts(), self.missing(sources))
    }

    fn counts(&self) -> String {
        let active = self.fragments.values().filter(|seen| seen.1).count();
        let ways = self.branches.values().flatten().filter(|way| **way).count();
        let taken = self.transitions.values().filter(|taken| **taken).count();
        format!(
            "{active} of {} fragments, {ways} of {} branches, {taken} of {} transitions",
            self.fragments.len(),
            2 * self.branches.len(),
            self.transitions.len()
        )
    }

    fn missing(&self, sources: &SourceMap) -> String {
        let mut text = String::new();
        for (path, _) in self.fragments.values().filter(|seen| !seen.1) {
            let _ = writeln!(text, "  never active: {path}");
        }
        for (place, ways) in &self.branches {
            for (_, branch) in [(ways[0], "else"), (ways[1], "then")]
                .iter()
                .filter(|(seen, _)| !seen)
            {
                let place = located(sources, *place);
                let _ = writeln!(text, "  `{branch}` never taken: {place}");
            }
        }
        for (place, _) in self.transitions.iter().filter(|(_, taken)| !**taken) {
            let (transition, place) = (sources.slice(*place), located(sources, *place));
            let _ = writeln!(text, "  `{transition}` never taken: {place}");
        }
        text
    }
}

fn located(sources: &SourceMap, place: Span) -> String {
    let (file, at) = (sources.name(place.file), sources.line_col(place));
    format!("{file}:{}:{}", at.line, at.col)
}

fn is_own(sources: &SourceMap, place: Span) -> bool {
    place.file == FileId(0) || !sources.name(place.file).starts_with("stdlib/")
}
