#include "withy/study/bent.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "withy/core/simulation/tips.hpp"
#include "withy/core/simulation/validity_limits.hpp"
#include "withy/scene/names.hpp"

namespace withy::study {
namespace {

std::string loads_of(const Model& model) {
  std::vector<std::string> names;
  for (const LoadNode& load : model.loads()) names.push_back(load.name);
  return names.empty() ? "" : fmt::format(" and the loads ({})", listed(names));
}

}  // namespace

std::string bent_text(const Configuration& c, const State& steady) {
  const Model& model = c.prepared().model();
  double most = deflection_limit;
  const BodyNode* body = nullptr;
  std::string tip_of;
  for (const Tip& tip : measured_ends(model)) {
    if (!tip.flexible || !(tip.length > 0)) continue;
    const auto d = deflection(*c.prepared().equations, steady.y, tip);
    const double share = std::hypot(d[0], d[1], d[2]) / tip.length;
    if (share <= most) continue;
    most = share;
    body = &model.bodies()[static_cast<std::size_t>(tip.tip.body)];
    tip_of = tip.body + '.' + tip.station;
  }
  if (body == nullptr) return {};
  const Terms terms = body->terms.value_or(c.prepared().scene.formulation->terms());
  const bool small = terms.strain != StrainOrder::exact && !body->segment;
  return fmt::format(
      "At this state {} is deflected by {:.2g} of its body's length, by weight{} as they are at t = {:g} s: what "
      "acts there for a moment counts as lasting.{}",
      tip_of, most, loads_of(model), steady.time,
      small ? fmt::format(" Beyond {:g} deflections are not small.", deflection_limit) : "");
}

}  // namespace withy::study
