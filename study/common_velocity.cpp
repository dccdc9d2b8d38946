#include "withy/study/common_velocity.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "withy/core/model/hinge_rates.hpp"

namespace withy::study {
namespace {

/// Speeds of hinges to the world that go anywhere in space.
std::vector<std::size_t> common_speeds(const Model& model) {
  std::vector<std::size_t> found;
  for (std::size_t h = 0; h < model.hinges().size(); ++h) {
    if (model.hinges()[h].parent >= 0) continue;
    std::vector<std::size_t> of_hinge;
    std::size_t s = model.layout().hinges[h].speed;
    for (const HingeRate& r : hinge_rates(*model.hinges()[h].hinge)) {
      if (!r.angular) of_hinge.push_back(s);
      ++s;
    }
    if (of_hinge.size() == 3) found.insert(found.end(), of_hinge.begin(), of_hinge.end());
  }
  return found;
}

bool symmetric_anywhere(const Scene& scene) {
  const std::vector<Terms> terms = terms_in_use(scene);
  return std::any_of(terms.begin(), terms.end(), [](const Terms& t) { return t.truncation == Truncation::symmetric; });
}

/// What equations make of a velocity: accelerations with it and without.
class With {
 public:
  explicit With(const EquationsOfMotion& equations)
      : equations_(equations), work_(equations.make_work()), rates_(equations.size()) {}
  /// \returns whether there are any; they are in `accelerations`.
  bool look(double time, std::span<const double> y) {
    if (!equations_.derivatives(time, y, rates_, work_).ok()) return false;
    const Layout& layout = equations_.layout();
    const auto first = rates_.begin() + static_cast<std::ptrdiff_t>(layout.positions);
    accelerations.assign(first, first + static_cast<std::ptrdiff_t>(layout.speeds));
    return true;
  }
  /// aᵀ M a less that of the acceleration that all have in common, which an orbit may have much of: speeds `common`
  /// move the whole tree along three axes, so the block of M that is theirs is its mass.
  double square(std::span<const double> y, std::span<const double> a, std::span<const std::size_t> common) {
    std::vector<double> product(a.size()), along(a.size()), momentum(a.size());
    equations_.mass_times(y, a, product, work_);
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * product[i];
    for (const std::size_t s : common) {
      along[s] = 1;
      equations_.mass_times(y, along, momentum, work_);
      along[s] = 0;
      sum -= product[s] * product[s] / momentum[s];
    }
    return std::max(sum, 0.0);
  }
  std::vector<double> accelerations;

 private:
  const EquationsOfMotion& equations_;
  Work work_;
  std::vector<double> rates_;
};

}  // namespace

std::optional<double> part_of_common_velocity(const Prepared& prepared, const Beyond* beyond,
                                              const RunSummary& summary) {
  const Layout& layout = prepared.model().layout();
  const std::vector<std::size_t> common = common_speeds(prepared.model());
  if (beyond == nullptr || common.empty() || !symmetric_anywhere(prepared.scene)) return {};
  With used(*prepared.equations), up(*beyond->equations);
  constexpr std::size_t looks = 16;
  std::vector<const State*> states = {&summary.final};
  const std::vector<State>& along = summary.validity.along;
  for (std::size_t i = 0; i < along.size(); i += std::max<std::size_t>(along.size() / looks, 1))
    states.push_back(&along[i]);
  std::optional<double> greatest;
  for (const State* state : states) {
    State resting = *state;
    for (const std::size_t s : common) resting.y[layout.positions + s] = 0;
    if (!used.look(state->time, state->y) || !up.look(state->time, state->y)) continue;
    const std::vector<double> here = used.accelerations;
    std::vector<double> part(here.size());
    for (std::size_t i = 0; i < part.size(); ++i) part[i] = here[i] - up.accelerations[i];
    if (!used.look(resting.time, resting.y) || !up.look(resting.time, resting.y)) continue;
    for (std::size_t i = 0; i < part.size(); ++i) part[i] -= used.accelerations[i] - up.accelerations[i];
    const double size = up.square(state->y, here, common);
    if (size > 0) greatest = std::max(greatest.value_or(0), std::sqrt(up.square(state->y, part, common) / size));
  }
  return greatest;
}

}  // namespace withy::study
