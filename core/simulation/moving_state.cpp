#include "withy/core/simulation/moving_state.hpp"

#include <random>

namespace withy {

State moving_state(const Model& model, State state) {
  std::mt19937 random(1);
  // Standard distributions differ between libraries; these numbers do not.
  const auto number = [&](double size) { return size * (2.0 * random() / 4294967295.0 - 1); };
  const Layout& layout = model.layout();
  double* speeds = state.y.data() + layout.positions;
  for (std::size_t h = 0; h < layout.hinges.size(); ++h) {
    const Slot& slot = layout.hinges[h];
    const Hinge& hinge = *model.hinges()[h].hinge;
    const auto x = std::span(state.y).subspan(slot.position, slot.positions);
    std::vector<double> along(slot.speeds), change(slot.positions);
    for (double& a : along) a = number(0.3);
    hinge.derivatives(x, along, change);
    for (std::size_t i = 0; i < change.size(); ++i) x[i] += change[i];
    hinge.normalize(x);
    for (std::size_t i = 0; i < slot.speeds; ++i) speeds[slot.speed + i] = number(1);
  }
  for (const Slot& slot : layout.bodies) {
    for (std::size_t i = 0; i < slot.speeds; ++i) {
      state.y[slot.position + i] += number(1e-3);
      speeds[slot.speed + i] = number(1e-2);
    }
  }
  model.prescribe(state);
  return state;
}

}  // namespace withy
