// What the library brings.
#include "kinematics_plugin.hpp"
#include "withy/core/plugin/entry.hpp"

namespace {

void enroll(withy::Enrollment& enrollment) {
  enrollment.add(withy::linear_kinematics());
  enrollment.add(withy::quadratic_kinematics());
  enrollment.add(withy::exact_kinematics());
  enrollment.add(withy::foreshortening_kinematics());
}

}  // namespace

WITHY_PLUGIN(kinematics, enroll);
