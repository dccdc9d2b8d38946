/* A host in C: it integrates the arm with a method of its own, steps a simulation beside it, and misuses the interface.
 * c_host SCENE; exit status 0 where everything is as it should be. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <withy/withy.h>

#define SIZE 64
static int failures = 0;

static void expect(int condition, const char* what, const char* detail) {
  if (condition) return;
  ++failures;
  fprintf(stderr, "failed: %s (%s)\n", what, detail);
}
#define EXPECT(condition, handle) expect(condition, #condition, withy_error(handle))

/* The classical Runge-Kutta method. */
static void rk4(withy_equations* f, double t, double h, double* y, size_t n) {
  double k1[SIZE], k2[SIZE], k3[SIZE], k4[SIZE], at[SIZE];
  size_t i;
  EXPECT(withy_equations_derivatives(f, t, y, k1, n) == WITHY_OK, f);
  for (i = 0; i < n; ++i) at[i] = y[i] + h / 2 * k1[i];
  EXPECT(withy_equations_derivatives(f, t + h / 2, at, k2, n) == WITHY_OK, f);
  for (i = 0; i < n; ++i) at[i] = y[i] + h / 2 * k2[i];
  EXPECT(withy_equations_derivatives(f, t + h / 2, at, k3, n) == WITHY_OK, f);
  for (i = 0; i < n; ++i) at[i] = y[i] + h * k3[i];
  EXPECT(withy_equations_derivatives(f, t + h, at, k4, n) == WITHY_OK, f);
  for (i = 0; i < n; ++i) y[i] += h / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i]);
  EXPECT(withy_equations_normalize(f, y, n) == WITHY_OK, f);
}

/* Its own integration against withy's; the Jacobian against differences. */
static void integrate(withy_scene* scene) {
  withy_equations *equations = NULL, *copy = NULL;
  withy_simulation* simulation = NULL;
  double y[SIZE], ahead[SIZE], behind[SIZE], jacobian[SIZE * SIZE], t0 = -1, value = 0;
  size_t n, i, j, index;
  int k;
  EXPECT(withy_scene_set(scene, "integrator", "{name: dop853, rtol: 1e-11, atol: 1e-13}") == WITHY_OK, scene);
  EXPECT(withy_equations_create(scene, "quadratic", &equations) == WITHY_OK, scene);
  EXPECT(withy_simulation_create(scene, &simulation) == WITHY_OK, scene);
  n = withy_equations_size(equations);
  EXPECT(n > 0 && n <= SIZE, equations);
  EXPECT(withy_equations_initial(equations, &t0, y, n) == WITHY_OK && t0 == 0, equations);
  EXPECT(withy_equations_set_input(equations, "command", 0.5) == WITHY_OK, equations);
  EXPECT(withy_equations_copy(equations, &copy) == WITHY_OK, equations);
  for (k = 0; k < 400; ++k) rk4(copy, 0.00025 * k, 0.00025, y, n);

  EXPECT(withy_simulation_input_index(simulation, "command", &index) == WITHY_OK && index == 0, simulation);
  EXPECT(withy_simulation_set_input(simulation, index, 0.5) == WITHY_OK, simulation);
  EXPECT(withy_simulation_step(simulation, 0.1) == WITHY_OK, simulation);
  for (i = 0; i < n; ++i) {
    const withy_port port = withy_equations_state_port(equations, i);
    EXPECT(withy_simulation_output_index(simulation, port.name, &index) == WITHY_OK, simulation);
    EXPECT(withy_simulation_output(simulation, index, &value) == WITHY_OK, simulation);
    expect(fabs(value - y[i]) < 1e-7, "the host's integration", port.name);
  }

  EXPECT(withy_equations_jacobian(equations, 0.1, y, n, jacobian) == WITHY_OK, equations);
  for (j = 0; j < n; ++j) {
    const double h = 1e-5, there = y[j];
    y[j] = there + h;
    EXPECT(withy_equations_derivatives(equations, 0.1, y, ahead, n) == WITHY_OK, equations);
    y[j] = there - h;
    EXPECT(withy_equations_derivatives(equations, 0.1, y, behind, n) == WITHY_OK, equations);
    y[j] = there;
    for (i = 0; i < n; ++i)
      expect(fabs((ahead[i] - behind[i]) / (2 * h) - jacobian[i * n + j]) < 1e-3 * (1 + fabs(jacobian[i * n + j])),
             "the Jacobian", withy_equations_state_port(equations, j).name);
  }
  withy_free(copy);
  withy_free(equations);
  withy_free(simulation);
}

/* Back to a snapshot, and the same bits again. */
static void replay(withy_scene* scene) {
  withy_simulation* simulation = NULL;
  withy_snapshot* snapshot = NULL;
  double first[256], second[256];
  size_t count;
  int reached = 0;
  EXPECT(withy_simulation_create(scene, &simulation) == WITHY_OK, scene);
  count = withy_simulation_outputs(simulation);
  EXPECT(count > 1 && count <= 256, simulation);
  EXPECT(withy_simulation_step(simulation, 0.05) == WITHY_OK, simulation);
  EXPECT(withy_simulation_snapshot(simulation, &snapshot) == WITHY_OK, simulation);
  EXPECT(withy_simulation_set_input(simulation, 0, -1) == WITHY_OK, simulation);
  EXPECT(withy_simulation_advance_to(simulation, 0.1, &reached) == WITHY_OK && reached, simulation);
  EXPECT(withy_simulation_output_values(simulation, first, count) == WITHY_OK, simulation);
  EXPECT(strstr(withy_simulation_state(simulation), "\"command\":-1.0") != NULL, simulation);
  EXPECT(withy_simulation_restore(simulation, snapshot) == WITHY_OK, simulation);
  EXPECT(withy_simulation_time(simulation) == 0.05, simulation);
  EXPECT(withy_simulation_set_input(simulation, 0, -1) == WITHY_OK, simulation);
  EXPECT(withy_simulation_step(simulation, 0.1) == WITHY_OK, simulation);
  EXPECT(withy_simulation_output_values(simulation, second, count) == WITHY_OK, simulation);
  EXPECT(memcmp(first, second, count * sizeof(double)) == 0, simulation);
  withy_free(snapshot);
  withy_free(simulation);
}

static void run(withy_scene* scene) {
  withy_scene* short_one = NULL;
  withy_result* result = NULL;
  double* t;
  size_t rows;
  EXPECT(withy_scene_copy(scene, &short_one) == WITHY_OK, scene);
  EXPECT(withy_scene_set_number(short_one, "time.end", 0.25) == WITHY_OK, short_one);
  EXPECT(withy_scene_run(short_one, &result) == WITHY_OK, short_one);
  EXPECT(strcmp(withy_result_status(result), "completed") == 0, result);
  rows = withy_result_rows(result);
  t = malloc(rows * sizeof(double));
  EXPECT(withy_result_values(result, "t", t, rows) == WITHY_OK && t[rows - 1] == 0.25, result);
  EXPECT(strcmp(withy_result_column(result, 0).unit, "s") == 0, result);
  EXPECT(withy_result_column(result, withy_result_columns(result)).name == NULL, result);
  EXPECT(strstr(withy_result_json(result), "\"certificate\"") != NULL, result);
  EXPECT(withy_result_values(result, "t", t, rows - 1) == WITHY_BAD_USE, result);
  EXPECT(withy_result_values(result, "shouldr", t, rows) == WITHY_BAD_USE, result);
  EXPECT(strstr(withy_error(result), "did you mean 'shoulder'") != NULL, result);
  free(t);
  withy_free(result);
  withy_free(short_one);
}

/* A status and a sentence each time, and the host lives on. */
static void misuse(withy_library* library, withy_scene* scene) {
  withy_scene* none = (withy_scene*)1;
  withy_simulation* simulation = NULL;
  withy_equations* equations = NULL;
  withy_library_options old;
  withy_library* other = NULL;
  const char* const no_folder = NULL;
  double y[SIZE] = {0};
  size_t i;
  EXPECT(withy_scene_read(NULL, "x", &none) == WITHY_BAD_USE, library);
  EXPECT(withy_scene_read(library, NULL, &none) == WITHY_BAD_USE && none == NULL, library);
  EXPECT(withy_scene_read(library, "no-such-file", &none) == WITHY_ENVIRONMENT, library);
  EXPECT(strstr(withy_error(library), "no-such-file") != NULL, library);
  EXPECT(withy_scene_parse(library, "a: [", NULL, &none) == WITHY_BAD_INPUT, library);
  EXPECT(withy_scene_check((withy_scene*)library) == WITHY_BAD_USE, library);
  EXPECT(strstr(withy_error(library), "another kind, 'library'; need 'scene'") != NULL, library);
  EXPECT(withy_scene_parse(library, "format: withy/1\nbodies: {b: {type: rigd}}\n", "mine", &none) == WITHY_OK,
         library);
  EXPECT(withy_scene_check(none) == WITHY_BAD_INPUT, none);
  EXPECT(strstr(withy_error(none), "mine:2:") != NULL, none);
  EXPECT(withy_simulation_create(none, &simulation) == WITHY_BAD_INPUT && simulation == NULL, none);
  withy_free(none);

  EXPECT(withy_simulation_create(scene, &simulation) == WITHY_OK, scene);
  EXPECT(withy_simulation_set_input(simulation, 0, NAN) == WITHY_BAD_USE, simulation);
  EXPECT(withy_simulation_set_input(simulation, 9, 1) == WITHY_BAD_USE, simulation);
  EXPECT(withy_simulation_step(simulation, NAN) == WITHY_BAD_USE, simulation);
  EXPECT(withy_simulation_step(simulation, 0.01) == WITHY_OK, simulation);
  EXPECT(strcmp(withy_error(simulation), "") == 0, simulation);
  EXPECT(withy_simulation_step(simulation, 0.001) == WITHY_BAD_USE, simulation);
  EXPECT(withy_simulation_restore(simulation, NULL) == WITHY_BAD_USE, simulation);
  EXPECT(withy_simulation_output_values(simulation, y, 1) == WITHY_BAD_USE, simulation);
  withy_free(simulation);

  EXPECT(withy_equations_create(scene, "quadratc", &equations) == WITHY_BAD_INPUT, scene);
  EXPECT(withy_equations_create(scene, NULL, &equations) == WITHY_OK, scene);
  EXPECT(withy_equations_derivatives(equations, 0, y, y, 1) == WITHY_BAD_USE, equations);
  EXPECT(withy_equations_derivatives(equations, NAN, y, y + SIZE / 2, withy_equations_size(equations)) == WITHY_STOPPED,
         equations);
  EXPECT(strstr(withy_error(equations), "the time is not finite") != NULL, equations);
  for (i = 0; i < SIZE / 2; ++i) y[i] = NAN;
  EXPECT(withy_equations_derivatives(equations, 0, y, y + SIZE / 2, withy_equations_size(equations)) == WITHY_STOPPED,
         equations);
  EXPECT(strlen(withy_error(equations)) > 0, equations);
  withy_free(equations);

  memset(&old, 0, sizeof old);
  EXPECT(withy_library_create(&old, &other) == WITHY_BAD_USE && other == NULL, library);
  EXPECT(strstr(withy_error(NULL), "size") != NULL, NULL);
  old.size = sizeof old;
  old.plugin_count = 1;
  EXPECT(withy_library_create(&old, &other) == WITHY_BAD_USE && other == NULL, library);
  old.plugins = &no_folder;
  EXPECT(withy_library_create(&old, &other) == WITHY_BAD_USE && other == NULL, library);
  EXPECT(strstr(withy_error(NULL), "a name in plugins is null") != NULL, NULL);
  withy_free(NULL);
}

int main(int argc, char** argv) {
  withy_library* library = NULL;
  withy_scene* scene = NULL;
  if (argc != 2) return 2;
  if (withy_library_create(NULL, &library) != WITHY_OK) return 2;
  if (withy_scene_read(library, argv[1], &scene) != WITHY_OK) {
    fprintf(stderr, "%s\n", withy_error(library));
    return 2;
  }
  integrate(scene);
  replay(scene);
  run(scene);
  misuse(library, scene);
  withy_free(scene);
  withy_free(library);
  printf("withy %s: %d failures\n", withy_version(), failures);
  return failures == 0 ? 0 : 1;
}
