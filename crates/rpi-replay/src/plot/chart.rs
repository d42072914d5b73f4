//! Chart of values over time, with the name of each line at its end.

use super::axis::{Axis, padded, value_range};
use super::frame::{Frame, TICK_LABEL};
use super::palette::{AXIS, dashes, hue};
use super::simplify::simplify;
use super::svg::{Anchor, Svg, TextStyle};
use super::{Chart, ExecutionSpan, Line};

/// Rectangle on the page in which the lines of a chart are drawn, in pixels.
#[derive(Clone, Copy)]
pub(super) struct PlotArea {
    /// Left and right edge of the rectangle, in pixels from the left of the page.
    pub(super) x: (f64, f64),
    /// Upper and lower edge of the rectangle, in pixels from the top of the page.
    pub(super) y: (f64, f64),
}

/// Minimum vertical distance between two names of lines, in pixels.
const LABEL_HEIGHT: f64 = 13.0;

pub(super) fn draw(
    svg: &mut Svg,
    chart: &Chart,
    place: PlotArea,
    seconds: (f64, f64),
    spells: &[ExecutionSpan],
) {
    let lines: Vec<Vec<(f64, f64)>> = chart
        .lines
        .iter()
        .enumerate()
        .map(|(k, line)| placed(chart, k, line))
        .collect();
    let rows = level_rows(chart);
    let levels = rows.iter().map(|row| row.0);
    let values = lines.iter().flatten().map(|p| p.1).chain(levels);
    let frame = Frame {
        x: Axis {
            values: seconds,
            pixels: place.x,
        },
        y: Axis {
            values: padded(value_range(values, 1e-3), 0.06),
            pixels: (place.y.1, place.y.0),
        },
    };
    match rows.is_empty() {
        true => frame.draw(svg, &chart.title, "s"),
        false => frame.draw_with_rows(svg, &chart.title, "s", &rows),
    }
    for span in spells.iter().skip(1) {
        let x = frame.x.to_pixel(span.from);
        svg.dashed((x, frame.top()), (x, frame.bottom()), AXIS);
    }
    for (k, (line, points)) in chart.lines.iter().zip(&lines).enumerate() {
        let pixels: Vec<(f64, f64)> = points.iter().map(|p| frame.to_pixel(p.0, p.1)).collect();
        svg.polyline(&simplify(&pixels, 0.15), hue(k), dashes(k), &line.name);
    }
    draw_names(svg, chart, &lines, &frame);
}

/// Returns the points of the line with the index `k` on the vertical axis: in rows of its own if the values are named levels.
fn placed(chart: &Chart, k: usize, line: &Line) -> Vec<(f64, f64)> {
    let below = (k * chart.levels.len()) as f64;
    line.points.iter().map(|p| (p.0, below + p.1)).collect()
}

/// Returns the rows of a chart of named levels, from below: their places on the vertical axis and their names. Empty for numbers.
fn level_rows(chart: &Chart) -> Vec<(f64, String)> {
    let names = chart.lines.iter().flat_map(|_| &chart.levels);
    let rows = names.enumerate();
    rows.map(|(place, name)| (place as f64, name.clone()))
        .collect()
}

/// Draws the names of a chart's lines at its right edge, as near to the ends of the lines as possible.
fn draw_names(svg: &mut Svg, chart: &Chart, lines: &[Vec<(f64, f64)>], frame: &Frame) {
    let ends = lines.iter().enumerate();
    let mut ends: Vec<(f64, usize)> = ends
        .filter_map(|(k, points)| Some((frame.y.to_pixel(points.last()?.1), k)))
        .filter(|(y, _)| y.is_finite())
        .collect();
    // Lines that end at the same pixel keep their order.
    ends.sort_by(|a, b| a.0.round().total_cmp(&b.0.round()).then(a.1.cmp(&b.1)));
    let heights = spread_labels(
        ends.iter().map(|e| e.0).collect(),
        frame.top(),
        frame.bottom(),
    );
    for (y, (_, k)) in heights.into_iter().zip(ends) {
        svg.line(
            (frame.right() + 6.0, y),
            (frame.right() + 16.0, y),
            hue(k),
            3.0,
        );
        let style = TextStyle {
            anchor: Anchor::Start,
            ..TICK_LABEL
        };
        svg.text((frame.right() + 21.0, y + 4.0), style, &chart.lines[k].name);
    }
}

/// Moves vertical positions of names, in pixels and in ascending order, apart so that no names overlap, within the
/// range from `top` to `bottom` if they fit.
fn spread_labels(mut heights: Vec<f64>, top: f64, bottom: f64) -> Vec<f64> {
    let mut least = top;
    for height in &mut heights {
        *height = height.max(least);
        least = *height + LABEL_HEIGHT;
    }
    // The first pass may move names below the plot area. The second moves them up again, without a new overlap.
    let mut most = bottom;
    for height in heights.iter_mut().rev() {
        *height = height.min(most);
        most = *height - LABEL_HEIGHT;
    }
    heights
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two outputs: each has rows named `false` and `true`, and no line hides the other.
    #[test]
    fn truth_values_are_named_levels() {
        let line = |name: &str, values: [f64; 2]| Line {
            name: name.into(),
            points: vec![(0.0, values[0]), (1.0, values[1])],
        };
        let chart = Chart {
            title: "outputs".into(),
            lines: vec![line("output 0", [0.0, 1.0]), line("output 1", [1.0, 1.0])],
            levels: ["false", "true"].map(str::to_owned).to_vec(),
        };
        let rows = level_rows(&chart);
        let names = ["false", "true", "false", "true"];
        let expected: Vec<(f64, String)> = (0..4)
            .map(|k| (f64::from(k), names[k as usize].to_owned()))
            .collect();
        assert_eq!(rows, expected);
        assert_eq!(placed(&chart, 1, &chart.lines[1]), [(0.0, 3.0), (1.0, 3.0)]);
        let mut svg = Svg::new(400.0, 200.0, "outputs", "white");
        let place = PlotArea {
            x: (60.0, 300.0),
            y: (20.0, 180.0),
        };
        draw(&mut svg, &chart, place, (0.0, 1.0), &[]);
        let text = svg.finish();
        assert_eq!(text.matches(">false<").count(), 2, "{text}");
        assert_eq!(text.matches(">true<").count(), 2, "{text}");
        // No row has a number: only the times and the names of the lines have digits.
        assert!(!text.contains("text-anchor=\"end\">0"), "{text}");
    }

    #[test]
    fn names_that_would_overlap_move_apart_and_stay_inside() {
        assert_eq!(spread_labels(vec![10.0, 50.0], 0.0, 100.0), [10.0, 50.0]);
        assert_eq!(
            spread_labels(vec![98.0, 99.0, 100.0], 0.0, 100.0),
            [74.0, 87.0, 100.0]
        );
        assert_eq!(spread_labels(vec![0.0, 0.0], 0.0, 100.0), [0.0, 13.0]);
    }
}
