#include "withy/study/bent.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "withy/core/simulation/tips.hpp"
#include "withy/core/simulation/validity_limits.hpp"
#include "withy/scene/names.hpp"

namespace withy::study {
namespace {

/// Weight, the rates of hinges and loads: what there is of these; empty where nothing is.
std::string causes_of(const Model& model, const State& steady) {
  std::vector<std::string> causes, moving, loads;
  if (!model.gravity().isZero(0)) causes.emplace_back("weight");
  for (const Slot& slot : model.layout().hinges) {
    const auto first = steady.y.begin() + static_cast<std::ptrdiff_t>(model.layout().positions + slot.speed);
    const auto moves = [](double rate) { return rate != 0; };
    if (std::any_of(first, first + static_cast<std::ptrdiff_t>(slot.speeds), moves)) moving.push_back(slot.name);
  }
  if (!moving.empty()) causes.push_back(fmt::format("the motion of hinges ({})", listed(moving)));
  for (const LoadNode& load : model.loads()) loads.push_back(load.name);
  if (!loads.empty()) causes.push_back(fmt::format("the loads ({})", listed(loads)));
  return fmt::format("{}", fmt::join(causes, " and "));
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
  const std::string causes = causes_of(model, steady);
  return fmt::format(
      "At this state {} is deflected by {:.2g} of its body's length{}.{}", tip_of, most,
      causes.empty() ? ""
                     : fmt::format(", by {} as they are at t = {:g} s: what acts there for a moment counts as lasting",
                                   causes, steady.time),
      small ? fmt::format(" Beyond {:g} deflections are not small.", deflection_limit) : "");
}

}  // namespace withy::study
