/// \file
/// What error a tolerance asked for gives: every formulation with every integrator, from 1e-3 to 1e-11.
#include <algorithm>
#include <cmath>

#include "campaign.hpp"
#include "withy/tests/conformance/integrator_problems.hpp"

namespace withy::extremes {
namespace {

constexpr std::size_t looks = 10;
constexpr double end = 0.5;

/// States at tenths of the way, on which the steps land; fewer where the run fails.
std::vector<std::vector<double>> states(const Made& made, const std::string& options) {
  const auto stepper = integrator(options)->start(*made.equations, made.scene.initial);
  std::vector<std::vector<double>> found;
  for (std::size_t i = 1; i <= looks; ++i) {
    const double limit = end * static_cast<double>(i) / looks;
    if (drive(*stepper, limit, 100'000'000).outcome != StepResult::Outcome::ok) break;
    found.push_back(stepper->state().y);
  }
  return found;
}

/// Greatest error of a coordinate or speed over what the tolerance weighs it with, 1 + |y|.
double error_of(const std::vector<std::vector<double>>& run, const std::vector<std::vector<double>>& reference) {
  if (run.size() < looks || reference.size() < looks) return std::nan("");
  double worst = 0;
  for (std::size_t k = 0; k < looks; ++k) {
    for (std::size_t i = 0; i + 1 < run[k].size(); ++i) {
      const double e = std::abs(run[k][i] - reference[k][i]) / (1 + std::abs(reference[k][i]));
      if (!(e <= worst)) worst = e;
    }
  }
  return worst;
}

/// Slope of the straight line through (log tolerance, log error), least squares.
double slope_of(const std::vector<double>& tolerances, const std::vector<double>& errors) {
  double x = 0, y = 0, xx = 0, xy = 0;
  const auto n = static_cast<double>(errors.size());
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const double a = std::log10(tolerances[i]), b = std::log10(errors[i]);
    x += a, y += b, xx += a * a, xy += a * b;
  }
  return (n * xy - x * y) / (n * xx - x * x);
}

}  // namespace

void work_precision(Campaign& campaign) {
  const int last = campaign.quick() ? 8 : 11;
  std::vector<std::pair<std::string, std::string>> methods;  // ids, and what else is asked for
  for (const std::string& id : ids<Integrator>()) {
    methods.emplace_back(id, "");
    if (id == "cvode") methods.emplace_back(id, ", method: adams");
  }
  for (const auto& [id, more] : methods) {
    const bool asked = !with_tolerance(id, 1e-3).empty();
    const auto options = [&, &id = id, &more = more](double tolerance) {
      std::string text = with_tolerance(id, tolerance);
      return text.insert(text.size() - 1, more);
    };
    double least = 10, most = -10, ratio = 0;
    std::string off, back, refused, over;
    int compared = 0;
    for (const std::string& formulation : ids<Formulation>()) {
      if (campaign.quick() && formulation != "quadratic") continue;
      // Of moderate deflection, so that no formulation leaves what it is made for.
      const Made made(pendulum, formulation,
                      {"bodies.arm.bending_y.modes=1", "initial.bodies.arm.modes=[0.01]", "bodies.bob.mass=0.1",
                       "bodies.bob.inertia=[0.001, 0.001, 0.001, 0, 0, 0]"});
      const auto reference = states(made, with_tolerance("dop853", 1e-14));
      const int order = integrator(asked ? options(1e-3) : equal_steps(id, 0.1))->order();
      std::vector<double> tolerances, errors;
      double greatest = 0;
      bool monotone = true;
      try {
        for (int k = 3; k <= last; ++k) {
          const double tolerance = std::pow(10.0, -k);
          // Without error control: steps whose error, of the method's order, is the tolerance times the same number.
          const double step = 0.02 * std::pow(10.0, -(k - 3.0) / order);
          const double e = error_of(states(made, asked ? options(tolerance) : equal_steps(id, step)), reference);
          monotone = monotone && (errors.empty() || e < errors.back() || e < 1e-13);
          tolerances.push_back(tolerance);
          errors.push_back(e);
          if (!(e / tolerance <= greatest)) greatest = e / tolerance;
        }
      } catch (const std::invalid_argument&) {
        refused += formulation + " ";  // the integrator says that it cannot treat this formulation
        continue;
      }
      ++compared;
      const double slope = slope_of(tolerances, errors);
      least = std::min(least, slope);
      most = std::max(most, slope);
      if (!(greatest <= ratio)) ratio = greatest;
      if (!(std::abs(slope - 1) <= 0.2)) off += fmt::format("; {} {:.2f}", formulation, slope);
      if (!monotone) back += " " + formulation;
      if (asked && !(greatest <= 10)) over += fmt::format("; {} {:.3g}", formulation, greatest);
    }
    const std::string range = fmt::format("{}{}, {} formulations, {} 1e-3 … 1e-{}{}", id, more, compared,
                                          asked ? "tolerance" : fmt::format("step to the order,"), last,
                                          refused.empty() ? "" : ", refused by " + refused);
    campaign.row(range + ": slope of log error", "dop853 at 1e-14", "1 ± 0.2, error falls each time",
                 fmt::format("{:.2f} to {:.2f}{}{}", least, most, off, back.empty() ? "" : "; not each time:" + back),
                 compared > 0 && off.empty() && back.empty());
    if (asked)
      campaign.row(id + more + ": error over tolerance", "dop853 at 1e-14", "≤ 10",
                   fmt::format("at most {:.3g}{}", ratio, over), compared > 0 && over.empty());
  }
}

}  // namespace withy::extremes
