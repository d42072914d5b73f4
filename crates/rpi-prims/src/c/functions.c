/*# rpi_asin_ratio */
/* (arcsin(x) - x) / x for z = x^2. */
static double rpi_asin_ratio(double z) {
  const double p =
      z * (1.66666666666666657415e-01 +
           z * (-3.25565818622400915405e-01 +
                z * (2.01212532134862925881e-01 +
                     z * (-4.00555345006794114027e-02 +
                          z * (7.91534994289814532176e-04 + z * 3.47933107596021167570e-05)))));
  const double q =
      1.0 + z * (-2.40339491173441421878e+00 +
                 z * (2.02094576023350569471e+00 +
                      z * (-6.88283971605453293030e-01 + z * 7.70381505559019352791e-02)));
  return p / q;
}
/*# rpi_asin */
static double rpi_asin(double x) {
  const double half_pi = 1.57079632679489655800e+00;
  const double rest = 6.12323399573676603587e-17;
  const uint32_t high = rpi_high(x) & 0x7fffffffU;
  if (high >= 0x3ff00000U) {
    return rpi_abs(x) == 1.0 ? x * half_pi + 0x1p-120 : 0.0 / (x - x);
  }
  if (high < 0x3fe00000U) {
    if (high >= 0x00100000U && high < 0x3e500000U) {
      return x;
    }
    return x + x * rpi_asin_ratio(x * x);
  }
  {
    const double z = (1.0 - rpi_abs(x)) * 0.5;
    const double s = rpi_sqrt(z);
    const double r = rpi_asin_ratio(z);
    double value;
    if (high >= 0x3fef3333U) {
      value = half_pi - (2.0 * (s + s * r) - rest);
    } else {
      const double upper = rpi_upper(s);
      const double lower = (z - upper * upper) / (s + upper);
      value = 0.5 * half_pi - (2.0 * s * r - (rest - 2.0 * lower) - (0.5 * half_pi - 2.0 * upper));
    }
    return rpi_high(x) >> 31 != 0U ? -value : value;
  }
}
/*# rpi_acos */
static double rpi_acos(double x) {
  const double half_pi = 1.57079632679489655800e+00;
  const double rest = 6.12323399573676603587e-17;
  const uint32_t high = rpi_high(x) & 0x7fffffffU;
  if (high >= 0x3ff00000U) {
    if (x == 1.0) {
      return 0.0;
    }
    return x == -1.0 ? 2.0 * half_pi + 0x1p-120 : 0.0 / (x - x);
  }
  if (high < 0x3fe00000U) {
    if (high <= 0x3c600000U) {
      return half_pi + 0x1p-120;
    }
    return half_pi - (x - (rest - x * rpi_asin_ratio(x * x)));
  }
  if (x < 0.0) {
    const double z = (1.0 + x) * 0.5;
    const double s = rpi_sqrt(z);
    const double w = rpi_asin_ratio(z) * s - rest;
    return 2.0 * (half_pi - (s + w));
  }
  {
    const double z = (1.0 - x) * 0.5;
    const double s = rpi_sqrt(z);
    const double upper = rpi_upper(s);
    const double lower = (z - upper * upper) / (s + upper);
    const double w = rpi_asin_ratio(z) * s + lower;
    return 2.0 * (upper + w);
  }
}
/*# rpi_atan */
/* Arc tangent: arctan(c) for c = 0, 1/2, 1, 3/2 or infinity, and a polynomial of the reduced argument. */
static double rpi_atan(double x) {
  static const double upper[4] = {
    4.63647609000806093515e-01, 7.85398163397448278999e-01, 9.82793723247329054082e-01,
    1.57079632679489655800e+00,
  };
  static const double lower[4] = {
    2.26987774529616870924e-17, 3.06161699786838301793e-17, 1.39033110312309984516e-17,
    6.12323399573676603587e-17,
  };
  const uint32_t high = rpi_high(x) & 0x7fffffffU;
  const bool is_negative = rpi_high(x) >> 31 != 0U;
  int32_t interval = -1;
  double z;
  double w;
  double odd;
  double even;
  if (high >= 0x44100000U) {
    if (rpi_is_nan(x)) {
      return x;
    }
    return is_negative ? -upper[3] : upper[3];
  }
  if (high < 0x3fdc0000U) {
    if (high < 0x3e400000U) {
      return x;
    }
  } else {
    x = rpi_abs(x);
    if (high < 0x3fe60000U) {
      x = (2.0 * x - 1.0) / (2.0 + x);
      interval = 0;
    } else if (high < 0x3ff30000U) {
      x = (x - 1.0) / (x + 1.0);
      interval = 1;
    } else if (high < 0x40038000U) {
      x = (x - 1.5) / (1.0 + 1.5 * x);
      interval = 2;
    } else {
      x = -1.0 / x;
      interval = 3;
    }
  }
  z = x * x;
  w = z * z;
  even = z * (3.33333333333329318027e-01 +
              w * (1.42857142725034663711e-01 +
                   w * (9.09088713343650656196e-02 +
                        w * (6.66107313738753120669e-02 +
                             w * (4.97687799461593236017e-02 + w * 1.62858201153657823623e-02)))));
  odd = w * (-1.99999999998764832476e-01 +
             w * (-1.11111104054623557880e-01 +
                  w * (-7.69187620504482999495e-02 +
                       w * (-5.83357013379057348645e-02 + w * -3.65315727442169155270e-02))));
  if (interval < 0) {
    return x - x * (even + odd);
  }
  z = upper[interval] - (x * (even + odd) - lower[interval] - x);
  return is_negative ? -z : z;
}
/*# rpi_atan2 */
/* Angle of the point (x, y). */
static double rpi_atan2(double y, double x) {
  const double pi = 3.1415926535897931160e+00;
  const double rest = 1.2246467991473531772e-16;
  const uint32_t high_x = rpi_high(x) & 0x7fffffffU;
  const uint32_t high_y = rpi_high(y) & 0x7fffffffU;
  const bool is_left = rpi_high(x) >> 31 != 0U;
  const bool is_below = rpi_high(y) >> 31 != 0U;
  double z;
  if (rpi_is_nan(x) || rpi_is_nan(y)) {
    return x + y;
  }
  if (x == 1.0) {
    return rpi_atan(y);
  }
  if (y == 0.0) {
    if (!is_left) {
      return y;
    }
    return is_below ? -pi : pi;
  }
  if (x == 0.0) {
    return is_below ? -pi / 2.0 : pi / 2.0;
  }
  if (high_x == 0x7ff00000U) {
    if (high_y == 0x7ff00000U) {
      z = is_left ? 3.0 * pi / 4.0 : pi / 4.0;
    } else {
      z = is_left ? pi : 0.0;
    }
    return is_below ? -z : z;
  }
  if (high_x + (64U << 20) < high_y || high_y == 0x7ff00000U) {
    return is_below ? -pi / 2.0 : pi / 2.0;
  }
  z = is_left && high_y + (64U << 20) < high_x ? 0.0 : rpi_atan(rpi_abs(y / x));
  if (!is_left) {
    return is_below ? -z : z;
  }
  return is_below ? (z - rest) - pi : pi - (z - rest);
}
/*# rpi_exp */
static double rpi_exp(double x) {
  const uint32_t high = rpi_high(x) & 0x7fffffffU;
  const bool is_negative = rpi_high(x) >> 31 != 0U;
  int32_t k = 0;
  double upper = x;
  double lower = 0.0;
  if (high >= 0x4086232bU) {
    if (rpi_is_nan(x)) {
      return x;
    }
    if (x > 709.782712893383973096) {
      return x * 0x1p1023;
    }
    if (x < -745.13321910194110842) {
      return 0.0;
    }
  }
  if (high > 0x3fd62e42U) {
    if (high >= 0x3ff0a2b2U) {
      k = (int32_t)(1.44269504088896338700e+00 * x + (is_negative ? -0.5 : 0.5));
    } else {
      k = is_negative ? -1 : 1;
    }
    upper = x - (double)k * 6.93147180369123816490e-01;
    lower = (double)k * 1.90821492927058770002e-10;
    x = upper - lower;
  } else if (high <= 0x3e300000U) {
    return 1.0 + x;
  }
  {
    const double z = x * x;
    const double c =
        x - z * (1.66666666666666019037e-01 +
                 z * (-2.77777777770155933842e-03 +
                      z * (6.61375632143793436117e-05 +
                           z * (-1.65339022054652515390e-06 + z * 4.13813679705723846039e-08))));
    const double y = 1.0 + (x * c / (2.0 - c) - lower + upper);
    return k == 0 ? y : rpi_scale(y, k);
  }
}
/*# rpi_log */
static double rpi_log(double x) {
  uint32_t high = rpi_high(x);
  int32_t k = 0;
  if (high < 0x00100000U || high >> 31 != 0U) {
    if (x == 0.0) {
      return -1.0 / (x * x);
    }
    if (high >> 31 != 0U) {
      return (x - x) / (x - x);
    }
    k = -54;
    x *= 0x1p54;
    high = rpi_high(x);
  } else if (high >= 0x7ff00000U) {
    return x;
  } else if (x == 1.0) {
    return 0.0;
  }
  high += 0x3ff00000U - 0x3fe6a09eU;
  k += (int32_t)(high >> 20) - 0x3ff;
  x = rpi_with_high(x, (high & 0x000fffffU) + 0x3fe6a09eU);
  {
    const double f = x - 1.0;
    const double half = 0.5 * f * f;
    const double s = f / (2.0 + f);
    const double z = s * s;
    const double w = z * z;
    const double even = w * (3.999999999940941908e-01 +
                             w * (2.222219843214978396e-01 + w * 1.531383769920937332e-01));
    const double odd = z * (6.666666666666735130e-01 +
                            w * (2.857142874366239149e-01 +
                                 w * (1.818357216161805012e-01 + w * 1.479819860511658591e-01)));
    const double count = (double)k;
    return s * (half + (odd + even)) + count * 1.90821492927058770002e-10 - half + f +
           count * 6.93147180369123816490e-01;
  }
}
/*# rpi_expm1 */
/* exp(x) - 1 without cancellation near 0. */
static double rpi_expm1(double x) {
  const uint32_t high = rpi_high(x) & 0x7fffffffU;
  const bool is_negative = rpi_high(x) >> 31 != 0U;
  double c = 0.0;
  int32_t k = 0;
  if (high >= 0x4043687aU) {
    if (rpi_is_nan(x)) {
      return x;
    }
    if (is_negative) {
      return -1.0;
    }
    if (x > 7.09782712893383973096e+02) {
      return x * 0x1p1023;
    }
  }
  if (high > 0x3fd62e42U) {
    double upper;
    double lower;
    if (high < 0x3ff0a2b2U) {
      k = is_negative ? -1 : 1;
    } else {
      k = (int32_t)(1.44269504088896338700e+00 * x + (is_negative ? -0.5 : 0.5));
    }
    upper = x - (double)k * 6.93147180369123816490e-01;
    lower = (double)k * 1.90821492927058770002e-10;
    x = upper - lower;
    c = (upper - x) - lower;
  } else if (high < 0x3c900000U) {
    return x;
  }
  {
    const double half = 0.5 * x;
    const double z = x * half;
    const double r = 1.0 + z * (-3.33333333333331316428e-02 +
                                z * (1.58730158725481460165e-03 +
                                     z * (-7.93650757867487942473e-05 +
                                          z * (4.00821782732936239552e-06 +
                                               z * -2.01099218183624371326e-07))));
    const double t = 3.0 - r * half;
    double e = z * ((r - t) / (6.0 - x * t));
    if (k == 0) {
      return x - (x * e - z);
    }
    e = x * (e - c) - c;
    e -= z;
    if (k == -1) {
      return 0.5 * (x - e) - 0.5;
    }
    if (k == 1) {
      return x < -0.25 ? -2.0 * (e - (x + 0.5)) : 1.0 + 2.0 * (x - e);
    }
    if (k == 1024) {
      return (x - e + 1.0) * 2.0 * 0x1p1023 - 1.0;
    }
    {
      const double power = rpi_real((uint64_t)(uint32_t)(0x3ff + k) << 52);
      if (k < 0 || k > 56) {
        return (x - e + 1.0) * power - 1.0;
      }
      {
        const double inverse = rpi_real((uint64_t)(uint32_t)(0x3ff - k) << 52);
        return k < 20 ? (x - e + (1.0 - inverse)) * power : (x - (e + inverse) + 1.0) * power;
      }
    }
  }
}
/*# rpi_tanh */
static double rpi_tanh(double x) {
  const uint32_t high = rpi_high(x) & 0x7fffffffU;
  const double size = rpi_abs(x);
  double t;
  if (high > 0x40340000U) {
    t = 1.0 - 0.0 / size;
  } else if (high > 0x3fe193eaU) {
    t = 1.0 - 2.0 / (rpi_expm1(2.0 * size) + 2.0);
  } else if (high > 0x3fd058aeU) {
    t = rpi_expm1(2.0 * size);
    t = t / (t + 2.0);
  } else if (high >= 0x00100000U) {
    t = rpi_expm1(-2.0 * size);
    t = -t / (t + 2.0);
  } else {
    t = size;
  }
  return rpi_high(x) >> 31 != 0U ? -t : t;
}
