//! Means and curves of rotations.

use crate::geometry;
use crate::macros::primitive;
use crate::moving_sum::Window;
use crate::registry::Prim;
use crate::value_types::{Rotation, Vector};
use nalgebra::Quaternion;
use rpi_image::SizeArgs;

pub(super) const ALL: &[Prim] = &[AVERAGE, BEZIER];

primitive! {
    /// Mean rotation of the last `Duration` seconds, rounded up to whole cycles; before that, the mean of the rotations
    /// so far. `inReset` restarts the window with the current rotation. The mean is the normalised sum of the
    /// quaternions, which approximates the mean of rotations that are close to each other (Gramkow, On averaging
    /// rotations, 2001).
    AVERAGE = "World::RotationAverage";
    in { inValue: Rotation; inReset: bool = Reset(Bool(false)) }
    param { Duration: f64 = Real(1.0) }
    out { outValue: Rotation }
    ring { window }
    presence strict work 40;
    full |cx, _, history, _, (value, reset): (Rotation, bool)| {
        let window = Window::<Quaternion<f64>>::from_region(*history);
        if reset {
            window.clear(cx.slots);
        }
        let last = window.newest(cx.slots);
        // The quaternions q and -q are one rotation; opposite signs in the sum would cancel.
        let value = if value.coords.dot(&last.coords) < 0.0 { -value.into_inner() } else { value.into_inner() };
        let sum = window.push(cx.slots, value);
        (geometry::from_quaternion(sum.i, sum.j, sum.k, sum.w),)
    }
}

primitive! {
    /// Cubic Bézier curve of rotations over the parameter `inValue` from 0 to 1, from `inFrom` to `inTo`. `inFromVel`
    /// and `inToVel` are the angular velocities at the ends, in rad per unit of the parameter and in coordinates of the
    /// rotated frame. Uses the construction of De Casteljau on great arcs (Shoemake, Animating rotation with quaternion
    /// curves, 1985).
    BEZIER = "World::RotationBezier";
    in { inValue: f64; inFrom: Rotation; inFromVel: Vector; inToVel: Vector; inTo: Rotation }
    out { outValue: Rotation }
    presence strict work 600;
    pure |(t, from, from_vel, to_vel, to): (f64, Rotation, Vector, Vector, Rotation)| {
        let second = from * geometry::exp(from_vel / 3.0);
        let third = to * geometry::exp(-to_vel / 3.0);
        (bezier([from, second, third, to], t),)
    }
}

fn window(args: &SizeArgs<'_>) -> u32 {
    Window::<Quaternion<f64>>::cells(args.cycles_of_param(0))
}

/// Evaluates a cubic Bézier curve of rotations with four control rotations at the parameter `t` (0 to 1), by the
/// construction of De Casteljau.
fn bezier(mut points: [Rotation; 4], t: f64) -> Rotation {
    for count in (1..points.len()).rev() {
        for k in 0..count {
            points[k] = geometry::slerp(points[k], points[k + 1], t);
        }
    }
    points[0]
}
