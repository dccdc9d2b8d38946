// A plugin that calls a function no library has: an error when it is loaded, not when the function is reached.
#include "point_mass.hpp"
#include "withy/core/plugin/entry.hpp"

void function_that_is_nowhere();

namespace {

void enroll(withy::Enrollment& enrollment) {
  function_that_is_nowhere();
  enrollment.add(zoo::point_mass("zoo-unresolved"));
}

}  // namespace

WITHY_PLUGIN(zoo_unresolved, enroll);
