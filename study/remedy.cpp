#include "withy/study/remedy.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "withy/core/model/closing.hpp"
#include "withy/core/simulation/diagnosis.hpp"
#include "withy/core/simulation/stop.hpp"
#include "withy/study/fast_course.hpp"
#include "withy/study/step_limit.hpp"

namespace withy::study {
namespace {

bool leaves_something_out(const Terms& terms) {
  return terms.strain == StrainOrder::linear || terms.truncation != Truncation::none || terms.kinematics != nullptr ||
         !terms.products_of_speeds;
}

/// "'law' (line 12 of the scene)": a part of the scene that stands under `key`.
std::string placed_name(const Prepared& prepared, const char* key, const std::string& name) {
  const Value* parts = prepared.scene.source.find(key);
  const Value* given = parts == nullptr ? nullptr : parts->find(name);
  const int line = given == nullptr ? 0 : given->place().line;
  return fmt::format("'{}'{}", name, line > 0 ? fmt::format(" (line {} of the scene)", line) : "");
}

/// Where a load gives no finite efforts, or its states no finite rates, at the last state or a step later.
std::string load_remedy(const Prepared& prepared, const RunSummary& summary) {
  const Model& model = prepared.model();
  Work work = prepared.equations->make_work();
  std::vector<double> efforts(model.layout().speeds);
  for (std::size_t load = 0; load < model.loads().size(); ++load) {
    const double ahead = summary.steps.largest_step;
    for (double after = 0; after <= ahead; after = after > 0 ? 2 * after : ahead * 0x1p-30) {
      prepared.equations->load_efforts(summary.final.time + after, summary.final.y, static_cast<int>(load), efforts,
                                       work);
      if (!std::all_of(efforts.begin(), efforts.end(), [](double e) { return std::isfinite(e); }))
        return fmt::format(
            " What to do: change load {} so that its effort is finite up to the end of the run: no division by zero, "
            "and no root or logarithm of what falls to zero or below.",
            placed_name(prepared, "loads", model.loads()[load].name));
      if (!(ahead > 0)) break;
    }
  }
  const NonfiniteRates rates = nonfinite_rates(model, summary.final, summary.steps.largest_step);
  for (const LoadSlot& slot : model.layout().continuous_slots) {
    const std::size_t first = slot.first - model.layout().positions - model.layout().speeds;
    if (!rates.states.empty() && rates.states.front() >= first && rates.states.front() < first + slot.count)
      return fmt::format(
          " What to do: change load {}, or what it measures, so that the rate of '{}' is finite up to the end of the "
          "run.",
          placed_name(prepared, "loads", model.loads()[slot.load].name),
          model.layout().continuous_names[rates.states.front()]);
  }
  return {};
}

/// Where the motion of a hinge is not finite at the last state or until a step after the run's end.
std::string hinge_remedy(const Prepared& prepared, const RunSummary& summary) {
  const double ahead = summary.reached - summary.final.time + summary.steps.largest_step;
  const auto found = nonfinite_hinge(prepared.model(), summary.final, ahead);
  if (!found) return {};
  return fmt::format(
      " What to do: change hinge {} so that its pose, H and bias are finite wherever it comes to, or keep it from "
      "there, by a load that stops it or an earlier end of the run (time.end).",
      placed_name(prepared, "hinges", prepared.model().hinges()[found->hinge].name));
}

/// Where a motion has no finite numbers from a time [s] on.
std::string motion_remedy(const Prepared& prepared, const std::string& name, double time) {
  return fmt::format(
      " What to do: change the law of {} so that its coordinate, rate and acceleration are finite up to the end of "
      "the run: no division by zero, and no root or logarithm of what falls to zero or below; or end the run before, "
      "as "
      "--set time.end={:.3g}.",
      placed_name(prepared, "motions", name), 0.99 * time);
}

/// Where kinematics is exact and a deflection past the scene's limit ended the run: nothing says that the motion itself
/// breaks down there. Empty where something else ended it.
std::string limit_remedy(const Prepared& prepared, const RunSummary& summary) {
  if (prepared.scene.formulation->terms().strain != StrainOrder::exact || !summary.past_deflection) return {};
  const double limit = prepared.scene.deflection_limit;
  return fmt::format(
      " What to do: where the body may bend so far, let the run go on: limits.deflection is {0:g} of a body's length "
      "(--set limits.deflection={1:g}), and exact kinematics holds at any deflection. If it ends again at a larger "
      "one, the motion itself grows: look at the scene's loads, gains and stiffness (withy check).",
      limit, 3 * limit);
}

/// Whether a run of steps that nobody controls ended where steps are beyond what the integrator is stable to; then also
/// what has to be said of them, empty where the run's message does.
std::optional<std::string> unstable_steps(const Prepared& prepared, const RunSummary& summary) {
  const Scene& scene = prepared.scene;
  const Value& integrator = scene.source.at("integrator");
  if (integrator.find("rtol") != nullptr) return {};
  const bool first = summary.steps.accepted == 0;
  const Value* given = integrator.find("step");
  if (first && given == nullptr) return {};
  const double step =
      first ? given->number() : (summary.reached - scene.initial.time) / static_cast<double>(summary.steps.accepted);
  if (!first && !steps_too_long(summary, *scene.integrator, step).empty()) return std::string();
  if (summary.final.y.size() != prepared.equations->size()) return {};
  // What has grown already is no reason for its growth.
  RunSummary trusted = summary;
  std::erase_if(trusted.validity.along, [&](const State& s) { return s.time > summary.final.time; });
  RunOptions options;
  watch_poles(prepared, options);
  const std::string text = options.too_fast(trusted, step);
  return text.empty() ? std::nullopt : std::optional(" " + text);
}

/// Of what is too fast for the steps allowed.
std::string stiff_remedy(const Prepared& prepared, const RunSummary& summary) {
  if (summary.final.y.size() == prepared.equations->size() && !too_stiff(prepared, summary.final))
    if (const std::optional<FastCourse> course = fast_course(prepared, summary.final))
      return fmt::format(
          " What to do: give {} {} the time that is meant, in seconds; if it really is that fast, replace it by its "
          "mean "
          "effect; or let the run end earlier (time.end).",
          course->of_motion ? "motion" : "load",
          placed_name(prepared, course->of_motion ? "motions" : "loads", course->name));
  return " What to do: use --integrator radau, whose steps are not limited by fast motions; or slow down what is named "
         "above: less damping or stiffness, or more inertia (of a motor, that of its rotor).";
}

const char* const shorter_steps =
    " What to do: take shorter steps (a smaller 'step', or 'rtol' or 'max_step' of an integrator that controls its "
    "error), or one that no vibration limits, as radau.";

/// Whether all bodies with modes have exact kinematics.
bool can_be_exact(const Model& model) {
  return std::all_of(model.bodies().begin(), model.bodies().end(), [](const BodyNode& node) {
    return node.body->shape().modes() == 0 || node.body->rod() != nullptr;
  });
}

/// Where bodies were bent beyond what kinematics of second order is good for, which grows by what it leaves out; empty
/// where they were not.
std::string bent_remedy(const Prepared& prepared, const RunSummary& summary) {
  constexpr double small = 0.1;
  double most = 0;
  for (const auto& [body, ratio] : summary.peak_deflection_ratio) most = std::max(most, ratio);
  if (!(most > small) || prepared.scene.formulation->terms().strain == StrainOrder::exact) return {};
  if (!can_be_exact(prepared.model()))
    return fmt::format(
        " What to do: bodies were bent by {:.2g} of their length, and beyond a tenth no formulation holds but exact, "
        "which a body here does not offer: write what is slender as a beam, or keep bodies from bending so far, by "
        "stiffness or by smaller loads.",
        most);
  return fmt::format(
      " What to do: use --formulation exact, which no deflection limits: bodies were bent by {:.2g} of their "
      "length, and beyond a tenth no other formulation holds. If that ends the same way the motion itself grows, or "
      "bodies may bend as far as that (limits.deflection).",
      most);
}

/// Where closed loops do not go on; empty of trees, and where the mass matrix is what cannot be solved.
std::string loop_remedy(const Prepared& prepared, const RunSummary& summary) {
  if (loops_of(prepared.model()).empty() || summary.final.y.size() != prepared.equations->size()) return {};
  Work work = prepared.equations->make_work();
  std::vector<double> slopes(prepared.equations->size());
  if (!prepared.equations->derivatives(summary.final.time, summary.final.y, slopes, work).ok()) return {};
  std::string text = " What to do: ";
  if (!prepared.model().motions().empty())
    text += "let motions drive no more hinges than the loops leave free, or by laws that agree for the whole run; ";
  return text +
         "keep links from coming into one line, by other lengths, another start or a spring or hinge-limit that stops "
         "them before; or end the run before that (time.end).";
}

}  // namespace

const Value* least_step(const Scene& scene, double time) {
  const Value* least = scene.source.at("integrator").find("min_step");
  const bool ends = least != nullptr && least->number() > 16 * std::numeric_limits<double>::epsilon() * std::abs(time);
  return ends ? least : nullptr;
}

std::string remedy_text(const Prepared& prepared, const RunSummary& summary) {
  const Terms terms = prepared.scene.formulation->terms();
  const bool bends = flexible(prepared.model());
  switch (summary.status) {
    case RunStatus::completed:
    case RunStatus::interrupted:
    case RunStatus::load_failed:  // its law has said why: the engine has nothing to add
      return {};
    case RunStatus::too_stiff:
      return stiff_remedy(prepared, summary);
    case RunStatus::inaccurate:
      if (const auto& lost = summary.lost_motion; !lost.name.empty())
        return motion_remedy(prepared, lost.name, lost.time);
      return shorter_steps;
    default:
      break;
  }
  if (summary.status == RunStatus::diverged || summary.status == RunStatus::step_underflow)
    if (const auto motion = nonfinite_motion(prepared.model(), summary.reached, summary.steps.largest_step))
      return motion_remedy(prepared, motion->name, motion->time);
  if (summary.status == RunStatus::diverged && summary.final.y.size() == prepared.equations->size()) {
    if (std::string text = hinge_remedy(prepared, summary); !text.empty()) return text;
    if (std::string text = load_remedy(prepared, summary); !text.empty()) return text;
  }
  // Before any model: what grows in such steps tells nothing of it.
  if (summary.status == RunStatus::diverged || (summary.status == RunStatus::singular && summary.steps.accepted == 0))
    if (const std::optional<std::string> steps = unstable_steps(prepared, summary)) return *steps + shorter_steps;
  if (summary.status == RunStatus::diverged)
    if (std::string text = limit_remedy(prepared, summary); !text.empty()) return text;
  if (summary.status == RunStatus::step_underflow)
    if (const Value* least = least_step(prepared.scene, summary.reached))
      return fmt::format(
          " What to do: make min_step smaller: it is {:g} s, and time is resolved more finely than that.",
          least->number());
  if (bends && leaves_something_out(terms))
    return std::string(" What to do: use --formulation quadratic, which neglects less") +
           (can_be_exact(prepared.model()) ? ", or exact where bodies bend by more than a tenth of their length" : "") +
           "; if the run then stops in the same way, the cause is the model and not the formulation.";
  if (summary.status == RunStatus::diverged && bends)
    if (std::string text = bent_remedy(prepared, summary); !text.empty()) return text;
  if (summary.status == RunStatus::singular)
    if (std::string text = loop_remedy(prepared, summary); !text.empty()) return text;
  if (summary.status == RunStatus::singular)
    return " What to do: look for a hinge that moves next to no inertia, or hinges that move the same (withy inspect).";
  if (summary.status == RunStatus::step_underflow)
    return " What to do: look at what acts at that time: a load that grows without end, a stop that is too stiff, a "
           "'rtol' below what the numbers hold.";
  return std::string(
             " What to do: use a tenth of 'rtol' or of the step. If it ends at the same time the motion "
             "itself grows: look at the scene's loads, gains and stiffness (withy check") +
         (bends && terms.strain != StrainOrder::exact && can_be_exact(prepared.model())
              ? "; --formulation exact for large deflections)."
              : ").");
}

}  // namespace withy::study
