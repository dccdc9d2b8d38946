/// \file
/// What the library of formulations brings: one source each, with its ids in CMakeLists.txt.
#include "withy/core/plugin/entry.hpp"

namespace withy {

void enroll_ruthless(Enrollment& enrollment);
void enroll_inconsistent(Enrollment& enrollment);
void enroll_consistent(Enrollment& enrollment);
void enroll_quadratic(Enrollment& enrollment);
void enroll_linear(Enrollment& enrollment);
void enroll_exact(Enrollment& enrollment);
void enroll_rate_linear(Enrollment& enrollment);
void enroll_automatic(Enrollment& enrollment);

namespace {

void enroll(Enrollment& enrollment) {
  enroll_ruthless(enrollment);
  enroll_inconsistent(enrollment);
  enroll_consistent(enrollment);
  enroll_quadratic(enrollment);
  enroll_linear(enrollment);
  enroll_exact(enrollment);
  enroll_rate_linear(enrollment);
  enroll_automatic(enrollment);
}

}  // namespace
}  // namespace withy

WITHY_PLUGIN(formulations, withy::enroll);
