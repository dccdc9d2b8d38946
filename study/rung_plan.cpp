#include "withy/study/rung_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <numeric>

#include "withy/core/simulation/instants.hpp"
#include "withy/core/simulation/run_times.hpp"
#include "withy/study/accuracy.hpp"
#include "withy/study/coarse_run.hpp"
#include "withy/study/input_error.hpp"
#include "withy/study/reference_track.hpp"
#include "withy/study/third_order.hpp"

namespace withy::study {
namespace {

/// Of what is allowed; the rest is for what the estimate and the integrator are off by.
constexpr double usable = 0.9;
/// What a window may leave of it: shares by time, and where errors grew beyond them later, smaller ones.
constexpr std::array<double, 2> theta = {usable, 0.2};
/// A lower rung is tried where no more than this part of the share is used up.
constexpr double hardly_used = 0.5;

/// The composite run: it changes its rung, and goes back.
class Planner {
 public:
  Planner(const Prepared& prepared, Registry& registry, const Outputs& outputs, const ReferenceTrack& reference,
          double accuracy, const Control& control, RungPlan& plan)
      : prepared_(prepared),
        outputs_(outputs),
        reference_(reference),
        control_(control),
        plan_(plan),
        integrator_(make_integrator(registry, reference.integrator, std::min(looser * reference.tolerance, 1.0))),
        allowed_(usable - std::min(reference.third_order / accuracy, 0.5)) {
    plan_.scales = scales(outputs, reference.ranges, reference.energy);
    limits_ = Accuracy{accuracy, {}, {}}.limits(outputs, plan_.scales);
    marks_.push_back({reference.start, outputs.none(), 0, true});
  }

  /// The whole way in the least rung, as it went beside the reference. False where it does not hold the accuracy.
  bool least_holds() {
    if (reference_.beside.size() != reference_.windows.size() || reference_.windows.empty()) return false;
    for (std::size_t k = 0; k < reference_.windows.size(); ++k) {
      Distances errors = marks_.back().errors;
      const auto& a = reference_.beside[k].readings;
      for (std::size_t i = 0; i < a.size(); ++i)
        if (!a[i].empty()) outputs_.raise(a[i], reference_.windows[k].readings[i], errors);
      if (use(errors) > allowed_) return false;
      marks_.push_back({reference_.beside[k].end, errors, 0, false});
    }
    make_stretches();
    return true;
  }

  void run() {
    while (window() < reference_.windows.size() && !control_.stop()) {
      if (one_window()) continue;
      if (strictness_ == 0 && rung_ + 1 < top()) {
        start_over(rung_ + 1);
      } else {
        go_back();
      }
    }
    make_stretches();
  }
  [[nodiscard]] const Distances& errors() const { return marks_.back().errors; }
  [[nodiscard]] double use(const Distances& errors) const {
    double most = 0;
    for (std::size_t i = 0; i < errors.size(); ++i) most = std::max(most, errors[i] / limits_[i]);
    return most;
  }
  [[nodiscard]] std::string worst() const {
    std::size_t most = 0;
    for (std::size_t i = 1; i < limits_.size(); ++i)
      if (errors()[i] / limits_[i] > errors()[most] / limits_[most]) most = i;
    return outputs_.list()[most].label;
  }

 private:
  /// The composite run where a window begins.
  struct Mark {
    State state;
    Distances errors;    ///< greatest so far
    std::size_t rung;    ///< of the window before
    bool exact = false;  ///< no other rung than the reference's so far: the states are the same
  };

  [[nodiscard]] std::size_t window() const { return marks_.size() - 1; }
  [[nodiscard]] std::size_t top() const { return reference_.rung; }
  /// Greatest use at the end of a window that is kept.
  [[nodiscard]] double share(std::size_t window) const {
    if (strictness_ == 0) return allowed_;
    const auto n = static_cast<double>(reference_.windows.size());
    const double part = strictness_ <= theta.size() ? theta.at(strictness_ - 1) / usable : 0;
    return allowed_ * part * static_cast<double>(window + 1) / n;
  }

  /// Advances by one window in the least rung that keeps its share. False where earlier errors have grown too far.
  bool one_window() {
    if (lower_is_due() && attempt(lower(), hardly_used * share(window()))) {
      rung_ = marks_.back().rung;
      return true;
    }
    for (; rung_ < top(); ++rung_) {
      if (attempt(rung_, share(window()))) return true;
      if (strictness_ == 0) return false;
    }
    if (marks_.back().exact) {
      marks_.push_back({reference_.windows[window()].end, outputs_.none(), top(), true});
      return true;
    }
    return attempt(top(), allowed_);
  }

  [[nodiscard]] bool lower_is_due() {
    return strictness_ > 0 && strictness_ <= theta.size() && rung_ > 0 && window() >= next_lower_ &&
           use(marks_.back().errors) <= hardly_used * share(window());
  }
  /// The least rung, or the next lower one: in turns. Where it fails, longer is waited each time.
  std::size_t lower() {
    next_lower_ = window() + wait_;
    wait_ *= 2;
    least_next_ = !least_next_;
    return least_next_ ? 0 : rung_ - 1;
  }

  /// Runs the next window in a rung; kept where no output of it is beyond the share.
  bool attempt(std::size_t rung, double share) {
    const Mark& from = marks_.back();
    if (run_ == nullptr || run_rung_ != rung) begin(rung, from.state);
    const std::size_t before = run_->evaluations();
    Distances errors = from.errors;
    const WindowTrack& track = reference_.windows[window()];
    bool good = true;
    for (std::size_t i = 0; good && i < track.times.size(); ++i) {
      // A model that needs a hundred times the evaluations is not one to go on with.
      good = run_->to(track.times[i], control_, before + most_evaluations(track));
      if (!good || track.readings[i].empty()) continue;
      outputs_.raise(run_->read(), track.readings[i], errors);
      good = use(errors) <= share;
    }
    run_->charge(plan_.evaluations);
    if (good) {
      marks_.push_back({run_->state(), errors, rung, false});
    } else {
      ++plan_.repeated;
      run_.reset();
    }
    return good;
  }
  void begin(std::size_t rung, const State& state) {
    run_ = std::make_unique<CoarseRun>(prepared_, rung == top() ? reference_.low : rung, rung, outputs_, *integrator_,
                                       state, reference_.end);
    run_rung_ = rung;
  }

  /// From the beginning in one rung throughout: where that holds the accuracy, no mix need be sought.
  void start_over(std::size_t rung) {
    marks_.resize(1);
    rung_ = rung;
    run_.reset();
  }

  /// To the last mark that keeps the next stricter shares, and one rung up from what was made there.
  void go_back() {
    ++strictness_;
    const auto kept = [&](const Mark& m) {
      return strictness_ > theta.size() ? m.exact : use(m.errors) <= share(window() - 1);
    };
    while (marks_.size() > 1 && !kept(marks_.back())) marks_.pop_back();
    rung_ = strictness_ == 1 ? std::min<std::size_t>(1, top()) : top();
    next_lower_ = window() + 2;
    run_.reset();
  }

  void make_stretches() {
    for (std::size_t k = 1; k < marks_.size(); ++k) {
      const WindowTrack& track = reference_.windows[k - 1];
      const double start = k == 1 ? reference_.start.time : reference_.windows[k - 2].times.back();
      if (plan_.stretches.empty() || plan_.stretches.back().stretch.rung != marks_[k].rung)
        plan_.stretches.push_back({{marks_[k].rung, start, start}, 0});
      plan_.stretches.back().stretch.end = track.times.back();
      plan_.stretches.back().use = use(marks_[k].errors);
    }
  }

  const Prepared& prepared_;
  const Outputs& outputs_;
  const ReferenceTrack& reference_;
  const Control& control_;
  RungPlan& plan_;
  std::shared_ptr<const Integrator> integrator_;
  double allowed_;
  Distances limits_;
  std::vector<Mark> marks_;
  std::unique_ptr<CoarseRun> run_;  ///< at the last mark; null: to be begun
  std::size_t run_rung_ = 0, rung_ = 0;
  std::size_t strictness_ = 0;  ///< 0: all that is allowed at any time
  std::size_t next_lower_ = 0, wait_ = 2;
  bool least_next_ = false;
};

/// What is left of the run stays in the highest rung.
void fill_up(RungPlan& plan, std::size_t rung, double start, double end) {
  const double from = plan.stretches.empty() ? start : plan.stretches.back().stretch.end;
  if (!plan.stretches.empty() && (from >= end || plan.stretches.back().stretch.rung == rung)) {
    plan.stretches.back().stretch.end = end;
    return;
  }
  plan.stretches.push_back({{rung, from, end}, 0});
}

void judge(RungPlan& plan, const ReferenceTrack& reference, const Prepared& prepared) {
  const auto add = [&](const std::string& sentence) { plan.problem += (plan.problem.empty() ? "" : " ") + sentence; };
  const std::string& highest = prepared.rungs[reference.rung].name;
  if (!reference.problem.empty())
    add(fmt::format("The coarse run in {} ended at t = {:.4g} s: {}. The error beyond is not known.", highest,
                    plan.estimate->distances.until, reference.problem));
  if (reference.third_order > plan.accuracy) {
    std::string bend = bend_text(reference.bend);
    bend.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(bend.front())));
    add(
        fmt::format("{} are beyond what {} is good for: over a run that may come to {:.2g} % of the range of "
                    "deflections, and no kinematics is offered that is better.",
                    bend, highest, 100 * reference.third_order));
  } else if (plan.use > 1)
    add(fmt::format("The accuracy asked is not held: '{}' is off by {:.2g} times as much.", plan.worst, plan.use));
}

}  // namespace

double asked_accuracy(const Scene& scene) { return scene.source.at("formulation").number_at("accuracy"); }

RungPlan plan_rungs(const Prepared& prepared, Registry& registry, double accuracy, const Control& control) {
  RungPlan plan;
  plan.accuracy = accuracy;
  plan.evaluations.assign(prepared.rungs.size(), 0);
  const Scene& scene = prepared.scene;
  const double start = scene.initial.time, end = end_of_run(scene);
  if (prepared.rungs.size() == 1 || !flexible(prepared.model()) || !(end > start)) {
    fill_up(plan, 0, start, end);
    return plan;
  }
  const double began = thread_cpu_seconds();
  const Outputs outputs(prepared.model());
  ReferenceTracker tracker(prepared, registry, outputs, accuracy, control, plan.evaluations);
  ReferenceTrack reference = tracker.beside_least();
  auto planner = std::make_unique<Planner>(prepared, registry, outputs, reference, accuracy, control, plan);
  if (!planner->least_holds()) {
    reference = tracker.highest();
    planner = std::make_unique<Planner>(prepared, registry, outputs, reference, accuracy, control, plan);
    planner->run();
  }
  plan.integrator = reference.integrator;
  plan.windows = reference.windows.size();
  // What no rung has is part of what the run may be off by.
  plan.use = planner->use(planner->errors()) + reference.third_order / accuracy;
  plan.worst = planner->worst();
  // Of less nothing is left even where phases run apart by a thousand times as much.
  constexpr double worth_a_word = 1e-4;
  if (reference.rung + 1 < prepared.rungs.size() && reference.third_order > worth_a_word * accuracy) {
    plan.above = prepared.rungs.back().name;
    plan.above_share = reference.third_order;
  }
  const double until = plan.stretches.empty() ? start : plan.stretches.back().stretch.end;
  plan.estimate = {prepared.rungs[reference.rung].name, named(outputs, planner->errors(), until), end,
                   std::accumulate(plan.evaluations.begin(), plan.evaluations.end(), std::size_t{0}),
                   thread_cpu_seconds() - began};
  for (const WindowTrack& w : reference.windows) plan.readings.push_back({w.times.back(), w.readings.back()});
  fill_up(plan, reference.rung, start, end);
  plan.throughout = plan.stretches.size() == 1 && plan.stretches.front().stretch.rung == reference.rung;
  if (plan.throughout) plan.worst.clear();
  judge(plan, reference, prepared);
  return plan;
}

}  // namespace withy::study
