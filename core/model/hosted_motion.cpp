#include "withy/core/model/hosted_motion.hpp"

#include "withy/core/model/model.hpp"

namespace withy {

HostedMotions::HostedMotions(const Model& model) {
  for (const LoadNode& node : model.loads())
    if (const HostedMotion* motion = hosted_motion(*node.load))
      places_.push_back({motion, node.slot.first, node.slot.count});
}

const HostedMotion* hosted_motion(const BoundLoad& load) { return dynamic_cast<const HostedMotion*>(&load); }

}  // namespace withy
