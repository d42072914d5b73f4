/*# rpi_reduce_by_parts */
/* Subtracts the multiple of pi / 32 in three parts (Cody and Waite, Software manual for the elementary functions, 1980). */
static inline rpi_angle rpi_reduce_by_parts(double x) {
  const double rounded = x * rpi_steps_per_unit + rpi_rounder;
  const double count = rounded - rpi_rounder;
  const rpi_pair first = rpi_ordered_sum(x - count * rpi_step_high, -(count * rpi_step_middle));
  rpi_angle angle;
  if (rpi_abs(first.high) < rpi_abs(count) * 0x1p-58) {
    return rpi_reduce_large(x);
  }
  angle.step = (uint32_t)(rpi_bits(rounded) & UINT64_C(0xffffffff));
  angle.rest = rpi_pair_of(first.high, first.low - count * rpi_step_low);
  return angle;
}
/*# rpi_reduce_far */
/* The reduction of an angle of at least 1024, of an infinity or of what is not a number. */
static rpi_angle rpi_reduce_far(double x) {
  rpi_angle angle;
  if (!rpi_is_finite(x)) {
    angle.step = 0U;
    angle.rest = rpi_pair_of(rpi_nan(), rpi_nan());
    return angle;
  }
  if (rpi_abs(x) >= 131072.0) {
    return rpi_reduce_large(x);
  }
  angle = rpi_reduce_by_parts(x);
  angle.rest = rpi_ordered_sum(angle.rest.high, angle.rest.low);
  return angle;
}
/*# rpi_reduce */
/* Reduces an angle to a multiple of pi / 32 and a remainder. */
static inline rpi_angle rpi_reduce(double x) {
  return rpi_abs(x) < 1024.0 ? rpi_reduce_by_parts(x) : rpi_reduce_far(x);
}
/*# rpi_remainder */
/* An angle as a multiple of pi / 32 and a remainder r: 26 bits of r, sin r without them, and cos r - 1. */
typedef struct {
  uint32_t step;
  double upper;
  double sine;
  double cosine;
} rpi_remainder;
/*# rpi_remainder_of */
static inline rpi_remainder rpi_remainder_of(double x) {
  const rpi_angle angle = rpi_reduce(x);
  const double high = angle.rest.high;
  const double low = angle.rest.low;
  const double square = high * high;
  rpi_remainder remainder;
  remainder.step = angle.step;
  remainder.upper = rpi_upper_half(high);
  remainder.sine =
      (high - remainder.upper) + (low + high * square * rpi_quadratic(rpi_sin_terms[0], square));
  remainder.cosine = square * (square * rpi_quadratic(rpi_cos_terms[0], square) - 0.5) - high * low;
  return remainder;
}
/*# rpi_sine_after */
/* Sine of the angle that is `steps` times pi / 32 further. */
static inline rpi_pair rpi_sine_after(const rpi_remainder *remainder, uint32_t steps) {
  const uint32_t step = remainder->step + steps;
  const double *sine = rpi_sines[step & 63U];
  const double *cosine = rpi_sines[(step + 16U) & 63U];
  const rpi_pair sum = rpi_ordered_sum(sine[0], cosine[0] * remainder->upper);
  const double products =
      (cosine[1] * remainder->upper + cosine[2] * remainder->sine) + sine[2] * remainder->cosine;
  return rpi_pair_of(sum.high, sum.low + (sine[1] + products));
}
/*# rpi_sin */
static double rpi_sin(double x) {
  rpi_remainder remainder;
  rpi_pair sine;
  if (rpi_abs(x) < 0x1p-27) {
    return x;
  }
  remainder = rpi_remainder_of(x);
  sine = rpi_sine_after(&remainder, 0U);
  return sine.high + sine.low;
}
/*# rpi_cos */
static double rpi_cos(double x) {
  rpi_remainder remainder;
  rpi_pair cosine;
  remainder = rpi_remainder_of(x);
  cosine = rpi_sine_after(&remainder, 16U);
  return cosine.high + cosine.low;
}
/*# rpi_sincos */
/* Sine and cosine, with the bits of rpi_sin and rpi_cos. */
static void rpi_sincos(double x, double *sine, double *cosine) {
  rpi_remainder remainder;
  rpi_pair pair;
  remainder = rpi_remainder_of(x);
  pair = rpi_sine_after(&remainder, 16U);
  *cosine = pair.high + pair.low;
  pair = rpi_sine_after(&remainder, 0U);
  *sine = rpi_abs(x) < 0x1p-27 ? x : pair.high + pair.low;
}
/*# rpi_tan */
static double rpi_tan(double x) {
  rpi_remainder remainder;
  rpi_pair sine;
  rpi_pair cosine;
  if (rpi_abs(x) < 0x1p-27) {
    return x;
  }
  remainder = rpi_remainder_of(x);
  sine = rpi_sine_after(&remainder, 0U);
  cosine = rpi_sine_after(&remainder, 16U);
  sine = rpi_quotient(sine, cosine);
  return sine.high + sine.low;
}
