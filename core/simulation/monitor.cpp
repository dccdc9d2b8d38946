#include "withy/core/simulation/monitor.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "withy/core/model/closing.hpp"
#include "withy/core/plugin/measured_place.hpp"

namespace withy {
namespace {

/// Why a state has no energy: one of its numbers is none, a hinge's motion is not finite there, or the greatest of its
/// speeds, squared, is beyond all.
std::string without_energy(const Model& model, const State& state) {
  const Layout& layout = model.layout();
  if (const std::string number = nonfinite_number(layout, state); !number.empty())
    return "the energy is not finite: " + number;
  if (const auto hinge = nonfinite_hinge(model, state, 0)) return "the energy is not finite: " + hinge->why;
  const auto speeds = std::span(state.y).subspan(layout.positions, layout.speeds);
  const auto fastest =
      std::max_element(speeds.begin(), speeds.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
  if (fastest == speeds.end()) return "the energy is not finite";
  const auto index = static_cast<std::size_t>(fastest - speeds.begin());
  return "the energy is not finite: the speed '" + layout.speed_names[index] + "' is " + brief(*fastest);
}

}  // namespace

Monitor::Monitor(const Model& model, const EquationsOfMotion& equations, const State& initial, double deflection_limit,
                 double span, Observation* seen, RunSummary& summary, Attention attention)
    : model_(model),
      equations_(equations),
      summary_(summary),
      own_(seen != nullptr ? nullptr : equations.make_observation()),
      seen_(seen != nullptr ? *seen : *own_),
      deflection_limit_(deflection_limit),
      last_(initial),
      between_(initial),
      trusted_(initial),
      efforts_(model.layout().speeds),
      work_(0),
      initial_work_(initial.y.back()),
      loops_(dynamic_cast<const ClosedLoops*>(&equations)),
      length_of_loops_(loops_ != nullptr ? length_of_loops(model) : 0),
      multipliers_(loops_ != nullptr ? loops_->closing_equations() : 0),
      loops_work_(loops_ != nullptr ? equations.make_work() : Work(0)),
      checked_(initial.time) {
  if (attention == Attention::whole) effort_watch_.emplace(model, equations, span, summary);
  for (std::size_t b = 0; b < model.bodies().size(); ++b) {
    const BodyNode& node = model.bodies()[b];
    const double length = node.body->shape().length;
    if (node.body->shape().modes() == 0 || !(length > 0)) continue;
    for (const MeasuredPlace& place : measured_places(*node.body)) {
      const bool tip = place.name == "tip";
      ends_.push_back({model.layout().modes(b),
                       static_cast<int>(b),
                       node.frame(place.name),
                       seen_.expands(static_cast<int>(b)),
                       SectionExpansion(place.at),
                       length,
                       place.in_words(),
                       tip && !node.segment ? &summary.peak_deflection[node.name] : nullptr,
                       &summary.peak_deflection_ratio[node.name],
                       &summary.peak_section_angle[node.name],
                       {}});
    }
  }
  for (Tip& tip : tips(model)) {
    if (!tip.in_segments() || !tip.flexible) continue;
    summary.peak_deflection[tip.body] = {};
    wholes_.push_back(std::move(tip));
  }
  seen_.observe(initial.y);
  initial_energies_ = seen_.energies();
  initial_energy_ = initial_energies_.kinetic + initial_energies_.potential;
  if (attention == Attention::whole && may_float(model)) {
    momenta_.emplace(model, equations, initial, initial_energies_);
    momenta_->look(initial, initial_energies_, seen_);
  }
  initial_sign_ = mass_matrix_sign(initial);
  look(initial);
  each_peak([this](double peak) { trusted_peaks_.push_back(peak); });
}

template <class Visit>
void Monitor::each_peak(const Visit& visit) {
  for (auto& [body, peak] : summary_.peak_deflection) {
    for (double& d : peak) visit(d);
  }
  for (auto& [body, ratio] : summary_.peak_deflection_ratio) visit(ratio);
  for (auto& [body, angle] : summary_.peak_section_angle) visit(angle);
  for (double& effort : summary_.peak_effort) visit(effort);
  for (double& effort : summary_.peak_motion_effort) visit(effort);
}

void Monitor::trust_state(const State& state) {
  trusted_ = state;
  auto kept = trusted_peaks_.begin();
  each_peak([&kept](double peak) { *kept++ = peak; });
}

void Monitor::forget_untrusted_peaks() {
  auto kept = trusted_peaks_.begin();
  each_peak([&kept](double& peak) { peak = *kept++; });
}

void Monitor::observe(const Stepper& stepper) {
  look(stepper.state());
  steps_ = stepper.statistics().accepted;
  if (effort_watch_) effort_watch_->observe(stepper);
}

double Monitor::kinetic(const State& state, const Energies& energies) {
  if (!own_energy_) return energies.kinetic;
  const auto speeds = std::span<const double>(state.y).subspan(model_.layout().positions, efforts_.size());
  equations_.mass_times(state.y, speeds, efforts_, work_);
  double twice = 0;
  for (std::size_t i = 0; i < speeds.size(); ++i) twice += speeds[i] * efforts_[i];
  return 0.5 * twice;
}

double Monitor::potential(const State& state, const Energies& energies) {
  if (!own_energy_) return energies.potential;
  const auto weight = equations_.weight_potential(state.y, work_);
  if (!weight) return energies.potential;
  double twice = 0;
  for (std::size_t b = 0; b < model_.bodies().size(); ++b) {
    const Slot* modes = model_.layout().modes(b);
    if (modes == nullptr) continue;
    const Eigen::MatrixXd& K = model_.bodies()[b].body->shape().stiffness;
    const double* q = state.y.data() + modes->position;
    for (Eigen::Index j = 0; j < K.cols(); ++j)
      for (Eigen::Index i = 0; i < K.rows(); ++i) twice += q[i] * K(i, j) * q[j];
  }
  return *weight + 0.5 * twice;
}

void Monitor::use_own_energy(const State& initial) {
  work_ = equations_.make_work();
  own_energy_ = true;
  initial_energy_ = kinetic(initial, initial_energies_) + potential(initial, initial_energies_);
}

void Monitor::rebase_energy(const State& state, const std::function<void()>& change) {
  audit_energy(state);
  const auto energy = [&] {
    seen_.observe(state.y);
    const Energies e = seen_.energies();
    return e.kinetic + e.potential;
  };
  const double before = energy();
  change();
  const double jump = energy() - before;
  initial_energy_ += jump;
  initial_energies_.potential += jump;
  seen_y_.clear();
}

void Monitor::pass_event(const State& before, const State& after) {
  audit_energy(before);
  if (own_energy_) {
    // The work of impulses is that of the energy without truncation.
    const auto own = [&](const State& state) {
      seen_.observe(state.y);
      const Energies e = seen_.energies();
      return kinetic(state, e) - e.kinetic;
    };
    initial_energy_ += own(after) - own(before);
    seen_y_.clear();
  }
  audit_energy(after);
  look(after);
}

void Monitor::look_at_loads(const State& state) {
  if (own_ == nullptr) seen_y_.clear();
  see(state);
  momenta_->look_at_loads(state, seen_);
}

void Monitor::finish(const State& state) {
  audit_energy(state);
  if (!momenta_) return;
  momenta_->finish(state, seen_.energies());
  summary_.momentum = momenta_->drift();
}

/// In loops that rest under load each step leaves gaps of rounding, over which the loads work against forces of λ whose
/// work nothing takes up: that is no motion that could be off by anything. Looked for where it may matter alone.
void Monitor::find_rounding_energy(const State& state) {
  constexpr double visible = 1e-3, far = 1e6;
  constexpr double gap = 1e-15;  // of ℓ, to which loops are closed
  if (loops_ == nullptr || !(energy_error_ > visible * energy_scale_)) return;
  if (rounding_energy_ > 0 && energy_scale_ > far * rounding_energy_) return;
  loops_->multipliers(state.time, state.y, multipliers_, loops_work_);
  double forces = 0;
  for (const double lambda : multipliers_) forces += std::abs(lambda);
  if (!std::isfinite(forces)) return;
  rounding_energy_ = std::max(rounding_energy_, static_cast<double>(steps_) * gap * length_of_loops_ * forces);
}

void Monitor::audit_energy(const State& state) {
  if (own_ == nullptr) seen_y_.clear();
  see(state);
  const Energies e = seen_.energies();
  if (momenta_) momenta_->look(state, e, seen_);
  const double kinetic_energy = kinetic(state, e);
  const double energy = kinetic_energy + potential(state, e);
  const double work = state.y.back() - initial_work_;
  const double error = std::abs(energy - initial_energy_ - work);
  if (!std::isfinite(error) && excess_.empty()) excess_ = without_energy(model_, state);
  energy_error_ = std::max(energy_error_, error);
  energy_scale_ =
      std::max({energy_scale_, std::abs(energy), std::abs(initial_energy_), std::abs(work), kinetic_energy});
  const double untruncated = e.kinetic + e.potential - initial_energies_.kinetic - initial_energies_.potential - work;
  untruncated_error_ = std::max(untruncated_error_, std::abs(untruncated));
  find_rounding_energy(state);
  const bool moves = energy_scale_ > rounding_energy_;
  const auto relative = [&](double x) { return moves ? x / energy_scale_ : 0; };
  summary_.energy_drift = relative(energy_error_);
  summary_.energy_scale = moves ? energy_scale_ : 0;
  summary_.untruncated_drift = relative(untruncated_error_);
  for (std::size_t i = 0; i < model_.layout().speeds; ++i)
    greatest_speed_ = std::max(greatest_speed_, std::abs(state.y[model_.layout().positions + i]));
  // The greatest error so far: one that has grown with the energy passes through zero now and then.
  if (!sign_change_ && (moves ? energy_error_ : 0) <= trust_limit_ * energy_scale_) trust_state(state);
}

int Monitor::mass_matrix_sign(const State& state) {
  Work work = equations_.make_work();
  std::vector<double> rates(equations_.size());
  const Evaluation evaluation = equations_.derivatives(state.time, state.y, rates, work);
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
  for (auto& [body, angle] : summary_.peak_section_angle) memory(angle);
  for (End& end : ends_) {
    for (double& d : end.rough) memory(d);
    memory(end.rough_square);
    for (double& d : end.now.displacement) memory(d);
    for (double& d : end.now.velocity) memory(d);
  }
  if (effort_watch_) effort_watch_->remember(memory);
  memory(summary_.energy_drift);
  memory(summary_.suspected_jumps);
  memory(last_.time);
  memory(last_.y);
  memory(initial_energy_);
  memory(initial_energies_.potential);
  memory(energy_error_);
  memory(energy_scale_);
  memory(rounding_energy_);
  memory(summary_.untruncated_drift);
  if (momenta_) momenta_->remember(memory);
  memory(untruncated_error_);
  memory(trusted_.time);
  memory(trusted_.y);
  for (double& peak : trusted_peaks_) memory(peak);
  memory(greatest_speed_);
  memory(checked_);
  memory(rejected_);
  memory(burst_);
  memory(calm_);
  memory(noted_);
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
