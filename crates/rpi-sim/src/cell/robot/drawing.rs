//! Drawing of a robot description as SVG: the chain from the side and from above.

use super::RobotDescription;
use core::fmt::Write;
use nalgebra::Vector3;
use rpi_kin::ArmModel;

/// Width and height of a view of the robot, in user units of the SVG.
const VIEW: f64 = 360.0;
/// Margin around a view of the robot, in user units of the SVG.
const MARGIN: f64 = 30.0;

/// Projection of a point (m, base frame) to the plane of a view (m).
type Projection = fn(&Vector3<f64>) -> [f64; 2];

/// Returns an SVG drawing with two views of the robot, x to the right: from the side (z up) and from above (y up). The
/// axes are in the middle of their ranges, at most a quarter turn from zero.
#[must_use]
pub fn drawing(description: &RobotDescription) -> String {
    let model = description.model;
    let points = chain_points(model);
    let views: [(&str, Projection); 2] = [
        ("from the side", |p| [p.x, p.z]),
        ("from above", |p| [p.x, p.y]),
    ];
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\" font-family=\"sans-serif\" font-size=\"12\">\n",
        2.0 * VIEW,
        VIEW + MARGIN
    );
    let _ = writeln!(svg, "<title>{}</title>", escaped(model.display_name));
    let _ = writeln!(svg, "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>");
    for (number, (title, flat)) in views.into_iter().enumerate() {
        let flat: Vec<[f64; 2]> = points.iter().map(flat).collect();
        let left = number as f64 * VIEW;
        svg += &view(&flat, left, title);
    }
    svg + "</svg>\n"
}

/// Returns the origins of the base, of all links and of the flange, in the base frame (m), for the drawn joint
/// positions.
fn chain_points(model: &ArmModel) -> Vec<Vector3<f64>> {
    let joints: Vec<f64> = model
        .limits
        .iter()
        .map(|axis| {
            let middle = (axis.position.lower + axis.position.upper) / 2.0;
            let bound = core::f64::consts::FRAC_PI_2;
            middle.clamp(-bound, bound)
        })
        .collect();
    let mut points = vec![Vector3::zeros()];
    let frames = model.chain.link_frames(&joints);
    points.extend(frames.map(|frame| frame.translation.vector));
    points.push(model.forward(&joints).translation.vector);
    points
}

/// Returns the SVG of one view: the chain as a line, with a circle at the base, each link and the flange. `points` are
/// in m; `left` is the left edge of the view in SVG units.
fn view(points: &[[f64; 2]], left: f64, title: &str) -> String {
    let bounds = |which: usize| {
        let values = points.iter().map(|point| point[which]);
        let (low, high) = (
            values.clone().fold(f64::INFINITY, f64::min),
            values.fold(f64::NEG_INFINITY, f64::max),
        );
        (low, high)
    };
    let [(x0, x1), (y0, y1)] = [bounds(0), bounds(1)];
    let size = (x1 - x0).max(y1 - y0).max(0.1);
    let scale = (VIEW - 2.0 * MARGIN) / size;
    let place = |point: &[f64; 2]| {
        let x = left + VIEW / 2.0 + scale * (point[0] - (x0 + x1) / 2.0);
        let y = VIEW / 2.0 - scale * (point[1] - (y0 + y1) / 2.0);
        (x, y)
    };
    let mut svg = String::new();
    let line: Vec<String> = points
        .iter()
        .map(place)
        .map(|(x, y)| format!("{x:.1},{y:.1}"))
        .collect();
    let line = line.join(" ");
    let _ = writeln!(
        svg,
        "<polyline points=\"{line}\" fill=\"none\" stroke=\"#1f77b4\" stroke-width=\"6\" stroke-linejoin=\"round\" stroke-linecap=\"round\"/>"
    );
    for (x, y) in points.iter().map(place) {
        let _ = writeln!(
            svg,
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4\" fill=\"white\" stroke=\"#222\"/>"
        );
    }
    let _ = writeln!(
        svg,
        "<text x=\"{:.1}\" y=\"{:.1}\">{title}, {size:.2} m</text>",
        left + MARGIN,
        VIEW + MARGIN / 3.0
    );
    svg
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}
