// A plugin of nothing, linked with -ffast-math: the linker's start-up code sets flush-to-zero for the whole program.
#include "withy/core/plugin/entry.hpp"

namespace {
void enroll(withy::Enrollment&) {}
}  // namespace

WITHY_PLUGIN(extremes_fast_math, enroll);
