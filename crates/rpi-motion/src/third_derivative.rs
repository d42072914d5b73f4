//! Third derivatives of the joint positions at a node of a path.
//!
//! At the points of a spline they jump. A difference across such a point gives a mean of both sides, so that the larger
//! value would be missed. There, each side is taken from the piece on that side alone, which is continued beyond its end.

use crate::joint_path::JointPath;
use crate::path::{Kink, Path};
use crate::window::Window;
use crate::{Arm, Joints};

/// Returns the smallest and the largest third derivative of each joint near the centre of the window (rad/m³; rad/rad³ on a
/// joint line). They are equal except next to a point of a spline. `before` is the position along the path of the node
/// before the centre. Only the nearest point on either side counts, so that the work is bounded: 16 inverse kinematics.
pub(crate) fn extent(arm: &Arm, path: &JointPath, window: &Window, before: f64) -> [Joints; 2] {
    let [a, b, _, d, e, _] = &window.joints;
    let own = difference([a, b, d, e], window.spacing);
    let Path::Tool(tool) = &path.path else {
        return [own; 2];
    };
    let reach = 2.0 * window.spacing;
    let from = before.min(window.centre - reach);
    let behind = tool.kinks_between(from, window.centre).last();
    let ahead = tool
        .kinks_between(window.centre, window.centre + reach)
        .next();
    let sides = behind
        .into_iter()
        .chain(ahead)
        .flat_map(|kink| [kink.piece_before, kink.piece_before + 1].map(|piece| (kink, piece)));
    sides.fold([own; 2], |extent, side| {
        match beside(arm, path, side, window) {
            Some(side) => joined(extent, &side),
            // The continued piece leaves the reach of the arm, or its configuration: only the difference is known.
            None => extent,
        }
    })
}

/// Returns the third derivatives at a point of a spline on one piece; `None` if the continued piece cannot be reached.
fn beside(
    arm: &Arm,
    path: &JointPath,
    (kink, piece): (Kink, usize),
    window: &Window,
) -> Option<Joints> {
    let step = window.spacing;
    let at = |steps: f64| {
        let s = kink.s + steps * step;
        path.joints_on_piece(arm, piece, s, window.nearest(s))
    };
    let (a, b, d, e) = (at(-2.0)?, at(-1.0)?, at(1.0)?, at(2.0)?);
    Some(difference([&a, &b, &d, &e], step))
}

/// Returns the third derivative from the joint positions two steps and one step before and behind a place (central
/// difference of second order).
fn difference([a, b, d, e]: [&Joints; 4], step: f64) -> Joints {
    core::array::from_fn(|axis| {
        (-a[axis] + 2.0 * b[axis] - 2.0 * d[axis] + e[axis]) / (2.0 * step * step * step)
    })
}

fn joined([low, high]: [Joints; 2], side: &Joints) -> [Joints; 2] {
    [
        core::array::from_fn(|axis| low[axis].min(side[axis])),
        core::array::from_fn(|axis| high[axis].max(side[axis])),
    ]
}
