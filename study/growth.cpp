#include "withy/study/growth.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <stdexcept>

#include "withy/core/analysis/fastest_pole.hpp"
#include "withy/core/model/closing.hpp"
#include "withy/core/model/hinge_rates.hpp"
#include "withy/core/plugin/formulation.hpp"
#include "withy/core/plugin/measured_place.hpp"
#include "withy/core/simulation/diagnosis.hpp"
#include "withy/core/simulation/felt_motion.hpp"
#include "withy/core/simulation/loop_following.hpp"
#include "withy/core/simulation/motion_stiffness.hpp"

namespace withy::study {
namespace {

/// What bends a body by its own length, where it is measured: by its static stiffness there.
struct Strength {
  std::size_t body = 0;
  double force = std::numeric_limits<double>::infinity();   ///< [N]
  double moment = std::numeric_limits<double>::infinity();  ///< of that force over the length [N m]
};

/// Of the weakest body; infinite where none has such a station.
Strength weakest_body(const Model& model) {
  Strength weakest;
  for (std::size_t b = 0; b < model.bodies().size(); ++b) {
    const Body& body = *model.bodies()[b].body;
    const ModalShape& shape = body.shape();
    const auto place = measured_place(body);
    const Eigen::LLT<Eigen::MatrixXd> factors(shape.stiffness);
    if (shape.modes() == 0 || !place || !(shape.length > 0) || factors.info() != Eigen::Success) continue;
    const Eigen::Matrix3d give = place->at.phi * factors.solve(place->at.phi.transpose());
    const double most = give.diagonal().maxCoeff();
    if (!(most > 0) || shape.length * shape.length / most >= weakest.moment) continue;
    weakest = {b, shape.length / most, shape.length * shape.length / most};
  }
  return weakest;
}

/// A speed of a hinge.
struct HingeSpeed {
  std::size_t speed = 0;
  bool angular = false;
};

std::vector<HingeSpeed> speeds_of_hinges(const Model& model) {
  std::vector<HingeSpeed> all;
  for (std::size_t h = 0; h < model.hinges().size(); ++h) {
    std::size_t speed = model.layout().hinges[h].speed;
    for (const HingeRate& rate : hinge_rates(*model.hinges()[h].hinge)) all.push_back({speed++, rate.angular});
  }
  return all;
}

/// The load that pushes a hinge hardest at one of some times, where that is more than what bends the weakest body by
/// its length: no such motion is one of this structure.
std::string wild_load(const Prepared& prepared, const State& state, std::initializer_list<double> times) {
  const Model& model = prepared.model();
  const Strength strength = weakest_body(model);
  if (!std::isfinite(strength.moment)) return {};
  Work work = prepared.equations->make_work();
  const std::vector<HingeSpeed> speeds = speeds_of_hinges(model);
  double most = 1;
  std::string text;
  for (const double t : times) {
    for (std::size_t l = 0; l < model.loads().size(); ++l) {
      std::vector<double> efforts(model.layout().speeds);
      prepared.equations->load_efforts(t, state.y, static_cast<int>(l), efforts, work);
      for (const auto& [speed, angular] : speeds) {
        const double times_strength = std::abs(efforts[speed]) / (angular ? strength.moment : strength.force);
        if (!(times_strength > most)) continue;
        most = times_strength;
        text =
            fmt::format(" Load '{}' gives {:.3g} {} on {} at t = {:.4g} s, {:.2g} times what bends '{}' by its length.",
                        model.loads()[l].name, efforts[speed], angular ? "N m" : "N", model.layout().speed_names[speed],
                        t, most, model.bodies()[strength.body].name);
      }
    }
  }
  return text;
}

/// Whether a body's formulation has the centrifugal force on deflections and nothing that stiffens.
bool softens(const Prepared& prepared, const BodyNode& body) {
  const Terms terms = body.terms.value_or(prepared.scene.formulation->terms());
  return terms.strain == StrainOrder::linear && terms.products_of_speeds &&
         (terms.truncation == Truncation::strict || terms.truncation == Truncation::none);
}

/// Hinges that move next to nothing where they moved something at the start: any effort on them, and the momentum that
/// they have, turns them without limit.
std::string emptied_hinges(const Prepared& prepared, const State& state) {
  constexpr double next_to_nothing = 1e-6;
  const Model& model = prepared.model();
  const State& initial = prepared.scene.initial;
  const DenseSystem now = prepared.equations->system(state.time, state.y),
                    first = prepared.equations->system(initial.time, initial.y);
  std::string text;
  for (const auto& [speed, angular] : speeds_of_hinges(model)) {
    const std::size_t at = speed * (now.size + 1);
    const double left = now.mass[at], had = first.mass[at];
    if (!(had > 0 && left < next_to_nothing * had)) continue;
    text += fmt::format(
        " There {} moves {:.2g} {}, {:.2g} times what it moved at the start: the mass that it carries is on its axis, "
        "and nothing limits its rate.",
        model.layout().speed_names[speed], left, angular ? "kg m^2" : "kg", left / had);
  }
  return text;
}

/// What the motion of the bodies explains at the last trusted state: behind it a body may turn as fast as it likes.
std::string physical_cause(const Prepared& prepared, const RunSummary& summary) {
  const Model& model = prepared.model();
  const EquationsOfMotion& equations = *prepared.equations;
  const State& state = summary.final;
  std::vector<double> rates(equations.size());
  Work work = equations.make_work();
  if (!equations.derivatives(state.time, state.y, rates, work).ok()) return {};
  TreeMotion motion(model);
  motion.update(state.y, std::span<const double>(rates).subspan(model.layout().positions, model.layout().speeds));
  // Where steps collapse the reason lies ahead.
  const double ahead = summary.status == RunStatus::step_underflow ? summary.steps.largest_step : 0;
  std::string text = wild_load(prepared, state, {state.time, summary.reached, summary.reached + ahead});
  text += emptied_hinges(prepared, state);
  FeltMotion felt(model, equations);
  felt.update(state, motion.bodies());
  LoopFollowing loops(model, equations);
  loops.update(state.y);
  for (const BodyValidity& b : summary.validity.bodies) {
    const auto index = static_cast<std::size_t>(model.body(b.name));
    const double rate = b.fundamental > 0 ? motion.bodies()[index].rate.norm() / b.fundamental : 0;
    const double buckling =
        -MotionStiffness(model, index).evaluate(felt.bodies(), felt.at_frames(), loops.of(index)).least;
    if (rate >= 1)
      text += fmt::format(" There '{}' turns at {:.3g} times its fundamental frequency of {:.4g} rad/s{}.", b.name,
                          rate, b.fundamental,
                          softens(prepared, model.bodies()[index])
                              ? ": its formulation knows the inertia of rotation and not the stiffening it causes, and "
                                "its stiffness is negative from there on"
                              : "");
    if (buckling >= 1)
      text += fmt::format(" There '{}' is compressed by {:.3g} times its buckling load.", b.name, buckling);
  }
  return text;
}

/// "1.8/s, vibrating at 25 rad/s, most by damping of load 'servo' on shoulder.0": the small motion about a state that
/// grows fastest. Empty where none grows within a time [s], and where there are no derivatives.
std::string growth_at(const TangentDynamics& dynamics, const State& state, double lasted) {
  const Model& model = dynamics.model();
  FastestPole pole;
  try {
    pole = growing_pole(dynamics, state, driven_speeds(model, state));
  } catch (const std::domain_error&) {
    return {};
  }
  if (!(pole.value.real() * lasted > 1)) return {};
  return fmt::format("{:.3g}/s{}, most by {}{}", pole.value.real(),
                     pole.value.imag() > 0 ? fmt::format(", vibrating at {:.3g} rad/s", pole.value.imag()) : "",
                     pole.cause.empty() ? "forces" : pole.cause,
                     pole.of_load_state() ? "" : " on " + model.layout().speed_names[pole.speed]);
}

}  // namespace

std::string growth_text(const Prepared& prepared, const RunSummary& summary) {
  const Model& model = prepared.model();
  const bool may_grow = summary.status == RunStatus::diverged || summary.status == RunStatus::step_underflow ||
                        summary.status == RunStatus::inaccurate;
  if (!may_grow || model.layout().speeds > largest_examined) return {};
  if (!loops_of(model).empty()) return physical_cause(prepared, summary);  // tangents are a tree's
  const TangentDynamics dynamics(prepared.scene.model, prepared.scene.formulation->terms());
  const State& start = prepared.scene.initial;
  const double lasted = summary.reached - start.time;
  std::string text;
  // The last state may be far from where the motion began to grow, bent over and turning.
  if (summary.final.time > start.time)
    if (const std::string first = growth_at(dynamics, start, lasted); !first.empty())
      text = fmt::format(" Already at the start small motions grew by {}.", first);
  if (const std::string last = growth_at(dynamics, summary.final, lasted); !last.empty())
    text += fmt::format(" About the state at t = {:.4g} s small motions grow by {}.", summary.final.time, last);
  return text + physical_cause(prepared, summary);
}

}  // namespace withy::study
