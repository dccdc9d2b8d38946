/* The attitude loop about an FMU: a master of co-simulation, FMI 3.0, with the controller of docs/attitude-loop.md.
 * master FOLDER NAME: FOLDER is where the FMU was unpacked, NAME its model identifier. */
#include <dlfcn.h>
#include <fmi3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double step = 0.125; /* s: a power of two, so that every door counts the same times */
static const double proportional = 4.0, integral = 0.2, derivative = 22.0;

enum { QW, QX, QY, QZ, RX, RY, RZ, TIP, READ };
static const char* const names[READ] = {"float.qw", "float.qx", "float.qy", "float.qz",
                                        "gyro.x",   "gyro.y",   "gyro.z",   "left_boom.tip.deflection_y"};
static const char* const motors[3] = {"motor_x", "motor_y", "motor_z"};
static char description[1 << 20]; /* modelDescription.xml */

static void check(int good, const char* what) {
  if (good) return;
  fprintf(stderr, "the master stops: %s\n", what);
  exit(1);
}

/* An attribute of the element that begins so. */
static const char* attribute(const char* element, const char* key) {
  static char value[512];
  const char* at = strstr(description, element);
  check(at != NULL && (at = strstr(at, key)) != NULL && sscanf(at + strlen(key), "=\"%511[^\"]", value) == 1, element);
  return value;
}

static fmi3ValueReference reference(const char* name) {
  char element[256];
  snprintf(element, sizeof element, "<Float64 name=\"%s\"", name);
  return (fmi3ValueReference)atol(attribute(element, "valueReference"));
}

static void hear(fmi3InstanceEnvironment e, fmi3Status s, fmi3String category, fmi3String message) {
  fprintf(stderr, "%s\n", message);
}

#define LOAD(function) __typeof__(fmi3##function)* function = (__typeof__(fmi3##function)*)dlsym(fmu, "fmi3" #function)

int main(int argc, char** argv) {
  char path[4096];
  check(argc == 3, "master FOLDER NAME");
  snprintf(path, sizeof path, "%s/modelDescription.xml", argv[1]);
  FILE* file = fopen(path, "r");
  check(file != NULL && fread(description, 1, sizeof description - 1, file) > 0, path);
  fclose(file);
  snprintf(path, sizeof path, "%s/binaries/x86_64-linux/%s.so", argv[1], argv[2]);
  void* fmu = dlopen(path, RTLD_NOW | RTLD_LOCAL);
  check(fmu != NULL, path);
  LOAD(InstantiateCoSimulation);
  LOAD(EnterInitializationMode);
  LOAD(ExitInitializationMode);
  LOAD(SetFloat64);
  LOAD(GetFloat64);
  LOAD(DoStep);
  LOAD(FreeInstance);
  snprintf(path, sizeof path, "%s/resources/", argv[1]);
  fmi3Instance craft = InstantiateCoSimulation("craft", attribute("<fmiModelDescription", "instantiationToken"), path,
                                               false, false, false, false, NULL, 0, NULL, hear, NULL);
  check(craft != NULL && EnterInitializationMode(craft, false, 0, 0, false, 0) == fmi3OK &&
            ExitInitializationMode(craft) == fmi3OK,
        "the FMU does not begin");
  fmi3ValueReference outputs[READ], inputs[3];
  for (int i = 0; i < READ; ++i) outputs[i] = reference(names[i]);
  for (int i = 0; i < 3; ++i) inputs[i] = reference(motors[i]);
  double y[READ], command[3], learned[3] = {0, 0, 0}, reached;
  bool event, terminate, early;
  printf("t,qw,qx,qy,qz,tip\n");
  for (int k = 1; k <= 960; ++k) {
    check(GetFloat64(craft, outputs, READ, y, READ) == fmi3OK, "an output");
    for (int i = 0; i < 3; ++i) {
      const double error = y[QW] < 0 ? -2 * y[QX + i] : 2 * y[QX + i]; /* rad, for small angles */
      learned[i] += integral * step * error;
      command[i] = proportional * error + learned[i] + derivative * y[RX + i];
    }
    check(SetFloat64(craft, inputs, 3, command, 3) == fmi3OK, "an input");
    check(DoStep(craft, step * (k - 1), step, true, &event, &terminate, &early, &reached) == fmi3OK, "a step");
    check(GetFloat64(craft, outputs, READ, y, READ) == fmi3OK, "an output");
    printf("%.17g,%.17g,%.17g,%.17g,%.17g,%.17g\n", reached, y[QW], y[QX], y[QY], y[QZ], y[TIP]);
  }
  FreeInstance(craft);
  return 0;
}
