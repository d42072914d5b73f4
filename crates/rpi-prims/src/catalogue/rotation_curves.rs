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
    c Code(r"
const size_t capacity = (ring_len - 10U) / 4U;
const uint64_t *newest;
double value[4];
double sum[4];
double dot;
int32_t k;
if (inReset) {
  rpi_clear(ring, ring_len);
}
newest = ring + 10U + (rpi_index(ring[0]) % capacity + capacity - 1U) % capacity * 4U;
/* The quaternions q and -q are one rotation; opposite signs in the sum would cancel. */
dot = (inValue[0] * rpi_real(newest[0]) + inValue[2] * rpi_real(newest[2])) +
      (inValue[1] * rpi_real(newest[1]) + inValue[3] * rpi_real(newest[3]));
for (k = 0; k < 4; k += 1) {
  value[k] = dot < 0.0 ? -inValue[k] : inValue[k];
}
rpi_window_push(ring, ring_len, 4U, value, sum);
rpi_from_quaternion(sum[0], sum[1], sum[2], sum[3], outValue);
");
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
    c Code(r"
double points[4][4];
double vector[3];
double turn[4];
int32_t count;
int32_t k;
memcpy(points[0], inFrom, sizeof points[0]);
rpi_divided(inFromVel, 3.0, 3, vector);
rpi_from_axis(vector, turn);
rpi_compose(inFrom, turn, points[1]);
rpi_negation(inToVel, 3, vector);
rpi_divided(vector, 3.0, 3, vector);
rpi_from_axis(vector, turn);
rpi_compose(inTo, turn, points[2]);
memcpy(points[3], inTo, sizeof points[3]);
for (count = 3; count > 0; count -= 1) {
  for (k = 0; k < count; k += 1) {
    rpi_interpolate_rotation(points[k], points[k + 1], inValue, points[k]);
  }
}
memcpy(outValue, points[0], sizeof points[0]);
");
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
