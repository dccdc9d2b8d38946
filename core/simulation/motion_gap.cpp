#include "withy/core/simulation/motion_gap.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "withy/core/model/hinge_rates.hpp"
#include "withy/core/simulation/diagnosis.hpp"

namespace withy {

MotionGap::MotionGap(const Model& model) : model_(model) {
  constexpr double none = std::numeric_limits<double>::infinity();
  for (const MotionNode& m : model.motions())
    if (!m.motion->locks())
      driven_.push_back({&m, model.layout().hinges[static_cast<std::size_t>(m.hinge)].position, none, -none, 0, 0});
}

void MotionGap::look(const State& state) noexcept {
  for (Driven& d : driven_) {
    if (std::isinf(d.gap)) continue;
    const double law = d.motion->motion->at(state.time).position;
    // Integrators ask for accelerations alone: as long as these are finite, the run goes on.
    if (!std::isfinite(law)) {
      d.gap = std::numeric_limits<double>::infinity(), d.time = state.time;
      continue;
    }
    d.least = std::min(d.least, law), d.most = std::max(d.most, law);
    if (const double gap = std::abs(state.y[d.position] - law); gap > d.gap) d.gap = gap, d.time = state.time;
  }
}

void MotionGap::remember(Memory& memory) {
  for (Driven& d : driven_)
    for (double* number : {&d.least, &d.most, &d.gap, &d.time}) memory(*number);
}

const MotionGap::Driven* MotionGap::lost() const {
  const auto found = std::find_if(driven_.begin(), driven_.end(), [](const Driven& d) { return std::isinf(d.gap); });
  return found == driven_.end() ? nullptr : &*found;
}

void MotionGap::tell(RunSummary& summary) const {
  const Driven* driven = lost();
  if (driven != nullptr) summary.lost_motion = {driven->motion->name, driven->time};
}

std::string MotionGap::text() const {
  constexpr double kept = 0.01;
  if (const Driven* d = lost())
    return "Motion '" + d->motion->name + "' has no finite coordinate at t = " + brief(d->time) + " s: where hinge '" +
           hinge_of(*d).name + "' is from then on has no meaning.";
  const Driven* worst = nullptr;
  double greatest = kept;
  for (const Driven& d : driven_) {
    const double range = d.most - d.least;
    // What stands still has no range, and rounding is no distance.
    const double share = d.gap > 1e-9 * (std::abs(d.least) + std::abs(d.most)) ? d.gap / range : 0;
    if (share > greatest) greatest = share, worst = &d;
  }
  if (worst == nullptr) return {};
  const HingeNode& hinge = hinge_of(*worst);
  const std::string unit = hinge_rates(*hinge.hinge).front().angular ? " rad" : " m";
  return "Hinge '" + hinge.name + "' is off its motion '" + worst->motion->name + "' by " + brief(worst->gap) + unit +
         " at t = " + brief(worst->time) + " s, of " + brief(worst->most - worst->least) + unit +
         " that the motion goes: steps have passed over what its law does in between. Limit them "
         "(integrator.max_step, or a smaller step); where the law has a kink, as of min, max or abs, give it as a "
         "table or in parts.";
}

}  // namespace withy
