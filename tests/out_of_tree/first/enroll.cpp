// enroll.cpp: the entry of the library.
#include <withy/core/plugin/entry.hpp>

#include "bodies.hpp"

namespace {

void enroll(withy::Enrollment& enrollment) { enrollment.add(example::rod()); }

}  // namespace

WITHY_PLUGIN(rods, enroll);  // the name given to withy_plugin(), with _ for -
