#include "withy/core/simulation/escalation.hpp"

#include <algorithm>
#include <cmath>
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
  const Energies e = equations.energies(state.y);
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
  std::vector<double> rates;
};

LimitWatch::LimitWatch(const Model& model) : model_(model), watched_(std::make_unique<Watched>(model)) {}
LimitWatch::~LimitWatch() = default;

std::vector<Excess> LimitWatch::excess(const State& state, const Rung& used, const Terms& limits_of) {
  std::vector<Excess> found;
  Work work = used.equations->make_work();
  watched_->rates.resize(used.equations->size());
  if (!used.equations->derivatives(state.time, state.y, watched_->rates, work).ok()) return found;
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
  for (const Tip& tip : watched_->places) {
    const Terms terms = model_.bodies()[static_cast<std::size_t>(tip.tip.body)].terms.value_or(limits_of);
    if (!tip.flexible || terms.strain == StrainOrder::exact || !(tip.length > 0)) continue;
    const auto d = deflection(*used.equations, state.y, tip);
    check(tip.body, "deflection over length", std::hypot(d[0], d[1], d[2]) / tip.length, deflection_limit);
  }
  return found;
}

EscalatedRun simulate_escalating(const Model& model, const std::vector<Rung>& rungs, const Integrator& integrator,
                                 const State& initial, const RunOptions& options,
                                 const std::function<void(const State&, std::size_t)>& output) {
  if (rungs.empty()) throw std::invalid_argument("no formulation to run in");
  if (!model.layout().discrete_slots.empty())
    throw std::invalid_argument("discrete states of loads do not go over from one formulation to the next");
  if (options.checkpoint || options.resume != nullptr)
    throw std::invalid_argument("a run that changes its formulation is neither put down nor resumed");
  EscalatedRun run;
  LimitWatch watch(model);
  State from = initial;
  std::size_t rung = 0;
  bool begun = false, joined = false;
  double seconds = 0, emitted = 0;
  while (true) {
    const Rung& used = rungs[rung];
    const bool last = rung + 1 == rungs.size();
    std::vector<Excess> excess;
    double held = from.time;  // last output at which all limits held
    bool held_any = false;
    RunOptions own = options;
    own.beyond = last ? options.beyond : rungs[rung + 1].equations;
    own.interrupted = [&] { return !excess.empty() || (options.interrupted && options.interrupted()); };
    std::size_t next_rung = rung;
    const auto emit = [&](const State& s) {
      if (begun && s.time <= emitted) return;
      begun = true;
      emitted = s.time;
      if (output) output(s, rung);
    };
    RunSummary summary = simulate(model, *used.equations, integrator, from, own, [&](const State& s) {
      if (!excess.empty()) return;
      if (!last) excess = watch.excess(s, used, used.terms);
      if (excess.empty()) {
        held = s.time;
        held_any = true;
        emit(s);
        return;
      }
      do {
        ++next_rung;
      } while (next_rung + 1 < rungs.size() && !watch.excess(s, used, rungs[next_rung].terms).empty());
    });
    seconds += summary.cpu_seconds;
    // A formulation that cannot go on is past its validity, whatever the indicators said.
    if (excess.empty() && !last && summary.status != RunStatus::completed && summary.status != RunStatus::interrupted) {
      excess.push_back({"", "it stopped: " + summary.message, 0, 0, summary.final.time});
      next_rung = rung + 1;
    }
    if (excess.empty()) {
      run.stretches.push_back({rung,
                               from.time,
                               summary.final.time,
                               summary.steps.accepted,
                               summary.steps.evaluations,
                               summary.energy_drift,
                               {},
                               0});
      join(run.summary, summary, !joined);
      break;
    }
    run.discarded_evaluations += summary.steps.evaluations;
    Stretch stretch{rung, from.time, held, 0, 0, 0, excess, 0};
    if (held_any && held > from.time) {
      own.end = held;
      own.interrupted = options.interrupted;
      summary = simulate(model, *used.equations, integrator, from, own, {});
      seconds += summary.cpu_seconds;
      stretch.steps = summary.steps.accepted;
      stretch.evaluations = summary.steps.evaluations;
      stretch.energy_drift = summary.energy_drift;
      join(run.summary, summary, !joined);
      joined = true;
      from = summary.final;
      // An event that ends the run, up to rounding where the stretch does, ends it all the same.
      const bool stopped = summary.final.time < held;
      if (stopped || summary.status != RunStatus::completed) {
        if (stopped) stretch.excess.clear();
        stretch.end = summary.final.time;
        run.stretches.push_back(stretch);
        break;
      }
    }
    stretch.energy_jump = energy(*rungs[next_rung].equations, from) - energy(*used.equations, from);
    run.stretches.push_back(stretch);
    rung = next_rung;
  }
  run.summary.cpu_seconds = seconds;
  return run;
}

}  // namespace withy
