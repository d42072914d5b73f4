/*# rpi_angle */
/* An angle as a multiple of pi / 32, of which the lower 6 bits matter, and a remainder of at most pi / 64. */
typedef struct {
  uint32_t step;
  rpi_pair rest;
} rpi_angle;
/*# rpi_turn_fraction */
/* Fraction of an integer times 1 / (2 pi), where the table begins `skipped` bits later. */
static void rpi_turn_fraction(uint64_t integer, uint32_t skipped, uint32_t fraction[7]) {
  const uint32_t first = skipped / 32U;
  const uint32_t shift = skipped % 32U;
  const uint64_t upper = integer >> 32;
  const uint64_t lower = integer & UINT64_C(0xffffffff);
  uint64_t carry = 0;
  uint64_t above = 0;
  uint32_t left;
  for (left = 7; left > 0U; left -= 1U) {
    const uint32_t k = left - 1U;
    const uint64_t both = ((uint64_t)rpi_turn_words[first + k] << 32) | rpi_turn_words[first + k + 1U];
    const uint64_t word = (both << shift) >> 32;
    const uint64_t low = word * lower;
    uint64_t sum;
    /* The upper half of the integer contributes one word further up. */
    carry += above;
    sum = (low & UINT64_C(0xffffffff)) + (carry & UINT64_C(0xffffffff));
    fraction[k] = (uint32_t)(sum & UINT64_C(0xffffffff));
    carry = (carry >> 32) + (low >> 32) + (sum >> 32);
    above = word * upper;
  }
}
/*# rpi_negate_words */
/* Two's complement of a number of seven words. */
static void rpi_negate_words(uint32_t words[7]) {
  uint64_t carry = 1;
  uint32_t left;
  for (left = 7; left > 0U; left -= 1U) {
    const uint64_t sum = (words[left - 1U] ^ UINT64_C(0xffffffff)) + carry;
    words[left - 1U] = (uint32_t)(sum & UINT64_C(0xffffffff));
    carry = sum >> 32;
  }
}
/*# rpi_angle_of_fraction */
/* Angle in rad of a fraction of a turn. */
static rpi_pair rpi_angle_of_fraction(const uint32_t fraction[7]) {
  uint32_t first = 0;
  uint64_t upper;
  uint64_t lower;
  uint64_t rest;
  int32_t exponent;
  double high;
  double low;
  rpi_pair product;
  while (first < 3U && fraction[first] == 0U) {
    first += 1U;
  }
  upper = ((uint64_t)fraction[first] << 32) | fraction[first + 1U];
  lower = ((uint64_t)fraction[first + 2U] << 32) | fraction[first + 3U];
  exponent = -32 * (int32_t)first;
  while ((upper >> 63) == 0U && exponent > -300) {
    upper = (upper << 1) | (lower >> 63);
    lower <<= 1;
    exponent -= 1;
  }
  /* 53 bits each. */
  rest = ((upper & 0x7ffU) << 42) | (lower >> 22);
  high = (double)(upper >> 11) * rpi_power_of_two(exponent - 53);
  low = (double)rest * rpi_power_of_two(exponent - 106);
  product = rpi_product(high, rpi_turn_high);
  return rpi_ordered_sum(product.high, product.low + (high * rpi_turn_low + low * rpi_turn_high));
}
/*# rpi_reduce_large */
/* Reduces a finite angle of at least 2^-10 rad in size. After Payne and Hanek, Radian reduction for trigonometric
   functions, 1983. */
static rpi_angle rpi_reduce_large(double x) {
  const uint64_t bits = rpi_bits(x);
  const bool negative = (bits >> 63) != 0U;
  const uint64_t integer = (bits & UINT64_C(0x000fffffffffffff)) | UINT64_C(0x0010000000000000);
  uint32_t fraction[7] = {0U};
  rpi_angle angle;
  bool below;
  rpi_turn_fraction(integer, (uint32_t)(rpi_biased_exponent(x) - 1075 + 64), fraction);
  /* The first 6 bits, rounded, are the multiple of pi / 32. */
  angle.step = ((fraction[0] >> 25) + 1U) >> 1;
  fraction[0] -= angle.step << 26;
  below = (fraction[0] >> 31) != 0U;
  if (below) {
    rpi_negate_words(fraction);
  }
  angle.rest = rpi_angle_of_fraction(fraction);
  if (below != negative) {
    angle.rest = rpi_pair_of(-angle.rest.high, -angle.rest.low);
  }
  if (negative) {
    angle.step = 0U - angle.step;
  }
  return angle;
}
