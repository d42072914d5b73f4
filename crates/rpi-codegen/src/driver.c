
#include <stdio.h>
#include <stdlib.h>
/* After stdio.h, without which newlib leaves out the formats of 64 bits. */
#include <inttypes.h>

/* Number of periods of a clock, modulo 2^24, if the target has one for measurements. */
#ifndef DRIVER_CLOCK
#define DRIVER_CLOCK() 0U
#endif

uint64_t driver_read(void) {
  uint64_t word = 0U;
  if (scanf("%" SCNx64, &word) != 1) {
    exit(3);
  }
  return word;
}

void driver_write(uint64_t word) {
  printf(" %" PRIx64, word);
}

double driver_real(uint64_t word) {
  double x;
  memcpy(&x, &word, sizeof x);
  return x;
}

int64_t driver_integer(uint64_t word) {
  int64_t n;
  memcpy(&n, &word, sizeof n);
  return n;
}

uint64_t driver_bits(double x) {
  uint64_t word;
  memcpy(&word, &x, sizeof word);
  return word;
}

