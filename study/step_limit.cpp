#include "withy/study/step_limit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "withy/core/analysis/closed_pole.hpp"
#include "withy/core/analysis/fastest_pole.hpp"
#include "withy/core/model/closing.hpp"
#include "withy/core/simulation/diagnosis.hpp"
#include "withy/core/simulation/loop_following.hpp"
#include "withy/study/fast_course.hpp"

namespace withy::study {
namespace {

/// Loads count: what a servo does is not among the vibrations of the modes. Nothing of models too large to be looked at
/// as a whole, and where there are no derivatives, as at the end of a run that failed.
/// \param resting speeds that stay as they are; empty: none
std::optional<FastestPole> pole_at(const Prepared& prepared, const State& state, const Held& resting = {}) {
  const Model& model = prepared.model();
  if (model.layout().speeds > largest_examined) return {};
  try {
    if (!loops_of(model).empty()) {
      const FastestPole pole = fastest_pole_of_loops(model, *prepared.equations, state, resting);
      return std::abs(pole.value) > 0 ? std::optional(pole) : std::nullopt;
    }
    const TangentDynamics dynamics(prepared.scene.model, prepared.scene.formulation->terms());
    Held held = driven_speeds(model, state);
    for (std::size_t i = 0; i < resting.size(); ++i) held[i] = held[i] || resting[i];
    const FastestPole pole = fastest_pole(dynamics, state, held);
    if (std::abs(pole.value) > 0) return pole;
  } catch (const std::domain_error&) {
    return {};
  }
  return {};
}

/// Rates below this [rad/s, m/s] may be those of an integrator that goes to and fro about rest.
constexpr double creeping = 1e-6;

/// Dry friction is steep within its scale of rates alone. Where that is below what the integrator resolves, its states
/// step over it, to and fro, and about none of them the pole is seen that makes it do so.
std::optional<State> with_what_creeps_at_rest(const Model& model, const State& state) {
  State resting = state;
  bool any = false;
  const Layout& layout = model.layout();
  for (std::size_t i = layout.positions; i < layout.positions + layout.speeds; ++i)
    if (double& rate = resting.y[i]; rate != 0 && std::abs(rate) < creeping) {
      rate = 0;
      any = true;
    }
  return any ? std::optional(resting) : std::nullopt;
}

std::optional<TooStiff> too_stiff_at(const Prepared& prepared, const State& state, std::size_t most_steps,
                                     const std::string& introduction) {
  const Scene& scene = prepared.scene;
  const std::optional<double> limit = scene.integrator->stability_limit();
  if (!limit || !std::isfinite(*limit) || !scene.end) return {};
  const std::optional<FastestPole> pole = pole_at(prepared, state);
  if (!pole) return {};
  TooStiff found{*limit / std::abs(pole->value), (*scene.end - state.time) * std::abs(pole->value) / *limit, {}};
  if (!(found.steps > static_cast<double>(most_steps))) return {};
  found.text = fmt::format(
      "{} is stable to steps of about {:.1g} s, of which the run would need about {:.1g} where {:g} are "
      "allowed; {} {}",
      scene.integrator_name, found.step, found.steps, static_cast<double>(most_steps), introduction,
      describe(*pole, prepared.model().layout()));
  return found;
}

bool controlled(const Scene& scene) { return scene.source.at("integrator").find("rtol") != nullptr; }

/// Whether steps that have another length than the one before them can be only the integrator's own choice.
bool chosen(const Scene& scene, const StepStatistics& steps) {
  constexpr double rounding = 1e-6;
  return !controlled(scene) && scene.source.at("integrator").find("step") == nullptr &&
         steps.largest_step - steps.smallest_step > rounding * steps.largest_step;
}

/// The longest step that the scene allows [s]: its max_step, or from one sample of a load to the next.
double longest_step(const Scene& scene) {
  const Value* given = scene.source.at("integrator").find("max_step");
  double longest = given != nullptr ? given->number() : std::numeric_limits<double>::infinity();
  for (const LoadNode& node : scene.model->loads())
    if (const DiscretePart* part = node.load->discrete(); part != nullptr && part->period() > 0)
      longest = std::min(longest, part->period());
  return longest;
}

/// Speeds that rest along a run, as those out of the plane of a motion do; empty where none does or it is not known.
/// What limits steps by stability grows until error control sees it: its rates then go to and fro at tens of times the
/// tolerance and more, so what stays below this share of it at all states that are looked at limits nothing.
Held resting_speeds(const Model& model, const RunSummary& summary, double absolute) {
  constexpr double far_below = 0.01;
  const Layout& layout = model.layout();
  Held resting(layout.speeds, true);
  const auto look = [&](const State& state) {
    for (std::size_t i = 0; i < layout.speeds; ++i)
      if (!(std::abs(state.y[layout.positions + i]) <= far_below * absolute)) resting[i] = false;
  };
  if (summary.validity.along.empty()) return {};
  for (const State& state : summary.validity.along) look(state);
  look(summary.final);
  return std::find(resting.begin(), resting.end(), true) != resting.end() ? resting : Held();
}

/// Of equations at a state, resting speeds as if they were prescribed.
DenseSystem system_of_moving(const EquationsOfMotion& equations, const State& state, const Held& resting) {
  DenseSystem system = equations.system(state.time, state.y);
  for (std::size_t i = 0; i < resting.size(); ++i)
    if (resting[i]) system.prescribed.push_back({i, 0});
  return system;
}

StepLimit of_vibrations(const Prepared& prepared, const Integrator& integrator, const RunSummary& summary,
                        const Held& resting) {
  StepLimit s;
  s.limit = integrator.stability_limit();
  // What never moves is no measure of what its steps are limited by.
  if (summary.steps.accepted == 0 || summary.energy_scale == 0) return s;
  s.mean = (summary.reached - prepared.scene.initial.time) / static_cast<double>(summary.steps.accepted);
  s.fastest = s.moving = summary.fastest_mode;
  const EquationsOfMotion& equations = *prepared.equations;
  if (s.fastest > 0 && !resting.empty())
    s.moving = fastest_mode(prepared.model(), system_of_moving(equations, summary.final, resting),
                            closing_rows(equations, summary.final.y));
  s.product = s.mean * s.moving;
  return s;
}

/// Where no pole is known the fastest mode stays.
void find_fastest(const Prepared& prepared, const RunSummary& summary, const Held& resting, StepLimit& s) {
  if (s.mean == 0) return;
  std::optional<FastestPole> pole = pole_at(prepared, summary.final);
  if (!pole) return;
  const Layout& layout = prepared.model().layout();
  s.fastest = std::abs(pole->value);
  if (!resting.empty()) {
    constexpr double clearly = 1.01;
    std::optional<FastestPole> moving = pole_at(prepared, summary.final, resting);
    s.moving = moving ? std::abs(moving->value) : 0;
    if (s.fastest > clearly * s.moving && !pole->of_load_state()) s.resting = layout.speed_names[pole->speed];
    pole = std::move(moving);
  } else {
    s.moving = s.fastest;
  }
  s.product = s.mean * s.moving;
  if (!pole) return;
  s.maker = describe(*pole, layout);
  s.made_by_load = pole->of_load;
}

}  // namespace

std::string StepLimit::cause() const {
  // Of the greatest stable step: the mean of steps that go to and fro about it lies above this share.
  constexpr double near_limit = 0.6;
  // Steps land on what they may not pass, and are shorter here and there.
  constexpr double all_of_it = 0.9;
  if (mean == 0) return "unknown";
  if (!controlled) return chosen ? "chosen" : "given";
  if (!limit || fastest == 0) return "unknown";
  if (!fastest_rests() && product > near_limit * *limit) return "stability";
  return mean >= all_of_it * longest ? "given" : "accuracy";
}

bool StepLimit::fastest_rests() const {
  constexpr double far = 3;
  return controlled && limit && product > far * *limit;
}

StepLimit step_limit(const Prepared& prepared, const Integrator& integrator, double absolute,
                     const RunSummary& summary) {
  return of_vibrations(prepared, integrator, summary, resting_speeds(prepared.model(), summary, absolute));
}

StepLimit step_limit(const Prepared& prepared, const RunSummary& summary, Registry& registry) {
  const Scene& scene = prepared.scene;
  // An instability of steps that nobody controls grows from nothing.
  const Value* absolute = controlled(scene) ? scene.source.at("integrator").find("atol") : nullptr;
  const Held resting = absolute != nullptr ? resting_speeds(prepared.model(), summary, absolute->number()) : Held();
  StepLimit s = of_vibrations(prepared, *scene.integrator, summary, resting);
  s.controlled = controlled(scene);
  s.chosen = chosen(scene, summary.steps);
  s.longest = longest_step(scene);
  find_fastest(prepared, summary, resting, s);
  if (s.cause() != "stability") return s;
  const EquationsOfMotion& equations = *prepared.equations;
  // In longer steps what rests now grows once they are too long for it: all modes count.
  if (!s.made_by_load && s.resting.empty())
    s.fewer = best_slowing(*scene.model, equations.system(summary.final.time, summary.final.y),
                           closing_rows(equations, summary.final.y));
  // Those with error control, so that no step need be chosen. The first folds stiffness into a symmetric mass matrix.
  for (const std::string id : {"imex", "radau"}) {
    // imex treats stiffness and damping of bodies implicitly, and loads explicitly.
    if (id == "imex" && s.made_by_load) continue;
    const bool able = id != "imex" || equations.linearly_implicit() != nullptr;
    if (able && registry.find<Integrator>(id) != nullptr) s.unlimited.push_back(id);
  }
  return s;
}

std::optional<TooStiff> too_stiff(const Prepared& prepared, const State& state, std::size_t most_steps) {
  std::optional<TooStiff> found = too_stiff_at(prepared, state, most_steps, "its fastest motion is");
  if (found) return found;
  if (const std::optional<State> resting = with_what_creeps_at_rest(prepared.model(), state))
    return too_stiff_at(
        prepared, *resting, most_steps,
        fmt::format("what creeps slower than {:g} rad/s or m/s taken as at rest, its fastest motion is", creeping));
  return {};
}

namespace {

/// For RunOptions::too_fast: steps that nobody controls beyond what the integrator is stable to, at the end of the run
/// or at a state on its way.
std::string too_fast(const Prepared& prepared, const RunSummary& summary, double step) {
  const Scene& scene = prepared.scene;
  const std::optional<double> limit = scene.integrator->stability_limit();
  if (controlled(scene) || !limit || !std::isfinite(*limit)) return {};
  std::optional<FastestPole> fastest = pole_at(prepared, summary.final);
  constexpr std::size_t looks = 8;  // the poles of two hundred speeds take a second
  const std::vector<State>& along = summary.validity.along;
  for (std::size_t i = 0; i < along.size(); i += std::max<std::size_t>(along.size() / looks, 1)) {
    std::optional<FastestPole> pole = pole_at(prepared, along[i]);
    if (pole && (!fastest || std::abs(pole->value) > std::abs(fastest->value))) fastest = std::move(pole);
  }
  if (!fastest) return {};
  const double product = step * std::abs(fastest->value);
  if (!(product > *limit)) return {};
  return fmt::format(
      "Steps of {} s are too long for the integrator: times the fastest pole they are {}, and it is stable to {}; the "
      "pole is {}.",
      brief(step), brief(product), brief(*limit), describe(*fastest, prepared.model().layout()));
}

}  // namespace

void watch_poles(const Prepared& prepared, RunOptions& options) {
  options.too_stiff = [&prepared](const State& state) {
    const std::optional<TooStiff> found = too_stiff(prepared, state);
    if (found) return found->text;
    const std::optional<FastCourse> course = fast_course(prepared, state);
    return course ? course->text : std::string();
  };
  options.too_fast = [&prepared](const RunSummary& summary, double step) { return too_fast(prepared, summary, step); };
}

}  // namespace withy::study
