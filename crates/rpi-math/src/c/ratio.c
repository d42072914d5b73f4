/*# rpi_asin_excess */
/* (asin x - x) / x of z = x^2, up to 1/4. */
static inline double rpi_asin_excess(double z) {
  const double square = z * z;
  const double fourth = square * square;
  const double upper = rpi_cubic(rpi_asin_terms[2], z, square) + fourth * rpi_cubic(rpi_asin_terms[3], z, square);
  return z * ((rpi_cubic(rpi_asin_terms[0], z, square) + fourth * rpi_cubic(rpi_asin_terms[1], z, square)) +
              fourth * fourth * upper);
}
/*# rpi_half_arccosine */
/* Half of the arccosine of x from 1/2 to 1. */
static inline rpi_pair rpi_half_arccosine(double x) {
  const double z = (1.0 - x) * 0.5;
  const rpi_pair root = rpi_root(rpi_pair_of(z, 0.0));
  return rpi_pair_of(root.high, root.low + root.high * rpi_asin_excess(z));
}
/*# rpi_asin */
static double rpi_asin(double x) {
  const double size = rpi_abs(x);
  if (size < 0x1p-27) {
    return x;
  }
  if (size <= 0.5) {
    return x + x * rpi_asin_excess(x * x);
  }
  if (size < 1.0) {
    const rpi_pair half = rpi_half_arccosine(size);
    const rpi_pair sum = rpi_ordered_sum(rpi_quarter_high, -2.0 * half.high);
    return rpi_copy_sign(sum.high + (sum.low + (rpi_quarter_low - 2.0 * half.low)), x);
  }
  return size == 1.0 ? rpi_copy_sign(rpi_quarter_high, x) : rpi_nan();
}
/*# rpi_acos */
static double rpi_acos(double x) {
  const double size = rpi_abs(x);
  if (size <= 0.5) {
    const rpi_pair sum = rpi_ordered_sum(rpi_quarter_high, -x);
    return sum.high + (sum.low + (rpi_quarter_low - x * rpi_asin_excess(x * x)));
  }
  if (size < 1.0) {
    const rpi_pair half = rpi_half_arccosine(size);
    const rpi_pair sum = rpi_ordered_sum(2.0 * rpi_quarter_high, -2.0 * half.high);
    return x > 0.0 ? 2.0 * (half.high + half.low) : sum.high + (sum.low + 2.0 * (rpi_quarter_low - half.low));
  }
  if (size == 1.0) {
    return x > 0.0 ? 0.0 : 2.0 * rpi_quarter_high;
  }
  return rpi_nan();
}
