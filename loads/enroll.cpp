/// \file
/// What the library of loads brings: one source each, with its ids in CMakeLists.txt.
#include "withy/core/plugin/entry.hpp"

namespace withy {

void enroll_bang_bang_slew(Enrollment& enrollment);
void enroll_base_excitation(Enrollment& enrollment);
void enroll_computed_torque(Enrollment& enrollment);
void enroll_force(Enrollment& enrollment);
void enroll_gravity_gradient(Enrollment& enrollment);
void enroll_hinge_effort(Enrollment& enrollment);
void enroll_hinge_friction(Enrollment& enrollment);
void enroll_hinge_limit(Enrollment& enrollment);
void enroll_hinge_relay(Enrollment& enrollment);
void enroll_hinge_spring(Enrollment& enrollment);
void enroll_input(Enrollment& enrollment);
void enroll_pd_controller(Enrollment& enrollment);
void enroll_point_gravity(Enrollment& enrollment);
void enroll_rigid_inverse_dynamics(Enrollment& enrollment);
void enroll_rotating_frame(Enrollment& enrollment);
void enroll_spring_damper(Enrollment& enrollment);
void enroll_thruster(Enrollment& enrollment);
void enroll_torque(Enrollment& enrollment);

namespace {

void enroll(Enrollment& enrollment) {
  enroll_bang_bang_slew(enrollment);
  enroll_base_excitation(enrollment);
  enroll_computed_torque(enrollment);
  enroll_force(enrollment);
  enroll_gravity_gradient(enrollment);
  enroll_hinge_effort(enrollment);
  enroll_hinge_friction(enrollment);
  enroll_hinge_limit(enrollment);
  enroll_hinge_relay(enrollment);
  enroll_hinge_spring(enrollment);
  enroll_input(enrollment);
  enroll_pd_controller(enrollment);
  enroll_point_gravity(enrollment);
  enroll_rigid_inverse_dynamics(enrollment);
  enroll_rotating_frame(enrollment);
  enroll_spring_damper(enrollment);
  enroll_thruster(enrollment);
  enroll_torque(enrollment);
}

}  // namespace
}  // namespace withy

WITHY_PLUGIN(loads, withy::enroll);
