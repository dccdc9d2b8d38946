#include "withy/core/simulation/escalation.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "withy/core/simulation/elastic_modes.hpp"
#include "withy/core/simulation/motion_stiffness.hpp"
#include "withy/core/simulation/tips.hpp"
#include "withy/core/simulation/validity_limits.hpp"

namespace withy {
namespace {

/// The greater of two findings of the same body.
void raise(BodyValidity& a, const BodyValidity& b) {
  if (b.rate_ratio > a.rate_ratio) {
    a.rate_ratio = b.rate_ratio;
    a.rate_time = b.rate_time;
  }
  if (b.load.size() > a.load.size()) {
    a.load = b.load;
    a.load_time = b.load_time;
  }
  a.buckling = std::max(a.buckling, b.buckling);
  for (std::size_t i = 0; i < a.highest.size(); ++i)
    a.highest[i].share = std::max(a.highest[i].share, b.highest[i].share);
}

void raise(std::vector<double>& a, const std::vector<double>& b) {
  a.resize(std::max(a.size(), b.size()));
  for (std::size_t i = 0; i < b.size(); ++i) a[i] = std::max(a[i], b[i]);
}

/// The next stretch's summary joins that of the ones before.
void join(RunSummary& all, const RunSummary& next, bool first) {
  if (first) {
    all = next;
    return;
  }
  RunSummary before = std::move(all);
  all = next;
  for (const auto& [name, d] : before.peak_deflection)
    for (std::size_t k = 0; k < 3; ++k) all.peak_deflection[name][k] = std::max(all.peak_deflection[name][k], d[k]);
  for (const auto& [name, ratio] : before.peak_deflection_ratio)
    all.peak_deflection_ratio[name] = std::max(all.peak_deflection_ratio[name], ratio);
  raise(all.peak_effort, before.peak_effort);
  raise(all.peak_motion_effort, before.peak_motion_effort);
  all.energy_drift = std::max(all.energy_drift, before.energy_drift);
  all.untruncated_drift = std::max(all.untruncated_drift, before.untruncated_drift);
  all.momentum.conserved = all.momentum.conserved && before.momentum.conserved;
  all.momentum.linear = std::max(all.momentum.linear, before.momentum.linear);
  all.momentum.angular = std::max(all.momentum.angular, before.momentum.angular);
  all.suspected_jumps.insert(all.suspected_jumps.begin(), before.suspected_jumps.begin(), before.suspected_jumps.end());
  all.events.insert(all.events.begin(), before.events.begin(), before.events.end());
  all.fastest_mode = std::max(all.fastest_mode, before.fastest_mode);
  for (std::size_t b = 0; b < all.validity.bodies.size(); ++b) raise(all.validity.bodies[b], before.validity.bodies[b]);
  all.validity.samples += before.validity.samples;
  all.steps.accepted += before.steps.accepted;
  all.steps.rejected += before.steps.rejected;
  all.steps.evaluations += before.steps.evaluations;
  all.steps.smallest_step = std::min(all.steps.smallest_step, before.steps.smallest_step);
  all.steps.largest_step = std::max(all.steps.largest_step, before.steps.largest_step);
}

double energy(const EquationsOfMotion& equations, const State& state) {
  const auto seen = equations.make_observation();
  seen->observe(state.y);
  const Energies e = seen->energies();
  return e.kinetic + e.potential;
}

}  // namespace

struct LimitWatch::Watched {
  struct Flexible {
    std::size_t body;
    double fundamental;
    bool one_direction;
    MotionStiffness stiffness;
  };
  explicit Watched(const Model& model) : motion(model), places(tips(model)) {
    for (std::size_t b = 0; b < model.bodies().size(); ++b) {
      const ModalShape& shape = model.bodies()[b].body->shape();
      if (shape.modes() == 0) continue;
      const ElasticModes modes = elastic_modes(shape);
      bodies.push_back({b, modes.frequencies.size() > 0 ? modes.frequencies[0] : 0, mode_groups(shape).size() == 1,
                        MotionStiffness(model, b)});
    }
  }
  TreeMotion motion;
  std::vector<Flexible> bodies;
  std::vector<Tip> places;
  // Of the equations that were used last.
  const EquationsOfMotion* equations = nullptr;
  std::vector<double> rates;
  std::optional<Work> work;
  std::unique_ptr<Observation> seen;

  void use(const EquationsOfMotion& used) {
    if (equations == &used) return;
    equations = &used;
    rates.resize(used.size());
    work.emplace(used.make_work());
    seen = used.make_observation();
  }
};

LimitWatch::LimitWatch(const Model& model) : model_(model), watched_(std::make_unique<Watched>(model)) {}
LimitWatch::~LimitWatch() = default;

std::vector<Excess> LimitWatch::excess(const State& state, const Rung& used, const Terms& limits_of) {
  std::vector<Excess> found;
  watched_->use(*used.equations);
  if (!used.equations->derivatives(state.time, state.y, watched_->rates, *watched_->work).ok()) return found;
  const Layout& layout = model_.layout();
  watched_->motion.update(state.y, std::span<const double>(watched_->rates).subspan(layout.positions, layout.speeds));
  const auto check = [&](const std::string& body, const char* indicator, double value, double limit) {
    if (value > limit) found.push_back({body, indicator, value, limit, state.time});
  };
  for (Watched::Flexible& f : watched_->bodies) {
    const BodyNode& node = model_.bodies()[f.body];
    const Terms terms = node.terms.value_or(limits_of);
    if (second_order(terms)) continue;
    if (f.fundamental > 0)
      check(node.name, "rate over fundamental frequency", watched_->motion.bodies()[f.body].rate.norm() / f.fundamental,
            rate_limit(terms, f.one_direction));
    check(node.name, "load over buckling load", f.stiffness.evaluate(watched_->motion.bodies()).size(), load_limit);
  }
  watched_->seen->observe(state.y);
  for (const Tip& tip : watched_->places) {
    const Terms terms = model_.bodies()[static_cast<std::size_t>(tip.tip.body)].terms.value_or(limits_of);
    if (!tip.flexible || terms.strain == StrainOrder::exact || !(tip.length > 0)) continue;
    const auto d = deflection(*watched_->seen, tip);
    check(tip.body, "deflection over length", std::hypot(d[0], d[1], d[2]) / tip.length, deflection_limit);
  }
  return found;
}

namespace {

/// A run that goes from one formulation over to the next.
class Escalation {
 public:
  Escalation(const Model& model, const std::vector<Rung>& rungs, const Integrator& integrator, const State& initial,
             const RunOptions& options, const std::function<void(const State&, std::size_t)>& output)
      : model_(model),
        rungs_(rungs),
        integrator_(integrator),
        options_(options),
        output_(output),
        watch_(model),
        from_(initial) {}

  EscalatedRun run() {
    for (bool done = false; !done;) done = one_stretch();
    run_.summary.cpu_seconds = seconds_;
    return std::move(run_);
  }

 private:
  /// How far a formulation has gone, and why no further.
  struct Attempt {
    RunSummary summary;
    std::vector<Excess> excess;  ///< empty: to its end
    std::optional<double> held;  ///< time of the last output at which all limits held
    std::size_t next = 0;        ///< rung that goes on
  };

  [[nodiscard]] bool is_last() const { return rung_ + 1 == rungs_.size(); }
  [[nodiscard]] RunOptions options_of_rung() const {
    RunOptions own = options_;
    own.beyond = is_last() ? options_.beyond : rungs_[rung_ + 1].equations;
    return own;
  }

  /// Runs with the present formulation up to where an indicator passes its limit.
  Attempt attempt() {
    const Rung& used = rungs_[rung_];
    Attempt a;
    RunOptions own = options_of_rung();
    if (!is_last()) {
      own.accept = [&](const State& s) {
        a.excess = watch_.excess(s, used, used.terms);
        if (!a.excess.empty()) a.next = rung_for(s);
        return a.excess.empty();
      };
    }
    a.summary = simulate(model_, *used.equations, integrator_, from_, own, [&](const State& s) {
      a.held = s.time;
      emit(s);
    });
    // A formulation that cannot go on is past its validity, whatever the indicators said.
    const RunStatus status = a.summary.status;
    if (a.excess.empty() && !is_last() && status != RunStatus::completed && status != RunStatus::interrupted) {
      a.excess.push_back({"", "it stopped: " + a.summary.message, 0, 0, a.summary.reached});
      a.next = rung_ + 1;
    }
    seconds_ += a.summary.cpu_seconds;
    return a;
  }

  /// The least formulation beyond the present one whose limits hold at a state, or the last.
  std::size_t rung_for(const State& state) {
    std::size_t next = rung_ + 1;
    while (next + 1 < rungs_.size() && !watch_.excess(state, rungs_[rung_], rungs_[next].terms).empty()) ++next;
    return next;
  }

  void emit(const State& state) {
    if (emitted_ && state.time <= *emitted_) return;
    emitted_ = state.time;
    if (output_) output_(state, rung_);
  }

  void keep(const Stretch& stretch, const RunSummary& summary) {
    join(run_.summary, summary, !joined_);
    joined_ = true;
    run_.stretches.push_back(stretch);
  }

  static Stretch stretch_of(std::size_t rung, double start, const RunSummary& summary) {
    return {rung, start, summary.reached, summary.steps.accepted, summary.steps.evaluations, summary.energy_drift,
            {},   0};
  }

  /// One formulation, as far as it holds. \returns whether the run is done
  bool one_stretch() {
    Attempt tried = attempt();
    if (tried.excess.empty()) {
      keep(stretch_of(rung_, from_.time, tried.summary), tried.summary);
      return true;
    }
    run_.discarded_evaluations += tried.summary.steps.evaluations;
    if (tried.held && *tried.held > from_.time) return again(*tried.held, tried);
    Stretch none{rung_, from_.time, tried.held.value_or(from_.time), 0, 0, 0, tried.excess, 0};
    go_over(none, tried.next);
    run_.stretches.push_back(none);
    return false;
  }

  /// Runs once more, up to the last output at which all limits held.
  bool again(double held, const Attempt& tried) {
    RunOptions own = options_of_rung();
    own.end = held;
    const RunSummary summary = simulate(model_, *rungs_[rung_].equations, integrator_, from_, own, {});
    seconds_ += summary.cpu_seconds;
    Stretch stretch = stretch_of(rung_, from_.time, summary);
    from_ = summary.final;
    // An event that ends the run, up to rounding where the stretch does, ends it all the same.
    const bool stopped = summary.reached < held;
    const bool done = stopped || summary.status != RunStatus::completed;
    if (!stopped) stretch.excess = tried.excess;
    if (!done) go_over(stretch, tried.next);
    keep(stretch, summary);
    return done;
  }

  void go_over(Stretch& stretch, std::size_t next) {
    stretch.energy_jump = energy(*rungs_[next].equations, from_) - energy(*rungs_[rung_].equations, from_);
    rung_ = next;
  }

  const Model& model_;
  const std::vector<Rung>& rungs_;
  const Integrator& integrator_;
  const RunOptions& options_;
  const std::function<void(const State&, std::size_t)>& output_;
  LimitWatch watch_;
  EscalatedRun run_;
  State from_;  ///< where the present stretch begins
  std::size_t rung_ = 0;
  std::optional<double> emitted_;  ///< time of the last output
  bool joined_ = false;
  double seconds_ = 0;
};

}  // namespace

EscalatedRun simulate_escalating(const Model& model, const std::vector<Rung>& rungs, const Integrator& integrator,
                                 const State& initial, const RunOptions& options,
                                 const std::function<void(const State&, std::size_t)>& output) {
  if (rungs.empty()) throw std::invalid_argument("no formulation to run in");
  for (const LoadSlot& slot : model.layout().discrete_slots)
    if (model.loads()[slot.load].load->input() == nullptr)
      throw std::invalid_argument("discrete states of loads do not go over from one formulation to the next");
  if (options.checkpoint || options.resume != nullptr)
    throw std::invalid_argument("a run that changes its formulation has no checkpoints");
  return Escalation(model, rungs, integrator, initial, options, output).run();
}

}  // namespace withy
