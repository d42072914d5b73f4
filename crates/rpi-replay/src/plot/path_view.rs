//! Projection of a path in space along an axis, with equal scales on both axes and one hue per command.

use super::axis::{Axis, padded, value_range};
use super::chart::PlotArea;
use super::frame::Frame;
use super::labels::Labels;
use super::palette::{BACKGROUND, SECONDARY_TEXT, TEXT, hue};
use super::simplify::simplify;
use super::svg::Svg;
use super::timeline::span_hues;
use super::{ExecutionSpan, SpacePath};

/// Direction from which the path of an arm's tool is drawn.
#[derive(Clone, Copy)]
pub(super) enum View {
    /// View from above: the x axis of the base to the right, the y axis up.
    Top,
    /// View from the side: the x axis of the base to the right, the z axis up.
    Side,
}

impl View {
    fn name(self) -> &'static str {
        match self {
            View::Top => "from above (x right, y up, m)",
            View::Side => "from the side (x right, z up, m)",
        }
    }

    fn project(self, [x, y, z]: [f64; 3]) -> (f64, f64) {
        match self {
            View::Top => (x, y),
            View::Side => (x, z),
        }
    }
}

/// Minimum width of the plotted range in metres. An arm at rest is then a dot instead of enlarged noise.
const LEAST_WIDTH: f64 = 0.02;

pub(super) fn draw(
    svg: &mut Svg,
    path: &SpacePath,
    view: View,
    place: PlotArea,
    spells: &[ExecutionSpan],
) {
    let points: Vec<(f64, (f64, f64))> = path
        .points
        .iter()
        .map(|(t, p)| (*t, view.project(*p)))
        .collect();
    let frame = equal_scale_frame(&points, place);
    frame.draw(svg, &format!("{}, {}", path.name, view.name()), "");
    let hues = span_hues(spells);
    let parts = split_by_command(&points, spells).into_iter();
    let lines = parts.map(|part| {
        let pixels: Vec<(f64, f64)> = part.iter().map(|(_, p)| frame.to_pixel(p.0, p.1)).collect();
        simplify(&pixels, 0.1)
    });
    let lines: Vec<Vec<(f64, f64)>> = lines.collect();
    for (k, line) in lines.iter().enumerate() {
        let name = spells.get(k).map_or("", |s| s.command.as_str());
        let color = hues.get(k).copied().unwrap_or(hue(0));
        svg.polyline(line, color, None, name);
    }
    draw_markers(svg, &points, spells, (&frame, &lines));
}

/// Returns a plot area for these points (time, and position in the plane in metres), with the same scale on both axes.
/// It fills the rectangle `place`.
fn equal_scale_frame(points: &[(f64, (f64, f64))], place: PlotArea) -> Frame {
    let x = padded(value_range(points.iter().map(|p| p.1.0), LEAST_WIDTH), 0.08);
    let y = padded(value_range(points.iter().map(|p| p.1.1), LEAST_WIDTH), 0.08);
    let (width, height) = (place.x.1 - place.x.0, place.y.1 - place.y.0);
    let scale = ((x.1 - x.0) / width).max((y.1 - y.0) / height);
    let widened = |(low, high): (f64, f64), pixels: f64| {
        let margin = (scale * pixels - (high - low)) / 2.0;
        (low - margin, high + margin)
    };
    Frame {
        x: Axis {
            values: widened(x, width),
            pixels: place.x,
        },
        y: Axis {
            values: widened(y, height),
            pixels: (place.y.1, place.y.0),
        },
    }
}

/// Splits the points of a path (time and position) by the command that ran at their time. `spells` are the execution
/// intervals of the commands. Each part begins with the last point of its predecessor, so that the path has no gap.
fn split_by_command<P: Copy>(points: &[(f64, P)], spells: &[ExecutionSpan]) -> Vec<Vec<(f64, P)>> {
    if spells.is_empty() {
        return vec![points.to_vec()];
    }
    let starts = spells
        .iter()
        .map(|s| points.partition_point(|p| p.0 < s.from));
    let starts: Vec<usize> = starts.collect();
    let ends = starts.iter().skip(1).copied().chain([points.len()]);
    let ranges = starts.iter().zip(ends);
    ranges
        .map(|(&from, to)| points[from.saturating_sub(1)..to.max(from)].to_vec())
        .collect()
}

/// Draws marks on a path at its start, at the takeovers between commands and at its end.
fn draw_markers(
    svg: &mut Svg,
    points: &[(f64, (f64, f64))],
    spells: &[ExecutionSpan],
    (frame, lines): (&Frame, &[Vec<(f64, f64)>]),
) {
    let (Some(first), Some(last)) = (points.first(), points.last()) else {
        return;
    };
    let pixel = |p: &(f64, (f64, f64))| frame.to_pixel(p.1.0, p.1.1);
    let takeover = |span: &ExecutionSpan| {
        let at = points.partition_point(|p| p.0 < span.from);
        (pixel(&points[at.min(points.len() - 1)]), span.from)
    };
    let takeovers: Vec<((f64, f64), f64)> = spells.iter().skip(1).map(takeover).collect();
    for ((at, _), color) in takeovers.iter().zip(span_hues(spells).into_iter().skip(1)) {
        svg.dot(*at, MARK, color, BACKGROUND);
    }
    let ends = [(pixel(first), "start"), (pixel(last), "end")];
    for (at, _) in ends {
        svg.dot(at, 4.5, TEXT, BACKGROUND);
    }
    let marks = takeovers.iter().map(|(at, _)| *at);
    let marks: Vec<(f64, f64)> = marks.chain(ends.map(|(at, _)| at)).collect();
    let mut labels = Labels::new(frame, lines, &marks, MARK + 1.0);
    for (at, name) in ends {
        labels.draw(svg, at, TEXT, name);
    }
    let mut labelled = Vec::new();
    for (at, time) in takeovers {
        // Cyclic programs have takeovers at the same points in every iteration.
        if is_new(&labelled, at) {
            labels.draw(svg, at, SECONDARY_TEXT, &format!("takeover {time:.3} s"));
            labelled.push(at);
        }
    }
}

/// Returns true if no takeover has a label that is so near to `at`, in pixels, that both would look like one.
fn is_new(labelled: &[(f64, f64)], at: (f64, f64)) -> bool {
    let apart = |other: &(f64, f64)| {
        let (dx, dy) = (other.0 - at.0, other.1 - at.1);
        dx * dx + dy * dy >= MARK * MARK
    };
    labelled.iter().all(apart)
}

/// Radius of the mark of a takeover, in pixels.
const MARK: f64 = 5.0;

#[cfg(test)]
mod tests {
    use super::*;

    fn span(from: f64, to: f64) -> ExecutionSpan {
        ExecutionSpan {
            from,
            to,
            ..ExecutionSpan::default()
        }
    }

    #[test]
    fn each_command_has_its_part_and_no_gap() {
        let points: Vec<(f64, u32)> = (0..6).map(|k| (f64::from(k), k)).collect();
        let parts = split_by_command(&points, &[span(0.0, 3.0), span(3.0, 6.0)]);
        assert_eq!(parts[0], points[0..3]);
        assert_eq!(parts[1], points[2..6]);
    }

    #[test]
    fn both_axes_have_one_scale() {
        let place = PlotArea {
            x: (0.0, 400.0),
            y: (0.0, 200.0),
        };
        let frame = equal_scale_frame(&[(0.0, (0.0, 0.0)), (1.0, (1.0, 1.0))], place);
        let per_pixel =
            |axis: Axis| ((axis.values.1 - axis.values.0) / (axis.pixels.1 - axis.pixels.0)).abs();
        assert!((per_pixel(frame.x) - per_pixel(frame.y)).abs() < 1e-12);
        assert!(frame.to_pixel(1.0, 1.0).1 > 0.0);
    }
}
