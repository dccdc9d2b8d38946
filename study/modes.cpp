#include "withy/study/modes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "withy/core/analysis/coupled_modes.hpp"
#include "withy/core/analysis/still_equations.hpp"
#include "withy/study/at_limits.hpp"
#include "withy/study/bent.hpp"
#include "withy/study/blade_tracker.hpp"
#include "withy/study/input_error.hpp"
#include "withy/study/sampled_loads.hpp"
#include "withy/study/sampled_steady.hpp"

namespace withy::study {
namespace {

double greatest_eigenvalue(const ModesAt& at) {
  double g = 0;
  for (const Mode& m : at.modes) g = std::max({g, std::abs(m.eigenvalue), std::abs(m.partner)});
  return g;
}

/// The modes of the map from one common sample to the next.
void find_sampled_modes(const Configuration& c, const Tangents& tangents, ModesAt& at) {
  const SmallMotions motions(c, {});
  const SampledLoads sampled(motions);
  const SampledLoads::Held held{
      motions.A(), sampled.moved(sampled.efforts()), Eigen::MatrixXd::Zero(motions.size(), 0), {}, {}};
  const Eigen::MatrixXd mass = tangents.mass(motions.free(), motions.free());
  const auto between = [&](const Eigen::MatrixXcd& columns) {
    SampledLoads::Course course = sampled.course(held, columns);
    for (Eigen::MatrixXcd& motion : course.motions) motion = motion.topRows(mass.rows()).eval();
    return MotionOverPeriod{course.fastest, std::move(course.times), std::move(course.weights),
                            std::move(course.motions)};
  };
  const Eigen::Index n = motions.size(), states = n - 2 * mass.rows();
  const Eigen::MatrixXd by_held = sampled.moved(0 * sampled.efforts());
  const Eigen::MatrixXd unheld =
      unheld_motions(tangents, c.held(),
                     {c.dynamics().on_motions(c.state().y, sampled.efforts()), by_held.bottomRows(states),
                      sampled.renewal(held).bottomRows(sampled.size())});
  MapModes found = modes_of_map({sampled.map(held).first, sampled.period(),
                                 balancing_units(motions.A(), mass.diagonal().cwiseAbs()), mass, unheld, between},
                                c.held());
  at.modes = std::move(found.modes);
  at.forgotten = found.gone;
  at.period = sampled.period();
}

/// Shapes with what follows in closed loops.
void add_followers(const Configuration& c, const State& state, std::vector<Mode>& modes) {
  const auto n = static_cast<Eigen::Index>(c.layout().speeds);
  for (Mode& mode : modes) {
    const Eigen::VectorXd re = mode.shape.head(n).real(), im = mode.shape.head(n).imag();
    mode.shape.head(n).real() = c.dynamics().whole(state.y, re);
    mode.shape.head(n).imag() = c.dynamics().whole(state.y, im);
  }
}

}  // namespace

std::string Sweep::text(double value) const {
  return unit.empty() ? fmt::format("{}", value) : fmt::format("{} {}", value, unit);
}

ModesAt modes_at(const Configuration& c, bool as_is, const TurningWish& wish) {
  ModesAt at;
  at.names = c.layout().speed_names;
  at.names.insert(at.names.end(), c.layout().continuous_names.begin(), c.layout().continuous_names.end());
  const std::vector<std::string> held = sampled_names(c.prepared().model());
  at.names.insert(at.names.end(), held.begin(), held.end());
  if (c.sampled() && (wish.floquet || wish.blades))
    throw InputError(
        "--floquet and --blades are of motions that are continuous in time, and loads are sampled: take "
        "their 'sample' away (--set loads.NAME.sample=null) or the loads");
  at.model = c.prepared().scene.model;
  State state = c.state();
  if (!as_is) {
    at.steady = SteadyFound{steady_state_of(c), c.kept(), {}, {}};
    at.problem = no_steady_state(c, at.steady->steady);
    if (!at.steady->steady.converged) return at;
    state = at.steady->steady.state;
    at.bent = bent_text(c, state);
  }
  try {
    const Tangents tangents = c.dynamics().tangents(state.time, state.y, c.dynamics().steady_accelerations(state.time));
    if (c.sampled()) {
      Configuration about = c;
      about.set_state(state);
      find_sampled_modes(about, tangents, at);
    } else {
      at.modes = natural_modes(tangents, c.held());
    }
    add_followers(c, state, at.modes);
    at.limited = at_limits(c, state);
    at.masses = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(at.names.size()));
    at.masses.head(tangents.mass.rows()) = tangents.mass.diagonal().cwiseAbs();
    if (!as_is) {
      at.steady->stays = stays_steady(c.dynamics(), tangents, state, c.held());
      at.steady->derivatives = derivatives_text(tangents);
    }
    at.turn = turning_modes(c, state, wish);
    if (!as_is && (!at.turn->check.steady || !at.turn->uneven.empty() || !at.turn->timed.empty()))
      at.steady->stays = false;
    // Of a state as it is nobody has said that it stays; and small motions may be the same about one that does not.
    if (as_is || (at.turn->shaking.empty() && at.turn->check.steady)) at.turn->timed.clear();
  } catch (const std::domain_error& e) {
    const NotFinite found = not_finite(c, state);
    at.problem = found.text.empty() ? e.what() : found.text;
  }
  return at;
}

ModesOf sweep_modes(const SceneValues& values, Registry& registry, const StartState& start, const Holding& holding,
                    const Sweep& sweep, bool as_is, const TurningWish& wish, const Control& control) {
  ModesOf run;
  const bool spins = !sweep.spun().empty(), varies = !sweep.none() && !spins;
  std::optional<Configuration> base, c, before;
  std::optional<State> last;
  BranchTracker tracker;
  BladeTracker blades;
  const auto configured = [&](double value) {
    if (!base || varies) {
      SceneValues here = values;
      if (varies) here.set_text(sweep.path + '=' + sweep.text(value));
      const Prepared prepared = prepare(std::move(here), registry);
      base.emplace(prepared, start ? start(prepared) : StateAsGiven(prepared.scene.initial), holding);
    }
    Configuration made = *base;
    if (spins) made.spin(read_spin(made.prepared().model(), sweep.spun(), sweep.text(value), "sweep"));
    return made;
  };
  const auto midway = [&](double a, double b) -> std::optional<Configuration> {
    try {
      return configured(0.5 * (a + b));
    } catch (const SceneError&) {  // of whole numbers there is none
      return {};
    }
  };
  for (std::size_t k = 0; k < sweep.values.size() && !control.stop(); ++k) {
    const double value = sweep.values[k];
    before.swap(c);
    c.emplace(configured(value));
    const bool goes_on = last && last->y.size() == c->state().y.size();
    if (goes_on) c->begin_at(*last);
    run.points.push_back(modes_at(*c, as_is, wish));
    ModesAt& at = run.points.back();
    at.value = value;
    if (!goes_on) at.closing = c->closing();
    if (at.steady && at.steady->steady.converged) {
      const State& steady = at.steady->steady.state;
      if (last && last->y.size() == steady.y.size() && run.points[k - 1].steady->steady.converged)
        at.jump = jump_between(*before, *last, *c, steady, [&] { return midway(sweep.values[k - 1], value); });
      last = steady;
    }
    if (at.turn && at.turn->blades) blades.follow(value, *at.turn->blades);
    if (at.problem.empty()) {
      BranchedModes followed = tracker.follow(
          std::move(at.modes), at.masses,
          c->layout().continuous > 0 || c->sampled() ? Closeness::of_eigenvalues : Closeness::of_squares);
      at.modes = std::move(followed.modes), at.branches = std::move(followed.branches);
    }
    control.tell(static_cast<double>(k + 1), static_cast<double>(sweep.values.size()));
  }
  if (c) run.formulation = c->prepared().scene.formulation_name;
  return run;
}

const Mode* ModesAt::on(std::size_t branch) const {
  const auto found = std::lower_bound(branches.begin(), branches.end(), branch);
  return found == branches.end() || *found != branch ? nullptr
                                                     : &modes[static_cast<std::size_t>(found - branches.begin())];
}

std::size_t ModesOf::branches() const {
  std::size_t count = 0;
  for (const ModesAt& at : points)
    if (!at.branches.empty()) count = std::max(count, at.branches.back() + 1);
  return count;
}

std::string ModesOf::name(std::size_t branch) const {
  for (const ModesAt& at : points)
    if (const Mode* mode = at.on(branch)) return dominating(at, *mode);
  return {};
}

std::string dominating(const ModesAt& at, const Mode& mode) {
  return at.names[static_cast<std::size_t>(mode.dominant)];
}

double resolved_growth(const ModesAt& at, const Mode& mode) {
  return std::abs(mode.growth()) > mode.resolution(greatest_eigenvalue(at)) ? mode.growth() : 0.0;
}

bool unstable(const ModesAt& at, const Mode& mode) { return !mode.rigid && resolved_growth(at, mode) > 0; }

std::string behaviour(const ModesAt& at, const Mode& mode) {
  if (mode.rigid) return "rigid";
  if (at.frozen()) return unstable(at, mode) ? "grows here" : "decays here";
  if (unstable(at, mode)) return mode.eigenvalue.imag() == 0 ? "diverges" : "flutters";
  const double alternating = at.period > 0 ? std::numbers::pi / at.period : 0;
  if (mode.single && mode.eigenvalue.imag() <= alternating)
    return mode.eigenvalue.imag() == 0 ? "decays" : "alternates";
  return mode.eigenvalue.imag() == 0 ? "overdamped" : "stable";
}

std::string sampling_text(const ModesOf& run) {
  const auto of_period = [](const ModesAt& a, const ModesAt& b) { return a.period < b.period; };
  const auto [least, most] = std::minmax_element(run.points.begin(), run.points.end(), of_period);
  if (least == run.points.end() || most->period == 0) return {};
  std::string text = fmt::format(
      "Loads are sampled every {:g}{} s: modes are those from one sample to the next, shapes "
      "what there is just before it",
      least->period, most->period > least->period ? fmt::format(" to {:g}", most->period) : "");
  if (const std::size_t forgotten = run.points.front().forgotten; run.points.size() == 1 && forgotten > 0)
    text += fmt::format("; {} more {} forgotten within some samples", forgotten, forgotten > 1 ? "are" : "is");
  return text + '.';
}

}  // namespace withy::study
