//! Plot area of a chart: heading, grid, tick labels.

use super::axis::Axis;
use super::palette::{AXIS, GRID, SECONDARY_TEXT, TEXT};
use super::svg::{Anchor, Svg, TextStyle};

/// Text style of chart headings.
pub(super) const HEADING: TextStyle = TextStyle {
    size: 13.0,
    color: TEXT,
    bold: true,
    anchor: Anchor::Start,
};

/// Text style of the numbers at the tick marks of an axis.
pub(super) const TICK_LABEL: TextStyle = TextStyle {
    size: 11.0,
    color: SECONDARY_TEXT,
    bold: false,
    anchor: Anchor::Middle,
};

/// Plot area of a chart with its horizontal and its vertical axis.
#[derive(Clone, Copy)]
pub(super) struct Frame {
    pub(super) x: Axis,
    pub(super) y: Axis,
}

/// Approximate distance of tick marks in pixels, on the horizontal and the vertical axis.
const SPACING: (f64, f64) = (90.0, 34.0);

impl Frame {
    pub(super) fn to_pixel(self, x: f64, y: f64) -> (f64, f64) {
        (self.x.to_pixel(x), self.y.to_pixel(y))
    }

    pub(super) fn left(&self) -> f64 {
        self.x.pixels.0
    }

    pub(super) fn right(&self) -> f64 {
        self.x.pixels.1
    }

    pub(super) fn bottom(&self) -> f64 {
        self.y.pixels.0
    }

    pub(super) fn top(&self) -> f64 {
        self.y.pixels.1
    }

    /// Draws the heading, the grid and the tick labels of the plot area. `x_title` is the label at the end of the
    /// horizontal axis.
    pub(super) fn draw(&self, svg: &mut Svg, heading: &str, x_title: &str) {
        let ticks = self.y.ticks(SPACING.1).into_iter();
        let rows: Vec<(f64, String)> = ticks
            .map(|tick| (tick, self.y.label(tick, SPACING.1)))
            .collect();
        self.draw_with_rows(svg, heading, x_title, &rows);
    }

    /// As [`draw`](Self::draw), with rows at these values of the vertical axis instead of its tick marks, in ascending order.
    /// The label of a row is left out if there is no room for it.
    pub(super) fn draw_with_rows(
        &self,
        svg: &mut Svg,
        heading: &str,
        x_title: &str,
        rows: &[(f64, String)],
    ) {
        svg.text((self.left(), self.top() - 10.0), HEADING, heading);
        self.draw_rows(svg, rows);
        self.draw_columns(svg, x_title);
        svg.line(
            (self.left(), self.bottom()),
            (self.right(), self.bottom()),
            AXIS,
            1.0,
        );
    }

    fn draw_rows(&self, svg: &mut Svg, rows: &[(f64, String)]) {
        let style = TextStyle {
            anchor: Anchor::End,
            ..TICK_LABEL
        };
        let mut lowest = f64::INFINITY;
        for (value, label) in rows {
            let y = self.y.to_pixel(*value);
            svg.line((self.left(), y), (self.right(), y), GRID, 1.0);
            if lowest - y >= TICK_LABEL.size {
                svg.text((self.left() - 8.0, y + 4.0), style, label);
                lowest = y;
            }
        }
    }

    fn draw_columns(&self, svg: &mut Svg, title: &str) {
        let below = self.bottom() + 17.0;
        for tick in self.x.ticks(SPACING.0) {
            let x = self.x.to_pixel(tick);
            svg.line((x, self.bottom()), (x, self.bottom() + 4.0), AXIS, 1.0);
            svg.text((x, below), TICK_LABEL, &self.x.label(tick, SPACING.0));
        }
        let style = TextStyle {
            anchor: Anchor::Start,
            ..TICK_LABEL
        };
        svg.text((self.right() + 8.0, below), style, title);
    }
}
