/// \file
/// Whether a tolerance means the same in every integrator, on problems that set none of their constants: the test set
/// of Hull, Enright, Fellen and Sedgwick, and three of our scenes.
#include "detest.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "campaign.hpp"
#include "withy/tests/conformance/integrator_problems.hpp"

namespace withy::extremes {
namespace {

constexpr int instants_compared = 4;  ///< instants at which a run is compared, on which its steps land

using States = std::vector<std::vector<double>>;

struct Problem {
  std::string name;
  const EquationsOfMotion* equations;
  State start;
  double end;
  States reference;
};

/// What the problems point to.
struct ProblemSet {
  std::vector<std::unique_ptr<FunctionEquations>> functions;
  std::vector<std::unique_ptr<Made>> scenes;
  std::vector<Problem> problems;
};

States run(const Problem& p, const std::string& options) {
  const auto stepper = integrator(options)->start(*p.equations, p.start);
  States found;
  for (int i = 1; i <= instants_compared; ++i) {
    if (drive(*stepper, p.start.time + p.end * i / instants_compared, 3'000'000).outcome != StepResult::Outcome::ok)
      break;
    found.push_back(stepper->state().y);
  }
  return found;
}

/// Greatest error of a coordinate or speed over what the tolerance weighs it with, 1 + |y|; NaN where the run fails.
double distance_of(const States& found, const States& reference) {
  if (found.size() < instants_compared) return std::nan("");
  double worst = 0;
  for (std::size_t k = 0; k < instants_compared; ++k) {
    for (std::size_t i = 0; i + 1 < found[k].size(); ++i) {
      const double e = std::abs(found[k][i] - reference[k][i]) / (1 + std::abs(reference[k][i]));
      if (!(e <= worst)) worst = e;
    }
  }
  return worst;
}

void add_detest(ProblemSet& set) {
  for (const DetestProblem& d : detest_problems()) {
    set.functions.push_back(std::make_unique<FunctionEquations>(d.equations()));
    Problem p{d.name, set.functions.back().get(), d.state(), DetestProblem::end,
              detest_reference(d, instants_compared, 4000)};
    for (std::vector<double>& y : p.reference) y.push_back(0);
    set.problems.push_back(std::move(p));
  }
}

/// The first second or two of scenes, from where nothing is symmetric.
void add_scenes(ProblemSet& set) {
  const std::vector<std::pair<std::string, double>> scenes = {
      {"two-link-slew", 1.0}, {"spin-up", 4.0}, {"pd-arm", 1.0}};
  for (const auto& [name, end] : scenes) {
    set.scenes.push_back(std::make_unique<Made>(scene_text(name), "quadratic"));
    const Made& made = *set.scenes.back();
    Problem p{name, made.equations.get(), made.scene.initial, end, {}};
    p.reference = run(p, with_tolerance("dop853", 1e-13));
    set.problems.push_back(std::move(p));
  }
}

double median(std::vector<double> values) {
  if (values.empty()) return std::nan("");
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

/// Achieved over asked, of each problem that a method can treat.
using Ratios = std::map<std::string, double>;

Ratios ratios_of(const ProblemSet& set, const std::string& id, const std::string& more, double tolerance) {
  Ratios found;
  for (const Problem& p : set.problems) {
    // Methods for second-order equations have no others.
    if (id == "generalized-alpha" && p.equations->layout().speeds == 0) continue;
    std::string options = with_tolerance(id, tolerance);
    options.insert(options.size() - 1, more);
    found[p.name] = distance_of(run(p, options), p.reference) / tolerance;
  }
  return found;
}

}  // namespace

void detest(Campaign& campaign) {
  ProblemSet set;
  add_detest(set);
  if (!campaign.quick()) add_scenes(set);
  std::vector<std::pair<std::string, std::string>> methods;
  for (const std::string& id : ids<Integrator>()) {
    if (with_tolerance(id, 1e-3).empty()) continue;
    methods.emplace_back(id, "");
    if (id == "cvode") methods.emplace_back(id, ", method: adams");
  }
  const std::vector<int> digits = campaign.quick() ? std::vector<int>{4} : std::vector<int>{3, 6, 9};
  for (const int digit : digits) {
    const double tolerance = std::pow(10.0, -digit);
    std::map<std::string, Ratios> all;
    std::map<std::string, std::vector<double>> by_problem;
    for (const auto& [id, more] : methods) {
      all[id + more] = ratios_of(set, id, more, tolerance);
      for (const auto& [name, ratio] : all[id + more]) by_problem[name].push_back(ratio);
    }
    for (const auto& [method, ratios] : all) {
      // What a problem makes of errors is its own: what a method makes of the problem shows beside the others.
      std::vector<double> values;
      std::string over;
      double greatest = 0, most = 0;
      std::size_t beyond = 0;
      for (const auto& [name, ratio] : ratios) {
        const double beside = ratio / std::max(1.0, median(by_problem[name]));
        values.push_back(ratio);
        if (!(ratio <= greatest)) greatest = ratio;
        if (!(beside <= most)) most = beside;
        if (beside <= 10) continue;
        ++beyond;
        over += fmt::format("; {} {:.3g}", name, beside);
      }
      const double middle = median(values);
      campaign.row(fmt::format("{}, tolerance 1e-{}, {} problems: achieved over asked", method, digit, ratios.size()),
                   "extrapolation to order 16 in 64 bits; dop853 at 1e-13",
                   "median 0.05 to 2; all but three ≤ 10 × the integrators' median or 10",
                   fmt::format("median {:.2g}, greatest {:.2g}; beside the others at most {:.2g}{}", middle, greatest,
                               most, over),
                   middle >= 0.05 && middle <= 2 && beyond <= 3);
    }
  }
}

}  // namespace withy::extremes
