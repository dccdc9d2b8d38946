#include "withy/core/simulation/monitor.hpp"

#include <algorithm>
#include <cmath>

#include "withy/core/deformation/point_motion.hpp"

namespace withy {

Monitor::Monitor(const Model& model, const EquationsOfMotion& equations, const State& initial, double deflection_limit,
                 RunSummary& summary)
    : model_(model),
      equations_(equations),
      summary_(summary),
      deflection_limit_(deflection_limit),
      efforts_(model.layout().speeds),
      rates_(equations.size()),
      work_(equations.make_work()),
      initial_work_(initial.y.back()),
      checked_(initial.time) {
  for (std::size_t b = 0; b < model.bodies().size(); ++b) {
    const BodyNode& node = model.bodies()[b];
    const Slot* slot = model.layout().body(node.name);
    const double length = node.body->shape().length;
    const auto section = node.body->station("tip");
    if (slot == nullptr || !section || !(length > 0)) continue;
    ends_.push_back({slot,
                     static_cast<int>(b),
                     node.frame("tip"),
                     *section,
                     length,
                     node.segment ? nullptr : &summary.peak_deflection[node.name],
                     &summary.peak_deflection_ratio[node.name],
                     {}});
  }
  for (Tip& tip : tips(model)) {
    if (tip.in_segments() && tip.flexible) wholes_.push_back(std::move(tip));
  }
  summary.peak_effort.assign(model.layout().speeds, 0.0);
  summary.peak_motion_effort.assign(model.layout().speeds, 0.0);
  const Energies e = equations.energies(initial.y);
  initial_energy_ = e.kinetic + e.potential;
  initial_sign_ = mass_matrix_sign(initial);
}

std::array<double, 3> Monitor::deflection_of(const End& end, const State& state) const {
  return end.frame >= 0 ? equations_.deflection(state.y, end.body, end.frame) : expanded(end, state);
}

std::array<double, 3> Monitor::expanded(const End& end, const State& state) {
  const Eigen::Map<const Eigen::VectorXd> q(state.y.data() + end.slot->position,
                                            static_cast<Eigen::Index>(end.slot->positions));
  const Vector3 d = point_velocity(end.section, StrainOrder::quadratic, q, q).first - end.section.X;
  return {d.x(), d.y(), d.z()};
}

void Monitor::note(const std::string& name, double length, const std::array<double, 3>& d,
                   std::array<double, 3>* peak) {
  for (std::size_t k = 0; peak != nullptr && k < 3; ++k) (*peak)[k] = std::max((*peak)[k], std::abs(d[k]));
  const double size = std::hypot(d[0], d[1], d[2]);
  if (!excess_.empty() || size <= deflection_limit_ * length) return;
  excess_ = "the tip of '" + name + "' is deflected by " + brief(size) + " m, " + brief(size / length) +
            " times its length (limit " + brief(deflection_limit_) + ")";
}

void Monitor::observe(const State& state, bool output) {
  for (End& end : ends_) {
    // Exact kinematics integrates along the body, at the cost of several evaluations: between outputs only where the
    // expansion says that the deflection has not been so great before.
    const std::array<double, 3> rough = expanded(end, state);
    bool greater = false;
    for (std::size_t k = 0; k < 3; ++k) {
      greater = greater || std::abs(rough[k]) > end.rough[k];
      end.rough[k] = std::max(end.rough[k], std::abs(rough[k]));
    }
    if (!output && !greater) continue;
    const std::array<double, 3> d = deflection_of(end, state);
    *end.ratio = std::max(*end.ratio, std::hypot(d[0], d[1], d[2]) / end.length);
    note(end.slot->name, end.length, d, end.peak);
  }
  if (output) {
    for (const Tip& tip : wholes_)
      note(tip.body, tip.length, deflection(equations_, state.y, tip), &summary_.peak_deflection[tip.body]);
  }
  const auto raise = [&](std::vector<double>& peak) {
    for (std::size_t i = 0; i < efforts_.size(); ++i) peak[i] = std::max(peak[i], std::abs(efforts_[i]));
  };
  if (!model_.loads().empty()) {
    equations_.load_efforts(state.time, state.y, EquationsOfMotion::all_loads, efforts_, work_);
    raise(summary_.peak_effort);
  }
  if (!model_.motions().empty() && equations_.motion_efforts(state.time, state.y, efforts_, work_).ok())
    raise(summary_.peak_motion_effort);
}

void Monitor::audit_energy(const State& state) {
  const Energies e = equations_.energies(state.y);
  const double energy = e.kinetic + e.potential;
  const double work = state.y.back() - initial_work_;
  energy_error_ = std::max(energy_error_, std::abs(energy - initial_energy_ - work));
  energy_scale_ = std::max({energy_scale_, std::abs(energy), std::abs(initial_energy_), std::abs(work), e.kinetic});
  summary_.energy_drift = energy_scale_ > 0 ? energy_error_ / energy_scale_ : 0;
}

int Monitor::mass_matrix_sign(const State& state) {
  const Evaluation evaluation = equations_.derivatives(state.time, state.y, rates_, work_);
  return evaluation.ok() ? evaluation.determinant_sign : 0;
}

void Monitor::audit_mass_matrix(const State& state, int sign) {
  if (sign == initial_sign_) {
    checked_ = state.time;
  } else if (!sign_change_) {
    sign_change_ = {checked_, state.time};
  }
}

void Monitor::remember(Memory& memory) {
  for (auto& [body, peak] : summary_.peak_deflection) {
    for (double& d : peak) memory(d);
  }
  for (auto& [body, ratio] : summary_.peak_deflection_ratio) memory(ratio);
  for (End& end : ends_) {
    for (double& d : end.rough) memory(d);
  }
  memory(summary_.peak_effort);
  memory(summary_.peak_motion_effort);
  memory(summary_.energy_drift);
  memory(summary_.suspected_jumps);
  memory(energy_error_);
  memory(energy_scale_);
  memory(checked_);
  memory(rejected_);
  memory(burst_);
}

// Where the right-hand side is smooth, error control rejects a step now and then. At a jump inside a step it rejects
// again and again, until the steps are so short that the jump does not matter; until as many in a row go well as make a
// burst, what follows belongs to the same jump.
void Monitor::audit_steps(const State& state, const StepStatistics& steps) {
  constexpr std::size_t many = 8;
  constexpr std::size_t most_reports = 16;
  const std::size_t rejected = steps.rejected - rejected_;
  rejected_ = steps.rejected;
  if (rejected == 0) {
    burst_ = burst_ < many ? burst_ - (burst_ > 0 ? 1 : 0) : 0;
    if (++calm_ >= many) noted_ = false;
    return;
  }
  calm_ = 0;
  burst_ += rejected;
  if (burst_ < many || noted_) return;
  noted_ = true;
  if (summary_.suspected_jumps.size() < most_reports) summary_.suspected_jumps.push_back(state.time);
}

}  // namespace withy
