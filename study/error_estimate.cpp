#include "withy/study/error_estimate.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "withy/core/simulation/paired_run.hpp"

namespace withy::study {
namespace {

constexpr std::size_t states_kept = 12;

/// Energy and momenta of the states given, against those of the first.
class DriftWatch {
 public:
  explicit DriftWatch(const RunSummary& summary) : summary_(summary) {}
  void look(const Energies& e, double work) {
    if (!first_) first_ = e, first_work_ = work;
    const auto raise = [](double& drift, double error, double scale) {
      if (scale > 0) drift = std::max(drift, error / scale);
    };
    const auto apart = [](const std::array<double, 3>& a, const std::array<double, 3>& b) {
      return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
    };
    const double gained = e.kinetic + e.potential - first_->kinetic - first_->potential;
    raise(drifts_.energy, std::abs(gained - (work - first_work_)), summary_.energy_scale);
    raise(drifts_.linear, apart(e.linear_momentum, first_->linear_momentum), summary_.momentum.linear_scale);
    raise(drifts_.angular, apart(e.angular_momentum, first_->angular_momentum), summary_.momentum.angular_scale);
  }
  [[nodiscard]] const Drifts& drifts() const { return drifts_; }

 private:
  const RunSummary& summary_;
  std::optional<Energies> first_;
  double first_work_ = 0;
  Drifts drifts_;
};

}  // namespace

ErrorEstimate estimate_error(const Scene& scene, const EquationsOfMotion& used, const Beyond& beyond,
                             const RunSummary& summary, Registry& registry, const std::function<bool()>& interrupted) {
  const PairedTolerances coarse = paired_tolerances(summary);
  const auto integrator =
      make_integrator(registry, "dopri5", Value::map({{"rtol", Value(coarse.rtol)}, {"atol", Value(coarse.atol)}}));
  PairedRunOptions options;
  options.end = summary.final.time;
  options.output = scene.output;
  options.most_evaluations = summary.steps.evaluations;
  options.interrupted = interrupted;
  const Outputs outputs = Outputs::all(*scene.model);
  OutputReader ours(outputs, *scene.model, used), theirs(outputs, *beyond.model, *beyond.equations);
  Distances greatest = outputs.none();
  DriftWatch watch(summary);
  std::vector<State> along;
  const double apart = (options.end - scene.initial.time) / states_kept;
  const PairedRun run = run_paired(*scene.model, used, *beyond.equations, *integrator, scene.initial, options,
                                   [&](const State& a, const State& b) {
                                     outputs.raise(ours.read(a), theirs.read(b), greatest);
                                     watch.look(ours.energies(), a.y.back());
                                     if (along.empty() || a.time >= along.back().time + apart) along.push_back(a);
                                   });
  return {beyond.formulation, named(outputs, greatest, run.until), summary.final.time, run.cpu_seconds, watch.drifts(),
          std::move(along)};
}

}  // namespace withy::study
