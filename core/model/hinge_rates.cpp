#include "withy/core/model/hinge_rates.hpp"

#include "withy/core/model/model.hpp"

namespace withy {
namespace {

/// The index i where v is the unit vector e_i.
std::optional<std::size_t> unit_index(const std::vector<double>& v) {
  std::optional<std::size_t> index;
  for (std::size_t i = 0; i < v.size(); ++i) {
    if (v[i] == 0) continue;
    if (v[i] != 1 || index) return {};
    index = i;
  }
  return index;
}

}  // namespace

std::vector<HingeRate> hinge_rates(const Hinge& hinge) {
  // Two poses, so that a relation which holds at the reference alone is not mistaken for a rule.
  std::vector<double> reference(hinge.coordinates());
  hinge.reference(reference);
  std::vector<double> displaced = reference;
  for (std::size_t i = 0; i < displaced.size(); ++i) displaced[i] += 0.3 + 0.07 * static_cast<double>(i);
  hinge.normalize(displaced);

  const bool known = hinge.kernel().has_value();
  std::vector<HingeRate> result(hinge.speeds());
  std::vector<double> rates(hinge.speeds()), x_dot(hinge.coordinates());
  HingeMotion motion;
  motion.H.resize(6, static_cast<Eigen::Index>(hinge.speeds()));
  for (std::size_t r = 0; r < rates.size(); ++r) {
    rates[r] = 1;
    hinge.motion(displaced, rates, motion);
    const bool turns = !motion.H.col(static_cast<Eigen::Index>(r)).head<3>().isZero(0);
    result[r].angular = turns;
    if (!known)
      if (const std::optional<bool> told = hinge.angular(r); told.has_value()) result[r].angular = *told;
    hinge.derivatives(displaced, rates, x_dot);
    result[r].coordinate = unit_index(x_dot);
    hinge.derivatives(reference, rates, x_dot);
    if (unit_index(x_dot) != result[r].coordinate) result[r].coordinate.reset();
    rates[r] = 0;
  }
  return result;
}

std::vector<ModelRate> hinge_rates(const Model& model) {
  std::vector<ModelRate> all;
  for (std::size_t h = 0; h < model.hinges().size(); ++h) {
    const Slot& slot = model.layout().hinges[h];
    std::size_t speed = slot.speed;
    for (const HingeRate& rate : hinge_rates(*model.hinges()[h].hinge)) {
      ModelRate& placed = all.emplace_back(ModelRate{speed++, {}, rate.angular, h});
      if (rate.coordinate) placed.position = slot.position + *rate.coordinate;
    }
  }
  return all;
}

}  // namespace withy
