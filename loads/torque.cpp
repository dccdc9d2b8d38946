/// \file
/// A moment on a frame as a function of time.
#include "withy/core/plugin/entry.hpp"
#include "withy/loads/frame_wrench.hpp"

namespace withy {
namespace {

std::unique_ptr<Load> make(const Value& p, const MakeContext& context) {
  return FrameWrench::make(p, context, &Wrench::moment);
}

void enroll(Enrollment& enrollment) {
  enrollment.add<Load>({.id = "torque",
                        .summary = "Moment on a frame as a function of time, in world axes or following",
                        .parameters = FrameWrench::parameters("moment", "N m"),
                        .make = &make});
}

}  // namespace
}  // namespace withy

WITHY_PLUGIN(torque, withy::enroll);
