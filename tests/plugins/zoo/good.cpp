// A good plugin. With the definitions of tests/plugins/CMakeLists.txt it is built in ways the host must refuse.
#ifdef ZOO_EIGEN_ALIGNMENT
#undef EIGEN_MAX_ALIGN_BYTES
#undef EIGEN_MAX_STATIC_ALIGN_BYTES
#define EIGEN_MAX_ALIGN_BYTES ZOO_EIGEN_ALIGNMENT
#define EIGEN_MAX_STATIC_ALIGN_BYTES ZOO_EIGEN_ALIGNMENT
#endif
#include <cfenv>

#include "point_mass.hpp"
#include "withy/core/plugin/entry.hpp"

namespace {

#ifdef ZOO_ROUNDING
// As a numerical library that sets the processor up to its own taste when it is loaded.
[[maybe_unused]] const int rounding = std::fesetround(FE_UPWARD);
#endif

void enroll(withy::Enrollment& enrollment) {
#ifdef ZOO_ROUNDING_LATE
  std::fesetround(FE_TOWARDZERO);
#endif
  enrollment.add(zoo::point_mass(ZOO_ID));
}

}  // namespace

// The name is given from outside: expanded first.
#define ZOO_PLUGIN(name) WITHY_PLUGIN(name, enroll)
ZOO_PLUGIN(ZOO_SYMBOL);
