/*# rpi_integer */
/* Signed integer with the given bits. */
static inline int64_t rpi_integer(uint64_t bits) {
  int64_t n;
  memcpy(&n, &bits, sizeof n);
  return n;
}
/*# rpi_trunc */
/* The real without its fractional part. */
static inline double rpi_trunc(double x) {
  const uint64_t bits = rpi_bits(x);
  const int32_t exponent = (int32_t)((bits >> 52) & 0x7ffU) - 0x3ff;
  if (exponent >= 52) {
    return x;
  }
  if (exponent < 0) {
    return rpi_copy_sign(0.0, x);
  }
  return rpi_real(bits & ~(UINT64_C(0x000fffffffffffff) >> exponent));
}
/*# rpi_floor */
static inline double rpi_floor(double x) {
  const double whole = rpi_trunc(x);
  return whole > x ? whole - 1.0 : whole;
}
/*# rpi_ceil */
static inline double rpi_ceil(double x) {
  const double whole = rpi_trunc(x);
  /* The sign of a zero is that of the argument. */
  return whole < x ? rpi_copy_sign(whole + 1.0, x) : whole;
}
/*# rpi_round */
/* Nearest whole number; halves are rounded away from 0. */
static inline double rpi_round(double x) {
  /* The largest real below one half: adding one half itself would round up the real below it. */
  return rpi_trunc(x + rpi_copy_sign(0x1.fffffffffffffp-2, x));
}
/*# rpi_min */
/* The smaller of two reals; the other one if one is not a number. */
static inline double rpi_min(double x, double y) {
  return rpi_is_nan(y) || x < y ? x : y;
}
/*# rpi_max */
/* The greater of two reals; the other one if one is not a number. */
static inline double rpi_max(double x, double y) {
  return rpi_is_nan(x) || x < y ? y : x;
}
/*# rpi_bounded */
/* `x` limited to `least` ... `most`. */
static inline double rpi_bounded(double x, double least, double most) {
  const double above = x < least ? least : x;
  return above > most ? most : above;
}
/*# rpi_significand */
/* Significand of a positive finite real with its leading bit at 2^52, and its biased exponent, which may be negative. */
static inline uint64_t rpi_significand(uint64_t bits, int32_t *exponent) {
  const uint64_t implicit = UINT64_C(0x0010000000000000);
  uint64_t significand = bits & (implicit - 1U);
  *exponent = (int32_t)(bits >> 52);
  if (*exponent != 0) {
    return significand | implicit;
  }
  *exponent = 1;
  while (significand < implicit) {
    significand <<= 1;
    *exponent -= 1;
  }
  return significand;
}
/*# rpi_fmod */
/* Remainder of the division truncated towards 0, which is exact, by long division of the significands. */
static double rpi_fmod(double x, double y) {
  const uint64_t implicit = UINT64_C(0x0010000000000000);
  const uint64_t infinite = UINT64_C(0x7ff0000000000000);
  const uint64_t sign = rpi_bits(x) & UINT64_C(0x8000000000000000);
  uint64_t a = rpi_bits(x) & UINT64_C(0x7fffffffffffffff);
  uint64_t b = rpi_bits(y) & UINT64_C(0x7fffffffffffffff);
  int32_t ea;
  int32_t eb;
  if (b == 0U || a >= infinite || b > infinite) {
    return rpi_nan();
  }
  if (a < b) {
    return x;
  }
  a = rpi_significand(a, &ea);
  b = rpi_significand(b, &eb);
  for (; ea > eb; ea -= 1) {
    if (a >= b) {
      a -= b;
    }
    a <<= 1;
  }
  if (a >= b) {
    a -= b;
  }
  if (a == 0U) {
    return rpi_real(sign);
  }
  while (a < implicit) {
    a <<= 1;
    ea -= 1;
  }
  if (ea > 0) {
    return rpi_real(sign | ((uint64_t)(uint32_t)ea << 52) | (a & (implicit - 1U)));
  }
  return rpi_real(sign | (a >> (1 - ea)));
}
