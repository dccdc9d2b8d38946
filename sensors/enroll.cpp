/// \file
/// What the library of sensors brings: one source each, with its ids in CMakeLists.txt.
#include "withy/core/plugin/entry.hpp"

namespace withy {

void enroll_angle(Enrollment& enrollment);
void enroll_control_sensor(Enrollment& enrollment);
void enroll_distance(Enrollment& enrollment);
void enroll_effort(Enrollment& enrollment);
void enroll_energy(Enrollment& enrollment);
void enroll_expression(Enrollment& enrollment);
void enroll_frame(Enrollment& enrollment);
void enroll_hinge(Enrollment& enrollment);
void enroll_inertial(Enrollment& enrollment);
void enroll_power(Enrollment& enrollment);
void enroll_reaction(Enrollment& enrollment);
void enroll_section(Enrollment& enrollment);

namespace {

void enroll(Enrollment& enrollment) {
  enroll_angle(enrollment);
  enroll_control_sensor(enrollment);
  enroll_distance(enrollment);
  enroll_effort(enrollment);
  enroll_energy(enrollment);
  enroll_expression(enrollment);
  enroll_frame(enrollment);
  enroll_hinge(enrollment);
  enroll_inertial(enrollment);
  enroll_power(enrollment);
  enroll_reaction(enrollment);
  enroll_section(enrollment);
}

}  // namespace
}  // namespace withy

WITHY_PLUGIN(sensors, withy::enroll);
