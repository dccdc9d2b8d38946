/// \file
/// Why a configuration has no steady state, or no accelerations.
#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

#include "withy/core/plugin/foreign_law.hpp"
#include "withy/core/simulation/diagnosis.hpp"
#include "withy/study/at_limits.hpp"
#include "withy/study/configuration.hpp"

namespace withy::study {
namespace {

/// The first coordinate by which what acts has no finite derivative at a state; empty where there are all.
std::string without_derivative(const Configuration& c, const State& state) {
  const Eigen::MatrixXd by_position =
      c.dynamics().stiffness(state.time, state.y, c.dynamics().steady_accelerations(state.time)).by_position;
  for (const Eigen::Index s : free_speeds(c.held()))
    if (!by_position.col(s).allFinite()) return c.layout().speed_names[static_cast<std::size_t>(s)];
  return {};
}

}  // namespace

NotFinite not_finite(const Configuration& c, const State& state) {
  const Model& model = c.prepared().model();
  for (const LoadNode& load : model.loads()) {
    const auto* law = dynamic_cast<const ForeignLaw*>(load.load.get());
    if (law == nullptr) continue;
    const std::string words = law->failure(load.discrete(std::span(state.y)));
    if (!words.empty()) return {fmt::format("load '{}': {}", load.name, words), true};
  }
  return {describe_nonfinite(model, *c.prepared().equations, state, 0)};
}

Eigen::VectorXd accelerations_of(const Configuration& c) {
  try {
    return withy::accelerations(c.dynamics(), c.state(), c.held());
  } catch (const std::domain_error&) {
    if (const NotFinite found = not_finite(c, c.state()); !found.text.empty()) throw std::domain_error(found.text);
    throw;
  }
}

std::string no_steady_state(const Configuration& c, const SteadyState& steady) {
  if (steady.converged) return {};
  // What is left over is no number where a load gives none.
  if (const NotFinite found = not_finite(c, steady.state); !found.text.empty())
    return "no steady state was found: " + found.text;
  if (const std::string name = without_derivative(c, steady.state); !name.empty())
    return fmt::format(
        "no steady state was found: the derivative of what acts by {} is not finite there, as that of a root at zero; "
        "start from another state (--at)",
        name);
  std::string text = fmt::format("no steady state was found: after {} steps of Newton's method ", steady.iterations);
  std::size_t worst = 0;
  double left = 0;
  for (std::size_t s = 0; s < c.held().size(); ++s) {
    const double effort = std::abs(steady.efforts[static_cast<Eigen::Index>(s)]);
    if (c.held()[s] || !(effort > left)) continue;
    left = effort;
    worst = s;
  }
  std::vector<std::string> unsettled;
  if (left > 0) unsettled.push_back(fmt::format("{:.3g} are left over on {}", left, c.layout().speed_names[worst]));
  if (Eigen::Index state = 0; steady.rates.size() > 0) {
    const double rate = steady.rates.cwiseAbs().maxCoeff(&state);
    if (rate > 0)
      unsettled.push_back(fmt::format("{} changes by {:.3g} a second",
                                      c.layout().continuous_names[static_cast<std::size_t>(state)], rate));
  }
  if (Eigen::Index number = 0; steady.renewed.size() > 0) {
    const double change = steady.renewed.cwiseAbs().maxCoeff(&number);
    if (change > 0)
      unsettled.push_back(fmt::format("{} changes by {:.3g} with a sample",
                                      sampled_names(c.prepared().model())[static_cast<std::size_t>(number)], change));
  }
  text += unsettled.empty() ? "it has not settled" : fmt::format("{}", fmt::join(unsettled, ", and "));
  if (const std::vector<std::string> limited = at_limits(c, steady.state); !limited.empty()) {
    text += fmt::format(
        "; '{}' {} at a limit there: start from a state nearer to a steady one (--at), as the run.json of "
        "a run that settles",
        fmt::join(limited, "', '"), limited.size() > 1 ? "are" : "is");
  } else if (steady.neutral.size() > 0) {
    // Where most of the work is done.
    Eigen::VectorXd works = steady.neutral.cwiseProduct(steady.efforts).cwiseAbs();
    if (!(works.maxCoeff() > 0)) works = steady.neutral.cwiseAbs();
    Eigen::Index weakest = 0;
    works.maxCoeff(&weakest);
    text += fmt::format("; nothing holds {}: lock its hinge, give it a spring, or start from another state",
                        c.layout().speed_names[static_cast<std::size_t>(weakest)]);
  } else {
    text += "; start from a state nearer to one (--at), or approach the load in steps (withy modes --sweep)";
  }
  return text;
}

}  // namespace withy::study
