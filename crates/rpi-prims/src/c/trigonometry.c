/*# rpi_scale */
/* x times 2 to the power of n, rounded once. */
static double rpi_scale(double x, int32_t n) {
  if (n > 1023) {
    x *= 0x1p1023;
    n -= 1023;
    if (n > 1023) {
      x *= 0x1p1023;
      n -= 1023;
      if (n > 1023) {
        n = 1023;
      }
    }
  } else if (n < -1022) {
    /* The factor keeps x normal, so that only the last product rounds. */
    x *= 0x1p-969;
    n += 969;
    if (n < -1022) {
      x *= 0x1p-969;
      n += 969;
      if (n < -1022) {
        n = -1022;
      }
    }
  }
  return x * rpi_real((uint64_t)(uint32_t)(0x3ff + n) << 52);
}
/*# rpi_sin_kernel */
/* Sine of x + y for |x| up to pi / 4; y is the rounding error of x. */
static double rpi_sin_kernel(double x, double y, bool exact) {
  const double z = x * x;
  const double w = z * z;
  const double r = 8.33333333332248946124e-03 +
                   z * (-1.98412698298579493134e-04 + z * 2.75573137070700676789e-06) +
                   z * w * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10);
  const double v = z * x;
  const double cubic = -1.66666666666666324348e-01;
  if (exact) {
    return x + v * (cubic + z * r);
  }
  return x - ((z * (0.5 * y - v * r) - y) - v * cubic);
}
/*# rpi_cos_kernel */
/* Cosine of x + y for |x| up to pi / 4. */
static double rpi_cos_kernel(double x, double y) {
  const double z = x * x;
  const double w = z * z;
  const double r =
      z * (4.16666666666666019037e-02 +
           z * (-1.38888888888741095749e-03 + z * 2.48015872894767294178e-05)) +
      w * w *
          (-2.75573143513906633035e-07 +
           z * (2.08757232129817482790e-09 + z * -1.13596475577881948265e-11));
  const double half = 0.5 * z;
  const double most = 1.0 - half;
  return most + (((1.0 - most) - half) + (z * r - x * y));
}
/*# rpi_product_term */
/* Digit `index` of the product of x (`count` digits of 24 bits) with 2 / pi from its digit `first` on. */
static double rpi_product_term(const double *x, int32_t count, int32_t first, int32_t index) {
  /* 2 / pi in digits of 24 bits. */
  static const int32_t two_over_pi[66] = {
    0xA2F983, 0x6E4E44, 0x1529FC, 0x2757D1, 0xF534DD, 0xC0DB62, 0x95993C, 0x439041, 0xFE5163,
    0xABDEBB, 0xC561B7, 0x246E3A, 0x424DD2, 0xE00649, 0x2EEA09, 0xD1921C, 0xFE1DEB, 0x1CB129,
    0xA73EE8, 0x8235F5, 0x2EBB44, 0x84E99C, 0x7026B4, 0x5F7E41, 0x3991D6, 0x398353, 0x39F49C,
    0x845F8B, 0xBDF928, 0x3B1FF8, 0x97FFDE, 0x05980F, 0xEF2F11, 0x8B5A0A, 0x6D1F6D, 0x367ECF,
    0x27CB09, 0xB74F46, 0x3F669E, 0x5FEA2D, 0x7527BA, 0xC7EBE5, 0xF17B3D, 0x0739F7, 0x8A5292,
    0xEA6BFB, 0x5FB11F, 0x8D5D08, 0x560330, 0x46FC7B, 0x6BABF0, 0xCFBC20, 0x9AF436, 0x1DA9E3,
    0x91615E, 0xE61B08, 0x659985, 0x5F14A0, 0x68408D, 0xFFD880, 0x4D7327, 0x310606, 0x1556CA,
    0x73A8C9, 0x60E27B, 0xC08C6B,
  };
  double sum = 0.0;
  int32_t j;
  for (j = 0; j < count; j += 1) {
    const int32_t digit = first + index - j;
    sum += x[j] * (digit < 0 ? 0.0 : (double)two_over_pi[digit]);
  }
  return sum;
}
/*# rpi_reduce_large */
/* Remainder of a large x by pi / 2 as y[0] + y[1], and the quotient modulo 8. x has `count` digits of 24 bits, the first
   one with the exponent `exponent`. After Payne and Hanek, Radian reduction for trigonometric functions, 1983. */
static int32_t rpi_reduce_large(const double *x, int32_t count, int32_t exponent, double *y) {
  static const double half_pi[5] = {
    1.57079625129699707031e+00, 7.54978941586159635335e-08, 5.39030252995776476554e-15,
    3.28200341580791294123e-22, 1.27065575308067607349e-29,
  };
  const int32_t least = 4;
  const int32_t first = (exponent - 3) / 24 < 0 ? 0 : (exponent - 3) / 24;
  int32_t shift = exponent - 24 * (first + 1);
  int32_t last = least;
  int32_t quotient = 0;
  int32_t half = 0;
  int32_t i;
  bool again = true;
  double q[20] = {0.0};
  double parts[20] = {0.0};
  int32_t digits[20] = {0};
  double z = 0.0;
  double sum;
  for (i = 0; i <= least; i += 1) {
    q[i] = rpi_product_term(x, count, first, i);
  }
  while (again) {
    again = false;
    /* Carries the digits, from the last one. */
    z = q[last];
    for (i = 0; i < last; i += 1) {
      const double carry = (double)(int32_t)(0x1p-24 * z);
      digits[i] = (int32_t)(z - 0x1p24 * carry);
      z = q[last - i - 1] + carry;
    }
    z = rpi_scale(z, shift);
    z -= 8.0 * rpi_floor(z * 0.125);
    quotient = (int32_t)z;
    z -= (double)quotient;
    half = 0;
    if (shift > 0) {
      const int32_t more = digits[last - 1] >> (24 - shift);
      quotient += more;
      digits[last - 1] -= more * (1 << (24 - shift));
      half = digits[last - 1] >> (23 - shift);
    } else if (shift == 0) {
      half = digits[last - 1] >> 23;
    } else if (z >= 0.5) {
      half = 2;
    }
    if (half > 0) {
      /* The fraction is above one half: the quotient is one more, and the remainder is negative. */
      bool borrows = false;
      quotient += 1;
      for (i = 0; i < last; i += 1) {
        if (borrows) {
          digits[i] = 0xffffff - digits[i];
        } else if (digits[i] != 0) {
          borrows = true;
          digits[i] = 0x1000000 - digits[i];
        }
      }
      if (shift == 1) {
        digits[last - 1] &= 0x7fffff;
      } else if (shift == 2) {
        digits[last - 1] &= 0x3fffff;
      }
      if (half == 2) {
        z = 1.0 - z;
        if (borrows) {
          z -= rpi_scale(1.0, shift);
        }
      }
    }
    if (z == 0.0) {
      /* All digits cancelled: more digits of 2 / pi are needed. */
      int32_t any = 0;
      for (i = last - 1; i >= least; i -= 1) {
        any |= digits[i];
      }
      if (any == 0) {
        int32_t more = 1;
        while (digits[least - more] == 0) {
          more += 1;
        }
        for (i = last + 1; i <= last + more; i += 1) {
          q[i] = rpi_product_term(x, count, first, i);
        }
        last += more;
        again = true;
      }
    }
  }
  if (z == 0.0) {
    do {
      last -= 1;
      shift -= 24;
    } while (digits[last] == 0);
  } else {
    z = rpi_scale(z, -shift);
    if (z >= 0x1p24) {
      const double carry = (double)(int32_t)(0x1p-24 * z);
      digits[last] = (int32_t)(z - 0x1p24 * carry);
      last += 1;
      shift += 24;
      digits[last] = (int32_t)carry;
    } else {
      digits[last] = (int32_t)z;
    }
  }
  sum = rpi_scale(1.0, shift);
  for (i = last; i >= 0; i -= 1) {
    q[i] = sum * (double)digits[i];
    sum *= 0x1p-24;
  }
  for (i = last; i >= 0; i -= 1) {
    int32_t k;
    sum = 0.0;
    for (k = 0; k <= least && k <= last - i; k += 1) {
      sum += half_pi[k] * q[i + k];
    }
    parts[last - i] = sum;
  }
  sum = 0.0;
  for (i = last; i >= 0; i -= 1) {
    sum += parts[i];
  }
  y[0] = half == 0 ? sum : -sum;
  sum = parts[0] - sum;
  for (i = 1; i <= last; i += 1) {
    sum += parts[i];
  }
  y[1] = half == 0 ? sum : -sum;
  return quotient & 7;
}
/*# rpi_reduce_medium */
/* Remainder of x by pi / 2 for |x| below 2^20 pi / 2, with pi / 2 in up to three parts (Cody and Waite, 1980). */
static int32_t rpi_reduce_medium(double x, double *y) {
  /* Adding and subtracting 1.5 * 2^52 rounds to a whole number. */
  const double rounding = 0x1.8p52;
  const double n = (x * 6.36619772367581382433e-01 + rounding) - rounding;
  const int32_t exponent = (int32_t)((rpi_high(x) >> 20) & 0x7ffU);
  double r = x - n * 1.57079632673412561417e+00;
  double w = n * 6.07710050650619224932e-11;
  y[0] = r - w;
  if (exponent - (int32_t)((rpi_high(y[0]) >> 20) & 0x7ffU) > 16) {
    double t = r;
    w = n * 6.07710050630396597660e-11;
    r = t - w;
    w = n * 2.02226624879595063154e-21 - ((t - r) - w);
    y[0] = r - w;
    if (exponent - (int32_t)((rpi_high(y[0]) >> 20) & 0x7ffU) > 49) {
      t = r;
      w = n * 2.02226624871116645580e-21;
      r = t - w;
      w = n * 8.47842766036889956997e-32 - ((t - r) - w);
      y[0] = r - w;
    }
  }
  y[1] = (r - y[0]) - w;
  return (int32_t)n;
}
/*# rpi_reduce_small */
/* Remainder of x by pi / 2 for the quotient n, with pi / 2 in two parts. */
static int32_t rpi_reduce_small(double x, int32_t n, double *y) {
  const double count = (double)n;
  const double z = x - count * 1.57079632673412561417e+00;
  const double rest = count * 6.07710050650619224932e-11;
  y[0] = z - rest;
  y[1] = (z - y[0]) - rest;
  return n;
}
/*# rpi_reduce */
/* Remainder of x by pi / 2 as y[0] + y[1], and the quotient, of which only the two lowest bits matter. */
static int32_t rpi_reduce(double x, double *y) {
  const uint32_t high = rpi_high(x) & 0x7fffffffU;
  const int32_t sign = (rpi_high(x) >> 31) != 0U ? -1 : 1;
  if (high <= 0x401c463bU) {
    /* Up to 9 pi / 4. Near a multiple of pi / 2 the two parts are not enough. */
    if (high <= 0x400f6a7aU) {
      if ((high & 0xfffffU) != 0x921fbU) {
        return rpi_reduce_small(x, high <= 0x4002d97cU ? sign : 2 * sign, y);
      }
    } else if (high <= 0x4015fdbcU) {
      if (high != 0x4012d97cU) {
        return rpi_reduce_small(x, 3 * sign, y);
      }
    } else if (high != 0x401921fbU) {
      return rpi_reduce_small(x, 4 * sign, y);
    }
  }
  if (high < 0x413921fbU) {
    return rpi_reduce_medium(x, y);
  }
  if (high >= 0x7ff00000U) {
    y[0] = x - x;
    y[1] = y[0];
    return 0;
  }
  {
    double digits[3];
    int32_t count = 3;
    int32_t i;
    int32_t n;
    double z = rpi_real((rpi_bits(x) & UINT64_C(0x000fffffffffffff)) | (UINT64_C(0x416) << 52));
    for (i = 0; i < 2; i += 1) {
      digits[i] = (double)(int32_t)z;
      z = (z - digits[i]) * 0x1p24;
    }
    digits[2] = z;
    while (count > 1 && digits[count - 1] == 0.0) {
      count -= 1;
    }
    n = rpi_reduce_large(digits, count, (int32_t)(high >> 20) - 0x416, y);
    if (sign < 0) {
      y[0] = -y[0];
      y[1] = -y[1];
      n = -n;
    }
    return n;
  }
}
/*# rpi_sin */
static double rpi_sin(double x) {
  const uint32_t high = rpi_high(x) & 0x7fffffffU;
  double y[2];
  int32_t n;
  if (high <= 0x3fe921fbU) {
    return high < 0x3e500000U ? x : rpi_sin_kernel(x, 0.0, true);
  }
  if (high >= 0x7ff00000U) {
    return x - x;
  }
  n = rpi_reduce(x, y) & 3;
  {
    const double value = (n & 1) == 0 ? rpi_sin_kernel(y[0], y[1], false) : rpi_cos_kernel(y[0], y[1]);
    return n < 2 ? value : -value;
  }
}
/*# rpi_cos */
static double rpi_cos(double x) {
  const uint32_t high = rpi_high(x) & 0x7fffffffU;
  double y[2];
  int32_t n;
  if (high <= 0x3fe921fbU) {
    return high < 0x3e46a09eU ? 1.0 : rpi_cos_kernel(x, 0.0);
  }
  if (high >= 0x7ff00000U) {
    return x - x;
  }
  n = rpi_reduce(x, y) & 3;
  {
    const double value = (n & 1) == 0 ? rpi_cos_kernel(y[0], y[1]) : rpi_sin_kernel(y[0], y[1], false);
    return n == 0 || n == 3 ? value : -value;
  }
}
/*# rpi_tan_kernel */
/* Tangent of x + y for |x| up to pi / 4, or minus its inverse if `odd` is 1. */
static double rpi_tan_kernel(double x, double y, int32_t odd) {
  const bool is_negative = (rpi_high(x) >> 31) != 0U;
  const bool is_big = (rpi_high(x) & 0x7fffffffU) >= 0x3fe59428U;
  double z;
  double w;
  double r;
  double v;
  if (is_big) {
    if (is_negative) {
      x = -x;
      y = -y;
    }
    x = (7.85398163397448278999e-01 - x) + (3.06161699786838301793e-17 - y);
    y = 0.0;
  }
  z = x * x;
  w = z * z;
  r = 1.33333333333201242699e-01 +
      w * (2.18694882948595424599e-02 +
           w * (3.59207910759131235356e-03 +
                w * (5.88041240820264096874e-04 +
                     w * (7.81794442939557092300e-05 + w * -1.85586374855275456654e-05))));
  v = z * (5.39682539762260521377e-02 +
           w * (8.86323982359930005737e-03 +
                w * (1.45620945432529025516e-03 +
                     w * (2.46463134818469906812e-04 +
                          w * (7.14072491382608190305e-05 + w * 2.59073051863633712884e-05)))));
  {
    const double s = z * x;
    r = y + z * (s * (r + v) + y) + s * 3.33333333333334091986e-01;
  }
  w = x + r;
  if (is_big) {
    const double s = 1.0 - 2.0 * (double)odd;
    v = s - 2.0 * (x + (r - w * w / (w + s)));
    return is_negative ? -v : v;
  }
  if (odd == 0) {
    return w;
  }
  {
    const double upper = rpi_upper(w);
    const double inverse = -1.0 / w;
    const double inverse_upper = rpi_upper(inverse);
    v = r - (upper - x);
    return inverse_upper + inverse * (1.0 + inverse_upper * upper + inverse_upper * v);
  }
}
/*# rpi_tan */
static double rpi_tan(double x) {
  const uint32_t high = rpi_high(x) & 0x7fffffffU;
  double y[2];
  int32_t n;
  if (high <= 0x3fe921fbU) {
    return high < 0x3e400000U ? x : rpi_tan_kernel(x, 0.0, 0);
  }
  if (high >= 0x7ff00000U) {
    return x - x;
  }
  n = rpi_reduce(x, y);
  return rpi_tan_kernel(y[0], y[1], n & 1);
}
