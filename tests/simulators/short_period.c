/* An aircraft in pitch as a functional mock-up unit of FMI 2 or, with FMI3 defined, of FMI 3.

   alpha' = q + g/V - L V (alpha + c delta) + force
   q'     = V^2 (m0 + ma alpha + md delta) + mq V q + moment
   Roll and yaw are linear in beta, p, r, aileron and rudder (ROLL, YAW), with gravity.
   With LAG defined the surface follows the command with that time constant in s.
   With FAULT defined a step crashes (1), hangs (2) or is refused (3) after 0.05 s. */
#include <math.h>
#include <stdlib.h>
#ifdef FMI3
#include "fmi3Functions.h"
typedef fmi3Instance Handle;
typedef fmi3Float64 Real;
typedef fmi3ValueReference Reference;
#define STATUS fmi3Status
#define OK fmi3OK
#define REFUSED fmi3Error
#else
#include "fmi2Functions.h"
typedef fmi2Component Handle;
typedef fmi2Real Real;
typedef fmi2ValueReference Reference;
#define STATUS fmi2Status
#define OK fmi2OK
#define REFUSED fmi2Error
#endif

enum { DELTA, FORCE, MOMENT, V, HEIGHT, ALPHA_START, THETA_START, ALPHA, Q, THETA, LOAD_FACTOR,
    AILERON, RUDDER, P, R, BANK, BETA, A_Y, COUNT };
static const double G = 9.80665, L = 0.04, C = 0.1, M0 = 0.0004, MA = -0.01, MD = -0.02, MQ = -0.08;
static const double SIDE[5] = {-0.4, 0.0, 0.0, 0.0, 0.1}, ROLL[5] = {-10.0, -5.0, 1.0, -20.0, 1.0};
static const double YAW[5] = {6.0, -0.2, -1.0, 0.5, -5.0};

typedef struct {
    double value[COUNT];
    double surface;
} Model;

static Model *make(void) {
    Model *model = calloc(1, sizeof(Model));
    model->value[V] = 30.0;
    model->value[HEIGHT] = 500.0;
    model->value[DELTA] = -0.11;
    return model;
}

static void outputs(Model *m) {
    double *v = m->value;
    v[LOAD_FACTOR] = L * v[V] * v[V] * (v[ALPHA] + C * m->surface) / G;
}

/* Rates of alpha, q, theta and the surface. */
static void rates(Model *m, double rate[4]) {
    double *v = m->value;
#ifdef LAG
    rate[3] = (v[DELTA] - m->surface) / LAG;
#else
    m->surface = v[DELTA];
    rate[3] = 0.0;
#endif
    rate[0] = v[Q] + G / v[V] - L * v[V] * (v[ALPHA] + C * m->surface) + v[FORCE];
    rate[1] = v[V] * v[V] * (M0 + MA * v[ALPHA] + MD * m->surface) + MQ * v[V] * v[Q] + v[MOMENT];
    rate[2] = v[Q];
}

static void start(Model *m) {
    m->value[ALPHA] = m->value[ALPHA_START];
    m->value[THETA] = m->value[THETA_START];
    m->surface = m->value[DELTA];
    outputs(m);
}

static void roll_and_yaw(double *v, double dt) {
    double x[5] = {v[BETA], v[P], v[R], v[AILERON], v[RUDDER]}, side = 0.0, roll = 0.0, yaw = 0.0;
    int k;
    for (k = 0; k < 5; k++) side += SIDE[k] * x[k], roll += ROLL[k] * x[k], yaw += YAW[k] * x[k];
    v[BETA] += dt * (side + sin(v[ALPHA]) * v[P] - cos(v[ALPHA]) * v[R]
        + G / v[V] * cos(v[THETA]) * sin(v[BANK]));
    v[BANK] += dt * (v[P] + tan(v[THETA]) * cos(v[BANK]) * v[R]);
    v[P] += dt * roll;
    v[R] += dt * yaw;
    v[A_Y] = v[V] * side;
}

static STATUS fly(Model *m, double t, double width) {
    double *v = m->value;
    int n = (int)(width / 1e-4 + 0.5), i;
#ifdef FAULT
    if (t > 0.05) {
        if (FAULT == 1) abort();
        while (FAULT == 2) { volatile int spin = 0; (void)spin; }
        return REFUSED;
    }
#endif
    for (i = 0; i < n; i++) {
        double dt = width / n, rate[4];
        rates(m, rate);
        v[ALPHA] += dt * rate[0];
        v[Q] += dt * rate[1];
        v[THETA] += dt * rate[2];
        m->surface += dt * rate[3];
        roll_and_yaw(v, dt);
    }
    outputs(m);
    return OK;
}

static STATUS set(Model *m, const Reference *which, size_t n, const Real *values) {
    size_t i;
    for (i = 0; i < n; i++) m->value[which[i]] = values[i];
    return OK;
}

static STATUS get(Model *m, const Reference *which, size_t n, Real *values) {
    size_t i;
    outputs(m);
    for (i = 0; i < n; i++) values[i] = m->value[which[i]];
    return OK;
}

#ifdef FMI3
fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources,
    fmi3Boolean visible, fmi3Boolean logging, fmi3Boolean events, fmi3Boolean early,
    const fmi3ValueReference required[], size_t nRequired, fmi3InstanceEnvironment environment,
    fmi3LogMessageCallback log, fmi3IntermediateUpdateCallback update) { return make(); }
void fmi3FreeInstance(fmi3Instance m) { free(m); }
fmi3Status fmi3EnterInitializationMode(fmi3Instance m, fmi3Boolean toleranceDefined, fmi3Float64 tolerance,
    fmi3Float64 startTime, fmi3Boolean stopTimeDefined, fmi3Float64 stopTime) { return OK; }
fmi3Status fmi3ExitInitializationMode(fmi3Instance m) { start(m); return OK; }
fmi3Status fmi3Terminate(fmi3Instance m) { return OK; }
fmi3Status fmi3SetFloat64(fmi3Instance m, const fmi3ValueReference which[], size_t n, const fmi3Float64 values[],
    size_t nValues) { return set(m, which, n, values); }
fmi3Status fmi3GetFloat64(fmi3Instance m, const fmi3ValueReference which[], size_t n, fmi3Float64 values[],
    size_t nValues) { return get(m, which, n, values); }
fmi3Status fmi3DoStep(fmi3Instance m, fmi3Float64 t, fmi3Float64 width, fmi3Boolean keep, fmi3Boolean *event,
    fmi3Boolean *terminate, fmi3Boolean *early, fmi3Float64 *last) {
    *event = *terminate = *early = fmi3False;
    *last = t + width;
    return fly(m, t, width);
}
#else
fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
    const fmi2CallbackFunctions *functions, fmi2Boolean visible, fmi2Boolean logging) { return make(); }
void fmi2FreeInstance(fmi2Component m) { free(m); }
fmi2Status fmi2SetupExperiment(fmi2Component m, fmi2Boolean toleranceDefined, fmi2Real tolerance,
    fmi2Real startTime, fmi2Boolean stopTimeDefined, fmi2Real stopTime) { return OK; }
fmi2Status fmi2EnterInitializationMode(fmi2Component m) { return OK; }
fmi2Status fmi2ExitInitializationMode(fmi2Component m) { start(m); return OK; }
fmi2Status fmi2Terminate(fmi2Component m) { return OK; }
fmi2Status fmi2SetReal(fmi2Component m, const fmi2ValueReference which[], size_t n, const fmi2Real values[]) {
    return set(m, which, n, values);
}
fmi2Status fmi2GetReal(fmi2Component m, const fmi2ValueReference which[], size_t n, fmi2Real values[]) {
    return get(m, which, n, values);
}
fmi2Status fmi2DoStep(fmi2Component m, fmi2Real t, fmi2Real width, fmi2Boolean keep) { return fly(m, t, width); }
#endif
