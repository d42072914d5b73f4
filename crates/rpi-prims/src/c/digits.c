/*# rpi_digit_count */
/* Number of elements of a digit array to use. */
static inline int32_t rpi_digit_count(int64_t bits, int32_t length) {
  const int32_t most = length < 63 ? length : 63;
  return bits < 0 ? 0 : (bits < (int64_t)most ? (int32_t)bits : most);
}
/*# rpi_number */
/* Number with the given binary digits; the first one is the least significant. */
static inline int64_t rpi_number(const bool *digits, int32_t count) {
  uint64_t value = 0U;
  int32_t k;
  for (k = 0; k < count; k += 1) {
    value |= (digits[k] ? UINT64_C(1) : UINT64_C(0)) << k;
  }
  return rpi_integer(value);
}
/*# rpi_decimal */
/* Number with the given decimal digits of four bits each; a fault for a digit above 9. */
static int64_t rpi_decimal(rpi_context *cx, int32_t at, const bool *digits, int32_t count) {
  int64_t value = 0;
  int32_t first;
  for (first = count > 0 ? (count - 1) / 4 * 4 : -1; first >= 0; first -= 4) {
    const int64_t digit = rpi_number(digits + first, count - first < 4 ? count - first : 4);
    if (digit > 9) {
      rpi_fault(cx, RPI_LOSSY_CONVERSION, at);
    }
    value = value * 10 + (digit < 9 ? digit : 9);
  }
  return value;
}
/*# rpi_to_decimal */
/* Decimal digits of four bits each of a number; true if it does not fit. */
static bool rpi_to_decimal(int64_t value, bool has_sign, bool *digits, int32_t length) {
  const int32_t count = has_sign && length > 0 ? length - 1 : length;
  uint64_t rest = value < 0 ? UINT64_C(0) - (uint64_t)value : (uint64_t)value;
  int32_t first;
  for (first = 0; first < count; first += 4) {
    const int32_t size = count - first < 4 ? count - first : 4;
    const uint64_t digit = rest % 10U;
    int32_t k;
    for (k = 0; k < size; k += 1) {
      digits[first + k] = ((digit >> k) & 1U) != 0U;
    }
    /* A digit that does not fit leaves a rest. */
    rest = digit < (UINT64_C(1) << size) ? rest / 10U : UINT64_MAX;
  }
  if (count < length) {
    digits[count] = value < 0;
  }
  return rest > 0U || (value < 0 && count == length);
}
/*# rpi_selected */
/* Entry of a list of row or column numbers; the number itself if the list is empty. */
static inline int64_t rpi_selected(const int64_t *list, int32_t length, int32_t k) {
  return length == 0 ? (int64_t)k : list[k];
}
/*# rpi_element */
/* Element of a matrix, or 0 outside of it. */
static inline double rpi_element(const double *matrix, int32_t rows, int32_t cols, int64_t row, int64_t col) {
  return row >= 0 && row < rows && col >= 0 && col < cols ? matrix[row * cols + col] : 0.0;
}
/*# rpi_ramp */
/* Position of a motion with a trapezoidal speed profile at a relative time. */
static double rpi_ramp(double time, double constant) {
  const double top = 2.0 / (1.0 + constant);
  const double rise = (1.0 - constant) / 2.0;
  if (time <= 0.0) {
    return 0.0;
  }
  if (time >= 1.0) {
    return 1.0;
  }
  if (time < rise) {
    return top * time * time / (2.0 * rise);
  }
  if (time <= 1.0 - rise) {
    return top * (time - rise / 2.0);
  }
  return 1.0 - top * (1.0 - time) * (1.0 - time) / (2.0 * rise);
}
/*# rpi_bezier */
/* Cubic Bezier curve in Bernstein form. */
static inline double rpi_bezier(double t, double p0, double p1, double p2, double p3) {
  const double s = 1.0 - t;
  return s * s * s * p0 + 3.0 * s * s * t * p1 + 3.0 * s * t * t * p2 + t * t * t * p3;
}
