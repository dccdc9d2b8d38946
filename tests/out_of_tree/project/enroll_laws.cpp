// What the library brings. The name is that of withy_plugin() in CMakeLists.txt.
#include <withy/core/plugin/entry.hpp>

#include "laws.hpp"

namespace {

void enroll(withy::Enrollment& enrollment) {
  enrollment.add(example::tautochrone());
  enrollment.add(example::drag());
  enrollment.add(example::cycloid());
  enrollment.add(example::speed());
  enrollment.add(example::slow_linear());
  enrollment.add(example::heun3());
}

}  // namespace

WITHY_PLUGIN(laws, enroll);
