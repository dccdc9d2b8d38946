// What the library brings. The name is that of withy_plugin() in CMakeLists.txt.
#include <withy/core/plugin/entry.hpp>

#include "laws.hpp"

namespace {

void enroll(withy::Enrollment& enrollment) {
  enrollment.add(example::slow_linear());
  enrollment.add(example::cycloid());
  enrollment.add(example::speed());
}

}  // namespace

WITHY_PLUGIN(laws, enroll);
