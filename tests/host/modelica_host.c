/* A Modelica tool, as far as an external object sees it: makes Withy.Model, integrates Withy.Plant, hears its errors.
 * modelica_host SCENE; exit status 0 where everything is as it should be. */
#include <math.h>
#include <setjmp.h>
#include <stdio.h>
#include <withy_modelica.h>

static jmp_buf tool;
static char heard[4096];
static int failures = 0;

void ModelicaError(const char* message) {
  snprintf(heard, sizeof heard, "%s", message);
  longjmp(tool, 1);
}

static void expect(int condition, const char* what) {
  if (condition) return;
  ++failures;
  fprintf(stderr, "failed: %s (%s)\n", what, heard);
}

/* Integrates der(y) = derivatives(model, time, y, u) with Heun's method to 0.1 s. */
static void integrate(void* model, const double* u, double* y, size_t n) {
  double now[64], then[64], ahead[64];
  const double h = 2e-5;
  size_t i;
  int k;
  for (k = 0; k < 5000; ++k) {
    withy_modelica_derivatives(model, k * h, y, n, u, 1, now);
    for (i = 0; i < n; ++i) ahead[i] = y[i] + h * now[i];
    withy_modelica_derivatives(model, (k + 1) * h, ahead, n, u, 1, then);
    for (i = 0; i < n; ++i) y[i] += h / 2 * (now[i] + then[i]);
  }
}

/* The same by withy's own integrator. */
static double shoulder_of_a_simulation(const char* file, double command) {
  withy_library* library = NULL;
  withy_scene* scene = NULL;
  withy_simulation* simulation = NULL;
  size_t index = 0;
  double angle = NAN;
  if (withy_library_create(NULL, &library) == WITHY_OK && withy_scene_read(library, file, &scene) == WITHY_OK &&
      withy_simulation_create(scene, &simulation) == WITHY_OK &&
      withy_simulation_set_input(simulation, 0, command) == WITHY_OK &&
      withy_simulation_step(simulation, 0.1) == WITHY_OK &&
      withy_simulation_output_index(simulation, "shoulder", &index) == WITHY_OK)
    withy_simulation_output(simulation, index, &angle);
  withy_free(simulation);
  withy_free(scene);
  withy_free(library);
  return angle;
}

/* Whether opening fails with a reason that has these words. */
static int refused(const char* file, const char* formulation, const char* input, const char* words) {
  if (setjmp(tool) == 0) {
    void* model = withy_modelica_open(file, formulation, &input, 1);
    withy_modelica_close(model);
    return 0;
  }
  return strstr(heard, words) != NULL;
}

int main(int argc, char** argv) {
  const char* inputs[] = {"command"};
  const double u = 0.5;
  double y[64], y_dot[64];
  void* model;
  int i, n;
  if (argc != 2) return 2;
  if (setjmp(tool) != 0) {
    fprintf(stderr, "%s\n", heard);
    return 2;
  }
  model = withy_modelica_open(argv[1], "", inputs, 1);
  n = withy_modelica_states(model);
  expect(n > 0 && n <= 64, "the number of states");
  withy_modelica_initial(model, y, (size_t)n);
  integrate(model, &u, y, (size_t)n);
  expect(fabs(y[0]) > 1e-5 && fabs(y[0] - shoulder_of_a_simulation(argv[1], u)) < 1e-6, "the integration by the tool");

  if (setjmp(tool) == 0) {
    for (i = 0; i < n; ++i) y[i] = NAN;
    withy_modelica_derivatives(model, 0, y, (size_t)n, &u, 1, y_dot);
    expect(0, "a state that is no number");
  }
  expect(strlen(heard) > 0, "why there are no derivatives");
  withy_modelica_close(model);

  expect(refused("no-such-file", "", "command", "no-such-file"), "a missing file");
  expect(refused(argv[1], "quadratc", "command", "did you mean 'quadratic'"), "a wrong formulation");
  expect(refused(argv[1], "", "comand", "did you mean 'command'"), "a wrong input");
  return failures == 0 ? 0 : 1;
}
