/// \file
/// The cheapest model and integration that hold an accuracy: probes, cheapest first, against a converged reference.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "withy/study/accuracy.hpp"
#include "withy/study/candidates.hpp"
#include "withy/study/indicators.hpp"
#include "withy/study/probe.hpp"
#include "withy/study/step_limit.hpp"

namespace withy::study {

/// What is advised, with the run that confirmed it and what was measured beside it.
struct Advice {
  std::optional<Yardstick> yardstick;  ///< none where no reference is exact enough
  std::string trouble;                 ///< why there is none
  std::optional<Reference> nearest;    ///< then the finest there is, if any
  std::vector<Probe> probes;           ///< in their order
  std::optional<Probe> choice;         ///< none where no candidate holds the accuracy
  std::vector<Probe> above;            ///< one step above the choice: a formulation that neglects less, a mode more
  RunSummary confirmed;                ///< the choice, run as a scene that says so is
  StepLimit steps;                     ///< of that run
  std::vector<Indicator> indicators;   ///< the same
  double cpu_seconds = 0;              ///< of the search
  double limit_seconds = 0;  ///< what it may cost: 20 runs of the scene in `quadratic`, or 10 s if that is more
  std::size_t models = 0, models_tried = 0;  ///< of the candidates; fewer tried: the time was over
  bool interrupted = false;                  ///< the user ended the search: there is no advice
};

/// Searches the candidates. Nothing is chosen that does not complete a run as a scene that says so would, and nothing
/// is "above" that does not hold the accuracy. \throws InputError where the scene has loads that switch by the state.
Advice advise(Evaluator& evaluator, const Candidates& candidates, const Accuracy& accuracy);

/// What the choice changes in the scene that it does not say already, formulation and integrator first.
std::vector<Change> new_changes(const Scene& scene, const Point& choice, Registry& registry);

}  // namespace withy::study
