/*# rpi_exponential */
/* An exponential function as a power of two and a factor from 1/2 to 4. */
typedef struct {
  int32_t exponent;
  rpi_pair factor;
} rpi_exponential;
/*# rpi_exponential_of */
/* Exponential function of x + rest, for x from -745.2 to 709.79. */
static inline rpi_exponential rpi_exponential_of(double x, double rest) {
  const double rounded = x * rpi_power_steps_per_unit + rpi_rounder;
  const double count = rounded - rpi_rounder;
  const double r = ((x - count * rpi_power_step_high) - count * rpi_power_step_low) + rest;
  const double square = r * r;
  const double excess = r + square * (0.5 + r * rpi_cubic(rpi_exp_terms[0], r, square));
  const uint32_t number = (uint32_t)(rpi_bits(rounded) & UINT64_C(0xffffffff));
  const double *row = rpi_powers[number & 127U];
  rpi_exponential result;
  result.exponent = (rpi_signed(number) - (int32_t)(number & 127U)) / 128;
  result.factor = rpi_pair_of(row[0], row[1] + row[0] * excess);
  return result;
}
/*# rpi_exponential_value */
static inline double rpi_exponential_value(rpi_exponential x) {
  return rpi_scale(x.factor.high + x.factor.low, x.exponent);
}
/*# rpi_exponential_pair */
/* The function as a pair, for an exponent from -1000 to 1000. */
static inline rpi_pair rpi_exponential_pair(rpi_exponential x) {
  const double factor = rpi_power_of_two(x.exponent);
  return rpi_pair_of(x.factor.high * factor, x.factor.low * factor);
}
/*# rpi_exp */
static double rpi_exp(double x) {
  if (rpi_is_nan(x)) {
    return rpi_nan();
  }
  if (x > 709.79) {
    return rpi_infinity();
  }
  if (x < -745.2) {
    return 0.0;
  }
  return rpi_exponential_value(rpi_exponential_of(x, 0.0));
}
/*# rpi_small_expm1 */
/* exp x - 1 for |x| up to 1/8. */
static inline double rpi_small_expm1(double x) {
  const double upper = rpi_upper_half(x);
  /* x^2 / 2 in two parts, of which the first one is exact. */
  const rpi_pair sum = rpi_ordered_sum(x, 0.5 * upper * upper);
  const double rest = (x - upper) * (x + upper) * 0.5;
  const double square = x * x;
  const double terms =
      rpi_cubic(rpi_expm1_terms[0], x, square) + square * square * rpi_cubic(rpi_expm1_terms[1], x, square);
  if (rpi_abs(x) < 0x1p-54) {
    return x;
  }
  return sum.high + (sum.low + (rest + x * square * terms));
}
/*# rpi_expm1 */
static double rpi_expm1(double x) {
  rpi_pair power;
  rpi_pair sum;
  if (rpi_abs(x) <= 0.125) {
    return rpi_small_expm1(x);
  }
  if (x > 50.0 || rpi_is_nan(x)) {
    return rpi_exp(x);
  }
  if (x < -50.0) {
    return -1.0;
  }
  power = rpi_exponential_pair(rpi_exponential_of(x, 0.0));
  sum = rpi_exact_sum(power.high, -1.0);
  return sum.high + (sum.low + power.low);
}
/*# rpi_tanh */
static double rpi_tanh(double x) {
  const double size = rpi_abs(x);
  rpi_pair power;
  rpi_pair numerator;
  rpi_pair denominator;
  if (size < 0x1p-54) {
    return x;
  }
  if (size <= 0.25) {
    const double z = x * x;
    const double square = z * z;
    return x + x * z * (rpi_cubic(rpi_tanh_terms[0], z, square) +
                        square * square * rpi_cubic(rpi_tanh_terms[1], z, square));
  }
  if (rpi_is_nan(x)) {
    return rpi_nan();
  }
  if (size > 22.0) {
    return rpi_copy_sign(1.0, x);
  }
  power = rpi_exponential_pair(rpi_exponential_of(2.0 * size, 0.0));
  numerator = rpi_ordered_sum(power.high, -1.0);
  numerator.low += power.low;
  denominator = rpi_ordered_sum(power.high, 1.0);
  denominator.low += power.low;
  numerator = rpi_quotient(numerator, denominator);
  return rpi_copy_sign(numerator.high + numerator.low, x);
}
