//! Timeline of the commands: one bar each, on the same time axis as the charts below, and a legend for the commands whose
//! bars are too narrow for their names.

use std::collections::{BTreeMap, BTreeSet};

use super::ExecutionSpan;
use super::axis::Axis;
use super::palette::{SECONDARY_TEXT, TEXT, hue};
use super::svg::{Anchor, Svg, TextStyle};

const BAR: f64 = 7.0;
/// Height in pixels of the timeline's names, bars and the space around them.
const BARS_HEIGHT: f64 = 56.0;
/// Height in pixels of a row of the timeline's legend.
const ROW_HEIGHT: f64 = 18.0;
/// Maximum number of rows in the timeline's legend. A run may execute thousands of commands with different names.
const MAX_ROWS: usize = 5;

/// Returns the colour of each execution interval. All intervals of one command have the same colour.
pub(super) fn span_hues(spans: &[ExecutionSpan]) -> Vec<&'static str> {
    let numbers = command_numbers(spans);
    let of = |span: &ExecutionSpan| numbers.get(span.command.as_str()).copied();
    spans
        .iter()
        .map(|span| hue(of(span).unwrap_or(0)))
        .collect()
}

/// Returns for each command a number from 0, in the order in which the commands started first.
fn command_numbers(spans: &[ExecutionSpan]) -> BTreeMap<&str, usize> {
    let mut numbers = BTreeMap::new();
    for span in spans {
        let next = numbers.len();
        numbers.entry(span.command.as_str()).or_insert(next);
    }
    numbers
}

/// Returns the height of the timeline with its legend, in pixels. `x` is the time axis.
pub(super) fn height(spans: &[ExecutionSpan], x: Axis) -> f64 {
    let rows = legend(spans, x).last().map_or(0, |entry| entry.row + 1);
    BARS_HEIGHT + rows as f64 * ROW_HEIGHT
}

/// Draws one bar per execution interval at the vertical position `y` in pixels, with the names above the bars and the
/// legend below. `x` is the time axis.
pub(super) fn draw(svg: &mut Svg, spans: &[ExecutionSpan], x: Axis, y: f64) {
    for (span, color) in spans.iter().zip(span_hues(spans)) {
        let (from, to) = (x.to_pixel(span.from), x.to_pixel(span.to));
        // A gap of two pixels separates adjacent bars.
        svg.rect((from, y), ((to - from - 2.0).max(1.0), BAR), 2.0, color);
        draw_name(svg, span, (from, y - 7.0), to - from);
    }
    for entry in legend(spans, x) {
        let base = y + BAR + 20.0 + entry.row as f64 * ROW_HEIGHT;
        svg.rect((entry.x, base - BAR - 1.0), (BAR, BAR), 2.0, entry.color);
        svg.text((entry.x + BAR + 6.0, base), SOFT, &entry.text);
    }
}

/// Text style of secondary texts in the timeline: ends of commands and names in the legend.
const SOFT: TextStyle = TextStyle {
    size: 11.0,
    color: SECONDARY_TEXT,
    bold: false,
    anchor: Anchor::Start,
};

/// Returns the approximate width of a text in pixels.
fn width(text: &str) -> f64 {
    text.chars().count() as f64 * 7.8
}

/// Returns whether the name of a command fits above the bar of an execution interval.
fn fits(span: &ExecutionSpan, x: Axis) -> bool {
    width(&span.command) <= x.to_pixel(span.to) - x.to_pixel(span.from)
}

/// Entry of the timeline's legend: the colour and the name of a command, with its position.
struct LegendEntry {
    /// Row of the legend, from 0 at the top.
    row: usize,
    /// Left edge of the entry in pixels.
    x: f64,
    color: &'static str,
    text: String,
}

/// Returns the entries of the timeline's legend in rows from left to right. The legend is empty if each command has at
/// least one bar that is wide enough for its name.
fn legend(spans: &[ExecutionSpan], x: Axis) -> Vec<LegendEntry> {
    let numbers = command_numbers(spans);
    let named = spans.iter().filter(|span| fits(span, x));
    let named: BTreeSet<&str> = named.map(|span| span.command.as_str()).collect();
    let mut entries: Vec<LegendEntry> = Vec::new();
    if named.len() == numbers.len() {
        return entries;
    }
    let mut names: Vec<(usize, &str)> = numbers.into_iter().map(|(name, k)| (k, name)).collect();
    names.sort_unstable();
    let (mut row, mut left) = (0, x.pixels.0);
    for (k, name) in &names {
        let needed = BAR + 6.0 + width(name) + 16.0;
        if left > x.pixels.0 && left + needed > x.pixels.1 {
            (row, left) = (row + 1, x.pixels.0);
        }
        if row == MAX_ROWS {
            if let Some(last) = entries.last_mut() {
                last.text = format!("and {} more", names.len() - *k + 1);
            }
            break;
        }
        entries.push(LegendEntry {
            row,
            x: left,
            color: hue(*k),
            text: (*name).to_owned(),
        });
        left += needed;
    }
    entries
}

/// Draws the name of a command and how it ended above its bar, as far as they fit into `room` pixels.
fn draw_name(svg: &mut Svg, span: &ExecutionSpan, at: (f64, f64), room: f64) {
    let style = TextStyle {
        size: 12.0,
        color: TEXT,
        bold: true,
        anchor: Anchor::Start,
    };
    if width(&span.command) > room {
        return;
    }
    svg.text(at, style, &span.command);
    let end = format!("\u{2192} {}", span.end);
    if !span.end.is_empty() && width(&span.command) + width(&end) + 10.0 < room {
        svg.text((at.0 + width(&span.command) + 8.0, at.1), SOFT, &end);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const AXIS: Axis = Axis {
        values: (0.0, 10.0),
        pixels: (0.0, 800.0),
    };

    fn span(command: &str, from: f64, to: f64) -> ExecutionSpan {
        ExecutionSpan {
            command: command.into(),
            from,
            to,
            ..ExecutionSpan::default()
        }
    }

    #[test]
    fn a_command_has_one_colour() {
        let spans = [
            span("Out", 0.0, 1.0),
            span("Back", 1.0, 2.0),
            span("Out", 2.0, 3.0),
        ];
        let hues = span_hues(&spans);
        assert_eq!(hues[0], hues[2]);
        assert_ne!(hues[0], hues[1]);
    }

    #[test]
    fn a_legend_names_what_no_bar_can_name() {
        let wide = [span("Out", 0.0, 5.0), span("Out", 5.0, 5.1)];
        assert!(legend(&wide, AXIS).is_empty());
        let narrow = [span("Out", 0.0, 5.0), span("Back", 5.0, 5.1)];
        let names: Vec<String> = legend(&narrow, AXIS).into_iter().map(|e| e.text).collect();
        assert_eq!(names, ["Out", "Back"]);
        assert!(height(&narrow, AXIS) > height(&wide, AXIS));
    }

    #[test]
    fn a_legend_ends_after_its_last_row() {
        let spans: Vec<ExecutionSpan> = (0..500)
            .map(|k| {
                span(
                    &format!("Command{k}"),
                    f64::from(k) / 50.0,
                    f64::from(k + 1) / 50.0,
                )
            })
            .collect();
        let entries = legend(&spans, AXIS);
        assert!(
            entries
                .iter()
                .all(|entry| entry.row < MAX_ROWS && entry.x < 800.0)
        );
        let hidden = 500 - (entries.len() - 1);
        assert_eq!(entries.last().unwrap().text, format!("and {hidden} more"));
    }
}
