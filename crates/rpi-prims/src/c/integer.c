/*# rpi_fault */
/* Records the first fault of a cycle and its place in the source. */
static inline void rpi_fault(rpi_context *cx, int32_t code, int32_t at) {
  if (cx->fault == 0) {
    cx->fault = code;
    cx->place = at;
  }
}
/*# rpi_int_add */
static inline int64_t rpi_int_add(rpi_context *cx, int32_t at, int64_t a, int64_t b) {
  if (b > 0 ? a > INT64_MAX - b : a < INT64_MIN - b) {
    rpi_fault(cx, RPI_INTEGER_OVERFLOW, at);
    return 0;
  }
  return a + b;
}
/*# rpi_int_subtract */
static inline int64_t rpi_int_subtract(rpi_context *cx, int32_t at, int64_t a, int64_t b) {
  if (b < 0 ? a > INT64_MAX + b : a < INT64_MIN + b) {
    rpi_fault(cx, RPI_INTEGER_OVERFLOW, at);
    return 0;
  }
  return a - b;
}
/*# rpi_product_overflows */
static inline bool rpi_product_overflows(int64_t a, int64_t b) {
  if (a == 0 || b == 0) {
    return false;
  }
  if (a > 0) {
    return b > 0 ? a > INT64_MAX / b : b < INT64_MIN / a;
  }
  return b > 0 ? a < INT64_MIN / b : a < INT64_MAX / b;
}
/*# rpi_int_multiply */
static inline int64_t rpi_int_multiply(rpi_context *cx, int32_t at, int64_t a, int64_t b) {
  if (rpi_product_overflows(a, b)) {
    rpi_fault(cx, RPI_INTEGER_OVERFLOW, at);
    return 0;
  }
  return a * b;
}
/*# rpi_int_divide */
static inline int64_t rpi_int_divide(rpi_context *cx, int32_t at, int64_t a, int64_t b) {
  if (b == 0 || (a == INT64_MIN && b == -1)) {
    rpi_fault(cx, b == 0 ? RPI_DIVISION_BY_ZERO : RPI_INTEGER_OVERFLOW, at);
    return 0;
  }
  return a / b;
}
/*# rpi_int_modulo */
static inline int64_t rpi_int_modulo(rpi_context *cx, int32_t at, int64_t a, int64_t b) {
  if (b == 0) {
    rpi_fault(cx, RPI_DIVISION_BY_ZERO, at);
    return 0;
  }
  return b == -1 ? 0 : a % b;
}
/*# rpi_int_power */
static int64_t rpi_int_power(rpi_context *cx, int32_t at, int64_t base, int64_t exponent) {
  int64_t result = 1;
  if (exponent < 0) {
    rpi_fault(cx, RPI_INTEGER_OVERFLOW, at);
    return 0;
  }
  /* Above 63 only the powers of 0, 1 and -1 fit, and they depend only on the parity. */
  if (exponent > 64) {
    exponent = 64 + exponent % 2;
  }
  for (; exponent > 0; exponent -= 1) {
    if (rpi_product_overflows(result, base)) {
      rpi_fault(cx, RPI_INTEGER_OVERFLOW, at);
      return 0;
    }
    result *= base;
  }
  return result;
}
/*# rpi_int_negate */
static inline int64_t rpi_int_negate(rpi_context *cx, int32_t at, int64_t a) {
  if (a == INT64_MIN) {
    rpi_fault(cx, RPI_INTEGER_OVERFLOW, at);
    return 0;
  }
  return -a;
}
/*# rpi_int_absolute */
static inline int64_t rpi_int_absolute(rpi_context *cx, int32_t at, int64_t a) {
  return a < 0 ? rpi_int_negate(cx, at, a) : a;
}
/*# rpi_int_within */
/* `value`, with a fault if it lies outside of its range while `active` is true. */
static inline int64_t rpi_int_within(rpi_context *cx, int32_t at, bool active, int64_t value, int64_t from, int64_t to) {
  if (active && (value < from || value > to)) {
    rpi_fault(cx, RPI_OUTSIDE_SUBRANGE, at);
  }
  return value;
}
/*# rpi_int_near */
/* True if a and b differ by at most `most`. */
static inline bool rpi_int_near(int64_t a, int64_t b, int64_t most) {
  const uint64_t far = a > b ? (uint64_t)a - (uint64_t)b : (uint64_t)b - (uint64_t)a;
  return most >= 0 && far <= (uint64_t)most;
}
/*# rpi_int_from_real */
/* Integer part of a real; a fault if it does not fit. */
static inline int64_t rpi_int_from_real(rpi_context *cx, int32_t at, double x) {
  if (!(x >= -0x1p63 && x < 0x1p63)) {
    rpi_fault(cx, RPI_LOSSY_CONVERSION, at);
    return 0;
  }
  return (int64_t)x;
}
/*# rpi_check */
/* `holds`, with a fault if it is false. */
static inline bool rpi_check(rpi_context *cx, int32_t at, int32_t code, bool holds) {
  if (!holds) {
    rpi_fault(cx, code, at);
  }
  return holds;
}
/*# rpi_wrap */
/* Integer with the lower bits of a number, as many as the magnitude of `width`, which is negative for signed integers. */
static inline int64_t rpi_wrap(int64_t value, int64_t width) {
  const int64_t size = width == INT64_MIN || width < -64 || width > 64 ? 64 : (width < 0 ? -width : width);
  const uint32_t above = 64U - (uint32_t)(size < 1 ? 1 : size);
  const uint64_t low = ((uint64_t)value << above) >> above;
  const uint64_t sign = UINT64_C(1) << (63U - above);
  return rpi_integer(width < 0 && (low & sign) != 0U ? low | ~((sign << 1) - 1U) : low);
}
/*# rpi_machine_divide */
static inline int64_t rpi_machine_divide(int64_t a, int64_t b, int64_t width) {
  int64_t quotient;
  if (b == 0) {
    quotient = width < 0 && a < 0 ? 1 : -1;
  } else if (width >= 0) {
    quotient = rpi_integer((uint64_t)a / (uint64_t)b);
  } else {
    quotient = b == -1 ? rpi_integer(0U - (uint64_t)a) : a / b;
  }
  return rpi_wrap(quotient, width);
}
/*# rpi_machine_modulo */
static inline int64_t rpi_machine_modulo(int64_t a, int64_t b, int64_t width) {
  if (b == 0) {
    return a;
  }
  if (width >= 0) {
    return rpi_integer((uint64_t)a % (uint64_t)b);
  }
  return b == -1 ? 0 : a % b;
}
/*# rpi_shift_left */
static inline int64_t rpi_shift_left(int64_t a, int64_t by, int64_t width) {
  return rpi_wrap(by < 0 || by > 63 ? 0 : rpi_integer((uint64_t)a << by), width);
}
/*# rpi_shift_right */
static inline int64_t rpi_shift_right(int64_t a, int64_t by, int64_t width) {
  const bool is_out = by < 0 || by > 63;
  if (width < 0 && a < 0) {
    return is_out ? -1 : rpi_integer(~(~(uint64_t)a >> by));
  }
  return is_out ? 0 : rpi_integer((uint64_t)a >> by);
}
/*# rpi_seconds */
/* Duration of a number of ticks, in s. */
static inline double rpi_seconds(int64_t ticks) {
  return (double)ticks * rpi_tick_ns / 1e9;
}
/*# rpi_elapsed */
/* Number of ticks of a number of cycles; the longest time if it does not fit. */
static inline int64_t rpi_elapsed(uint64_t cycles, uint64_t period) {
  return rpi_integer(cycles > UINT64_MAX / period ? UINT64_MAX : cycles * period);
}
/*# rpi_whole_ticks */
/* Smallest whole number of ticks that is not shorter than x seconds; false if there is none. */
static bool rpi_whole_ticks(double x, int64_t *ticks) {
  const double about = rpi_floor(x * 1e9 / rpi_tick_ns);
  int64_t whole;
  int32_t k;
  if (!(about >= -0x1.fffffffffffffp62 && about <= 0x1.fffffffffffffp62)) {
    return false;
  }
  whole = (int64_t)about;
  if (rpi_abs(x * 1e9) > 0x1p53) {
    *ticks = whole;
    return true;
  }
  /* The quotient is rounded, so its neighbours are tested. */
  for (k = -2; k <= 2; k += 1) {
    if (rpi_seconds(whole + k) >= x) {
      *ticks = whole + k;
      return true;
    }
  }
  return false;
}
/*# rpi_ticks */
/* Whole number of ticks, with a fault if there is none. */
static int64_t rpi_ticks(rpi_context *cx, int32_t at, double x) {
  int64_t ticks = 0;
  if (!rpi_whole_ticks(x, &ticks)) {
    rpi_fault(cx, RPI_LOSSY_CONVERSION, at);
  }
  return ticks;
}
/*# rpi_saturated_ticks */
/* Whole number of ticks; the longest time if it does not fit. */
static int64_t rpi_saturated_ticks(double x) {
  int64_t ticks = x > 0.0 ? INT64_MAX : (x < 0.0 ? INT64_MIN : 0);
  (void)rpi_whole_ticks(x, &ticks);
  return ticks;
}
/*# rpi_time_between */
/* Time from the first to the second point in time, in s. */
static inline double rpi_time_between(int64_t first, int64_t second) {
  if (second >= first) {
    return (double)((uint64_t)second - (uint64_t)first) / 1e9;
  }
  return -(double)((uint64_t)first - (uint64_t)second) / 1e9;
}
/*# rpi_time_add */
static inline int64_t rpi_time_add(rpi_context *cx, int32_t at, int64_t time, double delta) {
  const int64_t more = rpi_int_from_real(cx, at, delta * 1e9);
  if (more > 0 ? time > INT64_MAX - more : time < INT64_MIN - more) {
    rpi_fault(cx, RPI_INTEGER_OVERFLOW, at);
    return time;
  }
  return time + more;
}
/*# rpi_no_result */
/* Marks the results of a device function as missing: not a number. */
static inline void rpi_no_result(rpi_word *results, int32_t count) {
  int32_t k;
  for (k = 0; k < count; k += 1) {
    results[k].real = rpi_nan();
  }
}
