/*# rpi_index */
static inline size_t rpi_index(uint64_t word) {
  return (size_t)word;
}
/*# rpi_window_push */
/* Adds a value of `size` reals to a window, removes the oldest one from a full window and writes the sum. The words are
   the position, the number of values, the running sum, the sum of this turn and the values. */
static void rpi_window_push(uint64_t *window, size_t words, size_t size, const double *value, double *sum) {
  const size_t capacity = (words - 2U - 2U * size) / size;
  const size_t next = rpi_index(window[0]) % capacity;
  const bool is_complete = next + 1U == capacity;
  size_t k;
  for (k = 0; k < size; k += 1U) {
    uint64_t *entry = window + 2U + (2U + next) * size + k;
    const double turn = rpi_real(window[2U + size + k]) + value[k];
    const double running = rpi_real(window[2U + k]) + value[k] - rpi_real(*entry);
    *entry = rpi_bits(value[k]);
    sum[k] = is_complete ? turn : running;
    window[2U + k] = rpi_bits(sum[k]);
    window[2U + size + k] = rpi_bits(is_complete ? 0.0 : turn);
  }
  window[0] = (uint64_t)((next + 1U) % capacity);
  if (rpi_index(window[1]) < capacity) {
    window[1] += 1U;
  }
}
/*# rpi_clear */
static inline void rpi_clear(uint64_t *words, size_t count) {
  size_t k;
  for (k = 0; k < count; k += 1U) {
    words[k] = 0U;
  }
}
/*# rpi_mean */
/* Mean of the values in a window of `size` reals, after adding a value. */
static void rpi_mean(uint64_t *window, size_t words, size_t size, const double *value, bool reset, double *mean) {
  size_t k;
  if (reset) {
    rpi_clear(window, words);
  }
  rpi_window_push(window, words, size, value, mean);
  for (k = 0; k < size; k += 1U) {
    mean[k] = mean[k] / (double)window[1];
  }
}
/*# rpi_count */
/* Adds a Boolean to a window and returns the number of true values; `capacity` becomes the number that it can hold. */
static int64_t rpi_count(uint64_t *window, size_t words, bool value, bool reset, int64_t *capacity) {
  const size_t most = words - 4U;
  size_t next;
  uint64_t turn;
  if (reset) {
    rpi_clear(window, words);
  }
  next = rpi_index(window[0]) % most;
  turn = window[3] + (value ? 1U : 0U);
  window[2] = window[2] + (value ? 1U : 0U) - window[4U + next];
  window[4U + next] = value ? 1U : 0U;
  window[3] = turn;
  if (next + 1U == most) {
    window[2] = turn;
    window[3] = 0U;
  }
  window[0] = (uint64_t)((next + 1U) % most);
  if (rpi_index(window[1]) < most) {
    window[1] += 1U;
  }
  *capacity = (int64_t)most;
  return (int64_t)window[2];
}
/*# rpi_ring_entry */
/* Words of an entry, or a null pointer if it does not exist or is an absence. `back` counts from the newest entry. */
static const uint64_t *rpi_ring_entry(const uint64_t *ring, size_t words, size_t size, size_t back) {
  const size_t capacity = (words - 2U) / (size + 1U);
  const size_t next = rpi_index(ring[0]) % capacity;
  const uint64_t *entry;
  if (back >= capacity || back >= rpi_index(ring[1])) {
    return NULL;
  }
  entry = ring + 2U + ((next + capacity - 1U - back) % capacity) * (size + 1U);
  return entry[0] != 0U ? entry + 1 : NULL;
}
/*# rpi_ring_push */
/* Makes room for the newest entry in a ring and returns its words. */
static uint64_t *rpi_ring_push(uint64_t *ring, size_t words, size_t size, bool is_present) {
  const size_t capacity = (words - 2U) / (size + 1U);
  const size_t next = rpi_index(ring[0]) % capacity;
  uint64_t *entry = ring + 2U + next * (size + 1U);
  entry[0] = is_present ? 1U : 0U;
  ring[0] = (uint64_t)((next + 1U) % capacity);
  if (rpi_index(ring[1]) < capacity) {
    ring[1] += 1U;
  }
  return entry + 1;
}
/*# rpi_cycles_back */
/* Number of whole cycles in a share of a history. */
static inline size_t rpi_cycles_back(double share, size_t oldest) {
  const double cycles = rpi_floor(share * (double)oldest);
  const size_t most = oldest > 0U ? oldest - 1U : 0U;
  if (!(cycles > 0.0)) {
    return 0U;
  }
  return cycles < (double)most ? (size_t)cycles : most;
}
/*# rpi_range_at */
/* The two points of time of the entry `back` of a history of ranges; false if it is absent. */
static bool rpi_range_at(const uint64_t *starts, size_t words, size_t back, int64_t *range) {
  const uint64_t *start = rpi_ring_entry(starts, words, 1U, back);
  const uint64_t *end = rpi_ring_entry(starts + words, words, 1U, back);
  if (start == NULL || end == NULL) {
    return false;
  }
  range[0] = rpi_integer(*start);
  range[1] = rpi_integer(*end);
  return true;
}
/*# rpi_range_push */
static void rpi_range_push(uint64_t *starts, size_t words, bool is_present, const int64_t *range) {
  uint64_t *start = rpi_ring_push(starts, words, 1U, is_present);
  uint64_t *end = rpi_ring_push(starts + words, words, 1U, is_present);
  if (is_present) {
    *start = (uint64_t)range[0];
    *end = (uint64_t)range[1];
  }
}
/*# rpi_range_hull */
/* Smallest range that covers both; false if it is not shorter than `most` seconds. */
static bool rpi_range_hull(const int64_t *a, const int64_t *b, double most, int64_t *hull) {
  hull[0] = a[0] < b[0] ? a[0] : b[0];
  hull[1] = a[1] > b[1] ? a[1] : b[1];
  return rpi_time_between(hull[0], hull[1]) < most;
}
/*# rpi_consistent_range */
/* Newest range that covers a range of the first and a range of the second input; one of them is of this cycle. */
static bool rpi_consistent_range(uint64_t *ring, size_t words, const int64_t *first, bool has_first,
                                 const int64_t *second, bool has_second, double most, int64_t *found) {
  const size_t each = words / 6U;
  const size_t capacity = (each - 2U) / 2U;
  int64_t older[2];
  bool is_found = false;
  size_t k;
  rpi_range_push(ring, each, has_first, first);
  rpi_range_push(ring + 2U * each, each, has_second, second);
  for (k = 0; k < capacity && !is_found; k += 1U) {
    is_found = (has_first && rpi_range_at(ring + 2U * each, each, k, older) &&
                rpi_range_hull(first, older, most, found)) ||
               (has_second && rpi_range_at(ring, each, k, older) && rpi_range_hull(older, second, most, found));
  }
  rpi_range_push(ring + 4U * each, each, is_found, found);
  for (k = 0; k < capacity && !is_found; k += 1U) {
    is_found = rpi_range_at(ring + 4U * each, each, k, found);
  }
  return is_found;
}
/*# rpi_solve */
/* Solves n linear equations by Gaussian elimination with partial pivoting (Golub and Van Loan, 3.4). */
static void rpi_solve(const double *matrix, const double *right, int32_t n, double *out) {
  double rows[16][17];
  bool is_finite = true;
  int32_t r;
  int32_t c;
  int32_t k;
  for (r = 0; r < n; r += 1) {
    for (c = 0; c < n; c += 1) {
      rows[r][c] = matrix[r * n + c];
    }
    rows[r][16] = right[r];
  }
  for (k = 0; k < n; k += 1) {
    int32_t pivot = k;
    for (r = k + 1; r < n; r += 1) {
      if (rpi_abs(rows[r][k]) > rpi_abs(rows[pivot][k])) {
        pivot = r;
      }
    }
    if (pivot != k) {
      for (c = 0; c < 17; c += 1) {
        const double swapped = rows[k][c];
        if (c < n || c == 16) {
          rows[k][c] = rows[pivot][c];
          rows[pivot][c] = swapped;
        }
      }
    }
    for (r = k + 1; r < n; r += 1) {
      const double factor = rows[r][k] / rows[k][k];
      for (c = k; c < n; c += 1) {
        rows[r][c] -= factor * rows[k][c];
      }
      rows[r][16] -= factor * rows[k][16];
    }
  }
  for (k = n - 1; k >= 0; k -= 1) {
    double known = -0.0;
    for (c = k + 1; c < n; c += 1) {
      known += rows[k][c] * rows[c][16];
    }
    rows[k][16] = (rows[k][16] - known) / rows[k][k];
    is_finite = is_finite && rpi_is_finite(rows[k][16]);
  }
  for (k = 0; k < n; k += 1) {
    out[k] = is_finite ? rows[k][16] : rpi_nan();
  }
}
