#include "withy/core/model/hinge_angles.hpp"

#include <algorithm>
#include <cmath>

#include "withy/core/model/hinge_rates.hpp"

namespace withy {

HingeAngles::HingeAngles(const Model& model) {
  const Layout& layout = model.layout();
  for (std::size_t h = 0; h < layout.hinges.size(); ++h) {
    const Slot& slot = layout.hinges[h];
    std::size_t rate = layout.positions + slot.speed;
    for (const HingeRate& of : hinge_rates(*model.hinges()[h].hinge)) {
      if (of.angular)
        angles_.push_back({rate, of.coordinate ? std::optional(slot.position + *of.coordinate) : std::nullopt});
      ++rate;
    }
  }
}

double HingeAngles::turned(std::span<const double> before, std::span<const double> after,
                           double seconds) const noexcept {
  double most = 0;
  for (const auto& [rate, position] : angles_) {
    const double way = position ? std::abs(after[*position] - before[*position]) : 0;
    most = std::max({most, way, seconds * std::max(std::abs(before[rate]), std::abs(after[rate]))});
  }
  return most;
}

}  // namespace withy
