#include "withy/core/equations/rate_map.hpp"

#include <algorithm>

namespace withy::equations {

RateMap::RateMap(const Model& model) : model_(model) {
  const Layout& layout = model.layout();
  std::vector<Run> runs;
  for (std::size_t h = 0; h < layout.hinges.size(); ++h) {
    const Slot& slot = layout.hinges[h];
    if (slot.positions != slot.speeds) constrained_.push_back(h);
    if (slot.positions == 1 && slot.speeds == 1) {
      runs.push_back({slot.position, slot.speed, 1});
    } else if (slot.positions > 0) {
      general_.push_back(h);
    }
  }
  for (const Slot& slot : layout.bodies) runs.push_back({slot.position, slot.speed, slot.speeds});
  std::sort(runs.begin(), runs.end(), [](const Run& a, const Run& b) { return a.position < b.position; });
  for (const Run& run : runs) {
    const bool joins = !copies_.empty() && copies_.back().position + copies_.back().count == run.position &&
                       copies_.back().speed + copies_.back().count == run.speed;
    if (joins) {
      copies_.back().count += run.count;
    } else {
      copies_.push_back(run);
    }
  }
}

void RateMap::normalize(std::span<double> positions) const noexcept {
  for (const std::size_t h : constrained_) {
    const Slot& slot = model_.layout().hinges[h];
    model_.hinges()[h].hinge->normalize(positions.subspan(slot.position, slot.positions));
  }
}

}  // namespace withy::equations
