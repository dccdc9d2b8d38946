/* A controller as an FMU of both versions, for tests of the import: torque = kp (reference - angle) + integral, with
 * the integral summed at each step. It fails at the time `fail` where that is set. */
#include <stdlib.h>
#include <string.h>

#include "withy/bindings/fmi/fmi2.h"
#include "withy/bindings/fmi/fmi3.h"

enum { ANGLE, TORQUE, KP, KI, REFERENCE, FAIL, VARIABLES };

typedef struct {
  double v[VARIABLES], integral, time;
  int initialized;
} Model;

typedef struct {
  Model model; /* first: the state */
  const fmi2CallbackFunctions* functions;
  fmi3InstanceEnvironment environment;
  fmi3LogMessageCallback log;
} Controller;

static Controller* made(void) {
  Controller* c = calloc(1, sizeof(Controller));
  c->model.v[KP] = 1;
  c->model.v[FAIL] = 1e300;
  return c;
}
static int set(Controller* c, const unsigned vr[], size_t n, const double v[]) {
  for (size_t i = 0; i < n; ++i) {
    if (vr[i] >= VARIABLES || vr[i] == TORQUE) return 3;
    c->model.v[vr[i]] = v[i];
  }
  return 0;
}
static int get(const Controller* c, const unsigned vr[], size_t n, double v[]) {
  for (size_t i = 0; i < n; ++i) {
    if (vr[i] >= VARIABLES) return 3;
    v[i] = c->model.v[vr[i]];
  }
  return 0;
}
static int step(Controller* c, double t, double h) {
  double* v = c->model.v;
  double e = v[REFERENCE] - v[ANGLE];
  if (!c->model.initialized || t >= v[FAIL]) return 3;
  v[TORQUE] = v[KP] * e + c->model.integral;
  c->model.integral += h * (v[KI] * e);
  c->model.time = t + h;
  return 0;
}

FMI2_EXPORT fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                                          const fmi2CallbackFunctions* functions, fmi2Boolean visible,
                                          fmi2Boolean logging) {
  (void)name, (void)resources, (void)visible, (void)logging;
  if (type != fmi2CoSimulation || strcmp(guid, "controller") != 0) return NULL;
  Controller* c = made();
  c->functions = functions;
  return c;
}
FMI2_EXPORT void fmi2FreeInstance(fmi2Component c) { free(c); }
FMI2_EXPORT fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean tolerant, fmi2Real tolerance, fmi2Real start,
                                           fmi2Boolean stops, fmi2Real stop) {
  (void)tolerant, (void)tolerance, (void)stops, (void)stop;
  ((Controller*)c)->model.time = start;
  return fmi2OK;
}
FMI2_EXPORT fmi2Status fmi2EnterInitializationMode(fmi2Component c) { return c ? fmi2OK : fmi2Error; }
FMI2_EXPORT fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
  ((Controller*)c)->model.initialized = 1;
  return fmi2OK;
}
FMI2_EXPORT fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Real v[]) {
  return set(c, vr, n, v) ? fmi2Error : fmi2OK;
}
FMI2_EXPORT fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Real v[]) {
  return get(c, vr, n, v) ? fmi2Error : fmi2OK;
}
FMI2_EXPORT fmi2Status fmi2DoStep(fmi2Component c, fmi2Real t, fmi2Real h, fmi2Boolean final) {
  const fmi2CallbackFunctions* f = ((Controller*)c)->functions;
  (void) final;
  if (!step(c, t, h)) return fmi2OK;
  f->logger(f->componentEnvironment, "controller", fmi2Error, "logStatusError", "the %s is stuck", "valve");
  return fmi2Error;
}
FMI2_EXPORT fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate* state) {
  *state = malloc(sizeof(Model));
  memcpy(*state, c, sizeof(Model));
  return fmi2OK;
}
FMI2_EXPORT fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state) {
  memcpy(c, state, sizeof(Model));
  return fmi2OK;
}
FMI2_EXPORT fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate* state) {
  (void)c;
  free(*state);
  *state = NULL;
  return fmi2OK;
}
FMI2_EXPORT fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, size_t* size) {
  (void)c, (void)state;
  *size = sizeof(Model);
  return fmi2OK;
}
FMI2_EXPORT fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size) {
  (void)c;
  memcpy(bytes, state, size);
  return fmi2OK;
}
FMI2_EXPORT fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size,
                                               fmi2FMUstate* state) {
  (void)c;
  *state = malloc(size);
  memcpy(*state, bytes, size);
  return fmi2OK;
}

FMI3_EXPORT fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources,
                                                     fmi3Boolean visible, fmi3Boolean logging, fmi3Boolean events,
                                                     fmi3Boolean early, const fmi3ValueReference intermediate[],
                                                     size_t count, fmi3InstanceEnvironment environment,
                                                     fmi3LogMessageCallback log,
                                                     fmi3IntermediateUpdateCallback update) {
  (void)name, (void)resources, (void)visible, (void)logging, (void)events, (void)early, (void)intermediate, (void)count,
      (void)update;
  if (strcmp(token, "controller") != 0) return NULL;
  Controller* c = made();
  c->environment = environment;
  c->log = log;
  return c;
}
FMI3_EXPORT void fmi3FreeInstance(fmi3Instance c) { free(c); }
FMI3_EXPORT fmi3Status fmi3EnterInitializationMode(fmi3Instance c, fmi3Boolean tolerant, fmi3Float64 tolerance,
                                                   fmi3Float64 start, fmi3Boolean stops, fmi3Float64 stop) {
  (void)tolerant, (void)tolerance, (void)stops, (void)stop;
  ((Controller*)c)->model.time = start;
  return fmi3OK;
}
FMI3_EXPORT fmi3Status fmi3ExitInitializationMode(fmi3Instance c) {
  ((Controller*)c)->model.initialized = 1;
  return fmi3OK;
}
FMI3_EXPORT fmi3Status fmi3SetFloat64(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const fmi3Float64 v[],
                                      size_t nv) {
  return n != nv || set(c, vr, n, v) ? fmi3Error : fmi3OK;
}
FMI3_EXPORT fmi3Status fmi3GetFloat64(fmi3Instance c, const fmi3ValueReference vr[], size_t n, fmi3Float64 v[],
                                      size_t nv) {
  return n != nv || get(c, vr, n, v) ? fmi3Error : fmi3OK;
}
FMI3_EXPORT fmi3Status fmi3DoStep(fmi3Instance c, fmi3Float64 t, fmi3Float64 h, fmi3Boolean final, fmi3Boolean* event,
                                  fmi3Boolean* terminate, fmi3Boolean* early, fmi3Float64* reached) {
  Controller* controller = c;
  (void) final;
  *event = *terminate = *early = false;
  *reached = t + h;
  if (!step(c, t, h)) return fmi3OK;
  controller->log(controller->environment, fmi3Error, "logStatusError", "the valve is stuck");
  return fmi3Error;
}
