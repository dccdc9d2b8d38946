#include "withy/study/continuation.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "withy/study/sampled_steady.hpp"

namespace withy::study {
namespace {

/// How far two states are apart, √ Σ M_ii δ_i², coordinates of each speed with its inertia. Of rotations, whose
/// coordinates are one more, the first has the inertia of the first speed.
double states_apart(const Layout& layout, const Eigen::VectorXd& mass, const State& a, const State& b) {
  double sum = 0;
  const auto add = [&](const Slot& slot) {
    const std::size_t more = slot.positions > slot.speeds ? slot.positions - slot.speeds : 0;
    for (std::size_t i = 0; i < slot.positions && slot.speeds > 0; ++i) {
      const double d = a.y[slot.position + i] - b.y[slot.position + i];
      sum += std::abs(mass[static_cast<Eigen::Index>(slot.speed + (i < more ? 0 : i - more))]) * d * d;
    }
  };
  for (const Slot& slot : layout.hinges) add(slot);
  for (const Slot& slot : layout.bodies) add(slot);
  return std::sqrt(sum);
}

/// What differs by no more is the same state, found to the last digits: the share of coordinates that no drawing shows.
double same_state_within(const Layout& layout, const Eigen::VectorXd& mass, const State& a) {
  constexpr double unseen = 1e-6;
  double size = unseen;
  for (std::size_t i = 0; i < layout.positions; ++i) size = std::max(size, std::abs(a.y[i]));
  return unseen * size * std::sqrt(mass.cwiseAbs().sum());
}

/// The steady state found from another; nothing where none is.
std::optional<State> found_from(Configuration at, const State& start) {
  at.begin_at(start);
  try {
    SteadyState found = steady_state_of(at);
    if (found.converged) return std::move(found.state);
  } catch (const std::domain_error&) {  // small motions cannot be found there
  }
  return {};
}

}  // namespace

Jump jump_between(Configuration before, const State& steady_before, const Configuration& here, const State& steady,
                  const std::function<std::optional<Configuration>()>& midway) {
  const Layout& layout = here.layout();
  const Eigen::VectorXd mass = here.dynamics().mass(steady.time, steady.y).diagonal();
  // Along a line that nothing holds a state may come back elsewhere by the square of the step: much less than it.
  constexpr double of_the_way = 0.1;
  const double enough =
      std::max(of_the_way * states_apart(layout, mass, steady_before, steady), same_state_within(layout, mass, steady));
  const std::optional<State> back = found_from(std::move(before), steady);
  if (back && states_apart(layout, mass, *back, steady_before) > enough) return Jump::no_way_back;
  const std::optional<Configuration> between = midway();
  if (!between || between->state().y.size() != steady.y.size()) return Jump::none;
  const std::optional<State> half = found_from(*between, steady_before);
  const std::optional<State> there = half ? found_from(here, *half) : std::nullopt;
  return there && states_apart(layout, mass, *there, steady) > enough ? Jump::another_midway : Jump::none;
}

std::string jump_text(Jump jump) {
  switch (jump) {
    case Jump::no_way_back:
      return "this steady state does not continue that at the value before, to which no way leads back from it: what "
             "was there ends in between, as where something snaps through.";
    case Jump::another_midway:
      return "by way of the value midway another steady state is found, and which one continues that at the value "
             "before is not known: take smaller steps.";
    case Jump::none:
      break;
  }
  return {};
}

}  // namespace withy::study
