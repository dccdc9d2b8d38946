#include "withy/core/simulation/paired_run.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>

#include "withy/core/simulation/instants.hpp"
#include "withy/core/simulation/run_times.hpp"

namespace withy {
namespace {

/// Both equations as one system for a stepper, of one thread: y holds the positions of both, the
/// speeds of both, the discrete states of both, then the work of both together.
class PairedEquations final : public EquationsOfMotion {
 public:
  PairedEquations(const EquationsOfMotion& first, const EquationsOfMotion& second)
      : halves_{Half(first), Half(second)},
        positions_(first.layout().positions),
        speeds_(first.layout().speeds),
        discrete_(first.layout().discrete) {
    layout_.positions = 2 * positions_;
    layout_.speeds = 2 * speeds_;
    layout_.discrete = 2 * discrete_;
  }
  const Layout& layout() const override { return layout_; }
  Work make_work() const override { return Work(0); }
  Evaluation derivatives(double t, std::span<const double> y, std::span<double> y_dot, Work&) const noexcept override {
    y_dot.back() = 0;
    for (std::size_t i = 0; i < 2; ++i) {
      Half& half = halves_[i];
      take(y, i, half.y);
      const Evaluation e = half.equations->derivatives(t, half.y, half.y_dot, half.work);
      if (!e.ok()) return e;
      put(half.y_dot, i, y_dot);
      y_dot.back() += half.y_dot.back();
    }
    return {};
  }
  void normalize(std::span<double> y) const noexcept override {
    for (std::size_t i = 0; i < 2; ++i) {
      take(y, i, halves_[i].y);
      halves_[i].equations->normalize(halves_[i].y);
      put(halves_[i].y, i, y);
    }
  }
  /// One of the two states, without its work.
  void take(std::span<const double> y, std::size_t i, std::span<double> own) const noexcept {
    for (const Part& part : parts())
      std::copy_n(y.data() + 2 * part.first + i * part.count, part.count, own.data() + part.first);
    own.back() = 0;
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
  // Reports ask for these, steppers do not.
  void load_efforts(double, std::span<const double>, int, std::span<double>, Work&) const noexcept override {}
  Evaluation motion_efforts(double, std::span<const double>, std::span<double>, Work&) const noexcept override {
    return {Evaluation::Outcome::singular};
  }
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
  [[nodiscard]] std::array<Part, 3> parts() const noexcept {
    return {{{0, positions_}, {positions_, speeds_}, {positions_ + speeds_, discrete_}}};
  }
  struct Half {
    explicit Half(const EquationsOfMotion& e) : equations(&e), work(e.make_work()), y(e.size()), y_dot(e.size()) {}
    const EquationsOfMotion* equations;
    Work work;
    std::vector<double> y, y_dot;
  };
  [[noreturn]] static void refuse() { throw std::logic_error("two models in one have no dynamics but their own"); }

  mutable std::array<Half, 2> halves_;
  std::size_t positions_, speeds_, discrete_;
  Layout layout_;
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
  Clocks clocks(model);
  State one = initial;
  clocks.begin(one);
  State other = one;
  pair.put(one.y, 0, both.y);
  pair.put(one.y, 1, both.y);
  const auto emit = [&](const State& s) {
    one.time = other.time = s.time;
    pair.take(s.y, 0, one.y);
    pair.take(s.y, 1, other.y);
    output(one, other);
  };
  const auto stepper = integrator.start(pair, both);
  OutputTimes times(initial.time, options.output, options.end);
  double emitted = initial.time;
  const auto spent = [&] {
    return options.most_evaluations > 0 && stepper->statistics().evaluations >= options.most_evaluations;
  };
  bool stopped = false;
  for (const double landing : landings(model, initial.time, options.end)) {
    while (!stopped && stepper->state().time < landing) {
      stopped = spent() || (options.interrupted && options.interrupted()) ||
                stepper->step(std::min(landing, clocks.next())).outcome != StepResult::Outcome::ok;
      for (; times.due(stepper->state().time); times.pass()) {
        both.time = emitted = times.next();
        stepper->interpolate(both.time, both.y);
        emit(both);
      }
      if (stopped || stepper->state().time < clocks.next()) continue;
      both = stepper->state();
      one.time = other.time = both.time;
      pair.take(both.y, 0, one.y);
      pair.take(both.y, 1, other.y);
      clocks.renew(one);
      clocks.renew(other);
      clocks.go_on_after(both.time);
      pair.put(one.y, 0, both.y);
      pair.put(other.y, 1, both.y);
      stepper->jump(both);
    }
    if (stopped) break;
    stepper->restart();
  }
  if (stepper->state().time > emitted) emit(stepper->state());
  return {stepper->state().time, stepper->statistics().evaluations, thread_cpu_seconds() - began};
}

}  // namespace withy
