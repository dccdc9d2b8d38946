/// \file
/// What the library of hinges brings: one source each, with its ids in CMakeLists.txt.
#include "withy/core/plugin/entry.hpp"

namespace withy {

void enroll_weld(Enrollment& enrollment);
void enroll_revolute(Enrollment& enrollment);
void enroll_prismatic(Enrollment& enrollment);
void enroll_universal(Enrollment& enrollment);
void enroll_cylindrical(Enrollment& enrollment);
void enroll_screw(Enrollment& enrollment);
void enroll_planar(Enrollment& enrollment);
void enroll_spherical(Enrollment& enrollment);
void enroll_free(Enrollment& enrollment);

namespace {

void enroll(Enrollment& enrollment) {
  enroll_weld(enrollment);
  enroll_revolute(enrollment);
  enroll_prismatic(enrollment);
  enroll_universal(enrollment);
  enroll_cylindrical(enrollment);
  enroll_screw(enrollment);
  enroll_planar(enrollment);
  enroll_spherical(enrollment);
  enroll_free(enrollment);
}

}  // namespace
}  // namespace withy

WITHY_PLUGIN(hinges, withy::enroll);
