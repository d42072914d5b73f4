/*# rpi_logarithm */
/* Logarithm of a positive finite real. The error is below 2^-66 of the logarithm. */
static inline rpi_pair rpi_logarithm(double x) {
  /* Bits of the real with which the intervals of the table begin. */
  const uint64_t start = UINT64_C(0x3fe6100000000000);
  const bool subnormal = x < 0x1p-1022;
  const uint64_t bits = rpi_bits(subnormal ? x * 0x1p54 : x);
  const uint64_t offset = bits - start;
  const uint64_t m = bits - (offset & UINT64_C(0xfff0000000000000));
  const double *row = rpi_logarithms[(offset >> 45) & 127U];
  /* The exponent is that of a real of `offset` with 12 bits, as a signed number. */
  const int32_t exponent = (int32_t)(((offset >> 52) + 2048U) & 0xfffU) - 2048;
  const double k = (double)(exponent - (subnormal ? 54 : 0));
  const double base = k * rpi_ln_two_high + row[1];
  const double base_low = k * rpi_ln_two_low + row[2];
  /* Both parts of m have few enough bits for a product with the 13 bits of the number in the table. */
  const double upper = rpi_real(m & UINT64_C(0xffffffff00000000));
  const double lower = rpi_real(m) - upper;
  const rpi_pair r = rpi_ordered_sum(upper * row[0] - 1.0, lower * row[0]);
  const rpi_pair square = rpi_square(r.high);
  const rpi_pair first = rpi_ordered_sum(base, r.high);
  const rpi_pair second = rpi_ordered_sum(first.high, -0.5 * square.high);
  const double z = r.high * r.high;
  const double terms = rpi_quadratic(rpi_log_terms[0], r.high) + r.high * z * rpi_quadratic(rpi_log_terms[1], r.high);
  const double rest =
      (base_low + (r.low - r.high * r.low)) + (r.high * z * terms - 0.5 * square.low);
  return rpi_ordered_sum(second.high, (first.low + second.low) + rest);
}
/*# rpi_log */
static double rpi_log(double x) {
  if (rpi_is_nan(x) || x < 0.0) {
    return rpi_nan();
  }
  if (x == 0.0) {
    return -rpi_infinity();
  }
  return rpi_is_infinite(x) ? x : rpi_logarithm(x).high;
}
