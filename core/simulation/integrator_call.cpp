#include "withy/core/simulation/integrator_call.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <stdexcept>

#include "withy/core/plugin/plugin_call.hpp"
#include "withy/core/simulation/diagnosis.hpp"

namespace withy {
namespace {

/// A limit is asked for only where a run has ended badly, and would fail there.
void check_stability(const Integrator& integrator, const std::string& who) {
  const std::optional<double> limit =
      plugin_call(who + " does not say how long its steps may be", [&] { return integrator.stability_limit(); });
  if (!limit || *limit > 0) return;
  throw std::invalid_argument(who + " says that it is stable to h ω = " + brief(*limit) +
                              "; need a positive number, infinity, or nothing where it is not known");
}

void check_order(const Integrator& integrator, const std::string& who) {
  const int order = plugin_call(who + " does not say its order", [&] { return integrator.order(); });
  if (order < 1)
    throw std::invalid_argument(who + " says that it is of order " + std::to_string(order) + "; need at least 1");
}

/// The shortest text that is this number and no other.
std::string all_digits(double x) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, x).ptr};
}

}  // namespace

std::unique_ptr<Stepper> start_stepper(const Integrator& integrator, const EquationsOfMotion& equations,
                                       const State& state, const std::string& who) {
  check_order(integrator, who);
  check_stability(integrator, who);
  std::unique_ptr<Stepper> stepper =
      plugin_call(who + " cannot begin", [&] { return integrator.start(equations, state); });
  if (stepper == nullptr) throw std::invalid_argument(who + " cannot begin and does not say why");
  const State& begun = stepper->state();
  if (begun.y.size() != state.y.size() || begun.time != state.time)
    throw std::invalid_argument(
        who + " begins at another state: t = " + all_digits(begun.time) + " s and " + std::to_string(begun.y.size()) +
        " numbers, where it was given t = " + all_digits(state.time) + " s and " + std::to_string(state.y.size()));
  return stepper;
}

std::string false_end(double from, double limit, double to) {
  return "says of a step that it is done, which began at " + all_digits(from) + " s, was to end at " +
         all_digits(limit) + " s at the latest, and ended at " + all_digits(to) + " s" +
         (to > limit ? ", " + brief(to - limit) + " s too late" : "") + ": no result can be trusted";
}

std::string false_jump(const State& sent, const State& here) {
  const auto close = [](double a, double b) {
    constexpr double normalized = 1e-6;
    return a == b || std::abs(a - b) <= normalized * (1 + std::abs(b)) || (std::isnan(a) && std::isnan(b));
  };
  const auto [is, was] = std::mismatch(here.y.begin(), here.y.end(), sent.y.begin(), sent.y.end(), close);
  const bool same_numbers = is == here.y.end() && was == sent.y.end();
  if (same_numbers && here.time == sent.time) return {};
  const std::string sent_to =
      "does not go to another state: it was sent to one at " + all_digits(sent.time) + " s and is in another, ";
  if (here.time != sent.time) return sent_to + "at " + all_digits(here.time) + " s";
  if (is == here.y.end() || was == sent.y.end())
    return sent_to + "of " + std::to_string(here.y.size()) + " numbers and not " + std::to_string(sent.y.size());
  return sent_to + "where number " + std::to_string(is - here.y.begin() + 1) + " of " + std::to_string(here.y.size()) +
         " is " + all_digits(*is) + " and not " + all_digits(*was);
}

void interpolate_step(const Stepper& stepper, double t, std::span<double> y) {
  plugin_call<IntegratorError>("does not interpolate within its steps", [&] { stepper.interpolate(t, y); });
}

std::vector<std::string> remarks_of(const Stepper& stepper) {
  return plugin_call<IntegratorError>("does not say how it has integrated", [&] { return stepper.remarks(); });
}

}  // namespace withy
