/* The C part of Withy.mo: the equations of a scene as an external object of Modelica. Link withy-c. */
#ifndef WITHY_MODELICA_H
#define WITHY_MODELICA_H

#include <ModelicaUtilities.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <withy/withy.h>

typedef struct withy_modelica {
  withy_library* library;
  withy_scene* scene;
  withy_equations* equations;
  size_t input_count;
  char** inputs; /* the tool's texts may not last */
} withy_modelica;

static void withy_modelica_close(void* object) {
  withy_modelica* m = (withy_modelica*)object;
  size_t i;
  if (m == NULL) return;
  withy_free(m->equations);
  withy_free(m->scene);
  withy_free(m->library);
  for (i = 0; m->inputs != NULL && i < m->input_count; ++i) free(m->inputs[i]);
  free(m->inputs);
  free(m);
}

/* Gives the tool the reason of a handle, which does not outlive the object. Does not return. */
static void* withy_modelica_refuse(withy_modelica* m, const void* handle) {
  char reason[4096];
  snprintf(reason, sizeof reason, "%s", withy_error(handle));
  withy_modelica_close(m);
  ModelicaError(reason);
  return NULL;
}

/* formulation: empty for the scene's. inputs: loads of the type input, in the order in which u has their values. */
static void* withy_modelica_open(const char* file, const char* formulation, const char** inputs, size_t count) {
  withy_modelica* m = (withy_modelica*)calloc(1, sizeof *m);
  size_t i;
  if (m == NULL || (m->inputs = (char**)calloc(count + 1, sizeof *m->inputs)) == NULL) {
    free(m);
    ModelicaError("withy: out of memory");
    return NULL;
  }
  m->input_count = count;
  if (withy_library_create(NULL, &m->library) != WITHY_OK) return withy_modelica_refuse(m, m->library);
  if (withy_scene_read(m->library, file, &m->scene) != WITHY_OK) return withy_modelica_refuse(m, m->library);
  if (withy_equations_create(m->scene, formulation[0] ? formulation : NULL, &m->equations) != WITHY_OK)
    return withy_modelica_refuse(m, m->scene);
  for (i = 0; i < count; ++i) {
    if (withy_equations_set_input(m->equations, inputs[i], 0) != WITHY_OK)
      return withy_modelica_refuse(m, m->equations);
    m->inputs[i] = (char*)malloc(strlen(inputs[i]) + 1);
    if (m->inputs[i] != NULL) strcpy(m->inputs[i], inputs[i]);
  }
  return m;
}

/* The number of states: what the parameter n of Withy.Plant has to be. */
static int withy_modelica_states(void* object) {
  return (int)withy_equations_size(((withy_modelica*)object)->equations);
}

static void withy_modelica_initial(void* object, double* y, size_t n) {
  const withy_modelica* m = (withy_modelica*)object;
  double t0;
  if (withy_equations_initial(m->equations, &t0, y, n) != WITHY_OK) ModelicaError(withy_error(m->equations));
}

/* The last call's reason lives as long as the object, which the tool closes after an error. */
static void withy_modelica_derivatives(void* object, double t, const double* y, size_t n, const double* u, size_t count,
                                       double* y_dot) {
  const withy_modelica* m = (withy_modelica*)object;
  size_t i;
  for (i = 0; i < count && i < m->input_count; ++i)
    if (withy_equations_set_input(m->equations, m->inputs[i], u[i]) != WITHY_OK)
      ModelicaError(withy_error(m->equations));
  if (withy_equations_derivatives(m->equations, t, y, y_dot, n) != WITHY_OK) ModelicaError(withy_error(m->equations));
}

#endif
