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
/*# rpi_is_infinite */
static inline bool rpi_is_infinite(double x) {
  return (rpi_bits(x) & UINT64_C(0x7fffffffffffffff)) == UINT64_C(0x7ff0000000000000);
}
/*# rpi_nan */
static inline double rpi_nan(void) {
  return rpi_real(UINT64_C(0x7ff8000000000000));
}
/*# rpi_infinity */
static inline double rpi_infinity(void) {
  return rpi_real(UINT64_C(0x7ff0000000000000));
}
/*# rpi_biased_exponent */
/* Exponent of a real, biased by 1023: 0 for a subnormal number, 2047 for infinity. */
static inline int32_t rpi_biased_exponent(double x) {
  return (int32_t)((rpi_bits(x) >> 52) & 0x7ffU);
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
/*# rpi_rounder */
/* Addition of this number rounds a real below 2^51 to a whole number, which is in the lower bits of the sum. */
static const double rpi_rounder = 6755399441055744.0;
/*# rpi_upper_half */
/* The real with its upper 26 significant bits only: products of two such numbers are exact. */
static inline double rpi_upper_half(double x) {
  return rpi_real(rpi_bits(x) & UINT64_C(0xfffffffff8000000));
}
/*# rpi_signed */
/* Signed integer with the given bits. */
static inline int32_t rpi_signed(uint32_t bits) {
  int32_t n;
  memcpy(&n, &bits, sizeof n);
  return n;
}
/*# rpi_power_of_two */
/* 2 to the power of n, for n from -1022 to 1023. */
static inline double rpi_power_of_two(int32_t n) {
  return rpi_real((uint64_t)(uint32_t)(n + 1023) << 52);
}
/*# rpi_scale */
/* x times 2 to the power of n, rounded once, for x from 1/2 to 4 and n from -1100 to 1024. */
static inline double rpi_scale(double x, int32_t n) {
  if (n > 1022) {
    return x * rpi_power_of_two(1022) * rpi_power_of_two(n - 1022);
  }
  if (n < -1000) {
    /* The first product is normal, so that only the second one rounds. */
    return x * rpi_power_of_two(n + 200) * rpi_power_of_two(-200);
  }
  return x * rpi_power_of_two(n);
}
/*# rpi_quadratic */
/* Polynomial of the second degree. */
static inline double rpi_quadratic(const double terms[3], double z) {
  return terms[0] + z * (terms[1] + z * terms[2]);
}
/*# rpi_cubic */
/* Polynomial of the third degree at z, with few dependent operations. */
static inline double rpi_cubic(const double terms[4], double z, double square) {
  return (terms[0] + terms[1] * z) + square * (terms[2] + terms[3] * z);
}
