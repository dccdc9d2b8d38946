/// \file
/// What the library of controllers brings: one source each, with its ids in CMakeLists.txt.
#include "withy/core/plugin/entry.hpp"

namespace withy {

void enroll_actuator(Enrollment& enrollment);
void enroll_control_expression(Enrollment& enrollment);
void enroll_filter(Enrollment& enrollment);
void enroll_pid(Enrollment& enrollment);
void enroll_reaction_wheel(Enrollment& enrollment);
void enroll_transfer_function(Enrollment& enrollment);

namespace {

void enroll_control(Enrollment& enrollment) {
  enroll_actuator(enrollment);
  enroll_control_expression(enrollment);
  enroll_filter(enrollment);
  enroll_pid(enrollment);
  enroll_reaction_wheel(enrollment);
  enroll_transfer_function(enrollment);
}

}  // namespace
}  // namespace withy

WITHY_PLUGIN(control, withy::enroll_control);
