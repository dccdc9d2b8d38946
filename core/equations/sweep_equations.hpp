/// \file
/// Equations of motion by a sweep, with loads, elastic forces and rates of positions.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "withy/core/equations/applied_loads.hpp"
#include "withy/core/equations/denormals.hpp"
#include "withy/core/equations/elastic_part.hpp"
#include "withy/core/equations/rate_map.hpp"
#include "withy/core/equations/sensing.hpp"
#include "withy/core/equations/work_slices.hpp"
#include "withy/core/kinematics/observation.hpp"
#include "withy/core/model/hosted_motion.hpp"
#include "withy/core/plugin/forward_dynamics.hpp"
#include "withy/core/reference/reference.hpp"
#include "withy/core/tangents/state_jacobian.hpp"
#include "withy/core/tree/placed_tree.hpp"

namespace withy::equations {

/// Whether a sweep solves with G + δ D + δ² K in the place of the modal masses.
template <class Sweep>
constexpr bool has_modal_solver = requires(const Sweep& s, double* a, std::byte* work) {
  s.solve(a, 0.0, a, work);
};

/// Whether a sweep has weight by a potential of its own.
template <class Sweep>
constexpr bool has_own_weight = requires(const Sweep& s, const double* a, std::byte* work) {
  s.weight_potential(a, a, work);
};

/// What the compilation of a tree made of it, a line each.
std::vector<std::string> savings_of(const NodeTree& tree, const std::vector<std::string>& of_sweep);

/// The body whose hinge or modes have the first acceleration that is not finite; −1 where there is none.
int first_nonfinite(const Model& model, const double* accelerations);

/// Something made when it is first asked for, by whichever thread.
template <class T>
class Lazy {
 public:
  template <class Make>
  const T& operator()(Make&& make) const {
    std::call_once(once_, [&] { value_ = make(); });
    return *value_;
  }

 private:
  mutable std::once_flag once_;
  mutable std::shared_ptr<const T> value_;
};

/// A sweep with its loads; for everything that is not hot, the reference, tangents and observations.
template <class Sweep>
class SweepEquations final : public EquationsOfMotion,
                             public LinearlyImplicit,
                             public ForwardDynamics,
                             public MassSolver {
 public:
  SweepEquations(std::shared_ptr<const Model> model, Terms terms, PlacedTree tree, const std::vector<Terms>& node_terms)
      : model_(std::move(model)),
        terms_(terms),
        loads_(*model_, terms),
        sweep_(tree, node_terms, model_->gravity()),
        elastic_(*model_),
        rates_(*model_),
        savings_(savings_of(tree, sweep_.savings(tree))),
        tree_(std::make_unique<PlacedTree>(std::move(tree))) {
    for (std::size_t h = 0; h < layout().hinges.size(); ++h) {
      if (model_->driven(h)) driven_.push_back(layout().hinges[h]);
    }
    lay_out();
  }

  const Layout& layout() const override { return model_->layout(); }
  Work make_work() const override { return Work(work_size_); }

  Evaluation derivatives(double t, std::span<const double> y, std::span<double> y_dot,
                         Work& work) const noexcept override {
    [[maybe_unused]] const DenormalsAreZero guard;
    const auto speeds = speeds_of(y);
    const std::span<double> efforts = applied(t, y, y_dot, work);
    if (!terms_.products_of_speeds) elastic_.add_damping(speeds, efforts);
    const Evaluation evaluation = accelerations(y, efforts.data(), 0, y_dot, work);
    if (!evaluation.ok()) return evaluation;
    if (!terms_.products_of_speeds) elastic_.add_damping(speeds, efforts, -1);
    return finish(t, y, speeds, efforts, y_dot, evaluation, work);
  }

  Evaluation implicit_derivatives(double t, std::span<const double> y, std::span<const double> base, double delta,
                                  std::span<double> y_dot, Work& work) const noexcept override {
    [[maybe_unused]] const DenormalsAreZero guard;
    const Layout& order = layout();
    const std::span<double> efforts = applied(t, y, y_dot, work);
    // The sweep takes stiffness and damping at y: here is the difference.
    const std::span<double> forces = implicit_.in(work);
    std::copy(efforts.begin(), efforts.end(), forces.begin());
    elastic_.add_implicit(y, base, delta, terms_.products_of_speeds, forces);
    const Evaluation evaluation = accelerations(y, forces.data(), delta, y_dot, work);
    if (!evaluation.ok()) return evaluation;
    for (const Slot& slot : driven_) std::copy_n(forces.data() + slot.speed, slot.speeds, efforts.data() + slot.speed);
    const std::span<double> implicit = forces;  // which nobody needs any more
    const auto u = speeds_of(base);
    for (std::size_t i = 0; i < order.speeds; ++i) implicit[i] = u[i] + delta * y_dot[order.positions + i];
    return finish(t, y, implicit, efforts, y_dot, evaluation, work);
  }

  Evaluation forward_dynamics(std::span<const double> y, std::span<const double> efforts, std::span<double> u_dot,
                              Work& work) const noexcept override {
    const std::span<double> given = efforts_.in(work);
    std::copy(efforts.begin(), efforts.end(), given.begin());
    const auto speeds = speeds_of(y);
    if (!terms_.products_of_speeds) elastic_.add_damping(speeds, given);
    const double* inertial_speeds = inertial(speeds, work);
    if constexpr (has_modal_solver<Sweep>) {
      return sweep_.accelerations(y.data(), inertial_speeds, given.data(), 0, u_dot.data(), of_sweep_.in(work));
    } else {
      return sweep_.accelerations(y.data(), inertial_speeds, given.data(), u_dot.data(), of_sweep_.in(work));
    }
  }

  void load_efforts(double t, std::span<const double> y, int load, std::span<double> efforts,
                    Work& work) const noexcept override {
    std::fill(efforts.begin(), efforts.end(), 0.0);
    loads_.add(t, y, efforts, of_loads_.in(work), load);
  }
  Evaluation motion_efforts(double t, std::span<const double> y, std::span<double> efforts,
                            Work& work) const noexcept override {
    std::fill(efforts.begin(), efforts.end(), 0.0);
    if (model_->motions().empty()) return {};
    const Evaluation evaluation = derivatives(t, y, of_rates_.in(work), work);
    if (evaluation.ok()) find_motion_efforts(work, efforts);
    return evaluation;
  }
  bool found_efforts(Work& work, std::span<double> loads, std::span<double> motions) const noexcept override {
    const std::span<const double> all = efforts_.in(work), on_driven = on_driven_.in(work);
    std::copy(all.begin(), all.end(), loads.begin());
    const double* of_loads = on_driven.data();
    for (const Slot& slot : driven_) of_loads = copy_back(of_loads, slot, loads);
    std::fill(motions.begin(), motions.end(), 0.0);
    find_motion_efforts(work, motions);
    return true;
  }
  void inverse_dynamics(std::span<const double> y, std::span<const double> u_dot, std::span<double> efforts,
                        Work& work) const override {
    const auto speeds = speeds_of(y);
    sweep_.inverse(y.data(), inertial(speeds, work), u_dot.data(), false, efforts.data(), of_sweep_.in(work));
    if (!terms_.products_of_speeds) elastic_.add_damping(speeds, efforts, -1);
  }
  void mass_times(std::span<const double> y, std::span<const double> a, std::span<double> result,
                  Work& work) const override {
    const std::span<double> at_rest = efforts_.in(work);
    std::fill(at_rest.begin(), at_rest.end(), 0.0);
    sweep_.inverse(y.data(), at_rest.data(), a.data(), true, result.data(), of_sweep_.in(work));
  }

  std::optional<double> weight_potential(std::span<const double> y, Work& work) const noexcept override {
    if constexpr (has_own_weight<Sweep>) {
      const std::span<double> at_rest = efforts_.in(work);
      std::fill(at_rest.begin(), at_rest.end(), 0.0);
      return sweep_.weight_potential(y.data(), at_rest.data(), of_sweep_.in(work));
    } else {
      return std::nullopt;
    }
  }

  const LinearlyImplicit* linearly_implicit() const override { return has_modal_solver<Sweep> ? this : nullptr; }
  Work make_factors() const override { return Work(factors_size_); }
  Evaluation factorize(std::span<const double> y, double delta, Work& factors) const noexcept override {
    if constexpr (has_modal_solver<Sweep>) {
      factor_delta_.in(factors)[0] = delta;
      const std::span<double> at_rest = factor_rest_.in(factors);
      std::fill(at_rest.begin(), at_rest.end(), 0.0);
      return sweep_.factorize(y.data(), at_rest.data(), delta, factor_sweep_.in(factors));
    } else {
      return {Evaluation::Outcome::singular};
    }
  }
  // With z_q = r_q + δ z_u:  (M + δ D + δ² K) (r_u − z_u) = (δ D + δ² K) r_u + δ K r_q, all K, D on modes alone.
  void solve(std::span<double> r, Work& factors) const noexcept override {
    const double delta = factor_delta_.in(factors)[0];
    const std::span<double> forces = factor_forces_.in(factors), change = factor_change_.in(factors);
    std::fill(forces.begin(), forces.end(), 0.0);
    elastic_.add_coupling(r, delta, forces);
    if constexpr (has_modal_solver<Sweep>) sweep_.solve(forces.data(), delta, change.data(), factor_sweep_.in(factors));
    const std::span<double> u = r.subspan(layout().positions, layout().speeds);
    for (std::size_t i = 0; i < u.size(); ++i) u[i] -= change[i];
    for (const Slot& slot : layout().bodies) {
      for (std::size_t i = 0; i < slot.speeds; ++i) r[slot.position + i] += delta * u[slot.speed + i];
    }
  }

  std::size_t mass_factors_size() const override { return has_modal_solver<Sweep> ? factors_size_ : 0; }
  Evaluation factorize_mass(std::span<const double> y, Work& factors) const noexcept override {
    return factorize(y, 0, factors);
  }
  void accelerate(std::span<const double> forces, std::span<double> accelerations,
                  Work& factors) const noexcept override {
    if constexpr (has_modal_solver<Sweep>)
      sweep_.solve(forces.data(), 0, accelerations.data(), factor_sweep_.in(factors));
  }

  const Linearization* linearization() const override {
    return &linearization_([this] { return std::make_shared<const StateJacobian>(model_, terms_); });
  }
  Evaluation position_rates(double, std::span<const double> y, std::span<double> y_dot, Work&) const noexcept override {
    rates_.set(y.first(layout().positions), speeds_of(y), y_dot);
    return {};
  }
  void normalize(std::span<double> y) const noexcept override { rates_.normalize(y); }

  std::unique_ptr<Observation> make_observation() const override { return observed().make_observation(); }
  /// What its observations are made of.
  [[nodiscard]] const ObservedModel& observed() const {
    return observed_([this] { return observed_model(*model_, terms_, std::move(*std::exchange(tree_, nullptr))); });
  }
  std::unique_ptr<SensedState> make_sensed_state(std::span<const SectionPlace> sections) const override {
    return make_sensing(std::make_unique<const sensed::Plan>(*model_, terms_, sections), *this, loads_);
  }
  DenseSystem system(double t, std::span<const double> y) const override { return reference().system(t, y); }
  Energies energies(std::span<const double> y) const override { return reference().energies(y); }
  WorldPose frame_pose(std::span<const double> y, int body, int frame) const override {
    return reference().frame_pose(y, body, frame);
  }
  std::array<double, 3> deflection(std::span<const double> y, int body, int frame) const override {
    return reference().deflection(y, body, frame);
  }
  std::vector<std::string> savings() const override { return savings_; }

  // For evaluations of several cases at once, which have a sweep of their own: what stands before it and after it.
  [[nodiscard]] const Sweep& sweep() const { return sweep_; }
  [[nodiscard]] const Terms& terms() const { return terms_; }
  [[nodiscard]] const AppliedLoads& loads() const { return loads_; }
  [[nodiscard]] const ElasticPart& elastic() const { return elastic_; }
  [[nodiscard]] const RateMap& rates() const { return rates_; }
  /// Whether efforts are those of loads that are functions of time alone, and nothing is driven.
  [[nodiscard]] bool only_timed() const { return loads_.only_timed() && model_->motions().empty(); }
  /// The efforts that the last evaluation with this memory has found.
  std::span<double> efforts(Work& work) const noexcept { return efforts_.in(work); }
  /// The loads' efforts at (t, y), in the work memory; driven accelerations go into y_dot.
  std::span<double> applied(double t, std::span<const double> y, std::span<double> y_dot, Work& work) const noexcept {
    const std::span<double> efforts = efforts_.in(work);
    for (double& e : efforts) e = 0;
    loads_.add(t, y, efforts, of_loads_.in(work));
    prescribe(t, y, y_dot, efforts, work);
    return efforts;
  }
  /// The same for who has the efforts of loads that are functions of time alone; see AppliedLoads.
  std::span<double> applied(double t, std::span<const double> y, std::span<double> y_dot, Work& work,
                            std::span<const double> timed) const noexcept {
    const std::span<double> efforts = efforts_.in(work);
    for (double& e : efforts) e = 0;
    loads_.add_to_timed(t, y, timed, efforts, of_loads_.in(work));
    prescribe(t, y, y_dot, efforts, work);
    return efforts;
  }
  /// All that an evaluation gives beside accelerations: position rates and power of these speeds, the rates of the
  /// loads' own states, and whether all is finite.
  Evaluation finish(double t, std::span<const double> y, std::span<const double> speeds,
                    std::span<const double> efforts, std::span<double> y_dot, const Evaluation& evaluation,
                    Work& work) const noexcept {
    const Layout& order = layout();
    rates_.set(y.first(order.positions), speeds, y_dot);
    const double* accelerations = y_dot.data() + order.positions;
    double power = 0;
    if (!model_->motions().empty() || !model_->loads().empty()) {
      for (std::size_t i = 0; i < order.speeds; ++i) power += efforts[i] * speeds[i];
    }
    power += elastic_.damping_power(speeds);
    for (std::size_t i = 0; i < order.discrete; ++i) y_dot[order.moving() + i] = 0;
    y_dot[order.moving() + order.discrete] = power;
    double total = power;
    for (std::size_t i = 0; i < order.speeds; ++i) total += std::abs(accelerations[i]);
    if (!std::isfinite(total)) return {Evaluation::Outcome::nonfinite, first_nonfinite(*model_, accelerations)};
    if (order.continuous > 0 && !loads_.rates(t, y, y_dot, of_loads_.in(work)))
      return {Evaluation::Outcome::nonfinite, -1};
    return evaluation;
  }

 private:
  void lay_out() {
    sweep::WorkLayout memory;
    const std::size_t speeds = layout().speeds;
    efforts_ = {memory, speeds};
    std::size_t driven = 0;
    for (const Slot& slot : driven_) driven += slot.speeds;
    on_driven_ = {memory, driven};
    of_loads_ = {memory, loads_.work_size()};
    of_rates_ = {memory, model_->motions().empty() ? 0 : size()};
    implicit_ = {memory, has_modal_solver<Sweep> ? speeds : 0};
    at_rest_ = {memory, terms_.products_of_speeds ? 0 : speeds};
    of_sweep_ = {memory, sweep_.work_size()};
    work_size_ = memory.size();
    sweep::WorkLayout factors;
    factor_delta_ = {factors, 1};
    factor_rest_ = {factors, speeds};
    factor_forces_ = {factors, speeds};
    factor_change_ = {factors, speeds};
    factor_sweep_ = {factors, sweep_.work_size()};
    factors_size_ = factors.size();
  }

  /// Driven accelerations into y_dot; what loads do on driven speeds is kept.
  void prescribe(double t, std::span<const double> y, std::span<double> y_dot, std::span<const double> efforts,
                 Work& work) const noexcept {
    // The sweep leaves all efforts on driven speeds in the place of the loads'.
    double* on_driven = on_driven_.in(work).data();
    for (const Slot& slot : driven_) on_driven = std::copy_n(efforts.data() + slot.speed, slot.speeds, on_driven);
    if (!model_->motions().empty()) {
      const std::span<double> u_dot(y_dot.data() + layout().positions, layout().speeds);
      model_->prescribe_accelerations(t, u_dot);
      hosted_.prescribe(t, y, u_dot);
    }
  }

  [[nodiscard]] std::span<const double> speeds_of(std::span<const double> y) const noexcept {
    return y.subspan(layout().positions, layout().speeds);
  }
  [[nodiscard]] const ReferenceDynamics& reference() const {
    return reference_([this] { return std::make_shared<const ReferenceDynamics>(model_, terms_); });
  }
  /// Of the last evaluation, on driven speeds.
  void find_motion_efforts(Work& work, std::span<double> efforts) const noexcept {
    const std::span<const double> all = efforts_.in(work);
    const double* of_loads = on_driven_.in(work).data();
    for (const Slot& slot : driven_)
      for (std::size_t i = slot.speed; i < slot.speed + slot.speeds; ++i) efforts[i] = all[i] - *of_loads++;
  }
  static const double* copy_back(const double* of_loads, const Slot& slot, std::span<double> loads) noexcept {
    std::copy_n(of_loads, slot.speeds, loads.data() + slot.speed);
    return of_loads + slot.speeds;
  }
  /// The sweep, with M + δ D + δ² K where it can.
  Evaluation accelerations(std::span<const double> y, double* efforts, double delta, std::span<double> y_dot,
                           Work& work) const noexcept {
    const double* speeds = inertial(speeds_of(y), work);
    double* result = y_dot.data() + layout().positions;
    if constexpr (has_modal_solver<Sweep>) {
      return sweep_.accelerations(y.data(), speeds, efforts, delta, result, of_sweep_.in(work));
    } else {
      return sweep_.accelerations(y.data(), speeds, efforts, result, of_sweep_.in(work));
    }
  }
  /// The speeds that inertia forces see: zeros where their products are dropped.
  const double* inertial(std::span<const double> speeds, Work& work) const noexcept {
    if (terms_.products_of_speeds) return speeds.data();
    const std::span<double> at_rest = at_rest_.in(work);
    std::fill(at_rest.begin(), at_rest.end(), 0.0);
    return at_rest.data();
  }

  std::shared_ptr<const Model> model_;
  Terms terms_;
  AppliedLoads loads_;
  Sweep sweep_;
  ElasticPart elastic_;
  RateMap rates_;
  std::vector<std::string> savings_;
  mutable std::unique_ptr<PlacedTree> tree_;  ///< until somebody observes
  HostedMotions hosted_{*model_};
  std::vector<Slot> driven_;  ///< hinges that motions drive, in State's order
  Lazy<ReferenceDynamics> reference_;
  Lazy<StateJacobian> linearization_;
  Lazy<ObservedModel> observed_;
  // Work memory of an evaluation.
  Slice<double> efforts_, on_driven_, of_rates_, implicit_, at_rest_;
  Region of_loads_, of_sweep_;
  std::size_t work_size_ = 0;
  // Memory of factors.
  Slice<double> factor_delta_, factor_rest_, factor_forces_, factor_change_;
  Region factor_sweep_;
  std::size_t factors_size_ = 0;
};

}  // namespace withy::equations
