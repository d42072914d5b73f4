//! Timeline of the commands: one bar each, on the same time axis as the charts below.

use super::ExecutionSpan;
use super::axis::Axis;
use super::palette::{SECONDARY_TEXT, TEXT, hue};
use super::svg::{Anchor, Svg, TextStyle};

const BAR: f64 = 7.0;

/// Draws one bar per command at height `y`, with the names above the bars.
pub(super) fn draw(svg: &mut Svg, spells: &[ExecutionSpan], x: Axis, y: f64) {
    for (k, span) in spells.iter().enumerate() {
        let (from, to) = (x.to_pixel(span.from), x.to_pixel(span.to));
        // A gap of two pixels separates adjacent bars.
        svg.rect((from, y), ((to - from - 2.0).max(1.0), BAR), 2.0, hue(k));
        draw_name(svg, span, (from, y - 7.0), to - from);
    }
}

/// Draws the name of a command and how it ended, as far as they fit above its bar.
fn draw_name(svg: &mut Svg, span: &ExecutionSpan, at: (f64, f64), room: f64) {
    let width = |text: &str| text.chars().count() as f64 * 7.8;
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
        let soft = TextStyle {
            size: 11.0,
            color: SECONDARY_TEXT,
            bold: false,
            anchor: Anchor::Start,
        };
        svg.text((at.0 + width(&span.command) + 8.0, at.1), soft, &end);
    }
}
