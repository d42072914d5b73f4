//! Page layout: title, paths, timeline and charts from top to bottom.

use super::axis::Axis;
use super::chart::{self, PlotArea};
use super::palette::{BACKGROUND, TEXT};
use super::path_view::{self, View};
use super::svg::{Anchor, Svg, TextStyle};
use super::{Plot, timeline};

const WIDTH: f64 = 980.0;
const LEFT: f64 = 68.0;
const RIGHT: f64 = 120.0;
const HEAD: f64 = 56.0;
const VIEW_HEIGHT: f64 = 270.0;
const VIEW_GAP: f64 = 70.0;
const CHART_HEIGHT: f64 = 170.0;
/// Total height above and below a plot area for its heading and tick labels, in pixels.
const AREA_MARGIN: f64 = 62.0;

/// Returns the text of an SVG file that shows a plot.
#[must_use]
pub fn render_svg(picture: &Plot) -> String {
    let mut svg = Svg::new(WIDTH, page_height(picture), &picture.title, BACKGROUND);
    let style = TextStyle {
        size: 18.0,
        color: TEXT,
        bold: true,
        anchor: Anchor::Start,
    };
    svg.text((LEFT, 34.0), style, &picture.title);
    let y = draw_paths(&mut svg, picture, HEAD);
    let y = draw_timeline(&mut svg, picture, y);
    draw_charts(&mut svg, picture, y);
    svg.finish()
}

fn page_height(picture: &Plot) -> f64 {
    let views = picture.paths.len() as f64 * (VIEW_HEIGHT + AREA_MARGIN);
    let bars = timeline_height(picture);
    let charts = picture.charts.len() as f64 * (CHART_HEIGHT + AREA_MARGIN);
    HEAD + views + bars + charts
}

fn draw_paths(svg: &mut Svg, picture: &Plot, mut y: f64) -> f64 {
    let width = (WIDTH - LEFT - VIEW_GAP - 30.0) / 2.0;
    for path in &picture.paths {
        let rows = (y + 30.0, y + 30.0 + VIEW_HEIGHT);
        for (view, left) in [(View::Top, LEFT), (View::Side, LEFT + width + VIEW_GAP)] {
            let place = PlotArea {
                x: (left, left + width),
                y: rows,
            };
            path_view::draw(svg, path, view, place, &picture.spans);
        }
        y += VIEW_HEIGHT + AREA_MARGIN;
    }
    y
}

fn draw_timeline(svg: &mut Svg, picture: &Plot, y: f64) -> f64 {
    if picture.spans.is_empty() {
        return y;
    }
    timeline::draw(svg, &picture.spans, time_axis(picture), y + 30.0);
    y + timeline_height(picture)
}

/// Returns the height of the timeline in pixels; 0 without commands.
fn timeline_height(picture: &Plot) -> f64 {
    match &picture.spans[..] {
        [] => 0.0,
        spans => timeline::height(spans, time_axis(picture)),
    }
}

/// Returns the common horizontal axis of the timeline and of all charts, in seconds.
fn time_axis(picture: &Plot) -> Axis {
    Axis {
        values: time_range(picture),
        pixels: (LEFT, WIDTH - RIGHT),
    }
}

fn draw_charts(svg: &mut Svg, picture: &Plot, mut y: f64) {
    for one in &picture.charts {
        let place = PlotArea {
            x: (LEFT, WIDTH - RIGHT),
            y: (y + 30.0, y + 30.0 + CHART_HEIGHT),
        };
        chart::draw(svg, one, place, time_range(picture), &picture.spans);
        y += CHART_HEIGHT + AREA_MARGIN;
    }
}

/// Returns the range of times in the plot, from 0 to the end of the longest line or command, in seconds.
fn time_range(picture: &Plot) -> (f64, f64) {
    let lines = picture.charts.iter().flat_map(|c| &c.lines);
    let ends = lines.filter_map(|l| Some(l.points.last()?.0));
    let ends = ends.chain(picture.spans.iter().map(|s| s.to));
    (0.0, ends.fold(1e-3, f64::max))
}

#[cfg(test)]
mod tests {
    use super::super::{Chart, ExecutionSpan, Line, SpacePath};
    use super::*;

    fn span(command: &str, from: f64, to: f64) -> ExecutionSpan {
        ExecutionSpan {
            command: command.into(),
            from,
            to,
            end: "done".into(),
        }
    }

    fn picture() -> Plot {
        let times = (0..200).map(|k| f64::from(k) / 100.0);
        let line = |name: &str, f: f64| Line {
            name: name.into(),
            points: times.clone().map(|t| (t, f * t * (2.0 - t))).collect(),
        };
        Plot {
            title: "two commands".into(),
            paths: vec![SpacePath {
                name: "arm".into(),
                points: times.clone().map(|t| (t, [t, t * t, 0.5])).collect(),
            }],
            charts: vec![Chart {
                title: "joints, deg".into(),
                lines: vec![line("joint 1", 1.0), line("joint 2", -2.0)],
                levels: Vec::new(),
            }],
            spans: vec![span("First", 0.0, 1.2), span("Second", 1.2, 2.0)],
        }
    }

    #[test]
    fn everything_named_is_in_the_picture() {
        let svg = render_svg(&picture());
        for name in [
            "two commands",
            "joints, deg",
            "joint 1",
            "joint 2",
            "First",
            "Second",
            "takeover 1.200 s",
            "from above",
        ] {
            assert!(svg.contains(name), "{name} is missing");
        }
        assert!(!svg.contains("NaN") && !svg.contains("inf\""));
    }

    #[test]
    fn an_empty_picture_is_still_a_picture() {
        let svg = render_svg(&Plot::default());
        assert!(svg.starts_with("<svg") && svg.ends_with("</svg>\n"));
        assert!(!svg.contains("NaN"));
    }

    #[test]
    fn a_resting_arm_and_a_constant_can_be_drawn() {
        let mut still = picture();
        still.paths[0]
            .points
            .iter_mut()
            .for_each(|p| p.1 = [0.5; 3]);
        still.charts[0].lines[0]
            .points
            .iter_mut()
            .for_each(|p| p.1 = 3.0);
        assert!(!render_svg(&still).contains("NaN"));
    }
}
