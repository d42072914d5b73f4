//! Set of spans that answers in logarithmic time whether one of them contains a given span.
//!
//! A linear search for each diagnostic would make a program with many clock errors take quadratic time.

use rpi_diag::Span;
use std::collections::BTreeSet;

/// Set of spans in the source text, for tests whether a location is within one of them.
pub(super) struct SpanSet {
    /// Spans in ascending order of their starts. The end of each span is replaced by the greatest end of all spans up
    /// to it in the file.
    spans: Vec<Span>,
}

impl SpanSet {
    pub(super) fn new(places: &BTreeSet<Span>) -> Self {
        let mut spans: Vec<Span> = places.iter().copied().collect();
        for k in 1..spans.len() {
            if spans[k].file == spans[k - 1].file {
                spans[k].end = spans[k].end.max(spans[k - 1].end);
            }
        }
        SpanSet { spans }
    }

    /// Whether `place` lies within one of the spans.
    pub(super) fn contains(&self, place: Span) -> bool {
        let starts = |span: &Span| (span.file, span.start) <= (place.file, place.start);
        let before = self.spans.partition_point(starts);
        let last = self.spans[..before].last();
        last.is_some_and(|span| span.file == place.file && span.end >= place.end)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rpi_diag::FileId;

    fn span(file: u32, start: u32, end: u32) -> Span {
        let file = FileId(file);
        Span { file, start, end }
    }

    #[test]
    fn what_lies_in_one_of_them_is_covered() {
        let places = [span(0, 2, 20), span(0, 4, 6), span(1, 0, 5)].into();
        let covered = SpanSet::new(&places);
        for inside in [span(0, 2, 20), span(0, 8, 9), span(1, 3, 5)] {
            assert!(covered.contains(inside), "{inside:?}");
        }
        for beside in [span(0, 1, 3), span(0, 19, 21), span(1, 4, 6), span(2, 0, 1)] {
            assert!(!covered.contains(beside), "{beside:?}");
        }
    }
}
