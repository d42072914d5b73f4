/* Clock of the board for measurements, included before the program. */
#ifndef BOARD_H
#define BOARD_H
#include <stdint.h>

/* Number of periods of the processor clock (25 MHz), modulo 2^24. */
static inline uint32_t board_clock(void) {
  return 0xFFFFFFU - *(volatile uint32_t *)0xE000E018U;
}

#define DRIVER_CLOCK() board_clock()
#endif
