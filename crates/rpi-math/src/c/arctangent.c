/*# rpi_angle_of_ratio */
/* Arctangent of u / v for 0 <= u <= v. */
static inline rpi_pair rpi_angle_of_ratio(double u, double v) {
  const rpi_pair ratio = rpi_quotient(rpi_pair_of(u, 0.0), rpi_pair_of(v, 0.0));
  const double rounder = rpi_rounder / 64.0;
  const double rounded = ratio.high + rounder;
  /* Exact, with at most 26 bits. */
  const double d_high = ratio.high - (rounded - rounder);
  const double d = d_high + ratio.low;
  const double square = d * d;
  const uint32_t row = (uint32_t)(rpi_bits(rounded) & 127U);
  const double *angle = rpi_angles[row];
  const double *t = rpi_angle_terms[row];
  const double terms =
      (t[0] + t[1] * d) + square * ((t[2] + t[3] * d) + square * ((t[4] + t[5] * d) + square * t[6]));
  const rpi_pair sum = rpi_ordered_sum(angle[0], d_high);
  return rpi_pair_of(sum.high, sum.low + (angle[1] + (ratio.low + d * terms)));
}
/*# rpi_angle_of_point */
/* Angle of a point whose coordinates differ by less than 2^61, or 2^113 for subnormal numbers, and whose x is negative if
   it is on the `left`. */
static inline double rpi_angle_of_point(double size_y, double size_x, bool left) {
  /* Multiple of pi / 2 from which the angle of the ratio is measured, and its direction: for points with x > 0 next to
     the axis of x and of y, and the same with x < 0. */
  static const double octants[4][2] = {{0.0, 1.0}, {1.0, -1.0}, {2.0, -1.0}, {1.0, 1.0}};
  const bool is_steep = size_y > size_x;
  const rpi_pair angle = is_steep ? rpi_angle_of_ratio(size_x, size_y) : rpi_angle_of_ratio(size_y, size_x);
  const double *octant = octants[(left ? 2 : 0) + (is_steep ? 1 : 0)];
  const rpi_pair sum = rpi_ordered_sum(octant[0] * rpi_quarter_high, octant[1] * angle.high);
  return sum.high + (sum.low + (octant[0] * rpi_quarter_low + octant[1] * angle.low));
}
/*# rpi_atan */
static double rpi_atan(double x) {
  const double size = rpi_abs(x);
  if (size < 0x1p-27) {
    return x;
  }
  if (size <= 0x1p60) {
    return rpi_copy_sign(rpi_angle_of_point(size, 1.0, false), x);
  }
  return rpi_is_nan(x) ? rpi_nan() : rpi_copy_sign(rpi_quarter_high, x);
}
/*# rpi_near_axis */
/* Angle of a point next to the axis of x, where the cubic term is far below the rounding error. */
static inline double rpi_near_axis(double size_y, double x) {
  if ((rpi_bits(x) >> 63) != 0U) {
    return 2.0 * rpi_quarter_high;
  }
  return size_y == 0.0 ? 0.0 : size_y / x;
}
/*# rpi_special_angle */
/* Angle of a point with a coordinate that is not a number, infinite, 0, very large or small, or far less than the other. */
static double rpi_special_angle(double y, double x) {
  const double size_x = rpi_abs(x);
  const double size_y = rpi_abs(y);
  const int32_t difference = rpi_biased_exponent(y) - rpi_biased_exponent(x);
  double angle;
  if (rpi_is_nan(x) || rpi_is_nan(y)) {
    return rpi_nan();
  }
  if (size_x == size_y && rpi_is_infinite(x)) {
    angle = (x < 0.0 ? 3.0 : 1.0) * (0.5 * rpi_quarter_high);
  } else if (size_y == 0.0 || rpi_is_infinite(x) || difference < -60) {
    angle = rpi_near_axis(size_y, x);
  } else if (size_x == 0.0 || rpi_is_infinite(y) || difference > 60) {
    angle = rpi_quarter_high;
  } else {
    /* The scale keeps all products and their rounding errors normal. */
    const double factor = rpi_biased_exponent(y) < 500 ? 0x1p600 : 0x1p-600;
    angle = rpi_angle_of_point(size_y * factor, size_x * factor, x < 0.0);
  }
  return rpi_copy_sign(angle, y);
}
/*# rpi_atan2 */
static double rpi_atan2(double y, double x) {
  const int32_t exponent_y = rpi_biased_exponent(y);
  const int32_t difference = exponent_y - rpi_biased_exponent(x);
  if (difference >= -60 && difference <= 60 && exponent_y >= 500 && exponent_y < 1500) {
    return rpi_copy_sign(rpi_angle_of_point(rpi_abs(y), rpi_abs(x), x < 0.0), y);
  }
  return rpi_special_angle(y, x);
}
