/// \file
/// What the library of integrators brings: one source each, with its ids in CMakeLists.txt.
#include "withy/core/plugin/entry.hpp"

namespace withy {

void enroll_rk4(Enrollment& enrollment);
void enroll_rk4_adaptive(Enrollment& enrollment);
void enroll_dopri5(Enrollment& enrollment);
void enroll_dop853(Enrollment& enrollment);
void enroll_rosenbrock_w(Enrollment& enrollment);
void enroll_imex(Enrollment& enrollment);
void enroll_radau(Enrollment& enrollment);
void enroll_gauss(Enrollment& enrollment);
void enroll_generalized_alpha(Enrollment& enrollment);

namespace {

void enroll(Enrollment& enrollment) {
  enroll_rk4(enrollment);
  enroll_rk4_adaptive(enrollment);
  enroll_dopri5(enrollment);
  enroll_dop853(enrollment);
  enroll_rosenbrock_w(enrollment);
  enroll_imex(enrollment);
  enroll_radau(enrollment);
  enroll_gauss(enrollment);
  enroll_generalized_alpha(enrollment);
}

}  // namespace
}  // namespace withy

WITHY_PLUGIN(integrators, withy::enroll);
