/// \file
/// What the library of modes brings: one source each, with its ids in CMakeLists.txt.
#include "withy/core/plugin/entry.hpp"

namespace withy {

void enroll_clamped_free(Enrollment& enrollment);
void enroll_clamped_pinned(Enrollment& enrollment);
void enroll_clamped_clamped(Enrollment& enrollment);
void enroll_pinned_free(Enrollment& enrollment);
void enroll_pinned_pinned(Enrollment& enrollment);
void enroll_free_free(Enrollment& enrollment);
void enroll_craig_bampton(Enrollment& enrollment);
void enroll_orthogonal_polynomials(Enrollment& enrollment);
void enroll_clamped_loaded(Enrollment& enrollment);
void enroll_vibration_modes(Enrollment& enrollment);

namespace {

void enroll(Enrollment& enrollment) {
  enroll_clamped_free(enrollment);
  enroll_clamped_pinned(enrollment);
  enroll_clamped_clamped(enrollment);
  enroll_pinned_free(enrollment);
  enroll_pinned_pinned(enrollment);
  enroll_free_free(enrollment);
  enroll_craig_bampton(enrollment);
  enroll_orthogonal_polynomials(enrollment);
  enroll_clamped_loaded(enrollment);
  enroll_vibration_modes(enrollment);
}

}  // namespace
}  // namespace withy

WITHY_PLUGIN(modes, withy::enroll);
