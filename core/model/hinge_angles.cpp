#include "withy/core/model/hinge_angles.hpp"

#include <algorithm>
#include <cmath>

#include "withy/core/model/closing.hpp"
#include "withy/core/model/hinge_rates.hpp"

namespace withy {

HingeAngles::HingeAngles(const Model& model) {
  const std::vector<bool> in_loops = hinges_in_loops(model);
  for (const ModelRate& rate : hinge_rates(model))
    if (rate.angular && in_loops[rate.hinge]) angles_.push_back({model.layout().positions + rate.speed, rate.position});
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
