/// \file
/// What signals depend on, found by reading them with numbers that are none.
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "withy/core/kinematics/signals.hpp"

namespace withy {

void Signals::choose_readings(const Model& model, const Terms& terms) {
  const auto is_sensor = [](const Source& s) { return !s.element && s.load == nullptr; };
  if (std::any_of(sources_.begin(), sources_.end(), is_sensor)) {
    model_ = std::make_shared<const Model>(model);
    fields_ = ActingFields(*model_);
    for (const SensorNode& node : *model.measured()) {
      if (node.sensor == nullptr) continue;
      const std::size_t count = node.sensor->columns().size();
      readings_.push_back({node.sensor, numbers_, count});
      numbers_ += count;
    }
    lay_out();
    // Only what the numbers depend on: a sensor whose numbers may be anything is not read.
    const std::vector<Reading> all = readings_;
    std::vector<FrameIndex> ignored;
    for (std::size_t i = all.size(); i-- > 0;) {
      const bool named = std::any_of(sources_.begin(), sources_.end(), [&](const Source& s) {
        return is_sensor(s) && s.number >= all[i].first && s.number < all[i].first + all[i].count;
      });
      if (named) continue;
      const auto at = readings_.begin() + static_cast<std::ptrdiff_t>(i);
      const std::vector<double> with = probe(model, {}, &ignored);
      const Reading reading = *at;
      readings_.erase(at);
      const std::vector<double> without = probe(model, {}, &ignored);
      const bool needed = !std::equal(with.begin(), with.end(), without.begin(),
                                      [](double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); });
      if (needed) readings_.insert(readings_.begin() + static_cast<std::ptrdiff_t>(i), reading);
    }
    std::vector<FrameIndex> asked;
    static_cast<void>(probe(model, {}, &asked));
    for (const FrameIndex& f : asked) {
      if (!has_place(*model_, f))
        throw std::invalid_argument("what is measured asks for " + frame_in_words(*model_, f) +
                                    ", which the scene has not");
      const auto same = [&](const FrameIndex& g) { return g.body == f.body && g.frame == f.frame; };
      if (std::none_of(frames_.begin(), frames_.end(), same)) frames_.push_back(f);
    }
    if (!frames_.empty()) paths_ = std::make_unique<const FramePaths>(*model_, terms, frames_, true);
    sort_out(model);
  } else {
    model_ = nullptr;
  }
  lay_out();
}

void Signals::sort_out(const Model& model) {
  lay_out();
  std::vector<FrameIndex> ignored;
  const std::vector<double> still = probe(model, {}, &ignored);
  const auto moved = [&](const std::vector<double>& values, std::size_t i) {
    return !sources_[i].element && sources_[i].load == nullptr && values[i] != still[i] && !std::isnan(still[i]);
  };
  for (const double size : {std::numeric_limits<double>::quiet_NaN(), 1.7e3, -2.3e3}) {
    const std::vector<double> by_effort = probe(model, {0, size}, &ignored);
    const std::vector<double> by_acceleration = probe(model, {size, 0}, &ignored);
    for (std::size_t i = 0; i < sources_.size(); ++i) {
      if (moved(by_effort, i))
        throw std::invalid_argument("signal '" + names_[i] + "' depends on efforts or energies: the loop " + names_[i] +
                                    " -> this load -> efforts -> " + names_[i] +
                                    " would be algebraic; measure positions, rates or accelerations (a gyro, an "
                                    "accelerometer, a frame that shows its velocity), or give this load a 'sample'");
      sources_[i].accelerated = sources_[i].accelerated || moved(by_acceleration, i);
    }
  }
  accelerates_ = !frames_.empty() &&
                 std::any_of(sources_.begin(), sources_.end(), [](const Source& source) { return source.accelerated; });
}

std::vector<double> Signals::probe(const Model& model, Unknown unknown, std::vector<FrameIndex>* asked) const {
  State state;
  const Layout& layout = model.layout();
  state.y.assign(layout.size(), 0.0);
  for (std::size_t h = 0; h < model.hinges().size(); ++h) {
    const Slot& slot = layout.hinges[h];
    const auto x = std::span(state.y).subspan(slot.position, slot.positions);
    model.hinges()[h].hinge->reference(x);
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += 0.1 * std::sin(1.0 + static_cast<double>(slot.position + i));
    model.hinges()[h].hinge->normalize(x);
  }
  // A part of the body's length: an exact rod that is bent by many of its lengths has no numbers.
  for (std::size_t b = 0; b < model.bodies().size(); ++b) {
    const Slot* const slot = layout.modes(b);
    if (slot == nullptr) continue;
    const double length = model.bodies()[b].body->shape().length, size = 1e-3 * (length > 0 ? length : 1.0);
    for (std::size_t i = 0; i < slot->positions; ++i)
      state.y[slot->position + i] = size * std::cos(static_cast<double>(slot->position + i));
  }
  for (std::size_t i = 0; i < layout.speeds; ++i)
    state.y[layout.positions + i] = 0.1 * std::cos(1.0 + static_cast<double>(i));
  std::vector<double> scratch(scratch_), values(sources_.size());
  const LoadView view{0.1, layout, state.y, {}, {}, scratch};
  read_sensors(view, unknown, asked);
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    if (!sources_[i].element && sources_[i].load == nullptr) values[i] = scratch[sources_[i].number];
  }
  return values;
}

}  // namespace withy
