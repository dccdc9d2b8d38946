/* The attitude loop in C: the controller of docs/attitude-loop.md about a simulation that it steps. */
#include <stdio.h>
#include <withy/withy.h>

static const double step = 0.125; /* s: a power of two, so that every door counts the same times */
static const double proportional = 4.0, integral = 0.2, derivative = 22.0;

enum { QW, QX, QY, QZ, RX, RY, RZ, TIP, READ };
static const char* const names[READ] = {"float.qw", "float.qx", "float.qy", "float.qz",
                                        "gyro.x",   "gyro.y",   "gyro.z",   "left_boom.tip.deflection_y"};
static const char* const motors[3] = {"motor_x", "motor_y", "motor_z"};

/* From attitude and rate of the bus to the torque of a motor. */
static double command(double* learned, double q_scalar, double q_axis, double rate) {
  const double error = q_scalar < 0 ? -2 * q_axis : 2 * q_axis; /* rad, for small angles */
  *learned += integral * step * error;
  return proportional * error + *learned + derivative * rate;
}

static int fail(const void* handle) {
  fprintf(stderr, "%s\n", withy_error(handle));
  return 1;
}

static int fly(withy_simulation* craft) {
  size_t at[READ], motor[3];
  double y[READ], learned[3] = {0, 0, 0};
  int i, k;
  for (i = 0; i < READ; ++i)
    if (withy_simulation_output_index(craft, names[i], &at[i]) != WITHY_OK) return fail(craft);
  for (i = 0; i < 3; ++i)
    if (withy_simulation_input_index(craft, motors[i], &motor[i]) != WITHY_OK) return fail(craft);
  printf("t,qw,qx,qy,qz,tip\n");
  for (k = 0; k <= 960; ++k) {
    if (k > 0 && withy_simulation_step(craft, step * k) != WITHY_OK) return fail(craft);
    for (i = 0; i < READ; ++i)
      if (withy_simulation_output(craft, at[i], &y[i]) != WITHY_OK) return fail(craft);
    for (i = 0; i < 3; ++i)
      if (withy_simulation_set_input(craft, motor[i], command(&learned[i], y[QW], y[QX + i], y[RX + i])) != WITHY_OK)
        return fail(craft);
    if (k == 0) continue;
    printf("%.17g,%.17g,%.17g,%.17g,%.17g,%.17g\n", withy_simulation_time(craft), y[QW], y[QX], y[QY], y[QZ], y[TIP]);
  }
  return 0;
}

int main(int argc, char** argv) {
  withy_library* library = NULL;
  withy_scene* scene = NULL;
  withy_simulation* craft = NULL;
  int status = 2;
  if (argc != 2) return status;
  if (withy_library_create(NULL, &library) != WITHY_OK || withy_scene_read(library, argv[1], &scene) != WITHY_OK)
    status = fail(library);
  else if (withy_simulation_create(scene, &craft) != WITHY_OK)
    status = fail(scene);
  else
    status = fly(craft);
  withy_free(craft);
  withy_free(scene);
  withy_free(library);
  return status;
}
