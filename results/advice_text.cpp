#include "withy/results/advice_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>

#include "withy/results/certificate_text.hpp"
#include "withy/results/scene_edit.hpp"

namespace withy {
namespace {

std::string point_modes(const study::Point& p) {
  if (p.modes == 0) return "modes as they are";
  return fmt::format("{} mode{}{}", p.modes, p.modes == 1 ? "" : "s", p.family.empty() ? "" : ' ' + p.family);
}

std::string integration_text(const study::Point& p) { return fmt::format("{} at {:g}", p.integrator, p.tolerance); }

/// Of the accuracy asked, or where that is a share, the same share: "0.61 %".
std::string use_text(const study::Accuracy& accuracy, double use) {
  if (accuracy.share && !accuracy.length && !accuracy.angle)
    return fmt::format("{:.2g} %", 100 * use * *accuracy.share);
  return fmt::format("{:.2g} of the accuracy", use);
}

/// "3.4 mm", "2 deg", "0.5 N m".
std::string quantity(double value, const study::Output& output) {
  const std::string& unit = output.unit;
  if (unit == "rad") return fmt::format("{:.3g} deg", value * 180 / std::numbers::pi);
  return unit == "m" ? fmt::format("{:.3g} mm", 1e3 * value) : fmt::format("{:.3g} {}", value, unit);
}

/// The output that is furthest off, of what it goes: "most in blade.tip.deflection, 3.4 mm of 540 mm".
std::string worst_text(const AdviceReport& report, const study::Probe& p) {
  const study::Yardstick& yardstick = *report.advice.yardstick;
  const std::size_t i = yardstick.worst(p.distances);
  const study::Output& o = report.question.outputs.list()[i];
  return fmt::format("most in {}, {} of {}", o.label, quantity(p.distances[i], o),
                     quantity(yardstick.reference.ranges[i], o));
}

/// Outputs that hardly move, and what their ranges count as.
std::string floors_text(const AdviceReport& report) {
  const study::Reference& r = report.advice.yardstick->reference;
  std::string out;
  for (std::size_t i = 0; i < r.scales.size(); ++i) {
    if (!(r.ranges[i] < r.scales[i])) continue;
    const study::Output& o = report.question.outputs.list()[i];
    out += fmt::format("{}{} ({} counts as {})", out.empty() ? "" : ", ", o.label, quantity(r.ranges[i], o),
                       quantity(r.scales[i], o));
  }
  return out;
}

/// Each output once; of an output of the scene its components, where they are few.
std::string names_text(const study::Outputs& outputs) {
  constexpr std::ptrdiff_t few = 3;
  const std::vector<study::Output>& all = outputs.list();
  std::vector<std::string> names;
  for (const study::Output& output : all) {
    const auto same =
        std::count_if(all.begin(), all.end(), [&](const study::Output& o) { return o.name == output.name; });
    const std::string& name = output.measure == study::Measure::sensor && same <= few ? output.label : output.name;
    if (names.empty() || names.back() != name) names.push_back(name);
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

std::string milliseconds(double seconds) { return fmt::format("{:.3g} ms", 1e3 * seconds); }

/// The best that the probes with a property did: cheapest that passed, else the least wrong of those that went
/// furthest.
template <class Property>
const study::Probe* best_of(const std::vector<study::Probe>& probes, Property&& property) {
  const study::Probe* best = nullptr;
  for (const study::Probe& p : probes) {
    if (!property(p.point)) continue;
    if (best == nullptr || p.passed() != best->passed()) {
      if (best == nullptr || p.passed()) best = &p;
    } else if (p.passed()) {
      if (p.cost < best->cost) best = &p;
    } else if (std::pair(p.walk.time, -p.use) > std::pair(best->walk.time, -best->use)) {
      best = &p;
    }
  }
  return best;
}

/// How a probe fared beside the choice, as a clause.
std::string fared(const study::Advice& a, const study::Accuracy& accuracy, const study::Probe& p) {
  using Outcome = study::Probe::Outcome;
  const study::Probe& choice = *a.choice;
  const double end = choice.walk.time;
  switch (p.outcome) {
    case Outcome::passed:
      return fmt::format("holds it at {:.2g} times the cost, with {} and {}: {}", p.cost / choice.cost,
                         point_modes(p.point), integration_text(p.point), use_text(accuracy, p.use));
    case Outcome::inaccurate:
      return p.walk.time < end ? fmt::format("with {}, {} off when it was cut at {:.3g} of {:.3g} s",
                                             point_modes(p.point), use_text(accuracy, p.use), p.walk.time, end)
                               : fmt::format("with {}, {} off", point_modes(p.point), use_text(accuracy, p.use));
    case Outcome::too_costly:
      return fmt::format("with {} and {}, stopped when it had cost more than the choice", point_modes(p.point),
                         integration_text(p.point));
    case Outcome::no_candidate:
      return fmt::format("holds it with {} and {}, which is not among the candidates", point_modes(p.point),
                         integration_text(p.point));
    case Outcome::stopped:
      return fmt::format("with {}, stops at {:.3g} s: {}", point_modes(p.point), p.walk.time, p.reason);
    default:
      return p.reason;
  }
}

/// Lines of "what  text"; the first of several about one thing has its name.
class Lines {
 public:
  void add(const std::string& what, const std::string& text) {
    text_ += fmt::format("{:<12}{}\n", what == last_ ? "" : what, text);
    last_ = what;
  }
  [[nodiscard]] const std::string& str() const { return text_; }

 private:
  std::string text_, last_;
};

/// Why the choice: how the others fared, those above it too.
void add_reasons(Lines& lines, const AdviceReport& report) {
  const study::Advice& a = report.advice;
  const study::Point& choice = a.choice->point;
  std::vector<study::Probe> probes = a.probes;
  probes.insert(probes.end(), a.above.begin(), a.above.end());
  const auto add = [&](const std::string& what, const std::function<bool(const study::Point&)>& property) {
    const study::Probe* p = best_of(probes, property);
    if (p != nullptr) lines.add("why", what + ": " + fared(a, report.question.accuracy, *p));
  };
  if (!choice.bodies.empty())
    add(choice.formulation + " everywhere",
        [&](const study::Point& t) { return t.formulation == choice.formulation && t.bodies.empty(); });
  for (const std::string& f : report.candidates.formulations)
    if (f != choice.formulation) add(f, [&](const study::Point& t) { return t.formulation == f; });
  const auto own = [&](const study::Point& t) {
    return t.formulation == choice.formulation && t.family == choice.family;
  };
  // Of any family: another may do with fewer.
  add("fewer modes",
      [&](const study::Point& t) { return t.formulation == choice.formulation && t.modes < choice.modes; });
  for (const std::string& i : report.candidates.integrators)
    if (i != choice.integrator)
      add(i, [&](const study::Point& t) { return own(t) && t.modes == choice.modes && t.integrator == i; });
}

}  // namespace

std::string question_text(const AdviceQuestion& question) {
  // A share is of the output's own range, an angle or a length is not.
  study::Accuracy share, other = question.accuracy;
  std::swap(share.share, other.share);
  std::string asked = share.share ? share.text() + " of its own range" : "";
  if (other.angle || other.length) asked += (asked.empty() ? "" : " and ") + other.text();
  return fmt::format("{}: {} for each of {}", question.prepared.title(), asked, names_text(question.outputs));
}

std::string no_advice_text(const study::Advice& a, const AdviceQuestion& question) {
  const study::Accuracy& accuracy = question.accuracy;
  const std::string models = a.models == 0 ? "" : fmt::format(", {} of {} models", a.models_tried, a.models);
  const std::string measured =
      fmt::format(" Measured: {:.2g} s of CPU time of the {:.2g} allowed{}.", a.cpu_seconds, a.limit_seconds, models);
  const auto ended = [](std::string text) { return text.ends_with('.') ? text : text + '.'; };
  if (!a.trouble.empty()) return ended(a.trouble) + measured;
  const bool over = a.models_tried < a.models;
  std::string text =
      over ? "the time for the search was over before a model was found that holds " : "none of the candidates holds ";
  text += accuracy.text();
  if (!a.yardstick) return text + '.' + measured;
  text += fmt::format("; the reference ({}) is known to {}.", a.yardstick->reference.text(),
                      use_text(accuracy, a.yardstick->own_use()));
  const study::Probe *nearest = nullptr, *ended_early = nullptr;
  for (const study::Probe& p : a.probes)
    if (p.outcome == study::Probe::Outcome::stopped && p.use <= 1 && p.walk.end == study::Walk::End::reached)
      ended_early = &p;
  if (ended_early != nullptr)
    text += fmt::format(" {} holds it, but a run of the scene does not come to its end: {}", ended_early->point.text(),
                        ended(ended_early->reason));
  for (const study::Probe& p : a.probes)
    if (p.outcome == study::Probe::Outcome::inaccurate && p.walk.end == study::Walk::End::reached &&
        (nearest == nullptr || p.use < nearest->use))
      nearest = &p;
  if (nearest != nullptr)
    text += fmt::format(" Nearest: {}, {} off, most in {}{}.", nearest->point.text(), use_text(accuracy, nearest->use),
                        question.outputs.list()[a.yardstick->worst(nearest->distances)].label,
                        nearest->use > 1 ? "" : ", which may be too much together with what the reference is off");
  else
    text += " All were cut off when they were further off than that.";
  const bool modal = a.yardstick->reference.point.modes > 0;
  text += " What to do: ";
  if (over) text += study::more_time_text(a) + "; ";
  text += modal ? "allow more --modes; give a body that carries something modes made for that, as family: "
                  "{name: clamped-loaded, tip_mass: ...};"
                : "allow tighter --tolerances or a shorter time (--set time.end=...), since motions that "
                  "begin alike may part;";
  return text + " ask of --output no more than you need, or a coarser --accuracy." + measured;
}

std::string advice_text(const AdviceReport& report) {
  const study::Advice& a = report.advice;
  const study::Accuracy& accuracy = report.question.accuracy;
  const study::Probe& choice = *a.choice;
  Lines lines;
  lines.add("advice", fmt::format("{}, {}, {}", choice.point.formulation_text(), point_modes(choice.point),
                                  integration_text(choice.point)));
  lines.add("error", fmt::format("{}, {}; the reference itself is known to {}", use_text(accuracy, choice.use),
                                 worst_text(report, choice), use_text(accuracy, a.yardstick->own_use())));
  if (const std::string floors = floors_text(report); accuracy.share && !floors.empty())
    lines.add("hardly move", floors);
  lines.add("cost", fmt::format("{} of CPU time: {} steps, {} evaluations", milliseconds(choice.cost),
                                choice.walk.steps, choice.walk.evaluations));
  if (a.steps.product > 0) lines.add("steps", step_limit_text(a.steps));
  add_reasons(lines, report);
  lines.add("left out", report.left_out);
  if (const std::string limits = limits_text(a.indicators); !limits.empty())
    lines.add("limits", limits + (a.indicators.front().use() > 1 && a.yardstick->reference.third_order == 0
                                      ? ", which the error above has in it"
                                      : ""));
  for (const study::Probe& p : a.above)
    lines.add("next up",
              fmt::format("{}: {} off, {}", p.point.text(), use_text(accuracy, p.use), milliseconds(p.cost)));
  lines.add("measured", fmt::format("{} probes, {:.2g} s of CPU time of the {:.2g} allowed, against {}",
                                    a.probes.size(), a.cpu_seconds, a.limit_seconds, a.yardstick->reference.text()));
  if (!a.until.empty()) lines.add("measured", a.until);
  if (a.models_tried < a.models)
    lines.add("measured",
              fmt::format("{} of {} models before the time was over (--seconds gives more): there may be a cheaper one",
                          a.models_tried, a.models));
  return fmt::format("{}\n\n{}\nin the scene:\n\n{}", question_text(report.question), lines.str(),
                     scene_lines(report.changes));
}

}  // namespace withy
