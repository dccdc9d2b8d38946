/// \file
/// What the library of bodies brings: one source each, with its ids in CMakeLists.txt.
#include "withy/core/plugin/entry.hpp"

namespace withy {

void enroll_rigid(Enrollment& enrollment);
void enroll_beam(Enrollment& enrollment);
void enroll_plate(Enrollment& enrollment);
void enroll_modal(Enrollment& enrollment);

namespace {

void enroll(Enrollment& enrollment) {
  enroll_rigid(enrollment);
  enroll_beam(enrollment);
  enroll_plate(enrollment);
  enroll_modal(enrollment);
}

}  // namespace
}  // namespace withy

WITHY_PLUGIN(bodies, withy::enroll);
