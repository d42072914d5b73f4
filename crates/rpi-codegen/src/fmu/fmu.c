
/* Functions of the Functional Mock-up Interface 3.0 for co-simulation (https://fmi-standard.org).

   Cycle n of the program has the inputs at the time n * fmu_period. The step from that time on runs the cycle, and its
   outputs are those after the step. The value reference 0 is the time; k + 1 is the row k of fmu_variables. */

#include <stdio.h>
#include <stdlib.h>

#if defined(_WIN32)
#define FMU_EXPORT __declspec(dllexport)
#else
#define FMU_EXPORT __attribute__((visibility("default")))
#endif

typedef enum { FMI3_OK = 0, FMI3_ERROR = 3 } fmu_status;
typedef uint32_t fmu_reference;
typedef void (*fmu_log_callback)(void *environment, fmu_status status, const char *category, const char *message);

typedef struct fmu_instance {
  fmu_in in;
  fmu_out out;
  fmu_program_state state;
  double start;
  double time;
  uint64_t cycle;
  bool has_ended;
  bool has_failed;
  void *environment;
  fmu_log_callback log;
} fmu_instance;

#ifdef __cplusplus
extern "C" {
#endif

FMU_EXPORT const char *fmi3GetVersion(void) {
  return "3.0";
}

FMU_EXPORT fmu_status fmi3SetDebugLogging(void *instance, bool is_on, size_t count, const char *const categories[]) {
  (void)instance;
  (void)is_on;
  (void)count;
  (void)categories;
  return FMI3_OK;
}

static void fmu_begin(fmu_instance *fmu) {
  fmu_program_init(&fmu->in);
  fmu_program_reset(&fmu->state);
  memset(&fmu->out, 0, sizeof fmu->out);
  fmu->start = 0.0;
  fmu->time = 0.0;
  fmu->cycle = 0U;
  fmu->has_ended = false;
  fmu->has_failed = false;
}

static void fmu_report(const fmu_instance *fmu, const char *message) {
  if (fmu->log != NULL) {
    fmu->log(fmu->environment, FMI3_ERROR, "error", message);
  }
}

FMU_EXPORT void *fmi3InstantiateCoSimulation(const char *name, const char *token, const char *resources, bool is_visible,
    bool is_logging, bool has_events, bool may_return_early, const fmu_reference intermediate[], size_t count,
    void *environment, fmu_log_callback log, void (*update)(void)) {
  fmu_instance *fmu;
  (void)name;
  (void)resources;
  (void)is_visible;
  (void)is_logging;
  (void)may_return_early;
  (void)intermediate;
  (void)update;
  if (token == NULL || strcmp(token, fmu_token) != 0 || has_events || count > 0U || !fmu_program_self_test()) {
    if (log != NULL) {
      log(environment, FMI3_ERROR, "error",
          "the model description is that of another program, events are requested, or the compiler contracts operations");
    }
    return NULL;
  }
  fmu = (fmu_instance *)calloc(1U, sizeof *fmu);
  if (fmu != NULL) {
    fmu->environment = environment;
    fmu->log = log;
    fmu_begin(fmu);
  }
  return fmu;
}

FMU_EXPORT void fmi3FreeInstance(void *instance) {
  free(instance);
}

FMU_EXPORT fmu_status fmi3EnterInitializationMode(void *instance, bool has_tolerance, double tolerance, double start,
    bool has_stop, double stop) {
  fmu_instance *const fmu = (fmu_instance *)instance;
  (void)has_tolerance;
  (void)tolerance;
  (void)has_stop;
  (void)stop;
  fmu->start = start;
  fmu->time = start;
  return FMI3_OK;
}

FMU_EXPORT fmu_status fmi3ExitInitializationMode(void *instance) {
  (void)instance;
  return FMI3_OK;
}

FMU_EXPORT fmu_status fmi3Terminate(void *instance) {
  (void)instance;
  return FMI3_OK;
}

FMU_EXPORT fmu_status fmi3Reset(void *instance) {
  fmu_begin((fmu_instance *)instance);
  return FMI3_OK;
}

static fmu_status fmu_fail(fmu_instance *fmu) {
  char message[512];
  const rpi_fault_report *const fault = &fmu->out.fault;
  (void)snprintf(message, sizeof message, "fault %ld in %s:%lu (%s)", (long)fault->code,
      fault->file == NULL ? "" : fault->file, (unsigned long)fault->line, fault->flow == NULL ? "" : fault->flow);
  fmu_report(fmu, message);
  fmu->has_failed = true;
  return FMI3_ERROR;
}

FMU_EXPORT fmu_status fmi3DoStep(void *instance, double time, double step, bool is_final, bool *needs_events,
    bool *terminates, bool *returned_early, double *reached) {
  fmu_instance *const fmu = (fmu_instance *)instance;
  /* A thousandth of a period makes up for the rounding of the times. */
  const double cycles = (time + step - fmu->start) / fmu_period + 1e-3;
  (void)is_final;
  *needs_events = false;
  *returned_early = false;
  *terminates = fmu->has_ended;
  *reached = fmu->time;
  if (fmu->has_failed || !(cycles >= 0.0 && cycles < 9007199254740992.0)) {
    return FMI3_ERROR;
  }
  while (fmu->cycle < (uint64_t)cycles && !fmu->has_ended) {
    if (fmu_program_step(&fmu->state, &fmu->in, &fmu->out) != RPI_NO_FAULT) {
      return fmu_fail(fmu);
    }
    fmu->cycle += 1U;
    fmu->has_ended = fmu_has_ended(&fmu->out);
  }
  fmu->time = time + step;
  *terminates = fmu->has_ended;
  *reached = fmu->time;
  return FMI3_OK;
}

/* Returns the place of a variable; NULL if there is none of this type. */
static void *fmu_place(fmu_instance *fmu, fmu_reference reference, fmu_type type, size_t *length) {
  const size_t count = sizeof fmu_variables / sizeof fmu_variables[0];
  const fmu_variable *variable;
  *length = 1U;
  if (reference == 0U) {
    return type == FMU_REAL ? &fmu->time : NULL;
  }
  if (reference > count || fmu_variables[reference - 1U].type != type) {
    return NULL;
  }
  variable = &fmu_variables[reference - 1U];
  *length = variable->length;
  return (variable->is_input ? (char *)&fmu->in : (char *)&fmu->out) + variable->offset;
}

static fmu_status fmu_copy(void *instance, const fmu_reference references[], size_t count, char *to, const char *from,
    size_t values, size_t size, fmu_type type) {
  fmu_instance *const fmu = (fmu_instance *)instance;
  size_t at = 0U;
  size_t k;
  for (k = 0U; k < count; k += 1U) {
    size_t length;
    char *const place = (char *)fmu_place(fmu, references[k], type, &length);
    const bool is_writable = references[k] > 0U && (place == NULL || fmu_variables[references[k] - 1U].is_input);
    if (place == NULL || length > values - at || (from != NULL && !is_writable)) {
      fmu_report(fmu, "no such variable of this type and size");
      return FMI3_ERROR;
    }
    if (from != NULL) {
      memcpy(place, from + at * size, length * size);
    } else {
      memcpy(to + at * size, place, length * size);
    }
    at += length;
  }
  return FMI3_OK;
}

#define FMU_ACCESS(name, type, kind)                                                                                    \
  FMU_EXPORT fmu_status fmi3Get##name(void *instance, const fmu_reference references[], size_t count, type values[],    \
      size_t length) {                                                                                                  \
    return fmu_copy(instance, references, count, (char *)values, NULL, length, sizeof(type), kind);                     \
  }                                                                                                                     \
  FMU_EXPORT fmu_status fmi3Set##name(void *instance, const fmu_reference references[], size_t count,                   \
      const type values[], size_t length) {                                                                             \
    return fmu_copy(instance, references, count, NULL, (const char *)values, length, sizeof(type), kind);               \
  }

FMU_ACCESS(Float64, double, FMU_REAL)
FMU_ACCESS(Int64, int64_t, FMU_INTEGER)
FMU_ACCESS(UInt64, uint64_t, FMU_WORD)
FMU_ACCESS(Boolean, bool, FMU_BOOLEAN)
/* There are no variables of the other types. */
FMU_ACCESS(Float32, float, FMU_NONE)
FMU_ACCESS(Int8, int8_t, FMU_NONE)
FMU_ACCESS(UInt8, uint8_t, FMU_NONE)
FMU_ACCESS(Int16, int16_t, FMU_NONE)
FMU_ACCESS(UInt16, uint16_t, FMU_NONE)
FMU_ACCESS(Int32, int32_t, FMU_NONE)
FMU_ACCESS(UInt32, uint32_t, FMU_NONE)

FMU_EXPORT fmu_status fmi3GetFMUState(void *instance, void **saved) {
  if (*saved == NULL) {
    *saved = malloc(sizeof(fmu_instance));
  }
  if (*saved == NULL) {
    return FMI3_ERROR;
  }
  memcpy(*saved, instance, sizeof(fmu_instance));
  return FMI3_OK;
}

FMU_EXPORT fmu_status fmi3SetFMUState(void *instance, void *saved) {
  fmu_instance *const fmu = (fmu_instance *)instance;
  void *const environment = fmu->environment;
  const fmu_log_callback log = fmu->log;
  memcpy(fmu, saved, sizeof *fmu);
  fmu->environment = environment;
  fmu->log = log;
  return FMI3_OK;
}

FMU_EXPORT fmu_status fmi3FreeFMUState(void *instance, void **saved) {
  (void)instance;
  free(*saved);
  *saved = NULL;
  return FMI3_OK;
}

FMU_EXPORT fmu_status fmi3SerializedFMUStateSize(void *instance, void *saved, size_t *size) {
  (void)instance;
  (void)saved;
  *size = sizeof(fmu_instance);
  return FMI3_OK;
}

FMU_EXPORT fmu_status fmi3SerializeFMUState(void *instance, void *saved, uint8_t bytes[], size_t size) {
  (void)instance;
  if (size < sizeof(fmu_instance)) {
    return FMI3_ERROR;
  }
  memcpy(bytes, saved, sizeof(fmu_instance));
  return FMI3_OK;
}

FMU_EXPORT fmu_status fmi3DeserializeFMUState(void *instance, const uint8_t bytes[], size_t size, void **saved) {
  if (size != sizeof(fmu_instance) || fmi3GetFMUState(instance, saved) != FMI3_OK) {
    return FMI3_ERROR;
  }
  memcpy(*saved, bytes, sizeof(fmu_instance));
  return FMI3_OK;
}

/* Functions that the interface requires of each library, for features that the model description denies. */
#define FMU_REFUSED(name, ...)                 \
  FMU_EXPORT fmu_status name(__VA_ARGS__) { \
    return FMI3_ERROR;                         \
  }
#define FMU_VALUES void *instance, const fmu_reference references[], size_t count

FMU_EXPORT void *fmi3InstantiateModelExchange(const char *name, const char *token, const char *resources, bool is_visible,
    bool is_logging, void *environment, fmu_log_callback log) {
  return NULL;
}

FMU_EXPORT void *fmi3InstantiateScheduledExecution(const char *name, const char *token, const char *resources,
    bool is_visible, bool is_logging, void *environment, fmu_log_callback log, void (*update)(void), void (*lock)(void),
    void (*unlock)(void)) {
  return NULL;
}

FMU_REFUSED(fmi3EnterEventMode, void *instance)
FMU_REFUSED(fmi3EnterStepMode, void *instance)
FMU_REFUSED(fmi3EnterConfigurationMode, void *instance)
FMU_REFUSED(fmi3ExitConfigurationMode, void *instance)
FMU_REFUSED(fmi3EvaluateDiscreteStates, void *instance)
FMU_REFUSED(fmi3UpdateDiscreteStates, void *instance, bool *is_needed, bool *terminates, bool *nominals, bool *states,
    bool *has_next, double *next)
FMU_REFUSED(fmi3GetString, FMU_VALUES, const char *values[], size_t length)
FMU_REFUSED(fmi3SetString, FMU_VALUES, const char *const values[], size_t length)
FMU_REFUSED(fmi3GetBinary, FMU_VALUES, size_t sizes[], const uint8_t *values[], size_t length)
FMU_REFUSED(fmi3SetBinary, FMU_VALUES, const size_t sizes[], const uint8_t *const values[], size_t length)
FMU_REFUSED(fmi3GetClock, FMU_VALUES, bool values[])
FMU_REFUSED(fmi3SetClock, FMU_VALUES, const bool values[])
FMU_REFUSED(fmi3GetIntervalDecimal, FMU_VALUES, double intervals[], int qualifiers[])
FMU_REFUSED(fmi3GetIntervalFraction, FMU_VALUES, uint64_t counters[], uint64_t resolutions[], int qualifiers[])
FMU_REFUSED(fmi3GetShiftDecimal, FMU_VALUES, double shifts[])
FMU_REFUSED(fmi3GetShiftFraction, FMU_VALUES, uint64_t counters[], uint64_t resolutions[])
FMU_REFUSED(fmi3SetIntervalDecimal, FMU_VALUES, const double intervals[])
FMU_REFUSED(fmi3SetIntervalFraction, FMU_VALUES, const uint64_t counters[], const uint64_t resolutions[])
FMU_REFUSED(fmi3SetShiftDecimal, FMU_VALUES, const double shifts[])
FMU_REFUSED(fmi3SetShiftFraction, FMU_VALUES, const uint64_t counters[], const uint64_t resolutions[])
FMU_REFUSED(fmi3GetNumberOfVariableDependencies, void *instance, fmu_reference reference, size_t *count)
FMU_REFUSED(fmi3GetVariableDependencies, void *instance, fmu_reference reference, size_t elements[],
    fmu_reference independents[], size_t indices[], int kinds[], size_t count)
FMU_REFUSED(fmi3GetDirectionalDerivative, FMU_VALUES, const fmu_reference knowns[], size_t known_count,
    const double seed[], size_t seed_length, double sensitivity[], size_t length)
FMU_REFUSED(fmi3GetAdjointDerivative, FMU_VALUES, const fmu_reference knowns[], size_t known_count, const double seed[],
    size_t seed_length, double sensitivity[], size_t length)
FMU_REFUSED(fmi3GetOutputDerivatives, FMU_VALUES, const int32_t orders[], double values[], size_t length)
FMU_REFUSED(fmi3EnterContinuousTimeMode, void *instance)
FMU_REFUSED(fmi3CompletedIntegratorStep, void *instance, bool is_final, bool *enters_event_mode, bool *terminates)
FMU_REFUSED(fmi3SetTime, void *instance, double time)
FMU_REFUSED(fmi3GetContinuousStates, void *instance, double states[], size_t count)
FMU_REFUSED(fmi3SetContinuousStates, void *instance, const double states[], size_t count)
FMU_REFUSED(fmi3GetContinuousStateDerivatives, void *instance, double derivatives[], size_t count)
FMU_REFUSED(fmi3GetNominalsOfContinuousStates, void *instance, double nominals[], size_t count)
FMU_REFUSED(fmi3GetEventIndicators, void *instance, double indicators[], size_t count)
FMU_REFUSED(fmi3GetNumberOfContinuousStates, void *instance, size_t *count)
FMU_REFUSED(fmi3GetNumberOfEventIndicators, void *instance, size_t *count)
FMU_REFUSED(fmi3ActivateModelPartition, void *instance, fmu_reference clock, double time)

#ifdef __cplusplus
}
#endif
