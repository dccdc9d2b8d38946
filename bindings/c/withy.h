/** \file
 * The C interface of withy: library withy-c, CMake target withy::c. For hosts in C and whatever calls C.
 *
 * Everything is reached through handles. A function returns a status; where it is not WITHY_OK nothing has been changed
 * that the function's text does not name, but that a handle that was to be made is null; free what it was before the
 * call. withy_error() of the handle that was passed first says why in a sentence.
 * Arrays belong to the caller, who gives their sizes; texts belong to the handle and last until its next call that is
 * not const, or its end. No function exits, prints, or throws. A library and a scene that nobody changes may be shared
 * by threads: each of these has errors of its own there, which last until its own next call. Other handles are of one
 * thread at a time. All numbers are in SI units.
 */
#ifndef WITHY_H
#define WITHY_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#define WITHY_API __attribute__((visibility("default")))
#else
#define WITHY_API
#endif

/** How a call ended; the first four as the exit status of the program withy. */
typedef enum withy_status {
  WITHY_OK = 0,
  WITHY_STOPPED = 1,     /**< it cannot go on, and stands at its last accepted state; of equations: no derivatives */
  WITHY_BAD_INPUT = 2,   /**< the scene, a value set in it, or a choice cannot be */
  WITHY_ENVIRONMENT = 3, /**< a plugin is refused, a file cannot be read, memory has run out */
  WITHY_BAD_USE = 4      /**< the call itself: a handle or pointer that is none, a name, index, size or number */
} withy_status;

typedef struct withy_library withy_library;       /**< the plugins */
typedef struct withy_scene withy_scene;           /**< a scene, to be varied */
typedef struct withy_result withy_result;         /**< what a run gave */
typedef struct withy_simulation withy_simulation; /**< a simulation in steps */
typedef struct withy_snapshot withy_snapshot;     /**< where a simulation can go back to */
typedef struct withy_equations withy_equations;   /**< equations of motion for an integrator of the host's */

/** A number that goes in or comes out. Modal coordinates are called "link1.bending_y[1]"; where a name is asked for,
 * "link1.bending_y.1", as results.csv has it, will do. */
typedef struct withy_port {
  const char* name;
  const char* unit; /**< SI; empty for modal coordinates */
} withy_port;

/** Set `size` to sizeof(withy_library_options) and the rest to zero; later versions add members at the end. */
typedef struct withy_library_options {
  size_t size;
  const char* const* plugins; /**< folders of plugins beside the package's own */
  size_t plugin_count;
  void (*log)(void* context, const char* remark); /**< takes remarks, a sentence each; may be null */
  void* context;
} withy_library_options;

/** "0.2.0". */
WITHY_API const char* withy_version(void);
/** Why the last call with this handle failed, of a library or a scene the last one of the calling thread; empty where
 * it did not. Of null: why the last withy_library_create of the calling thread failed. Never null. */
WITHY_API const char* withy_error(const void* handle);
/** Ends any handle; null is allowed. Others made from it live on. */
WITHY_API void withy_free(void* handle);

/** \param options may be null */
WITHY_API withy_status withy_library_create(const withy_library_options* options, withy_library** library);

WITHY_API withy_status withy_scene_read(withy_library* library, const char* file, withy_scene** scene);
/** \param name stands for the file in messages; names of other files begin at its folder. May be null. */
WITHY_API withy_status withy_scene_parse(withy_library* library, const char* text, const char* name,
                                         withy_scene** scene);
WITHY_API withy_status withy_scene_copy(withy_scene* scene, withy_scene** copy);
/** Sets a value by its path, "loads.slew.time_scale", to what a file would have: "25 mm", "[0, 0, 1]". What is wrong is
 * reported when the scene is needed, together with every other problem. */
WITHY_API withy_status withy_scene_set(withy_scene* scene, const char* path, const char* text);
WITHY_API withy_status withy_scene_set_number(withy_scene* scene, const char* path, double value);
/** Checks it, and that a run of it can begin, as the program's command `check` does. */
WITHY_API withy_status withy_scene_check(withy_scene* scene);

/** Simulates to the end of the scene. WITHY_OK also where the run ends badly: ask withy_result_status. */
WITHY_API withy_status withy_scene_run(withy_scene* scene, withy_result** result);
/** As in run.json: "completed", "diverged", "load-failed" and others; empty where the handle is none, as all texts. */
WITHY_API const char* withy_result_status(const withy_result* result);
WITHY_API const char* withy_result_message(const withy_result* result);
/** The content of run.json but for what the files were made of and by. */
WITHY_API const char* withy_result_json(const withy_result* result);
WITHY_API size_t withy_result_rows(const withy_result* result);
WITHY_API size_t withy_result_columns(const withy_result* result);
/** The columns of results.csv. \returns names that are null past the end */
WITHY_API withy_port withy_result_column(const withy_result* result, size_t index);
/** Copies rows() numbers of a column. \param count size of the array */
WITHY_API withy_status withy_result_values(withy_result* result, const char* column, double* values, size_t count);

WITHY_API withy_status withy_simulation_create(withy_scene* scene, withy_simulation** simulation);
WITHY_API double withy_simulation_time(const withy_simulation* simulation);
WITHY_API size_t withy_simulation_inputs(const withy_simulation* simulation);
WITHY_API size_t withy_simulation_outputs(const withy_simulation* simulation);
/** Loads of type `input`, and the columns of results.csv. \returns names that are null past the end */
WITHY_API withy_port withy_simulation_input_port(const withy_simulation* simulation, size_t index);
WITHY_API withy_port withy_simulation_output_port(const withy_simulation* simulation, size_t index);
WITHY_API withy_status withy_simulation_input_index(withy_simulation* simulation, const char* name, size_t* index);
WITHY_API withy_status withy_simulation_output_index(withy_simulation* simulation, const char* name, size_t* index);
/** Acts from the next step on. */
WITHY_API withy_status withy_simulation_set_input(withy_simulation* simulation, size_t index, double value);
WITHY_API withy_status withy_simulation_input(withy_simulation* simulation, size_t index, double* value);
WITHY_API withy_status withy_simulation_output(withy_simulation* simulation, size_t index, double* value);
/** All outputs. \param count size of the array, withy_simulation_outputs() */
WITHY_API withy_status withy_simulation_output_values(withy_simulation* simulation, double* values, size_t count);
/** Integrates to the time t [s] and lands on it exactly. WITHY_STOPPED: it stands at its last accepted state, and each
    step gives the same until it is restored. */
WITHY_API withy_status withy_simulation_step(withy_simulation* simulation, double t);
/** The same, but halts at an event with `stop: true`, each time at one that does nothing else.
    \param reached 1 where t is; 0 where such an event halted it, before t or at t itself; may be null */
WITHY_API withy_status withy_simulation_advance_to(withy_simulation* simulation, double t, int* reached);
/** The present state as JSON; null with an error where that cannot be had. */
WITHY_API const char* withy_simulation_state(withy_simulation* simulation);
/** WITHY_STOPPED: it cannot go on, and nothing would from there. */
WITHY_API withy_status withy_simulation_snapshot(withy_simulation* simulation, withy_snapshot** snapshot);
WITHY_API withy_status withy_simulation_restore(withy_simulation* simulation, const withy_snapshot* snapshot);

/** \param formulation its name; null: the scene's */
WITHY_API withy_status withy_equations_create(withy_scene* scene, const char* formulation, withy_equations** equations);
/** The same equations with memory of their own, for another thread. */
WITHY_API withy_status withy_equations_copy(withy_equations* equations, withy_equations** copy);
/** Count of numbers in y: positions, then speeds. */
WITHY_API size_t withy_equations_size(const withy_equations* equations);
WITHY_API withy_port withy_equations_state_port(const withy_equations* equations, size_t index);
/** Initial state and its time [s]; `t0` may be null. \param count size of the array, withy_equations_size() */
WITHY_API withy_status withy_equations_initial(withy_equations* equations, double* t0, double* y0, size_t count);
WITHY_API withy_status withy_equations_set_input(withy_equations* equations, const char* name, double value);
/** y' at (t, y), each of `count` numbers. Allocates nothing where it succeeds. */
WITHY_API withy_status withy_equations_derivatives(withy_equations* equations, double t, const double* y, double* y_dot,
                                                   size_t count);
/** The derivatives of y' with respect to y, row after row: count * count numbers. */
WITHY_API withy_status withy_equations_jacobian(withy_equations* equations, double t, const double* y, size_t count,
                                                double* jacobian);
/** Scales quaternions in y to unit length, and closes loops. */
WITHY_API withy_status withy_equations_normalize(withy_equations* equations, double* y, size_t count);

#ifdef __cplusplus
}
#endif

#endif
