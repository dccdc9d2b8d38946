/// \file
/// The cheapest model and integration that hold an accuracy: probes, cheapest first, against a converged reference.
#pragma once

#include <functional>
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
  /// Where an event ends the run of the scene before its time, which and when, in a sentence without its full stop:
  /// everything is measured up to there. Else empty.
  std::string until;
  std::vector<Probe> probes;          ///< in their order
  std::optional<Probe> choice;        ///< none where no candidate holds the accuracy
  std::vector<Probe> above;           ///< one step above the choice: a formulation that neglects less, a mode more
  RunSummary confirmed;               ///< the choice, run as a scene that says so is
  StepLimit steps;                    ///< of that run
  std::vector<Indicator> indicators;  ///< the same
  double cpu_seconds = 0;             ///< of the search
  double limit_seconds = 0;           ///< what it may cost
  std::size_t models = 0, models_tried = 0;  ///< of the candidates; fewer tried: the time was over
  bool interrupted = false;                  ///< the user ended the search: there is no advice
};

/// Told while a search goes on, a sentence without its full stop: what it may cost, how exact the reference is by now,
/// which model is the cheapest of those that hold the accuracy so far, and of each formulation how far the first of its
/// models that does not is off. None of it is advice: what comes later may be cheaper, and may be found out to fail.
using Finding = std::function<void(const std::string&)>;

/// Searches the candidates. Nothing is chosen that does not complete a run as a scene that says so would, and nothing
/// is "above" that does not hold the accuracy. \throws InputError where the scene has loads that switch by the state.
/// \param finding may be empty
/// \param seconds of CPU time that the search may cost; nothing: 20 runs of the scene in `quadratic`, or 10 s if that
/// is more \throws OptionError of "seconds" where these are not above 0
Advice advise(Evaluator& evaluator, const Candidates& candidates, const Accuracy& accuracy, const Finding& finding = {},
              std::optional<double> seconds = {});

/// What to do where the time was over: "give the search more time (--seconds 30)".
std::string more_time_text(const Advice& advice);

/// What the choice changes in the scene that it does not say already, formulation and integrator first.
std::vector<Change> new_changes(const Scene& scene, const Point& choice, Registry& registry);

}  // namespace withy::study
