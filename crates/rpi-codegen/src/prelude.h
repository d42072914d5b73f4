#ifndef RPI_TYPES
#define RPI_TYPES
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Cause of a fault. A cycle with a fault has no set-points, and the command ends. */
enum rpi_fault_code {
  RPI_NO_FAULT = 0,
  RPI_INTEGER_OVERFLOW = 1,
  RPI_DIVISION_BY_ZERO = 2,
  RPI_LOSSY_CONVERSION = 3,
  RPI_INDEX_OUT_OF_RANGE = 4,
  RPI_SHAPE_MISMATCH = 5,
  RPI_CONCURRENT_ACCESS = 6,
  RPI_ASSERTION_FAILED = 11,
  RPI_OUTSIDE_SUBRANGE = 12,
  RPI_EMERGENCY_STOP = 13
};

/* First fault of a cycle: its cause, and the place in the source; line and column are 0 if they are not known. */
typedef struct rpi_fault_report {
  int32_t code;
  uint32_t line;
  uint32_t column;
  const char *file;
  const char *flow;
} rpi_fault_report;

/* Argument or result of a device function. A Boolean is the integer 0 or 1. */
typedef union rpi_word {
  double real;
  int64_t integer;
} rpi_word;
#endif
