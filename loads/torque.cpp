/// \file
/// A moment on a frame as a function of time.
#include "withy/core/plugin/registry.hpp"
#include "withy/loads/frame_wrench.hpp"

namespace withy {
namespace {

std::unique_ptr<Load> make_torque(const Value& p, const MakeContext& context) {
  return FrameWrench::make(p, context, &Wrench::moment);
}

}  // namespace

void enroll_torque(Enrollment& enrollment) {
  enrollment.add<Load>({.id = "torque",
                        .summary = "Moment on a frame as a function of time, in world axes or following",
                        .parameters = FrameWrench::parameters("moment", "N m"),
                        .make = &make_torque});
}

}  // namespace withy
