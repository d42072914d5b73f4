#include <stdbool.h>
#include <stdint.h>

double weighted(const double *in1, int64_t in2);
void split(const double *in1, bool in2, double *out1, int64_t *out2, bool *out3);
int64_t twice(int64_t in1);

double weighted(const double *in1, int64_t in2) {
  return (in1[0] * 0.5 + in1[1]) * (double)in2 + in1[2];
}

void split(const double *in1, bool in2, double *out1, int64_t *out2, bool *out3) {
  *out1 = in1[0] - in1[1];
  out2[0] = in1[0] > in1[1] ? 1 : 0;
  out2[1] = in2 ? 7 : -7;
  *out3 = !in2;
}

int64_t twice(int64_t in1) {
  return 2 * in1;
}
