#include "withy/core/equations/compile_equations.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <stdexcept>
#include <type_traits>

#include "withy/core/equations/applied_loads.hpp"
#include "withy/core/reference/reference.hpp"
#include "withy/core/sweep/first_order/first_order_sweep.hpp"
#include "withy/core/sweep/strict/strict_sweep.hpp"
#include "withy/core/sweep/symmetric/symmetric_sweep.hpp"
#include "withy/core/tangents/state_jacobian.hpp"

namespace withy {
namespace {

/// Whether a sweep solves with G + δ D + δ² K in the place of the modal masses.
template <class Sweep>
constexpr bool has_modal_solver = requires(const Sweep& s, double* a, std::byte* work) {
  s.solve(a, 0.0, a, work);
};

/// Whether the derivatives of a sweep's equations are known better than by differences of the sweep, which cost less.
template <class Sweep>
constexpr bool has_tangents = true;
template <class Space>
constexpr bool has_tangents<sweep::FirstOrderSweep<Space>> = false;

/// While it lives denormal numbers count as zero: products of coordinates below 1e-154, as of vibrations that have died
/// away, would each cost a hundred cycles. Then the processor's floating-point state is the host's again.
class DenormalsAreZero {
#ifdef __SSE2__
 public:
  DenormalsAreZero() : state_(__builtin_ia32_stmxcsr()) {
    __builtin_ia32_ldmxcsr(state_ | flush_to_zero | denormals_are_zero);
  }
  ~DenormalsAreZero() { __builtin_ia32_ldmxcsr(state_); }
  DenormalsAreZero(const DenormalsAreZero&) = delete;
  DenormalsAreZero& operator=(const DenormalsAreZero&) = delete;

 private:
  static constexpr unsigned flush_to_zero = 0x8000, denormals_are_zero = 0x40;
  unsigned state_;
#endif
};

/// A sweep, its loads, and the reference for everything that is not hot.
template <class Sweep>
class SweepEquations final : public EquationsOfMotion, public LinearlyImplicit {
 public:
  SweepEquations(std::shared_ptr<const Model> model, Terms terms, NodeTree tree, const std::vector<Terms>& node_terms)
      : model_(std::move(model)),
        terms_(terms),
        reference_(model_, terms),
        loads_(*model_, terms),
        sweep_(tree, node_terms, model_->gravity()),
        savings_(std::move(tree.savings)) {
    std::size_t aligned = 0;
    for (const NodeSpec& node : tree.nodes) {
      const auto kind = node.kernel ? node.kernel->kind : HingeKernel::Kind::free;
      if (kind == HingeKernel::Kind::revolute || kind == HingeKernel::Kind::prismatic) ++aligned;
    }
    if (aligned > 0)
      savings_.push_back(std::to_string(aligned) + " of " + std::to_string(tree.nodes.size()) +
                         " hinges lie along an axis of their frame: a column of the inertia in place of a product");
    for (std::string& line : sweep_.savings(tree)) savings_.push_back(std::move(line));
#ifdef __AVX2__
    savings_.emplace_back("sweeps compiled for x86-64-v3 (AVX2, FMA), which this processor has");
#else
    savings_.emplace_back("sweeps compiled for any x86-64 processor");
#endif
    for (const BodyNode& b : model_->bodies()) {
      const Eigen::MatrixXd& D = b.body->shape().damping;
      const Eigen::MatrixXd& K = b.body->shape().stiffness;
      const std::size_t first = D.size() > 0 ? layout().body(b.name)->speed : 0;
      for (Eigen::Index i = 0; i < D.rows(); ++i) {
        for (Eigen::Index j = 0; j < D.cols(); ++j) {
          const std::size_t row = first + static_cast<std::size_t>(i), column = first + static_cast<std::size_t>(j);
          if (K(i, j) != 0)
            springs_.push_back({row, column, layout().body(b.name)->position + static_cast<std::size_t>(j), K(i, j)});
          if (D(i, j) != 0) damped_.push_back({row, column, D(i, j)});
        }
      }
    }
    for (std::size_t h = 0; h < layout().hinges.size(); ++h) {
      const Slot& slot = layout().hinges[h];
      if (slot.positions == 1 && slot.speeds == 1) {
        copy(slot.position, slot.speed, 1);
      } else if (slot.positions > 0) {
        general_.push_back(h);
      }
    }
    for (std::size_t h = 0; h < layout().hinges.size(); ++h) {
      if (model_->driven(h)) driven_.push_back(layout().hinges[h]);
    }
    for (const Slot& slot : layout().bodies) copy(slot.position, slot.speed, slot.speeds);
    std::sort(copies_.begin(), copies_.end(), [](const Run& a, const Run& b) { return a.position < b.position; });
    for (std::size_t i = copies_.size(); i-- > 1;) {
      Run& before = copies_[i - 1];
      if (before.position + before.count != copies_[i].position || before.speed + before.count != copies_[i].speed)
        continue;
      before.count += copies_[i].count;
      copies_.erase(copies_.begin() + static_cast<std::ptrdiff_t>(i));
    }
    // Efforts, then the loads' memory, then the sweep's own.
    sweep::WorkLayout memory;
    efforts_offset_ = memory.take<double>(layout().speeds);
    loads_offset_ = memory.take<std::byte>(loads_.work_size());
    rates_offset_ = memory.take<double>(model_->motions().empty() ? 0 : size());
    implicit_offset_ = memory.take<double>(has_modal_solver<Sweep> ? layout().speeds : 0);
    at_rest_offset_ = memory.take<double>(terms.products_of_speeds ? 0 : layout().speeds);
    sweep_offset_ = memory.size();
    sweep::WorkLayout factors;
    factors.take<double>(1 + 3 * layout().speeds);
    factors_offset_ = factors.size();
  }

  const Layout& layout() const override { return model_->layout(); }
  Work make_work() const override { return Work(sweep_offset_ + sweep_.work_size()); }

  Evaluation derivatives(double t, std::span<const double> y, std::span<double> y_dot,
                         Work& work) const noexcept override {
    [[maybe_unused]] const DenormalsAreZero guard;
    const Layout& order = layout();
    const auto speeds = y.subspan(order.positions, order.speeds);
    const std::span<double> efforts = applied(t, y, y_dot, work);
    if (!terms_.products_of_speeds) add_damping(speeds, efforts);
    const Evaluation evaluation = accelerations(y, efforts.data(), 0, y_dot, work);
    if (!evaluation.ok()) return evaluation;
    if (!terms_.products_of_speeds) add_damping(speeds, efforts, -1);
    return finish(y.first(order.positions), speeds, efforts, y_dot, evaluation);
  }

  Evaluation implicit_derivatives(double t, std::span<const double> y, std::span<const double> base, double delta,
                                  std::span<double> y_dot, Work& work) const noexcept override {
    [[maybe_unused]] const DenormalsAreZero guard;
    const Layout& order = layout();
    const auto speeds = y.subspan(order.positions, order.speeds);
    const std::span<double> efforts = applied(t, y, y_dot, work);
    const double* u = base.data() + order.positions;
    // The sweep takes stiffness and damping at y: here is the difference.
    auto* forces = reinterpret_cast<double*>(work.data() + implicit_offset_);
    std::copy(efforts.begin(), efforts.end(), forces);
    for (const Spring& k : springs_) forces[k.i] += k.value * (y[k.position] - base[k.position] - delta * u[k.j]);
    for (const Damper& d : damped_)
      forces[d.i] -= d.value * (terms_.products_of_speeds ? u[d.j] - speeds[d.j] : u[d.j]);
    const Evaluation evaluation = accelerations(y, forces, delta, y_dot, work);
    if (!evaluation.ok()) return evaluation;
    for (const Slot& slot : driven_) std::copy_n(forces + slot.speed, slot.speeds, efforts.data() + slot.speed);
    double* implicit = forces;  // which nobody needs any more
    for (std::size_t i = 0; i < order.speeds; ++i) implicit[i] = u[i] + delta * y_dot[order.positions + i];
    return finish(y.first(order.positions), {implicit, order.speeds}, efforts, y_dot, evaluation);
  }

  void load_efforts(double t, std::span<const double> y, int load, std::span<double> efforts,
                    Work& work) const noexcept override {
    std::fill(efforts.begin(), efforts.end(), 0.0);
    loads_.add(t, y, efforts, work.data() + loads_offset_, load);
  }
  Evaluation motion_efforts(double t, std::span<const double> y, std::span<double> efforts,
                            Work& work) const noexcept override {
    std::fill(efforts.begin(), efforts.end(), 0.0);
    if (model_->motions().empty()) return {};
    const std::span<double> y_dot(reinterpret_cast<double*>(work.data() + rates_offset_), size());
    const Evaluation evaluation = derivatives(t, y, y_dot, work);
    if (!evaluation.ok()) return evaluation;
    // The evaluation leaves there all efforts on driven speeds.
    const double* all = reinterpret_cast<const double*>(work.data() + efforts_offset_);
    load_efforts(t, y, all_loads, efforts, work);
    std::size_t next = 0;  // the first speed not yet looked at
    for (const Slot& slot : driven_) {
      for (; next < slot.speed; ++next) efforts[next] = 0;
      for (; next < slot.speed + slot.speeds; ++next) efforts[next] = all[next] - efforts[next];
    }
    for (; next < efforts.size(); ++next) efforts[next] = 0;
    return evaluation;
  }
  void inverse_dynamics(std::span<const double> y, std::span<const double> u_dot, std::span<double> efforts,
                        Work& work) const override {
    if constexpr (has_modal_solver<Sweep>) {
      const auto speeds = y.subspan(layout().positions, layout().speeds);
      sweep_.inverse(y.data(), inertial(speeds, work.data()), u_dot.data(), false, efforts.data(),
                     work.data() + sweep_offset_);
      if (!terms_.products_of_speeds) add_damping(speeds, efforts, -1);
    } else {
      const DenseSystem s = reference_.system(0, y);
      product(s, u_dot, efforts);
      for (std::size_t i = 0; i < s.size; ++i) efforts[i] -= s.force[i];
    }
  }
  void mass_times(std::span<const double> y, std::span<const double> a, std::span<double> result,
                  Work& work) const override {
    if constexpr (has_modal_solver<Sweep>) {
      auto* at_rest = reinterpret_cast<double*>(work.data() + efforts_offset_);
      for (std::size_t i = 0; i < layout().speeds; ++i) at_rest[i] = 0;
      sweep_.inverse(y.data(), at_rest, a.data(), true, result.data(), work.data() + sweep_offset_);
    } else {
      product(reference_.system(0, y), a, result);
    }
  }

  const LinearlyImplicit* linearly_implicit() const override { return has_modal_solver<Sweep> ? this : nullptr; }
  // In the factors' memory: δ, zeros for the speeds, forces, the solution, the sweep's own.
  Work make_factors() const override { return Work(factors_offset_ + sweep_.work_size()); }
  Evaluation factorize(std::span<const double> y, double delta, Work& factors) const noexcept override {
    auto* memory = reinterpret_cast<double*>(factors.data());
    memory[0] = delta;
    for (std::size_t i = 0; i < layout().speeds; ++i) memory[1 + i] = 0;
    if constexpr (has_modal_solver<Sweep>) {
      return sweep_.factorize(y.data(), memory + 1, delta, factors.data() + factors_offset_);
    } else {
      return {Evaluation::Outcome::singular};
    }
  }
  // With z_q = r_q + δ z_u:  (M + δ D + δ² K) (r_u − z_u) = (δ D + δ² K) r_u + δ K r_q, all K, D on modes alone.
  void solve(std::span<double> r, Work& factors) const noexcept override {
    auto* memory = reinterpret_cast<double*>(factors.data());
    const std::size_t n = layout().speeds;
    const double delta = memory[0];
    double* forces = memory + 1 + n;
    double* change = memory + 1 + 2 * n;
    double* u = r.data() + layout().positions;
    for (std::size_t i = 0; i < n; ++i) forces[i] = 0;
    for (const Spring& k : springs_) forces[k.i] += delta * k.value * (r[k.position] + delta * u[k.j]);
    for (const Damper& d : damped_) forces[d.i] += delta * d.value * u[d.j];
    if constexpr (has_modal_solver<Sweep>) sweep_.solve(forces, delta, change, factors.data() + factors_offset_);
    for (std::size_t i = 0; i < n; ++i) u[i] -= change[i];
    for (const Slot& slot : layout().bodies) {
      for (std::size_t i = 0; i < slot.speeds; ++i) r[slot.position + i] += delta * u[slot.speed + i];
    }
  }

  const Linearization* linearization() const override {
    if constexpr (!has_tangents<Sweep>) return nullptr;
    std::call_once(linearized_, [this] { linearization_ = std::make_unique<StateJacobian>(model_, terms_); });
    return linearization_.get();
  }
  Evaluation position_rates(double, std::span<const double> y, std::span<double> y_dot, Work&) const noexcept override {
    set_position_rates(y.first(layout().positions), y.subspan(layout().positions, layout().speeds), y_dot);
    return {};
  }
  void normalize(std::span<double> y) const noexcept override {
    for (std::size_t h = 0; h < layout().hinges.size(); ++h) {
      const Slot& slot = layout().hinges[h];
      if (slot.positions != slot.speeds) model_->hinges()[h].hinge->normalize(y.subspan(slot.position, slot.positions));
    }
  }

  DenseSystem system(double t, std::span<const double> y) const override { return reference_.system(t, y); }
  Energies energies(std::span<const double> y) const override { return reference_.energies(y); }
  WorldPose frame_pose(std::span<const double> y, int body, int frame) const override {
    return reference_.frame_pose(y, body, frame);
  }
  std::array<double, 3> deflection(std::span<const double> y, int body, int frame) const override {
    return reference_.deflection(y, body, frame);
  }
  std::vector<std::string> savings() const override { return savings_; }

 private:
  /// The loads' efforts at (t, y), in the work memory; driven accelerations go into y_dot.
  std::span<double> applied(double t, std::span<const double> y, std::span<double> y_dot, Work& work) const noexcept {
    const std::span<double> efforts(reinterpret_cast<double*>(work.data() + efforts_offset_), layout().speeds);
    for (double& e : efforts) e = 0;
    loads_.add(t, y, efforts, work.data() + loads_offset_);
    if (!model_->motions().empty())
      model_->prescribe_accelerations(t, {y_dot.data() + layout().positions, layout().speeds});
    return efforts;
  }
  /// The sweep, with M + δ D + δ² K where it can.
  Evaluation accelerations(std::span<const double> y, double* efforts, double delta, std::span<double> y_dot,
                           Work& work) const noexcept {
    const double* speeds = inertial(y.subspan(layout().positions, layout().speeds), work.data());
    double* result = y_dot.data() + layout().positions;
    if constexpr (has_modal_solver<Sweep>) {
      return sweep_.accelerations(y.data(), speeds, efforts, delta, result, work.data() + sweep_offset_);
    } else {
      return sweep_.accelerations(y.data(), speeds, efforts, result, work.data() + sweep_offset_);
    }
  }
  /// All that an evaluation gives beside accelerations: position rates and power of these speeds, and whether all is
  /// finite.
  Evaluation finish(std::span<const double> positions, std::span<const double> speeds, std::span<const double> efforts,
                    std::span<double> y_dot, const Evaluation& evaluation) const noexcept {
    const Layout& order = layout();
    set_position_rates(positions, speeds, y_dot);
    const double* accelerations = y_dot.data() + order.positions;
    double power = 0;
    if (!model_->motions().empty() || !model_->loads().empty()) {
      for (std::size_t i = 0; i < order.speeds; ++i) power += efforts[i] * speeds[i];
    }
    for (const Damper& d : damped_) power -= speeds[d.i] * d.value * speeds[d.j];
    for (std::size_t i = 0; i < order.discrete; ++i) y_dot[order.positions + order.speeds + i] = 0;
    y_dot[order.positions + order.speeds + order.discrete] = power;
    double total = power;
    for (std::size_t i = 0; i < order.speeds; ++i) total += std::abs(accelerations[i]);
    if (!std::isfinite(total)) return {Evaluation::Outcome::nonfinite, first_nonfinite(accelerations)};
    return evaluation;
  }
  void set_position_rates(std::span<const double> positions, std::span<const double> speeds,
                          std::span<double> y_dot) const noexcept {
    const Layout& order = layout();
    for (const Run& run : copies_) {
      for (std::size_t i = 0; i < run.count; ++i) y_dot[run.position + i] = speeds[run.speed + i];
    }
    for (const std::size_t h : general_) {
      const Slot& slot = order.hinges[h];
      model_->hinges()[h].hinge->derivatives(positions.subspan(slot.position, slot.positions),
                                             speeds.subspan(slot.speed, slot.speeds),
                                             y_dot.subspan(slot.position, slot.positions));
    }
  }
  /// The speeds that inertia forces see: zeros where their products are dropped.
  const double* inertial(std::span<const double> speeds, std::byte* memory) const noexcept {
    if (terms_.products_of_speeds) return speeds.data();
    auto* at_rest = reinterpret_cast<double*>(memory + at_rest_offset_);
    std::fill(at_rest, at_rest + speeds.size(), 0.0);
    return at_rest;
  }
  /// Adds −D q̇, or takes it away, where the sweep sees no speeds.
  void add_damping(std::span<const double> speeds, std::span<double> efforts, double sign = 1) const noexcept {
    for (const Damper& d : damped_) efforts[d.i] -= sign * d.value * speeds[d.j];
  }
  static void product(const DenseSystem& s, std::span<const double> a, std::span<double> result) {
    for (std::size_t i = 0; i < s.size; ++i) {
      result[i] = 0;
      for (std::size_t j = 0; j < s.size; ++j) result[i] += s.mass[i * s.size + j] * a[j];
    }
  }
  /// The body whose hinge or modes have the first acceleration that is not finite.
  int first_nonfinite(const double* accelerations) const noexcept {
    const auto bad = [&](const Slot& slot) {
      for (std::size_t i = 0; i < slot.speeds; ++i) {
        if (!std::isfinite(accelerations[slot.speed + i])) return true;
      }
      return false;
    };
    std::size_t flexible = 0;
    for (std::size_t b = 0; b < layout().hinges.size(); ++b) {
      if (bad(layout().hinges[b])) return static_cast<int>(b);
      if (model_->bodies()[b].body->shape().modes() > 0 && bad(layout().bodies[flexible++])) return static_cast<int>(b);
    }
    return -1;
  }

  void copy(std::size_t position, std::size_t speed, std::size_t count) {
    if (count > 0) copies_.push_back({position, speed, count});
  }

  /// An element of a body's stiffness matrix: speeds of row and column, position of the column.
  struct Spring {
    std::size_t i, j, position;
    double value;
  };
  /// An element of a body's damping matrix, by speeds.
  struct Damper {
    std::size_t i, j;
    double value;
  };
  /// Coordinates whose derivatives are their speeds, in State's order.
  struct Run {
    std::size_t position, speed, count;
  };
  std::shared_ptr<const Model> model_;
  Terms terms_;
  ReferenceDynamics reference_;
  AppliedLoads loads_;
  Sweep sweep_;
  std::vector<std::string> savings_;
  std::vector<Spring> springs_;
  std::vector<Damper> damped_;
  std::vector<Run> copies_;
  std::vector<Slot> driven_;          ///< hinges that motions drive, in State's order
  std::vector<std::size_t> general_;  ///< hinges with derivatives of their own
  mutable std::once_flag linearized_;
  mutable std::unique_ptr<const StateJacobian> linearization_;  ///< made when it is first asked for
  std::size_t efforts_offset_ = 0, loads_offset_ = 0, rates_offset_ = 0, implicit_offset_ = 0, at_rest_offset_ = 0,
              sweep_offset_ = 0, factors_offset_ = 0;
};

}  // namespace

std::unique_ptr<EquationsOfMotion> compile_equations(std::shared_ptr<const Model> model, Terms terms) {
  model = Model::in_kinematics(std::move(model), terms);
  NodeTree tree = compile_tree(*model);
  std::vector<Terms> node_terms;
  // The body that is truncated so and not ruthlessly, of each truncation.
  std::array<const std::string*, 4> of{};
  for (const NodeSpec& node : tree.nodes) {
    const BodyNode& body = model->bodies()[static_cast<std::size_t>(node.body)];
    node_terms.push_back(body.terms.value_or(terms));
    if (node.modes > 0) of.at(static_cast<std::size_t>(node_terms.back().truncation)) = &body.name;
  }
  const std::string* strict = of.at(static_cast<std::size_t>(Truncation::strict));
  const std::string* symmetric = of.at(static_cast<std::size_t>(Truncation::symmetric));
  const std::string* full = of.at(static_cast<std::size_t>(Truncation::none));
  if (!terms.products_of_speeds && (strict != nullptr || symmetric != nullptr || terms.truncation != Truncation::none))
    throw std::invalid_argument("products of speeds can be dropped only where nothing is truncated");
  const auto refuse = [](const std::string* a, const char* how, const std::string* b, const char* other) {
    if (a == nullptr || b == nullptr) return;
    throw std::invalid_argument("body '" + *a + "' is " + how + " and body '" + *b + "' is " + other +
                                "; equations of one order cannot hold both");
  };
  refuse(strict, "truncated to strict first order", full, "not truncated");
  refuse(symmetric, "truncated to first order of the kinetic energy", full, "not truncated");
  refuse(symmetric, "truncated to first order of the kinetic energy", strict, "truncated to strict first order");
  const bool planar = tree.planar;
  const auto build = [&]<class Sweep>(std::type_identity<Sweep>) -> std::unique_ptr<EquationsOfMotion> {
    return std::make_unique<SweepEquations<Sweep>>(std::move(model), terms, std::move(tree), node_terms);
  };
  if (strict != nullptr) {
    return planar ? build(std::type_identity<sweep::StrictSweep<Planar>>{})
                  : build(std::type_identity<sweep::StrictSweep<Spatial>>{});
  }
  if (symmetric != nullptr) {
    return planar ? build(std::type_identity<sweep::FirstOrderSweep<Planar>>{})
                  : build(std::type_identity<sweep::FirstOrderSweep<Spatial>>{});
  }
  return planar ? build(std::type_identity<sweep::SymmetricSweep<Planar>>{})
                : build(std::type_identity<sweep::SymmetricSweep<Spatial>>{});
}

}  // namespace withy
