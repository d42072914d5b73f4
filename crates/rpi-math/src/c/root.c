/*# rpi_positive_cbrt */
/* Cube root of a positive normal number x = 8^q v, with v from 1 to 8. */
static inline double rpi_positive_cbrt(double x) {
  const int32_t exponent = rpi_biased_exponent(x);
  const double *row = rpi_cube_roots[exponent % 3];
  const double m = rpi_real((rpi_bits(x) & UINT64_C(0x000fffffffffffff)) | UINT64_C(0x3ff0000000000000));
  const double v = m * row[1];
  const double t = m - 1.0;
  const double estimate = row[0] * rpi_cubic(rpi_cbrt_terms[0], t, t * t);
  /* One step of the fourth order for 1 / cbrt v: e is the relative error of the cube. */
  const double e = 1.0 - v * (estimate * estimate * estimate);
  const double step = e * (1.0 / 3.0 + e * (2.0 / 9.0 + e * (14.0 / 81.0)));
  const double w = estimate + estimate * step;
  const double w_square = w * w;
  /* The root with 26 bits, whose square is exact, and a correction of the second order, where w is exact. */
  const double y = rpi_upper_half(v * w_square);
  const double y_square = y * y;
  const double square_upper = rpi_upper_half(y_square);
  const double rest = (v - square_upper * y) - (y_square - square_upper) * y;
  const double correction = rest * w_square * (1.0 / 3.0);
  const double root = y + (correction + correction * correction * w);
  return root * rpi_power_of_two(exponent / 3 - 341);
}
/*# rpi_cbrt */
static double rpi_cbrt(double x) {
  const double size = rpi_abs(x);
  if (x == 0.0 || rpi_is_infinite(x)) {
    return x;
  }
  if (rpi_is_nan(x)) {
    return rpi_nan();
  }
  return rpi_copy_sign(size < 0x1p-1022 ? rpi_positive_cbrt(size * 0x1p54) * 0x1p-18 : rpi_positive_cbrt(size), x);
}
/*# rpi_length */
/* Square root of the sum of two squares, where the first number is the greater one. */
static inline double rpi_length(double greater, double lesser) {
  const rpi_pair first = rpi_square(greater);
  const rpi_pair second = rpi_square(lesser);
  const rpi_pair sum = rpi_ordered_sum(first.high, second.high);
  return rpi_sqrt(sum.high + (sum.low + (first.low + second.low)));
}
/*# rpi_hypot */
static double rpi_hypot(double x, double y) {
  const bool ordered = rpi_abs(x) < rpi_abs(y);
  const double greater = ordered ? rpi_abs(y) : rpi_abs(x);
  const double lesser = ordered ? rpi_abs(x) : rpi_abs(y);
  const int32_t exponent = rpi_biased_exponent(greater);
  if (rpi_is_infinite(x) || rpi_is_infinite(y)) {
    return rpi_infinity();
  }
  if (rpi_is_nan(x) || rpi_is_nan(y)) {
    return rpi_nan();
  }
  if (lesser == 0.0 || exponent - rpi_biased_exponent(lesser) > 60) {
    return greater + lesser;
  }
  /* The scale keeps the squares and their rounding errors normal. */
  if (exponent > 1500) {
    return rpi_length(greater * 0x1p-600, lesser * 0x1p-600) * 0x1p600;
  }
  if (exponent < 600) {
    return rpi_length(greater * 0x1p600, lesser * 0x1p600) * 0x1p-600;
  }
  return rpi_length(greater, lesser);
}
