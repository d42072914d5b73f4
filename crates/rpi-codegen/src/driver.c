
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

static inline uint64_t driver_read(void) {
  uint64_t word = 0U;
  if (scanf("%" SCNx64, &word) != 1) {
    exit(3);
  }
  return word;
}

static inline void driver_write(uint64_t word) {
  printf(" %" PRIx64, word);
}

static inline double driver_real(uint64_t word) {
  double x;
  memcpy(&x, &word, sizeof x);
  return x;
}

static inline int64_t driver_integer(uint64_t word) {
  int64_t n;
  memcpy(&n, &word, sizeof n);
  return n;
}

static inline uint64_t driver_bits(double x) {
  uint64_t word;
  memcpy(&word, &x, sizeof word);
  return word;
}

static inline bool driver_call(int number, const rpi_word *arguments, int count, rpi_word *results, int expected) {
  int k;
  printf("c %d", number);
  for (k = 0; k < count; k += 1) {
    driver_write(driver_bits(arguments[k].real));
  }
  printf("\n");
  fflush(stdout);
  if (driver_read() == 0U) {
    return false;
  }
  for (k = 0; k < expected; k += 1) {
    results[k].real = driver_real(driver_read());
  }
  return true;
}

