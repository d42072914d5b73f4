/*# rpi_parity */
/* 0 for an even number, 1 for an odd one, 2 for one that is not whole. */
static inline int32_t rpi_parity(double y) {
  const double size = rpi_abs(y);
  int64_t whole;
  if (size >= 0x1p53) {
    return 0;
  }
  whole = (int64_t)size;
  return (double)whole != size ? 2 : (int32_t)(whole % 2);
}
/*# rpi_positive_power */
/* A positive finite number to the power of a finite y. */
static inline double rpi_positive_power(double x, double y) {
  const rpi_pair logarithm = rpi_logarithm(x);
  const double estimate = y * logarithm.high;
  rpi_pair exponent;
  if (estimate > 709.79) {
    return rpi_infinity();
  }
  if (estimate < -745.2) {
    return 0.0;
  }
  exponent = rpi_product(y, logarithm.high);
  return rpi_exponential_value(rpi_exponential_of(exponent.high, exponent.low + y * logarithm.low));
}
/*# rpi_pow */
static double rpi_pow(double x, double y) {
  const double size = rpi_abs(x);
  double sign;
  int32_t parity;
  if (y == 0.0 || x == 1.0) {
    return 1.0;
  }
  if (rpi_is_nan(x) || rpi_is_nan(y)) {
    return rpi_nan();
  }
  if (rpi_is_infinite(y)) {
    if (size == 1.0) {
      return 1.0;
    }
    return (size > 1.0) == (y > 0.0) ? rpi_infinity() : 0.0;
  }
  parity = rpi_parity(y);
  sign = (rpi_bits(x) >> 63) != 0U && parity == 1 ? -1.0 : 1.0;
  if (size == 0.0 || rpi_is_infinite(x)) {
    return sign * ((size == 0.0) == (y > 0.0) ? 0.0 : rpi_infinity());
  }
  return x < 0.0 && parity == 2 ? rpi_nan() : sign * rpi_positive_power(size, y);
}
