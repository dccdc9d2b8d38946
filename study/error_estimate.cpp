#include "withy/study/error_estimate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "withy/core/simulation/coarse_steps.hpp"
#include "withy/core/simulation/instants.hpp"
#include "withy/core/simulation/mass_centre.hpp"
#include "withy/core/simulation/paired_run.hpp"
#include "withy/core/simulation/run_times.hpp"
#include "withy/study/accuracy.hpp"
#include "withy/study/coarse_track.hpp"
#include "withy/study/correction_along.hpp"
#include "withy/study/output_reader.hpp"
#include "withy/study/sensitive_motion.hpp"

namespace withy::study {
namespace {

/// Energy and momenta of the states given, against those of the first.
class DriftWatch {
 public:
  /// \param equations whose energies it is given
  DriftWatch(const RunSummary& summary, const Model& model, const EquationsOfMotion& equations, const State& initial)
      : summary_(summary) {
    if (summary.momentum.conserved) centre_.emplace(model, equations, initial.y);
  }
  /// \param work since the first
  void look(const State& state, const Energies& e, double work) {
    if (looks_ == 0) first_ = e, first_work_ = work;
    const double gained = e.kinetic + e.potential - first_.kinetic - first_.potential;
    raise(drifts_.energy, std::abs(gained - (work - first_work_)), summary_.energy_scale);
    if (centre_) look_at_momenta(state, e);
    ++looks_;
  }
  /// The drifts up to the last state.
  [[nodiscard]] const Drifts& drifts() {
    if (left_) raise_angular(left_->state, left_->energies);
    left_.reset();
    return drifts_;
  }

 private:
  struct Seen {
    State state;
    Energies energies;
  };
  static void raise(double& drift, double error, double scale) {
    if (scale > 0) drift = std::max(drift, error / scale);
  }
  void look_at_momenta(const State& state, const Energies& e) {
    // The mass centre costs as much as three readings.
    constexpr std::size_t every = 8;
    raise(drifts_.linear, (vector(e.linear_momentum) - vector(first_.linear_momentum)).norm(),
          summary_.momentum.linear_scale);
    if (looks_ % every == 0) {
      raise_angular(state, e);
      left_.reset();
    } else {
      left_ = Seen{state, e};
    }
  }
  void raise_angular(const State& state, const Energies& e) {
    const Vector3 angular = spin(e, centre_->at(state.y).position);
    if (looks_ == 0) first_angular_ = angular;
    raise(drifts_.angular, (angular - first_angular_).norm(), summary_.momentum.angular_scale);
  }

  const RunSummary& summary_;
  std::optional<MassCentre> centre_;  ///< nothing where momenta are not conserved
  std::size_t looks_ = 0;
  Energies first_;
  double first_work_ = 0;
  Vector3 first_angular_ = Vector3::Zero();  ///< about the mass centre
  std::optional<Seen> left_;                 ///< the last state, where it was not looked at about its mass centre
  Drifts drifts_;
};

/// Of the cost of a run, for coarse steps; what else an estimate needs makes it a tenth.
constexpr double share_of_run = 0.09;
/// Fewer are not worth counting: a fifth of a millisecond, what it takes to read a scene many times over.
constexpr std::size_t least_evaluations = 200;
constexpr double least_readings = 60, most_readings = 500;
/// Part of an output's range below which what two coarse runs differ by is mostly the difference of their own errors:
/// of 600 claims on random scenes those that were more than three times the truth were all below.
constexpr double resolved = 0.005;
/// Nor is anything told by what differs by less than this many times what the coarse run is off the run itself, at its
/// end or before: a run that leaves another may come back to it. A claim 62 times the truth was at 1.3, where the end
/// alone said 3.3; on random scenes (seeds 21 to 80) as many are told as by twice what it is off at its end.
constexpr double beyond_its_own = 1.5;
/// The other model of a pair has no run to be held against, but nothing is truncated in it: what its energy and momenta
/// are off by is of its coarse steps. Where that is more than this many times what ours are off by, and than this part
/// of their scale, those steps are not good for it: a stiff stop, or mass that moves with the deformation, may throw
/// it.
constexpr double more_unbalanced = 2, balanced = 0.01;
/// Each so many of the states that the run has kept are looked at: two readings each, of the price of an estimate.
constexpr std::size_t look_every = 4;

/// Two models compared along one coarse run.
class PairedRuns {
 public:
  PairedRuns(const Scene& scene, const EquationsOfMotion& used, const Beyond& beyond, const RunSummary& summary,
             const std::function<bool()>& interrupted)
      : scene_(scene),
        used_(used),
        beyond_(beyond),
        summary_(summary),
        outputs_(Outputs::all(*scene.model)),
        first_(&used),
        track_(used) {
    options_.end = summary.final.time;
    options_.interrupted = interrupted;
  }
  PairedRunOptions& options() { return options_; }
  /// In the place of the equations used these, whose solution is the run too.
  void replace_used(const EquationsOfMotion& by) { first_ = &by; }

  ErrorEstimate with(const Integrator& integrator) {
    OutputReader ours(outputs_, *scene_.model, used_), theirs(outputs_, *beyond_.model, *beyond_.equations);
    Distances& greatest = greatest_ = outputs_.none();
    ranges_ = outputs_.none();
    energy_ = 0;
    track_.clear();
    DriftWatch watch(summary_, *scene_.model, used_, scene_.initial),
        watch_theirs(summary_, *beyond_.model, *beyond_.equations, scene_.initial);
    std::vector<double> first;
    const PairedRun run = run_paired(*scene_.model, *first_, *beyond_.equations, integrator, scene_.initial, options_,
                                     [&](const State& a, const State& b) {
                                       track_.keep(a);
                                       last_ = ours.read(a);
                                       outputs_.raise(last_, theirs.read(b), greatest);
                                       watch.look(a, ours.energies(), a.y.back());
                                       watch_theirs.look(b, theirs.energies(), b.y.back());
                                       if (first.empty()) first = last_;
                                       outputs_.raise_ranges(last_, first, ranges_);
                                       energy_ = std::max(energy_, ours.kinetic_energy());
                                     });
    // The work of both is known of coarse steps alone; the others hold errors of steps within tolerances.
    const bool known = dynamic_cast<const CoarseSteps*>(&integrator) != nullptr;
    const double of_theirs = unbalanced(watch_theirs.drifts()), of_ours = unbalanced(watch.drifts());
    unbalanced_ = known && of_theirs > more_unbalanced * of_ours + balanced ? of_theirs : 0;
    return {beyond_.formulation,
            named(outputs_, greatest, run.until),
            summary_.final.time,
            run.evaluations,
            run.cpu_seconds,
            watch.drifts(),
            {},
            0};
  }
  /// How far the run of our equations has ended from the run itself, as a part of an output's range.
  [[nodiscard]] double apart_at_the_end() const {
    OutputReader reader(outputs_, *scene_.model, used_);
    Distances apart = outputs_.none();
    outputs_.raise(last_, reader.read(summary_.final), apart);
    return relative_error(apart, scales(outputs_, ranges_, energy_));
  }
  /// Whether the coarse run has come to where the run came, if it came to the end of its time at all. Notes what it is
  /// too coarse to tell.
  [[nodiscard]] bool comes_to_the_end(ErrorEstimate& estimate) {
    if (estimate.distances.until < estimate.end || unbalanced_ > another_motion) return false;
    const double began = thread_cpu_seconds();
    const Off off = off_the_run();
    const Distances sizes = scales(outputs_, ranges_, energy_);
    estimate.off = relative_error(off.greatest, sizes);
    estimate.cpu_seconds += thread_cpu_seconds() - began;
    note_bounds(estimate, sizes, off);
    estimate.distances = named(outputs_, greatest_, estimate.distances.until);
    return relative_error(off.at_end, sizes) < another_motion;
  }

 private:
  /// How far the coarse run is from the run, of each output.
  struct Off {
    Distances at_end;
    Distances greatest;  ///< there and wherever else it is looked at
    Distances mean;      ///< root of the mean square wherever it is looked at before the end
  };
  /// The greatest part of its scale that the energy, or where they are conserved a momentum, is off by.
  [[nodiscard]] double unbalanced(const Drifts& drifts) const {
    return std::max(drifts.energy, summary_.momentum.conserved ? std::max(drifts.linear, drifts.angular) : 0.0);
  }
  /// Outputs of which the coarse runs tell no more than a bound, and the bounds.
  void note_bounds(ErrorEstimate& estimate, const Distances& sizes, const Off& off) {
    std::set<std::string> told;
    for (std::size_t i = 0; i < sizes.size(); ++i) {
      const bool tells =
          greatest_[i] >= std::max({resolved * sizes[i], beyond_its_own * off.greatest[i], unbalanced_ * sizes[i]});
      if (tells) told.insert(outputs_.list()[i].name);
      if (!tells && greatest_[i] > 0) estimate.at_most.insert(outputs_.list()[i].name);
    }
    for (const std::string& name : told) estimate.at_most.erase(name);
    // Coarse steps damp vibrations in both models, and what these differ by beside what is seen: by no more than the
    // run still has of them, and where the difference is no small part of a range, than what it had. At one instant, as
    // the end is, a vibration may pass through nothing. Of the two each has its own phase.
    for (std::size_t i = 0; i < sizes.size(); ++i) {
      const double unseen =
          greatest_[i] >= resolved * sizes[i] ? off.greatest[i] : std::max(off.at_end[i], off.mean[i]);
      if (estimate.at_most.count(outputs_.list()[i].name) > 0) greatest_[i] = std::hypot(greatest_[i], unseen);
    }
  }

  [[nodiscard]] Off off_the_run() const {
    OutputReader reader(outputs_, *scene_.model, used_);
    Off off{outputs_.none(), {}, outputs_.none()};
    outputs_.raise(last_, reader.read(summary_.final), off.at_end);
    off.greatest = off.at_end;
    const std::vector<State>& states = summary_.validity.along;
    double looks = 0;
    for (std::size_t i = look_every; i < states.size(); i += look_every) {
      const std::optional<State> there = track_.at(states[i].time);
      if (!there) continue;
      Distances apart = outputs_.none();
      outputs_.raise(reader.read(*there), reader.read(states[i]), apart);
      for (std::size_t k = 0; k < apart.size(); ++k) {
        off.greatest[k] = std::max(off.greatest[k], apart[k]);
        off.mean[k] += apart[k] * apart[k];
      }
      ++looks;
    }
    for (double& square : off.mean) square = looks > 0 ? std::sqrt(square / looks) : 0;
    return off;
  }

  const Scene& scene_;
  const EquationsOfMotion& used_;
  const Beyond& beyond_;
  const RunSummary& summary_;
  Outputs outputs_;
  PairedRunOptions options_;
  const EquationsOfMotion* first_;
  CoarseTrack track_;
  std::vector<double> last_;  ///< reading of our equations
  Distances ranges_, greatest_;
  double energy_ = 0;
  double unbalanced_ = 0;  ///< of the other model, beyond what ours is
};

/// What an evaluation of both models costs in evaluations of a run with all that goes with them. Measured in ruthless
/// against quadratic: 2.5 (arms of 2 modes a link), 3.2 (screw), 3.7 (beam-on-base), 5.1 (spacecraft), 8 (spin-up);
/// what makes the difference is the pairs of modes of which second-order kinematics has terms.
double cost_of_a_pair(const Model& model) {
  double pairs = 0;
  for (const BodyNode& body : model.bodies()) pairs += std::pow(body.body->shape().modes(), 2);
  return 2.2 + 1.1 * pairs / static_cast<double>(std::max<std::size_t>(model.layout().speeds, 1));
}

/// At every so many of these states that they make no more than `most` steps; where there are fewer states, each
/// stretch in equal parts.
std::vector<double> step_ends(std::span<const State> states, double most) {
  std::vector<double> ends;
  const double stretches = static_cast<double>(states.size() - 1);
  const auto every = static_cast<std::size_t>(std::max(1.0, std::ceil(stretches / most)));
  const auto parts = static_cast<std::size_t>(std::max(1.0, std::floor(most / stretches)));
  for (std::size_t i = every; i < states.size(); i += every)
    for (std::size_t part = 1; part <= parts; ++part)
      ends.push_back(
          std::lerp(states[i - every].time, states[i].time, static_cast<double>(part) / static_cast<double>(parts)));
  return ends;
}

/// Strict formulations fold no stiffness into their mass matrix: coarse steps are those of the model beyond, with what
/// the accelerations of the strict one were found to differ by along the run. \returns nothing where they come to
/// another end.
std::optional<ErrorEstimate> of_strict(const Scene& scene, const EquationsOfMotion& used, const Beyond& beyond,
                                       const RunSummary& summary, const std::function<bool()>& interrupted) {
  const std::vector<State>& states = summary.validity.closely;
  if (states.size() < 2) return {};
  // Two evaluations of both, a sample and what is read there, in evaluations of the run: measured, 6 (arms) to 10 (a
  // blade of six modes).
  const double of_a_step = 3.2 + 0.85 * cost_of_a_pair(*scene.model);
  const double steps = std::max(share_of_run * static_cast<double>(summary.steps.evaluations) / of_a_step,
                                static_cast<double>(least_evaluations) / 2);
  const CorrectionAlong corrected(*beyond.equations, used, states);
  PairedRuns pair(scene, used, beyond, summary, interrupted);
  pair.replace_used(corrected);
  pair.options().at_steps = true;
  pair.options().output = 0;
  pair.options().most_evaluations = static_cast<std::size_t>(2.5 * steps);  // steps land on discontinuities too
  ErrorEstimate estimate = pair.with(CoarseSteps(step_ends(states, steps)));
  if (!pair.comes_to_the_end(estimate)) return {};
  return estimate;
}

/// Evaluations of a pair at any price for one of the run where steps are implicit: derivatives of both are found by
/// differences there, of which the integrator of the run may need none.
constexpr std::size_t most_implicit = 30;

/// An estimate that was made after another one which did not do.
ErrorEstimate with_costs_of(const ErrorEstimate& before, ErrorEstimate estimate) {
  estimate.evaluations += before.evaluations;
  estimate.cpu_seconds += before.cpu_seconds;
  return estimate;
}

/// \param span time that the run took [s]: what a scene writes to its results is its own affair
EstimateOutcome at_any_price(PairedRuns& pair, double span, const RunSummary& summary, Registry& registry) {
  PairedTolerances t = paired_tolerances(summary);
  pair.options().at_steps = true;
  pair.options().output = span / most_readings;
  pair.options().most_evaluations = summary.steps.evaluations;
  const char* steps = "dopri5";
  const auto compared = [&] {
    return pair.with(*make_integrator(registry, steps, Value::map({{"rtol", Value(t.rtol)}, {"atol", Value(t.atol)}})));
  };
  ErrorEstimate estimate = compared();
  if (summary.status == RunStatus::completed && estimate.distances.until < estimate.end) {
    // What is stiff for it need not be for the integrator of the run.
    steps = "radau";
    pair.options().most_evaluations = most_implicit * summary.steps.evaluations;
    estimate = with_costs_of(estimate, compared());
  }
  if (summary.status != RunStatus::completed && estimate.distances.until < estimate.end)
    return {{},
            "not estimated: the motion of this run breaks down at its end, and coarse runs break down before it, at "
            "another time"};
  const double first = pair.apart_at_the_end();
  if (estimate.distances.until < estimate.end || first < another_motion) return {std::move(estimate), {}};
  // What a motion does that is only long comes nearer by as much as the tolerances go down; a sensitive one does not.
  t.rtol *= closer, t.atol *= closer;
  pair.options().most_evaluations *= most_closer;
  estimate = with_costs_of(estimate, compared());
  // What steps are left for is no answer: the run at the looser tolerances stands, which ended elsewhere.
  const bool came = estimate.distances.until >= estimate.end;
  const double apart = came ? pair.apart_at_the_end() : first;
  if (!(apart < another_motion)) return {{}, sensitive_text(apart, came ? t.rtol : t.rtol / closer)};
  return {std::move(estimate), {}};
}

/// By what a tenth of the cost of the run pays for.
EstimateOutcome affordable(PairedRuns& pair, const Scene& scene, const EquationsOfMotion& used, const Beyond& beyond,
                           const RunSummary& summary, Registry& registry, const std::function<bool()>& interrupted) {
  const double span = summary.final.time - scene.initial.time;
  const double paid = share_of_run * static_cast<double>(summary.steps.evaluations) / cost_of_a_pair(*scene.model);
  const auto allowed = std::max(static_cast<std::size_t>(paid), least_evaluations);
  PairedRunOptions& options = pair.options();
  options.at_steps = true;
  options.output = span / std::clamp(static_cast<double>(allowed) / 3, least_readings, most_readings);
  if (used.linearly_implicit() != nullptr && beyond.equations->linearly_implicit() != nullptr) {
    options.most_evaluations = allowed + allowed / 4;  // steps land on discontinuities too
    ErrorEstimate estimate = pair.with(CoarseSteps(2 * span / static_cast<double>(allowed)));
    if (pair.comes_to_the_end(estimate)) return {std::move(estimate), {}};
  }
  if (used.linearly_implicit() == nullptr && beyond.equations->linearly_implicit() != nullptr &&
      beyond.model == scene.model)
    if (auto estimate = of_strict(scene, used, beyond, summary, interrupted)) return {std::move(estimate), {}};
  // Where loads are stiff.
  options.most_evaluations = allowed / 3;
  const PairedTolerances t = paired_tolerances(summary);
  ErrorEstimate estimate = pair.with(
      *make_integrator(registry, "radau", Value::map({{"rtol", Value(10 * t.rtol)}, {"atol", Value(10 * t.atol)}})));
  if (pair.comes_to_the_end(estimate)) return {std::move(estimate), {}};
  return {{},
          "not estimated: what a tenth of the cost of this run pays for does not follow its motion; `--estimate "
          "always` compares with " +
              beyond.formulation + " at any cost"};
}

}  // namespace

EstimateOutcome estimate_error(const Scene& scene, const EquationsOfMotion& used, const Beyond& beyond,
                               const RunSummary& summary, Registry& registry, Price price,
                               const std::function<bool()>& interrupted) {
  PairedRuns pair(scene, used, beyond, summary, interrupted);
  EstimateOutcome found;
  if (price == Price::any) {
    found = at_any_price(pair, summary.final.time - scene.initial.time, summary, registry);
    if (!found.estimate || found.estimate->distances.until >= found.estimate->end || (interrupted && interrupted()))
      return found;
  }
  EstimateOutcome other = affordable(pair, scene, used, beyond, summary, registry, interrupted);
  if (!found.estimate) return other;
  // It has come to a part of the run alone.
  if (other.estimate) return {with_costs_of(*found.estimate, std::move(*other.estimate)), {}};
  return found;
}

}  // namespace withy::study
