#include "withy/study/against_next.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "withy/core/simulation/tips.hpp"
#include "withy/study/sampled_steady.hpp"

namespace withy::study {
namespace {

/// Every body in one formulation.
SceneValues values_in(const Prepared& prepared, const std::string& formulation) {
  constexpr const char* origin = "the next model up";
  SceneValues values = prepared.values;
  for (const BodyNode& body : prepared.model().bodies())
    if (body.terms) values.body_formulation(body.scene_name(), formulation, origin);
  values.choose_formulation(formulation, origin);
  return values;
}

void raise(AgainstNext& against, double difference, const std::string& of) {
  ++against.compared;
  if (difference <= against.most && against.compared > 1) return;
  against.most = difference;
  against.of = of;
}

}  // namespace

std::optional<AgainstNext> frequencies_against_next(const ModesOf& run, const SceneValues& values, Registry& registry,
                                                    const StartState& start, const Holding& holding, bool as_is,
                                                    std::size_t count, const Control& control) {
  const Prepared prepared = prepare(values, registry);
  const std::optional<Beyond> beyond = next_model_up(prepared, registry);
  if (!beyond || run.points.front().modes.empty()) return {};
  AgainstNext against{.formulation = beyond->formulation, .of = {}, .problem = {}};
  const ModesOf next =
      sweep_modes(values_in(prepared, beyond->formulation), registry, start, holding, {}, as_is, {}, control);
  const ModesAt &ours = run.points.front(), &theirs = next.points.front();
  const auto vibrating = [](const ModesAt& at) {
    std::vector<const Mode*> modes;
    for (const Mode& m : at.modes)
      if (!m.rigid) modes.push_back(&m);
    return modes;
  };
  const std::vector<const Mode*> of_ours = vibrating(ours), of_theirs = vibrating(theirs);
  if (!theirs.problem.empty() || of_theirs.size() != of_ours.size()) {
    against.problem = theirs.problem.empty() ? "it has another number of modes" : theirs.problem;
    return against;
  }
  for (std::size_t i = 0; i < std::min(count, of_ours.size()); ++i) {
    const double frequency = of_theirs[i]->frequency();
    if (!(frequency > 0)) continue;
    raise(against, std::abs(of_ours[i]->frequency() - frequency) / frequency, dominating(ours, *of_ours[i]));
  }
  return against;
}

std::optional<AgainstNext> deflections_against_next(const Configuration& configuration, const SteadyState& steady,
                                                    const Holding& holding, Registry& registry) {
  const Prepared& prepared = configuration.prepared();
  const std::optional<Beyond> beyond = next_model_up(prepared, registry);
  if (!beyond || !steady.converged) return {};
  AgainstNext against{.formulation = beyond->formulation, .of = {}, .problem = {}};
  const Prepared up = prepare(values_in(prepared, beyond->formulation), registry);
  Configuration there(up, configuration.state(), holding);
  there.begin_at(steady.state);
  const SteadyState found = steady_state_of(there);
  if (!found.converged) {
    against.problem = no_steady_state(there, found);
    return against;
  }
  // Rounding of what stays straight is no deflection.
  constexpr double straight = 1e-9;
  double greatest = 0;
  std::vector<std::pair<double, std::string>> differences;
  for (const Tip& tip : measured_ends(prepared.model())) {
    if (!tip.flexible) continue;
    const auto ours = deflection(*prepared.equations, steady.state.y, tip);
    const auto theirs = deflection(*up.equations, found.state.y, tip);
    if (std::max(std::hypot(ours[0], ours[1], ours[2]), std::hypot(theirs[0], theirs[1], theirs[2])) <=
        straight * tip.length)
      continue;
    greatest = std::max(greatest, std::hypot(theirs[0], theirs[1], theirs[2]));
    differences.emplace_back(std::hypot(ours[0] - theirs[0], ours[1] - theirs[1], ours[2] - theirs[2]),
                             tip.body + '.' + tip.station);
  }
  for (const auto& [difference, tip] : differences) raise(against, greatest > 0 ? difference / greatest : 0, tip);
  return against;
}

std::string against_next_text(const std::optional<AgainstNext>& against, const std::string& what) {
  if (!against) return {};
  if (!against->problem.empty())
    return fmt::format("How far {} are from those in {} is not known: {}.", what, against->formulation,
                       against->problem);
  if (against->compared == 0) return {};
  return fmt::format("Difference from {} in {}: up to {:.2g} %, most {}.", against->formulation, what,
                     100 * against->most, against->of);
}

}  // namespace withy::study
