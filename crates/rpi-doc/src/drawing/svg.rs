//! SVG output. The colours come from the style sheet of the page.

use std::fmt::Write as _;

use super::layout::{BoxLayout, LineLayout, SceneLayout, lay_out};
use super::scene::{Drawing, Link, Role, SceneId, Shape};
use crate::html::escape;

/// Empty space on all four sides of the drawing, in SVG units.
const MARGIN: f64 = 14.0;

/// Returns a drawing as an SVG element with a legend. `id` is the prefix of all HTML ids in it, and `title` its
/// accessible title.
pub(super) fn svg(drawing: &Drawing, id: &str, title: &str) -> String {
    let laid = lay_out(drawing, 0);
    let (width, height) = (laid.width + 2.0 * MARGIN, laid.height + 2.0 * MARGIN);
    let (id, title) = (escape(id), escape(title));
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width:.0}\" height=\"{height:.0}\" viewBox=\"0 0 {width:.0} {height:.0}\" \
         role=\"group\" aria-labelledby=\"{id}-title\">\n<title id=\"{id}-title\">{title}</title>\n\
         <defs><marker id=\"{id}-arrow\" viewBox=\"0 0 8 8\" refX=\"7\" refY=\"4\" markerWidth=\"7\" markerHeight=\"7\" orient=\"auto\">\
         <path class=\"head\" d=\"M0 0.5L7.5 4L0 7.5Z\"/></marker></defs>\n"
    );
    Picture {
        drawing,
        id: &id,
        out: &mut out,
    }
    .scene(0, &laid, (MARGIN, MARGIN));
    out.push_str("</svg>\n");
    out.push_str(&legend(drawing));
    out
}

/// Returns the legend of the line styles that occur in the drawing, in HTML; empty if all lines are plain.
fn legend(drawing: &Drawing) -> String {
    let links = || drawing.scenes.iter().flat_map(|scene| &scene.links);
    let lines = || links().filter(|link| link.label.is_empty());
    let mut words = Vec::new();
    if lines().any(|link| link.optional) {
        words.push("<span class=\"optional\">dashed</span>: may be absent");
    }
    if lines().any(|link| link.delayed) {
        words.push("<span class=\"delayed\">coloured</span>: read one cycle late");
    }
    match words.is_empty() {
        true => String::new(),
        false => format!("<p class=\"legend\">{}</p>\n", words.join("; ")),
    }
}

struct Picture<'p> {
    drawing: &'p Drawing,
    id: &'p str,
    out: &'p mut String,
}

impl Picture<'_> {
    fn scene(&mut self, scene: SceneId, laid: &SceneLayout, at: (f64, f64)) {
        let this = &self.drawing.scenes[scene];
        let _ = writeln!(
            self.out,
            "<g transform=\"translate({:.0} {:.0})\">",
            at.0, at.1
        );
        for (shape, place) in this.shapes.iter().zip(&laid.boxes) {
            self.shape(shape, place);
        }
        for (link, line) in this.links.iter().zip(&laid.lines) {
            self.line(scene, link, line);
        }
        self.out.push_str("</g>\n");
    }

    /// Draws the line and the label of a link between two boxes.
    fn line(&mut self, scene: SceneId, link: &Link, line: &LineLayout) {
        let _ = writeln!(
            self.out,
            "<path class=\"{}\" d=\"{}\"{}/>",
            classes(link),
            line.path,
            self.arrow(scene, link),
        );
        if !link.label.is_empty() {
            let (x, y) = line.label;
            let text = escape(&link.label);
            let _ = writeln!(
                self.out,
                "<text class=\"label\" x=\"{x:.0}\" y=\"{y:.0}\">{text}</text>"
            );
        }
    }

    /// Returns the SVG attribute for the arrow head of a line; empty for a line that ends at a port, because it
    /// continues on the other side.
    fn arrow(&self, scene: SceneId, link: &Link) -> String {
        let shape = &self.drawing.scenes[scene].shapes[link.to.shape];
        match shape.role == Role::Output || link.to.port.is_some() {
            true => String::new(),
            false => format!(" marker-end=\"url(#{}-arrow)\"", self.id),
        }
    }

    fn shape(&mut self, shape: &Shape, place: &BoxLayout) {
        let BoxLayout {
            x,
            y,
            width,
            height,
            ..
        } = place;
        let round = match shape.role {
            Role::Input | Role::Output | Role::Dot => height / 2.0,
            _ => 5.0,
        };
        let _ = writeln!(self.out, "<g class=\"{}\">", shape.role.class());
        if !shape.tooltip.is_empty() {
            let _ = writeln!(self.out, "<title>{}</title>", escape(&shape.tooltip));
        }
        let _ = writeln!(
            self.out,
            "<rect x=\"{x:.0}\" y=\"{y:.0}\" width=\"{width:.0}\" height=\"{height:.0}\" rx=\"{round:.0}\"/>"
        );
        self.words(shape, place);
        self.out.push_str("</g>\n");
        if let (Some(inner), Some(laid)) = (shape.inner, &place.inner) {
            let corner = (x + super::layout::PAD, y + super::layout::HEAD);
            self.scene(inner, laid, corner);
        }
    }

    fn words(&mut self, shape: &Shape, place: &BoxLayout) {
        let (x, y) = (place.x + 10.0, place.y + 16.0);
        let title = format!(
            "<text class=\"title\" x=\"{x:.0}\" y=\"{y:.0}\">{}</text>",
            escape(&shape.title)
        );
        let title = match &shape.href {
            Some(href) => format!("<a href=\"{}\">{title}</a>", escape(href)),
            None => title,
        };
        let _ = writeln!(self.out, "{title}");
        if !shape.detail.is_empty() {
            let (y, text) = (y + 16.0, escape(&shape.detail));
            let _ = writeln!(
                self.out,
                "<text class=\"detail\" x=\"{x:.0}\" y=\"{y:.0}\">{text}</text>"
            );
        }
    }
}

fn classes(link: &Link) -> String {
    let mut classes = vec!["line"];
    if link.optional {
        classes.push("optional");
    }
    if link.delayed && link.label.is_empty() {
        classes.push("delayed");
    }
    classes.join(" ")
}
