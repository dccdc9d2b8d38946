// What the library brings. The name is that of withy_plugin() in CMakeLists.txt.
#include <withy/core/plugin/entry.hpp>

#include "bodies.hpp"

namespace {

void enroll(withy::Enrollment& enrollment) {
  enrollment.add(example::rod());
  enrollment.add(example::tapered_beam());
  enrollment.add(example::unturned());
}

}  // namespace

WITHY_PLUGIN(rods, enroll);
