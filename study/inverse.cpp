#include "withy/study/inverse.hpp"

#include <cmath>
#include <utility>

#include "withy/core/model/columns.hpp"
#include "withy/study/input_error.hpp"
#include "withy/study/refusals.hpp"

namespace withy::study {

InverseStudy::InverseStudy(const Prepared& prepared)
    : prepared_(prepared), work_(prepared.equations->make_work()), efforts_(prepared.model().layout().speeds) {
  refuse_loops(prepared, "'withy inverse'");
  const Model& model = prepared.model();
  for (const MotionNode& motion : model.motions()) {
    const auto h = static_cast<std::size_t>(motion.hinge);
    const Slot& slot = model.layout().hinges[h];
    for (std::size_t s = slot.speed; s < slot.speed + slot.speeds; ++s)
      drives_.push_back({model.layout().speed_names[s], unit_of_effort(model, s), s, {}, {}});
  }
  if (drives_.empty())
    throw InputError(prepared.scene.file +
                     ": no hinge is driven; give the scene motions, or --motion FILE with columns "
                     "t[s] and hinge coordinates");
}

RunSettings InverseStudy::run_settings(Control control) {
  RunSettings settings;
  settings.look_beyond = false;
  settings.output = [this](const State& state, std::size_t) { enter(state); };
  settings.control = std::move(control);
  return settings;
}

void InverseStudy::enter(const State& state) {
  prepared_.equations->motion_efforts(state.time, state.y, efforts_, work_);
  times_.push_back(state.time);
  for (Drive& drive : drives_) {
    drive.effort.push_back(efforts_[drive.speed]);
    drive.rate.push_back(state.y[prepared_.model().layout().positions + drive.speed]);
  }
}

Demand InverseStudy::demand(const Drive& drive) const {
  Demand d;
  double squares = 0;
  const auto power = [&](std::size_t i) { return drive.effort[i] * drive.rate[i]; };
  for (std::size_t i = 0; i < times_.size(); ++i) {
    if (std::abs(drive.effort[i]) > std::abs(d.peak)) {
      d.peak = drive.effort[i];
      d.peak_time = times_[i];
    }
    if (std::abs(power(i)) > std::abs(d.peak_power)) d.peak_power = power(i);
    if (i == 0) continue;
    const double h = times_[i] - times_[i - 1];
    squares += 0.5 * h * (std::pow(drive.effort[i], 2) + std::pow(drive.effort[i - 1], 2));
    d.work += 0.5 * h * (power(i) + power(i - 1));
  }
  const double length = times_.empty() ? 0 : times_.back() - times_.front();
  if (length > 0) d.rms = std::sqrt(squares / length);
  return d;
}

}  // namespace withy::study
