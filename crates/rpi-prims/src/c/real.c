/*# rpi_bits */
/* Bits of a real. */
static inline uint64_t rpi_bits(double x) {
  uint64_t bits;
  memcpy(&bits, &x, sizeof bits);
  return bits;
}
/*# rpi_real */
/* Real with the given bits. */
static inline double rpi_real(uint64_t bits) {
  double x;
  memcpy(&x, &bits, sizeof x);
  return x;
}
/*# rpi_high */
/* Sign, exponent and the 20 upper bits of the fraction. */
static inline uint32_t rpi_high(double x) {
  return (uint32_t)(rpi_bits(x) >> 32);
}
/*# rpi_low */
static inline uint32_t rpi_low(double x) {
  return (uint32_t)(rpi_bits(x) & 0xffffffffU);
}
/*# rpi_with_high */
static inline double rpi_with_high(double x, uint32_t high) {
  return rpi_real(((uint64_t)high << 32) | (rpi_bits(x) & 0xffffffffU));
}
/*# rpi_upper */
/* The real without the 32 lower bits of its fraction. */
static inline double rpi_upper(double x) {
  return rpi_real(rpi_bits(x) & UINT64_C(0xffffffff00000000));
}
/*# rpi_integer */
/* Signed integer with the given bits. */
static inline int64_t rpi_integer(uint64_t bits) {
  int64_t n;
  memcpy(&n, &bits, sizeof n);
  return n;
}
/*# rpi_abs */
static inline double rpi_abs(double x) {
  return rpi_real(rpi_bits(x) & UINT64_C(0x7fffffffffffffff));
}
/*# rpi_copy_sign */
static inline double rpi_copy_sign(double x, double sign) {
  return rpi_real((rpi_bits(x) & UINT64_C(0x7fffffffffffffff)) |
                  (rpi_bits(sign) & UINT64_C(0x8000000000000000)));
}
/*# rpi_is_nan */
static inline bool rpi_is_nan(double x) {
  return (rpi_bits(x) & UINT64_C(0x7fffffffffffffff)) > UINT64_C(0x7ff0000000000000);
}
/*# rpi_is_finite */
static inline bool rpi_is_finite(double x) {
  return (rpi_bits(x) & UINT64_C(0x7ff0000000000000)) != UINT64_C(0x7ff0000000000000);
}
/*# rpi_nan */
static inline double rpi_nan(void) {
  return rpi_real(UINT64_C(0x7ff8000000000000));
}
/*# rpi_infinity */
static inline double rpi_infinity(void) {
  return rpi_real(UINT64_C(0x7ff0000000000000));
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
/*# rpi_sqrt */
/* Square root, rounded to nearest: the instruction of the processor, else digit by digit. */
#if defined(__SSE2__) && !defined(RPI_PORTABLE)
#include <emmintrin.h>
static inline double rpi_sqrt(double x) {
  return _mm_cvtsd_f64(_mm_sqrt_sd(_mm_setzero_pd(), _mm_set_sd(x)));
}
#elif defined(__aarch64__) && !defined(RPI_PORTABLE)
#include <arm_neon.h>
static inline double rpi_sqrt(double x) {
  return vget_lane_f64(vsqrt_f64(vdup_n_f64(x)), 0);
}
#else
static double rpi_sqrt(double x) {
  const uint64_t implicit = UINT64_C(0x0010000000000000);
  /* Without the functions for bits, which would be unused where the processor computes the root. */
  uint64_t rest;
  uint64_t root = 0;
  uint64_t bit = UINT64_C(0x0020000000000000);
  int32_t exponent;
  double result;
  memcpy(&rest, &x, sizeof rest);
  exponent = (int32_t)((rest >> 52) & 0x7ffU);
  if (exponent == 0x7ff || (rest >> 63) != 0U || rest == 0U) {
    if (x == 0.0 || (exponent == 0x7ff && !(x < 0.0))) {
      return x;
    }
    return (x - x) / (x - x);
  }
  rest &= implicit - 1U;
  if (exponent == 0) {
    exponent = 1;
    while (rest < implicit) {
      rest <<= 1;
      exponent -= 1;
    }
  } else {
    rest |= implicit;
  }
  exponent -= 0x3ff;
  if ((exponent & 1) != 0) {
    rest <<= 1;
    exponent -= 1;
  }
  /* 53 digits and one more to round by. */
  rest <<= 1;
  {
    uint64_t partial = 0;
    for (; bit != 0U; bit >>= 1) {
      const uint64_t trial = partial + bit;
      if (trial <= rest) {
        partial = trial + bit;
        rest -= trial;
        root += bit;
      }
      rest <<= 1;
    }
  }
  root += root & 1U;
  root >>= 1;
  root += (uint64_t)(uint32_t)(exponent / 2 + 0x3fe) << 52;
  memcpy(&result, &root, sizeof result);
  return result;
}
#endif
