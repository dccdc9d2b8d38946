/// \file
/// A force at a frame as a function of time.
#include "withy/core/plugin/registry.hpp"
#include "withy/loads/frame_wrench.hpp"

namespace withy {
namespace {

std::unique_ptr<Load> make_force(const Value& p, const MakeContext& context) {
  return FrameWrench::make(p, context, &Wrench::force);
}

}  // namespace

void enroll_force(Enrollment& enrollment) {
  enrollment.add<Load>({.id = "force",
                        .summary = "Force at the origin of a frame as a function of time, in world axes or following",
                        .parameters = FrameWrench::parameters("force", "N"),
                        .make = &make_force});
}

}  // namespace withy
