/// \file
/// A force at a frame as a function of time.
#include "withy/core/plugin/entry.hpp"
#include "withy/loads/frame_wrench.hpp"

namespace withy {
namespace {

std::unique_ptr<Load> make(const Value& p, const MakeContext& context) {
  return FrameWrench::make(p, context, &Wrench::force);
}

void enroll(Enrollment& enrollment) {
  enrollment.add<Load>({.id = "force",
                        .summary = "Force at the origin of a frame as a function of time, in world axes or following",
                        .parameters = FrameWrench::parameters("force", "N"),
                        .make = &make});
}

}  // namespace
}  // namespace withy

WITHY_PLUGIN(force, withy::enroll);
