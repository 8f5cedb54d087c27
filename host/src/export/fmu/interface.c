/* The pendulum of rig.h behind the functions of FMI 3.0, as a co-simulation. C99; needs only the standard library.

   A communication step is taken in equal pieces of at most `longest_step` seconds; the sensor is read after each.
   Functions of what the model does not have, such as clocks, texts and model exchange, say so and return an error. */

#include "fmi.h"
#include "rig.h"

#include <stdlib.h>
#include <string.h>

#if defined(_WIN32)
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
/* The standard says what a function is given; most need little of it. */
#pragma GCC diagnostic ignored "-Wunused-parameter"
#endif

/* Value references; those of the model's numbers follow from `NUMBERS` on. modelDescription.xml has the same. */
enum { TIME, START_ANGLE, START_VELOCITY, LONGEST_STEP, ANGLE, VELOCITY, READING, TORQUE, NUMBERS = 100 };
enum { N_NUMBERS = sizeof(rig_numbers) / sizeof(double) };

/* All that makes the next step what it is. */
typedef struct {
    rig_numbers numbers;
    double start_angle_rad, start_velocity_rad_s, longest_step_s;
    bool runs;
    double time_s;
    rig_state state;
    rig_sensor sensor;
    double reading_rad;
} pendulum;

typedef struct {
    pendulum now;
    fmi3InstanceEnvironment environment;
    fmi3LogMessageCallback log;
} instance;

static fmi3Status refuse(void *given, const char *why) {
    const instance *one = given;
    if (one && one->log) one->log(one->environment, fmi3Error, "logStatusError", why);
    return fmi3Error;
}

static void forget(pendulum *now) {
    memset(now, 0, sizeof *now);
    now->numbers = rig_usual;
    now->start_angle_rad = 1.5;
    now->longest_step_s = 1e-3;
}

/* Lets it go from where it is held. */
static void release(pendulum *now) {
    now->state = rig_release(&now->numbers, now->start_angle_rad, now->start_velocity_rad_s);
    now->sensor = rig_sensor_at_rest(&now->numbers, &now->state);
    now->reading_rad = rig_read(&now->numbers, &now->state, &now->sensor);
}

/* Where a variable stands that may be set; what it is before it runs, may not be set later. */
static double *place(pendulum *now, fmi3ValueReference reference) {
    if (reference >= NUMBERS && reference < NUMBERS + N_NUMBERS)
        return (double *)&now->numbers + (reference - NUMBERS);
    if (now->runs) return NULL;
    switch (reference) {
        case START_ANGLE: return &now->start_angle_rad;
        case START_VELOCITY: return &now->start_velocity_rad_s;
        case LONGEST_STEP: return &now->longest_step_s;
        default: return NULL;
    }
}

static bool value(pendulum *now, fmi3ValueReference reference, double *to) {
    if (!now->runs) release(now);
    switch (reference) {
        case TIME: *to = now->time_s; return true;
        case START_ANGLE: *to = now->start_angle_rad; return true;
        case START_VELOCITY: *to = now->start_velocity_rad_s; return true;
        case LONGEST_STEP: *to = now->longest_step_s; return true;
        case ANGLE: *to = now->state.angle_rad; return true;
        case VELOCITY: *to = now->state.velocity_rad_s; return true;
        case READING: *to = now->reading_rad; return true;
        case TORQUE: *to = rig_friction_nm(&now->numbers, &now->state); return true;
        default: break;
    }
    const double *number = place(now, reference);
    if (number) *to = *number;
    return number != NULL;
}

EXPORT const char *fmi3GetVersion(void) { return "3.0"; }

EXPORT fmi3Instance fmi3InstantiateCoSimulation(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible, fmi3Boolean logging,
    fmi3Boolean events, fmi3Boolean early_return, const fmi3ValueReference intermediate[], size_t n_intermediate,
    fmi3InstanceEnvironment environment, fmi3LogMessageCallback log, fmi3IntermediateUpdateCallback update) {
    if (!token || strcmp(token, RIG_TOKEN) != 0) {
        if (log) log(environment, fmi3Error, "logStatusError", "the token is not that of modelDescription.xml");
        return NULL;
    }
    instance *one = calloc(1, sizeof *one);
    if (!one) return NULL;
    one->environment = environment;
    one->log = log;
    forget(&one->now);
    return one;
}

EXPORT void fmi3FreeInstance(fmi3Instance given) { free(given); }

EXPORT fmi3Status fmi3SetDebugLogging(fmi3Instance given, fmi3Boolean on, size_t n, const fmi3String categories[]) {
    return fmi3OK;
}

EXPORT fmi3Status fmi3EnterInitializationMode(
    fmi3Instance given, fmi3Boolean has_tolerance, fmi3Float64 tolerance, fmi3Float64 start, fmi3Boolean has_stop,
    fmi3Float64 stop) {
    ((instance *)given)->now.time_s = start;
    return fmi3OK;
}

EXPORT fmi3Status fmi3ExitInitializationMode(fmi3Instance given) {
    pendulum *now = &((instance *)given)->now;
    release(now);
    now->runs = true;
    return fmi3OK;
}

EXPORT fmi3Status fmi3Terminate(fmi3Instance given) { return fmi3OK; }

EXPORT fmi3Status fmi3Reset(fmi3Instance given) {
    forget(&((instance *)given)->now);
    return fmi3OK;
}

EXPORT fmi3Status fmi3GetFloat64(
    fmi3Instance given, const fmi3ValueReference references[], size_t n, fmi3Float64 values[], size_t n_values) {
    if (n != n_values) return refuse(given, "there are as many values as variables");
    for (size_t k = 0; k < n; k++)
        if (!value(&((instance *)given)->now, references[k], &values[k])) return refuse(given, "no such variable");
    return fmi3OK;
}

EXPORT fmi3Status fmi3SetFloat64(
    fmi3Instance given, const fmi3ValueReference references[], size_t n, const fmi3Float64 values[],
    size_t n_values) {
    if (n != n_values) return refuse(given, "there are as many values as variables");
    for (size_t k = 0; k < n; k++) {
        double *to = place(&((instance *)given)->now, references[k]);
        if (!to) return refuse(given, "this variable can't be set, or not any more");
        if (!isfinite(values[k])) return refuse(given, "a value must be a finite number");
        if (references[k] == LONGEST_STEP && !(values[k] > 0.0)) return refuse(given, "a step is longer than zero");
        *to = values[k];
    }
    return fmi3OK;
}

EXPORT fmi3Status fmi3DoStep(
    fmi3Instance given, fmi3Float64 from, fmi3Float64 step, fmi3Boolean no_way_back, fmi3Boolean *event,
    fmi3Boolean *terminate, fmi3Boolean *early, fmi3Float64 *reached) {
    pendulum *now = &((instance *)given)->now;
    *event = *terminate = *early = false;
    *reached = from;
    if (!now->runs) return refuse(given, "the initialization is not over");
    if (!(step > 0.0 && isfinite(step))) return refuse(given, "a step is longer than zero");
    /* A step of just the longest length is one piece, whatever its last digit. */
    const double pieces = fmax(1.0, ceil(step / now->longest_step_s - 1e-6));
    for (double k = 0.0; k < pieces; k += 1.0) {
        rig_step(&now->numbers, &now->state, step / pieces);
        now->reading_rad = rig_read(&now->numbers, &now->state, &now->sensor);
    }
    if (!isfinite(now->state.angle_rad) || !isfinite(now->reading_rad))
        return refuse(given, "no pendulum moves like this; are the numbers possible?");
    now->time_s = *reached = from + step;
    return fmi3OK;
}

EXPORT fmi3Status fmi3GetFMUState(fmi3Instance given, fmi3FMUState *state) {
    if (!*state) *state = malloc(sizeof(pendulum));
    if (!*state) return refuse(given, "no memory for the state");
    memcpy(*state, &((instance *)given)->now, sizeof(pendulum));
    return fmi3OK;
}

EXPORT fmi3Status fmi3SetFMUState(fmi3Instance given, fmi3FMUState state) {
    memcpy(&((instance *)given)->now, state, sizeof(pendulum));
    return fmi3OK;
}

EXPORT fmi3Status fmi3FreeFMUState(fmi3Instance given, fmi3FMUState *state) {
    free(*state);
    *state = NULL;
    return fmi3OK;
}

EXPORT fmi3Status fmi3SerializedFMUStateSize(fmi3Instance given, fmi3FMUState state, size_t *size) {
    *size = sizeof(pendulum);
    return fmi3OK;
}

EXPORT fmi3Status fmi3SerializeFMUState(fmi3Instance given, fmi3FMUState state, fmi3Byte bytes[], size_t size) {
    if (size != sizeof(pendulum)) return refuse(given, "a state has another size");
    memcpy(bytes, state, size);
    return fmi3OK;
}

EXPORT fmi3Status fmi3DeserializeFMUState(
    fmi3Instance given, const fmi3Byte bytes[], size_t size, fmi3FMUState *state) {
    if (size != sizeof(pendulum)) return refuse(given, "a state has another size");
    if (!*state) *state = malloc(size);
    if (!*state) return refuse(given, "no memory for the state");
    memcpy(*state, bytes, size);
    return fmi3OK;
}

/* What a pendulum does not have. */

#define NOT_HERE(name, ...) \
    EXPORT fmi3Status name(fmi3Instance given, __VA_ARGS__) { return refuse(given, #name " is not offered"); }
#define NOT_HERE_ALONE(name) \
    EXPORT fmi3Status name(fmi3Instance given) { return refuse(given, #name " is not offered"); }
#define REFERENCES const fmi3ValueReference references[], size_t n
#define NO_VARIABLES(type) \
    NOT_HERE(fmi3Get##type, REFERENCES, fmi3##type values[], size_t n_values) \
    NOT_HERE(fmi3Set##type, REFERENCES, const fmi3##type values[], size_t n_values)

NO_VARIABLES(Float32)
NO_VARIABLES(Int8)
NO_VARIABLES(UInt8)
NO_VARIABLES(Int16)
NO_VARIABLES(UInt16)
NO_VARIABLES(Int32)
NO_VARIABLES(UInt32)
NO_VARIABLES(Int64)
NO_VARIABLES(UInt64)
NO_VARIABLES(Boolean)
NO_VARIABLES(String)
NOT_HERE(fmi3GetBinary, REFERENCES, size_t sizes[], fmi3Binary values[], size_t n_values)
NOT_HERE(fmi3SetBinary, REFERENCES, const size_t sizes[], const fmi3Binary values[], size_t n_values)
NOT_HERE(fmi3GetClock, REFERENCES, fmi3Clock values[])
NOT_HERE(fmi3SetClock, REFERENCES, const fmi3Clock values[])

NOT_HERE(fmi3GetNumberOfVariableDependencies, fmi3ValueReference reference, size_t *n)
NOT_HERE(fmi3GetVariableDependencies, fmi3ValueReference reference, size_t elements[], fmi3ValueReference on[],
         size_t their_elements[], fmi3DependencyKind kinds[], size_t n)
NOT_HERE(fmi3GetDirectionalDerivative, REFERENCES, const fmi3ValueReference knowns[], size_t n_knowns,
         const fmi3Float64 seed[], size_t n_seed, fmi3Float64 sensitivity[], size_t n_sensitivity)
NOT_HERE(fmi3GetAdjointDerivative, REFERENCES, const fmi3ValueReference knowns[], size_t n_knowns,
         const fmi3Float64 seed[], size_t n_seed, fmi3Float64 sensitivity[], size_t n_sensitivity)
NOT_HERE(fmi3GetOutputDerivatives, REFERENCES, const fmi3Int32 orders[], fmi3Float64 values[], size_t n_values)

NOT_HERE_ALONE(fmi3EnterConfigurationMode)
NOT_HERE_ALONE(fmi3ExitConfigurationMode)
NOT_HERE_ALONE(fmi3EnterEventMode)
NOT_HERE_ALONE(fmi3EnterStepMode)
NOT_HERE_ALONE(fmi3EvaluateDiscreteStates)
NOT_HERE(fmi3UpdateDiscreteStates, fmi3Boolean *again, fmi3Boolean *terminate, fmi3Boolean *nominals,
         fmi3Boolean *states, fmi3Boolean *has_next, fmi3Float64 *next)

NOT_HERE(fmi3GetIntervalDecimal, REFERENCES, fmi3Float64 intervals[], fmi3IntervalQualifier qualifiers[])
NOT_HERE(fmi3GetIntervalFraction, REFERENCES, fmi3UInt64 counters[], fmi3UInt64 resolutions[],
         fmi3IntervalQualifier qualifiers[])
NOT_HERE(fmi3GetShiftDecimal, REFERENCES, fmi3Float64 shifts[])
NOT_HERE(fmi3GetShiftFraction, REFERENCES, fmi3UInt64 counters[], fmi3UInt64 resolutions[])
NOT_HERE(fmi3SetIntervalDecimal, REFERENCES, const fmi3Float64 intervals[])
NOT_HERE(fmi3SetIntervalFraction, REFERENCES, const fmi3UInt64 counters[], const fmi3UInt64 resolutions[])
NOT_HERE(fmi3SetShiftDecimal, REFERENCES, const fmi3Float64 shifts[])
NOT_HERE(fmi3SetShiftFraction, REFERENCES, const fmi3UInt64 counters[], const fmi3UInt64 resolutions[])
NOT_HERE(fmi3ActivateModelPartition, fmi3ValueReference clock, fmi3Float64 time)

/* Model exchange and scheduled execution. */

EXPORT fmi3Instance fmi3InstantiateModelExchange(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible, fmi3Boolean logging,
    fmi3InstanceEnvironment environment, fmi3LogMessageCallback log) {
    return NULL;
}

EXPORT fmi3Instance fmi3InstantiateScheduledExecution(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible, fmi3Boolean logging,
    fmi3InstanceEnvironment environment, fmi3LogMessageCallback log, fmi3ClockUpdateCallback update,
    fmi3LockPreemptionCallback lock, fmi3UnlockPreemptionCallback unlock) {
    return NULL;
}

NOT_HERE_ALONE(fmi3EnterContinuousTimeMode)
NOT_HERE(fmi3CompletedIntegratorStep, fmi3Boolean no_way_back, fmi3Boolean *event, fmi3Boolean *terminate)
NOT_HERE(fmi3SetTime, fmi3Float64 time)
NOT_HERE(fmi3SetContinuousStates, const fmi3Float64 states[], size_t n)
NOT_HERE(fmi3GetContinuousStateDerivatives, fmi3Float64 derivatives[], size_t n)
NOT_HERE(fmi3GetEventIndicators, fmi3Float64 indicators[], size_t n)
NOT_HERE(fmi3GetContinuousStates, fmi3Float64 states[], size_t n)
NOT_HERE(fmi3GetNominalsOfContinuousStates, fmi3Float64 nominals[], size_t n)
NOT_HERE(fmi3GetNumberOfEventIndicators, size_t *n)
NOT_HERE(fmi3GetNumberOfContinuousStates, size_t *n)
