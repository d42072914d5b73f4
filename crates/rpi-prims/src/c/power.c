/*# rpi_power_parity */
/* 0 if y is no whole number, 1 if it is odd, 2 if it is even. */
static int32_t rpi_power_parity(double y) {
  const double size = rpi_abs(y);
  if (size >= 0x1p53) {
    return 2;
  }
  if (rpi_trunc(size) != size) {
    return 0;
  }
  return ((int64_t)size & 1) != 0 ? 1 : 2;
}
/*# rpi_power_special */
/* True, with the value of x to the power of y, if an operand is 0, infinite, not a number or 1, or y is 2, 1/2 or -1. */
static bool rpi_power_special(double x, double y, double *value) {
  const double size = rpi_abs(x);
  const bool is_up = rpi_high(y) >> 31 == 0U;
  if (y == 0.0 || x == 1.0) {
    *value = 1.0;
  } else if (rpi_is_nan(x) || rpi_is_nan(y)) {
    *value = x + y;
  } else if (!rpi_is_finite(y)) {
    if (size == 1.0) {
      *value = 1.0;
    } else {
      *value = (size > 1.0) == is_up ? rpi_abs(y) : 0.0;
    }
  } else if (y == 1.0) {
    *value = x;
  } else if (y == -1.0) {
    *value = 1.0 / x;
  } else if (y == 2.0) {
    *value = x * x;
  } else if (y == 0.5 && rpi_high(x) >> 31 == 0U) {
    *value = rpi_sqrt(x);
  } else if (size == 0.0 || size == 1.0 || !rpi_is_finite(x)) {
    const double z = is_up ? size : 1.0 / size;
    const int32_t parity = rpi_power_parity(y);
    *value = z;
    if (rpi_high(x) >> 31 != 0U) {
      if (size == 1.0 && parity == 0) {
        *value = (x - x) / (x - x);
      } else if (parity == 1) {
        *value = -z;
      }
    }
  } else {
    return false;
  }
  return true;
}
/*# rpi_power_log */
/* Binary logarithm of x > 0 as log[0] + log[1], where log[0] has few digits. */
static void rpi_power_log(double x, double *log) {
  static const double centre[2] = {1.0, 1.5};
  static const double log_upper[2] = {0.0, 5.84962487220764160156e-01};
  static const double log_lower[2] = {0.0, 1.35003920212974897128e-08};
  int32_t n = 0;
  int32_t high = (int32_t)rpi_high(x);
  int32_t fraction;
  int32_t k;
  if (high < 0x00100000) {
    x *= 0x1p53;
    n = -53;
    high = (int32_t)rpi_high(x);
  }
  n += (high >> 20) - 0x3ff;
  fraction = high & 0x000fffff;
  high = fraction | 0x3ff00000;
  if (fraction <= 0x3988e) {
    k = 0;
  } else if (fraction < 0xbb67a) {
    k = 1;
  } else {
    k = 0;
    n += 1;
    high -= 0x00100000;
  }
  x = rpi_with_high(x, (uint32_t)high);
  {
    const double u = x - centre[k];
    const double v = 1.0 / (x + centre[k]);
    const double s = u * v;
    const double s_upper = rpi_upper(s);
    const double sum_upper =
        rpi_with_high(0.0, (((uint32_t)high >> 1) | 0x20000000U) + 0x00080000U + ((uint32_t)k << 18));
    const double sum_lower = x - (sum_upper - centre[k]);
    const double s_lower = v * ((u - s_upper * sum_upper) - s_upper * sum_lower);
    const double z = s * s;
    const double square = s_upper * s_upper;
    const double r =
        z * z *
            (5.99999999999994648725e-01 +
             z * (4.28571428578550184252e-01 +
                  z * (3.33333329818377432918e-01 +
                       z * (2.72728123808534006489e-01 +
                            z * (2.30660745775561754067e-01 + z * 2.06975017800338417784e-01))))) +
        s_lower * (s_upper + s);
    const double t_upper = rpi_upper(3.0 + square + r);
    const double t_lower = r - ((t_upper - 3.0) - square);
    const double p = s_upper * t_upper;
    const double q = s_lower * t_upper + t_lower * s;
    const double p_upper = rpi_upper(p + q);
    const double p_lower = q - (p_upper - p);
    const double z_upper = 9.61796700954437255859e-01 * p_upper;
    const double z_lower =
        -7.02846165095275826516e-09 * p_upper + p_lower * 9.61796693925975554329e-01 + log_lower[k];
    const double count = (double)n;
    log[0] = rpi_upper(((z_upper + z_lower) + log_upper[k]) + count);
    log[1] = z_lower - (((log[0] - count) - log_upper[k]) - z_upper);
  }
}
/*# rpi_power_exp */
/* 2 to the power of p + q, where q is the rounding error of p. */
static double rpi_power_exp(double p, double q) {
  const double sum = q + p;
  const int32_t high = (int32_t)(rpi_high(sum) & 0x7fffffffU);
  const bool is_negative = rpi_high(sum) >> 31 != 0U;
  int32_t n = 0;
  if (high > 0x3fe00000) {
    /* The sign does not matter below: only the bits of the size are used. */
    const int32_t nearest = high + (0x00100000 >> ((high >> 20) - 0x3ff + 1));
    const int32_t exponent = (nearest >> 20) - 0x3ff;
    const uint32_t whole = (uint32_t)nearest & ~(0x000fffffU >> exponent);
    n = ((nearest & 0x000fffff) | 0x00100000) >> (20 - exponent);
    if (is_negative) {
      n = -n;
    }
    p -= rpi_with_high(0.0, is_negative ? whole | 0x80000000U : whole);
  }
  {
    const double t = rpi_upper(q + p);
    const double u = t * 6.93147182464599609375e-01;
    const double v =
        (q - (t - p)) * 6.93147180559945286227e-01 + t * -1.90465429995776804525e-09;
    const double z = u + v;
    const double w = v - (z - u);
    const double square = z * z;
    const double c =
        z - square * (1.66666666666666019037e-01 +
                      square * (-2.77777777770155933842e-03 +
                                square * (6.61375632143793436117e-05 +
                                          square * (-1.65339022054652515390e-06 +
                                                    square * 4.13813679705723846039e-08))));
    const double r = (z * c) / (c - 2.0) - (w + z * w);
    const double value = 1.0 - (r - z);
    const int32_t top = (int32_t)rpi_high(value) + n * 0x00100000;
    return top < 0x00100000 ? rpi_scale(value, n) : rpi_with_high(value, (uint32_t)top);
  }
}
/*# rpi_pow */
/* x to the power of y, by the binary logarithm of x in two parts. */
static double rpi_pow(double x, double y) {
  const uint32_t high_x = rpi_high(x) & 0x7fffffffU;
  const uint32_t high_y = rpi_high(y) & 0x7fffffffU;
  const bool is_up = rpi_high(y) >> 31 == 0U;
  double value;
  double sign = 1.0;
  double log[2];
  if (rpi_power_special(x, y, &value)) {
    return value;
  }
  if (rpi_high(x) >> 31 != 0U) {
    const int32_t parity = rpi_power_parity(y);
    if (parity == 0) {
      return (x - x) / (x - x);
    }
    sign = parity == 1 ? -1.0 : 1.0;
  }
  if (high_y > 0x41e00000U) {
    if (high_y > 0x43f00000U) {
      /* The sign is lost here, but y is then even. */
      return (high_x >= 0x3ff00000U) == is_up ? rpi_infinity() : 0.0;
    }
    if (high_x < 0x3fefffffU) {
      return sign * (is_up ? 0.0 : rpi_infinity());
    }
    if (high_x > 0x3ff00000U) {
      return sign * (is_up ? rpi_infinity() : 0.0);
    }
    {
      /* Near 1 the series of the logarithm has four terms. */
      const double t = rpi_abs(x) - 1.0;
      const double w = (t * t) * (0.5 - t * (0.3333333333333333333333 - t * 0.25));
      const double u = 1.44269502162933349609e+00 * t;
      const double v = t * 1.92596299112661746887e-08 - w * 1.44269504088896338700e+00;
      log[0] = rpi_upper(u + v);
      log[1] = v - (log[0] - u);
    }
  } else {
    rpi_power_log(rpi_abs(x), log);
  }
  {
    const double y_upper = rpi_upper(y);
    const double q = (y - y_upper) * log[0] + y * log[1];
    const double p = y_upper * log[0];
    const double z = q + p;
    if (z >= 1024.0) {
      if (z > 1024.0 || q + 8.0085662595372944372e-017 > z - p) {
        return sign * rpi_infinity();
      }
    } else if (z <= -1075.0) {
      if (z < -1075.0 || q <= z - p) {
        return sign * 0.0;
      }
    }
    return sign * rpi_power_exp(p, q);
  }
}
