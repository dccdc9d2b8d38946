#include "withy/core/simulation/paired_run.hpp"

#include <array>
#include <cmath>
#include <stdexcept>

#include "withy/core/simulation/instants.hpp"
#include "withy/core/simulation/integrator_call.hpp"
#include "withy/core/simulation/run_times.hpp"
#include "withy/core/simulation/stepping.hpp"

namespace withy {
namespace {

/// Both equations as one system for a stepper, of one thread: y holds the positions of both, the speeds of both, the
/// continuous and the discrete states of both, then the work of the second and that of the first. The work of the
/// second has no part in errors of steps: it stands with the discrete states, which linearly implicit steps alone move.
class PairedEquations final : public EquationsOfMotion, private LinearlyImplicit {
 public:
  PairedEquations(const EquationsOfMotion& first, const EquationsOfMotion& second)
      : halves_{Half(first), Half(second)},
        positions_(first.layout().positions),
        speeds_(first.layout().speeds),
        continuous_(first.layout().continuous),
        discrete_(first.layout().discrete) {
    layout_.positions = 2 * positions_;
    layout_.speeds = 2 * speeds_;
    layout_.continuous = 2 * continuous_;
    layout_.discrete = 2 * discrete_ + 1;
  }
  const Layout& layout() const override { return layout_; }
  Work make_work() const override { return Work(0); }
  Evaluation derivatives(double t, std::span<const double> y, std::span<double> y_dot, Work&) const noexcept override {
    for (std::size_t i = 0; i < 2; ++i) {
      Half& half = halves_[i];
      take(y, i, half.y);
      const Evaluation e = half.equations->derivatives(t, half.y, half.y_dot, half.work);
      if (!e.ok()) return e;
      put(half.y_dot, i, y_dot);
    }
    y_dot[y_dot.size() - 2] = 0;
    y_dot.back() = halves_[0].y_dot.back();
    return {};
  }
  [[nodiscard]] const LinearlyImplicit* linearly_implicit() const override {
    return halves_[0].linear != nullptr && halves_[1].linear != nullptr ? this : nullptr;
  }
  Evaluation implicit_derivatives(double t, std::span<const double> y, std::span<const double> base, double delta,
                                  std::span<double> y_dot, Work&) const noexcept override {
    for (std::size_t i = 0; i < 2; ++i) {
      Half& half = halves_[i];
      take(y, i, half.y);
      take(base, i, half.base);
      const Evaluation e = half.linear->implicit_derivatives(t, half.y, half.base, delta, half.y_dot, half.work);
      if (!e.ok()) return e;
      put(half.y_dot, i, y_dot);
    }
    y_dot[y_dot.size() - 2] = halves_[1].y_dot.back();
    y_dot.back() = halves_[0].y_dot.back();
    return {};
  }
  void normalize(std::span<double> y) const noexcept override {
    for (std::size_t i = 0; i < 2; ++i) {
      take(y, i, halves_[i].y);
      halves_[i].equations->normalize(halves_[i].y);
      put(halves_[i].y, i, y);
    }
  }
  /// One of the two states, with its work.
  void take(std::span<const double> y, std::size_t i, std::span<double> own) const noexcept {
    for (const Part& part : parts())
      std::copy_n(y.data() + 2 * part.first + i * part.count, part.count, own.data() + part.first);
    own.back() = i == 0 ? y.back() : y[y.size() - 2];
  }
  void put(std::span<const double> own, std::size_t i, std::span<double> y) const noexcept {
    for (const Part& part : parts())
      std::copy_n(own.data() + part.first, part.count, y.data() + 2 * part.first + i * part.count);
  }

  void inverse_dynamics(std::span<const double>, std::span<const double>, std::span<double>, Work&) const override {
    refuse();
  }
  void mass_times(std::span<const double>, std::span<const double>, std::span<double>, Work&) const override {
    refuse();
  }
  // Reports ask for these; steppers do not.
  void load_efforts(double, std::span<const double>, int, std::span<double>, Work&) const noexcept override {}
  Evaluation motion_efforts(double, std::span<const double>, std::span<double>, Work&) const noexcept override {
    return {Evaluation::Outcome::singular};
  }
  std::unique_ptr<Observation> make_observation() const override { refuse(); }
  DenseSystem system(double, std::span<const double>) const override { refuse(); }
  Energies energies(std::span<const double>) const override { refuse(); }
  WorldPose frame_pose(std::span<const double>, int, int) const override { refuse(); }
  std::array<double, 3> deflection(std::span<const double>, int, int) const override { refuse(); }
  std::vector<std::string> savings() const override { return {}; }

 private:
  /// Numbers of one state that stand together.
  struct Part {
    std::size_t first, count;
  };
  [[nodiscard]] std::array<Part, 4> parts() const noexcept {
    const std::size_t continuous = positions_ + speeds_, discrete = continuous + continuous_;
    return {{{0, positions_}, {positions_, speeds_}, {continuous, continuous_}, {discrete, discrete_}}};
  }
  struct Half {
    explicit Half(const EquationsOfMotion& e)
        : equations(&e),
          linear(e.linearly_implicit()),
          work(e.make_work()),
          y(e.size()),
          base(e.size()),
          y_dot(e.size()) {}
    const EquationsOfMotion* equations;
    const LinearlyImplicit* linear;  ///< null: they are not
    Work work;
    std::vector<double> y, base, y_dot;
  };
  // Steppers of pairs do without factors of their own.
  [[nodiscard]] Work make_factors() const override { return Work(0); }
  Evaluation factorize(std::span<const double>, double, Work&) const noexcept override {
    return {Evaluation::Outcome::singular};
  }
  void solve(std::span<double>, Work&) const noexcept override {}
  [[noreturn]] static void refuse() { throw std::logic_error("two models in one have no dynamics but their own"); }

  mutable std::array<Half, 2> halves_;
  std::size_t positions_, speeds_, continuous_, discrete_;
  Layout layout_;
};

/// Gives both states at outputs, and renews the discrete states of each.
class PairObserver final : public SteppingObserver {
 public:
  PairObserver(const PairedEquations& pair, std::array<Renewal, 2> renewals, const PairedRunOptions& options,
               const State& initial, const std::function<void(const State&, const State&)>& output)
      : pair_(pair),
        renewals_(std::move(renewals)),
        options_(options),
        output_(output),
        first_(initial),
        second_(initial),
        emitted_(initial.time) {}

  bool before_step(const Stepper& stepper) override {
    const bool spent = options_.most_evaluations > 0 && stepper.statistics().evaluations >= options_.most_evaluations;
    return !spent && !(options_.interrupted && options_.interrupted());
  }
  bool output(const State& both) override {
    take(both);
    emitted_ = both.time;
    output_(first_, second_);
    return true;
  }
  bool after_step(const Stepper& stepper, bool /*outputs*/) override {
    const double t = stepper.state().time;
    return !options_.at_steps || t < emitted_ + (1 - 1e-9) * options_.output || output(stepper.state());
  }
  void renew(Clocks& clocks, State& both) override {
    take(both);
    clocks.renew(first_, renewals_[0]);
    clocks.renew(second_, renewals_[1]);
    pair_.put(first_.y, 0, both.y);
    pair_.put(second_.y, 1, both.y);
  }
  std::string failure(const Clocks& clocks, const State& /*both*/) override {
    const std::string first = clocks.failure(first_);
    return first.empty() ? clocks.failure(second_) : first;
  }
  [[nodiscard]] double emitted() const { return emitted_; }

 private:
  void take(const State& both) {
    first_.time = second_.time = both.time;
    pair_.take(both.y, 0, first_.y);
    pair_.take(both.y, 1, second_.y);
  }

  const PairedEquations& pair_;
  std::array<Renewal, 2> renewals_;
  const PairedRunOptions& options_;
  const std::function<void(const State&, const State&)>& output_;
  State first_, second_;
  double emitted_;  ///< time of the last output
};

}  // namespace

PairedTolerances paired_tolerances(const RunSummary& summary) {
  PairedTolerances t;
  for (const auto& [body, d] : summary.peak_deflection) {
    const double size = std::hypot(d[0], d[1], d[2]);
    if (size > 0) t.atol = std::min(t.atol, 1e-3 * size);
  }
  t.atol = std::max(t.atol, 1e-10);
  return t;
}

PairedRun run_paired(const Model& model, const EquationsOfMotion& first, const EquationsOfMotion& second,
                     const Integrator& integrator, const State& initial, const PairedRunOptions& options,
                     const std::function<void(const State&, const State&)>& output) {
  if (has_switches(model)) throw std::invalid_argument("loads with switching functions have no common steps");
  const double began = thread_cpu_seconds();
  const PairedEquations pair(first, second);
  State both{initial.time, std::vector<double>(pair.size())};
  pair.put(begun(model, first, initial).y, 0, both.y);
  pair.put(begun(model, second, initial).y, 1, both.y);
  PairObserver observer(pair, {Renewal(model, first), Renewal(model, second)}, options, initial, output);
  const double never = 2 * (std::abs(initial.time) + std::abs(options.end)) + 1;
  Stepping loop(model, pair, start_stepper(integrator, pair, both),
                {options.end, options.at_steps ? never : options.output});
  observer.output(both);
  loop.run(observer);
  if (loop.state().time > observer.emitted()) observer.output(loop.state());
  return {loop.state().time, loop.stepper().statistics().evaluations, thread_cpu_seconds() - began};
}

}  // namespace withy
