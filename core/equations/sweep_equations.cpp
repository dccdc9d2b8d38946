#include "withy/core/equations/sweep_equations.hpp"

namespace withy::equations {

std::vector<std::string> savings_of(const NodeTree& tree, const std::vector<std::string>& of_sweep) {
  std::vector<std::string> lines = tree.savings;
  std::size_t aligned = 0;
  for (const NodeSpec& node : tree.nodes) {
    const auto kind = node.kernel ? node.kernel->kind : HingeKernel::Kind::free;
    if (kind == HingeKernel::Kind::revolute || kind == HingeKernel::Kind::prismatic) ++aligned;
  }
  if (aligned > 0)
    lines.push_back(std::to_string(aligned) + " of " + std::to_string(tree.nodes.size()) +
                    " hinges lie along an axis of their frame: a column of the inertia in place of a product");
  lines.insert(lines.end(), of_sweep.begin(), of_sweep.end());
#ifdef __AVX2__
  lines.emplace_back("sweeps compiled for x86-64-v3 (AVX2, FMA), which this processor has");
#else
  lines.emplace_back("sweeps compiled for any x86-64 processor");
#endif
  return lines;
}

int first_nonfinite(const Model& model, const double* accelerations) {
  const auto bad = [&](const Slot& slot) {
    for (std::size_t i = 0; i < slot.speeds; ++i) {
      if (!std::isfinite(accelerations[slot.speed + i])) return true;
    }
    return false;
  };
  const Layout& layout = model.layout();
  for (std::size_t b = 0; b < layout.hinges.size(); ++b) {
    const Slot* modes = layout.modes(b);
    if (bad(layout.hinges[b]) || (modes != nullptr && bad(*modes))) return static_cast<int>(b);
  }
  return -1;
}

}  // namespace withy::equations
