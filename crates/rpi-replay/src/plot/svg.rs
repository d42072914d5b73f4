//! SVG output: elements with attributes, short numbers, escaped texts.

use std::fmt::{Display, Write};

/// An SVG document under construction.
pub(super) struct Svg {
    out: String,
}

/// Alignment of a text relative to its position: the position is its start, middle or end.
#[derive(Clone, Copy)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

impl Anchor {
    fn name(self) -> &'static str {
        match self {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        }
    }
}

/// Size in pixels, colour, weight and alignment of a text.
#[derive(Clone, Copy)]
pub(super) struct TextStyle {
    pub(super) size: f64,
    pub(super) color: &'static str,
    pub(super) bold: bool,
    pub(super) anchor: Anchor,
}

impl Svg {
    pub(super) fn new(width: f64, height: f64, title: &str, paper: &str) -> Svg {
        let mut svg = Svg { out: String::new() };
        let size =
            format!("width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\"");
        svg.raw(format_args!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" {size} role=\"img\" font-family=\"Inter, 'Segoe UI', 'DejaVu Sans', sans-serif\">"
        ));
        svg.raw(format_args!("<title>{}</title>", escape(title)));
        svg.raw(format_args!(
            "<rect width=\"{width}\" height=\"{height}\" fill=\"{paper}\"/>"
        ));
        svg
    }

    pub(super) fn line(&mut self, from: (f64, f64), to: (f64, f64), color: &str, width: f64) {
        let [a, b, c, d] = [from.0, from.1, to.0, to.1].map(format_coordinate);
        self.raw(format_args!(
            "<line x1=\"{a}\" y1=\"{b}\" x2=\"{c}\" y2=\"{d}\" stroke=\"{color}\" stroke-width=\"{width}\"/>"
        ));
    }

    pub(super) fn dashed(&mut self, from: (f64, f64), to: (f64, f64), color: &str) {
        let [a, b, c, d] = [from.0, from.1, to.0, to.1].map(format_coordinate);
        self.raw(format_args!(
            "<line x1=\"{a}\" y1=\"{b}\" x2=\"{c}\" y2=\"{d}\" stroke=\"{color}\" stroke-width=\"1\" stroke-dasharray=\"3 3\"/>"
        ));
    }

    pub(super) fn rect(&mut self, at: (f64, f64), size: (f64, f64), radius: f64, fill: &str) {
        let [x, y, w, h] = [at.0, at.1, size.0, size.1].map(format_coordinate);
        self.raw(format_args!(
            "<rect x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\" rx=\"{radius}\" fill=\"{fill}\"/>"
        ));
    }

    pub(super) fn dot(&mut self, at: (f64, f64), radius: f64, fill: &str, ring: &str) {
        let [x, y] = [at.0, at.1].map(format_coordinate);
        self.raw(format_args!(
            "<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\" fill=\"{fill}\" stroke=\"{ring}\" stroke-width=\"2\"/>"
        ));
    }

    /// Draws a line through the points, in pixels. `dashes` is the dash pattern, `None` for a solid line; `name`
    /// becomes the title of the line for tooltips and screen readers.
    pub(super) fn polyline(
        &mut self,
        points: &[(f64, f64)],
        color: &str,
        dashes: Option<&str>,
        name: &str,
    ) {
        if points.is_empty() {
            return;
        }
        let mut d = String::new();
        for (k, (x, y)) in points.iter().enumerate() {
            let _ = write!(
                d,
                "{}{} {}",
                if k == 0 { 'M' } else { 'L' },
                format_coordinate(*x),
                format_coordinate(*y)
            );
        }
        let dashes = dashes
            .map(|d| format!(" stroke-dasharray=\"{d}\""))
            .unwrap_or_default();
        self.raw(format_args!(
            "<path d=\"{d}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"1.8\" stroke-linejoin=\"round\" stroke-linecap=\"round\"{dashes}><title>{}</title></path>",
            escape(name)
        ));
    }

    pub(super) fn text(&mut self, at: (f64, f64), style: TextStyle, text: &str) {
        let [x, y] = [at.0, at.1].map(format_coordinate);
        let weight = if style.bold {
            " font-weight=\"600\""
        } else {
            ""
        };
        self.raw(format_args!(
            "<text x=\"{x}\" y=\"{y}\" font-size=\"{}\" fill=\"{}\" text-anchor=\"{}\"{weight}>{}</text>",
            style.size,
            style.color,
            style.anchor.name(),
            escape(text)
        ));
    }

    pub(super) fn finish(mut self) -> String {
        self.out.push_str("</svg>\n");
        self.out
    }

    fn raw(&mut self, text: impl Display) {
        let _ = writeln!(self.out, "{text}");
    }
}

/// Formats a coordinate in pixels with at most two decimals.
fn format_coordinate(value: f64) -> String {
    let text = format!("{value:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" {
        "0".into()
    } else {
        text.into()
    }
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coordinates_are_short() {
        assert_eq!(
            [1.0, -0.001, 2.345, 100.0].map(format_coordinate),
            ["1", "0", "2.35", "100"]
        );
    }

    #[test]
    fn texts_cannot_break_out() {
        let mut svg = Svg::new(1.0, 1.0, "a<b>&", "#fff");
        svg.polyline(&[(0.0, 0.0)], "#000", None, "</svg>");
        assert_eq!(svg.finish().matches("</svg>").count(), 1);
    }
}
