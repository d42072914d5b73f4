//! Separation of overlapping labels.
//!
//! miette draws all marks of a source line in one row. Of two overlapping marks it would draw the inner one after the
//! outer, under the wrong text. The outer mark is therefore reduced to its longest part that no inner mark covers.

use std::ops::Range;

/// Label of a diagnostic, prepared for drawing: the marked range and the text of the label.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Mark {
    /// Marked range, as addresses in the joined text of all files of the diagnostic
    /// ([`DiagnosticSources`](crate::source_code::DiagnosticSources)).
    pub(crate) range: Range<usize>,
    /// Text of the label; may be empty.
    pub(crate) text: String,
    /// True if the label marks the error itself, false if it marks a related location.
    pub(crate) primary: bool,
}

/// Merges labels of equal ranges, and shrinks outer labels so that labels do not overlap where that is possible. `text`
/// returns the source text of a range.
pub(crate) fn separate_labels<'t>(
    marks: Vec<Mark>,
    text: impl Fn(Range<usize>) -> &'t str,
) -> Vec<Mark> {
    let marks = merge_equal_ranges(marks);
    let ranges: Vec<Range<usize>> = marks.iter().map(|mark| mark.range.clone()).collect();
    let mut marks = marks;
    for mark in &mut marks {
        let whole = text(mark.range.clone());
        match whole.split_once('\n') {
            None => mark.range = longest_uncovered_part(&mark.range, &ranges, &text),
            Some((first, _)) if shares_last_line(&mark.range, whole, &ranges) => {
                mark.range.end = mark.range.start + first.trim_end().len();
            }
            Some(_) => {}
        }
    }
    marks
}

/// Returns whether another label marks a range in the last line of a label of several lines, where the text of that
/// label is drawn. `range` and `text` are those of the label, `ranges` those of all labels.
fn shares_last_line(range: &Range<usize>, text: &str, ranges: &[Range<usize>]) -> bool {
    let last = range.start + text.rfind('\n').map_or(0, |at| at + 1);
    let mut others = ranges.iter().filter(|other| *other != range);
    others.any(|other| last < other.end && other.start < range.end && last <= other.start)
}

/// Merges labels of the same range into one label, whose text joins their texts with `; `.
fn merge_equal_ranges(marks: Vec<Mark>) -> Vec<Mark> {
    let mut all: Vec<Mark> = Vec::with_capacity(marks.len());
    for mark in marks {
        match all.iter_mut().find(|known| known.range == mark.range) {
            Some(known) if known.text.is_empty() => known.text = mark.text,
            Some(known) if !mark.text.is_empty() && !contains_text(&known.text, &mark.text) => {
                known.text.push_str("; ");
                known.text.push_str(&mark.text);
            }
            Some(_) => {}
            None => all.push(mark),
        }
    }
    all
}

/// Returns whether the text of a merged label (texts joined with `; `) already contains `text`.
fn contains_text(label: &str, text: &str) -> bool {
    label.split("; ").any(|output| output == text) || label == text
}

/// Returns the longest non-blank part of `whole` that none of the `ranges` within it covers, or `whole` if there is no
/// such part.
fn longest_uncovered_part<'t>(
    whole: &Range<usize>,
    ranges: &[Range<usize>],
    text: impl Fn(Range<usize>) -> &'t str,
) -> Range<usize> {
    let is_inside = |r: &&Range<usize>| {
        r.len() < whole.len() && !r.is_empty() && whole.start <= r.start && r.end <= whole.end
    };
    let mut inside: Vec<&Range<usize>> = ranges.iter().filter(is_inside).collect();
    inside.sort_by_key(|range| range.start);
    let mut parts = Vec::with_capacity(inside.len() + 1);
    let mut from = whole.start;
    for range in inside {
        parts.push(from..range.start.max(from));
        from = from.max(range.end);
    }
    parts.push(from..whole.end);
    // Brackets and commas next to an inner range belong to it visually.
    let trimmed = parts.into_iter().map(|part| {
        let held = text(part.clone());
        let rest = held.trim_start_matches([' ', ')', ']', ',']);
        let start = part.start + held.len() - rest.len();
        start..start + rest.trim_end_matches([' ', '(', '[', ',']).len()
    });
    // `max_by_key` returns the last maximum, so the order is reversed to get the first.
    let longest = trimmed.rev().max_by_key(|part| part.len());
    longest
        .filter(|part| !part.is_empty())
        .unwrap_or(whole.clone())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawn(text: &'static str, ranges: &[(Range<usize>, &str)]) -> Vec<(&'static str, String)> {
        let marks = ranges.iter().map(|(range, output)| Mark {
            range: range.clone(),
            text: (*output).to_owned(),
            primary: false,
        });
        let marks = separate_labels(marks.collect(), |range| &text[range]);
        let drawn = marks.into_iter();
        drawn.map(|mark| (&text[mark.range], mark.text)).collect()
    }

    #[test]
    fn the_outer_one_takes_what_the_inner_leaves() {
        let own = |text: &str| text.to_owned();
        assert_eq!(
            drawn("Before(y)", &[(0..9, "reads"), (7..8, "read")]),
            [("Before", own("reads")), ("y", own("read"))]
        );
        assert_eq!(
            drawn("(x when c) + all", &[(0..16, "whole"), (1..9, "part")]),
            [("+ all", own("whole")), ("x when c", own("part"))]
        );
        assert_eq!(
            drawn("a + b", &[(0..5, "whole"), (0..1, "a"), (4..5, "b")]),
            [("+", own("whole")), ("a", own("a")), ("b", own("b"))]
        );
    }

    #[test]
    fn those_of_one_place_are_one() {
        let both = drawn("n + 1", &[(0..1, "runs"), (0..1, "needed"), (0..1, "runs")]);
        assert_eq!(both, [("n", "runs; needed".to_owned())]);
    }

    #[test]
    fn those_that_only_touch_stay_and_of_several_lines_the_first_does() {
        let touching = drawn("ab", &[(0..1, ""), (1..2, "")]);
        assert_eq!(touching, [("a", String::new()), ("b", String::new())]);
        let lines = drawn("a\nb", &[(0..3, ""), (2..3, "")]);
        assert_eq!(lines, [("a", String::new()), ("b", String::new())]);
        let apart = drawn("a\nb\nc", &[(0..5, ""), (2..3, "")]);
        assert_eq!(apart, [("a\nb\nc", String::new()), ("b", String::new())]);
        let covered = drawn("ab", &[(0..2, ""), (0..1, ""), (1..2, "")]);
        assert_eq!(covered[0].0, "ab");
    }
}
