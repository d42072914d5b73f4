//! Means of rotations and curves over them.

use crate::flow::{Rotation, Vector};
use crate::geometry;
use crate::macros::primitive;
use crate::registry::Prim;
use crate::window::Window;
use nalgebra::Quaternion;
use rpi_image::SizeArgs;

pub(super) const ALL: &[Prim] = &[AVERAGE, BEZIER];

primitive! {
    /// Mean rotation of the last `Duration` seconds, rounded up to whole cycles; until then of what there is. The normalised
    /// sum of the quaternions, which is the mean where they lie close together (Gramkow, On averaging rotations, 2001).
    AVERAGE = "World::RotationAverage";
    in { inValue: Rotation; inReset: bool = Reset(Bool(false)) }
    param { Duration: f64 = Real(1.0) }
    out { outValue: Rotation }
    ring { window }
    presence strict work 40;
    full |cx, _, history, _, (value, reset): (Rotation, bool)| {
        let window = Window::<Quaternion<f64>>::of(*history);
        if reset {
            window.clear(cx.cells);
        }
        let last = window.newest(cx.cells);
        let value = if value.coords.dot(&last.coords) < 0.0 { -value.into_inner() } else { value.into_inner() };
        let sum = window.push(cx.cells, value);
        (geometry::from_quaternion(sum.i, sum.j, sum.k, sum.w),)
    }
}

primitive! {
    /// Cubic curve of rotations over 0 to 1: `inFrom` and `inTo` at its ends with the angular velocities (rad per unit, in
    /// coordinates of the turned frame) `inFromVel` and `inToVel`. De Casteljau's construction on great arcs (Shoemake,
    /// Animating rotation with quaternion curves, 1985).
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
    Window::<Quaternion<f64>>::cells(args.cycles(0))
}

/// De Casteljau's construction.
fn bezier(mut points: [Rotation; 4], t: f64) -> Rotation {
    for count in (1..points.len()).rev() {
        for k in 0..count {
            points[k] = geometry::slerp(points[k], points[k + 1], t);
        }
    }
    points[0]
}
