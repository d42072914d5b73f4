/*# rpi_pair */
/* Unevaluated sum of two reals. */
typedef struct {
  double high;
  double low;
} rpi_pair;
/*# rpi_pair_of */
static inline rpi_pair rpi_pair_of(double high, double low) {
  rpi_pair pair;
  pair.high = high;
  pair.low = low;
  return pair;
}
/*# rpi_ordered_sum */
/* The exact sum of two reals. The first one is 0, or not less than the second one in size, or a multiple of the last
   place of the second one. */
static inline rpi_pair rpi_ordered_sum(double large, double small) {
  const double high = large + small;
  return rpi_pair_of(high, (large - high) + small);
}
/*# rpi_exact_sum */
/* The exact sum of two reals. */
static inline rpi_pair rpi_exact_sum(double a, double b) {
  const double high = a + b;
  const double part = high - a;
  return rpi_pair_of(high, (a - (high - part)) + (b - part));
}
/*# rpi_product */
/* The product of two reals. The error is below 2^-105 of the product. */
static inline rpi_pair rpi_product(double a, double b) {
  const double ah = rpi_upper_half(a);
  const double bh = rpi_upper_half(b);
  const double al = a - ah;
  const double bl = b - bh;
  const double high = a * b;
  return rpi_pair_of(high, (((ah * bh - high) + ah * bl) + al * bh) + al * bl);
}
/*# rpi_square */
/* The square of a real, with 52 bits in the high part. The error is below 2^-78 of the square. */
static inline rpi_pair rpi_square(double x) {
  const double upper = rpi_upper_half(x);
  return rpi_pair_of(upper * upper, (x - upper) * (x + upper));
}
/*# rpi_quotient */
/* The quotient of two pairs, with 26 bits in the high part. The error is below 2^-70 of the quotient. The low parts may be
   up to 2^-17 of the high parts. */
static inline rpi_pair rpi_quotient(rpi_pair dividend, rpi_pair divisor) {
  const double inverse = 1.0 / (divisor.high + divisor.low);
  const double high = rpi_upper_half(dividend.high * inverse);
  const double divisor_upper = rpi_upper_half(divisor.high);
  const double divisor_rest = (divisor.high - divisor_upper) + divisor.low;
  const double rest = (dividend.high - high * divisor_upper) + (dividend.low - high * divisor_rest);
  return rpi_pair_of(high, rest * inverse);
}
/*# rpi_root */
/* The square root of a pair whose low part is a rounding error. The error is below 2^-70 of the root. */
static inline rpi_pair rpi_root(rpi_pair x) {
  const double high = rpi_sqrt(x.high);
  const rpi_pair square = rpi_square(high);
  const double rest = ((x.high - square.high) - square.low) + x.low;
  return rpi_pair_of(high, rest * (0.5 / high));
}
