/// \file
/// The certificate of a run: what was modelled, what was left out and how large that was, what binds.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "withy/apps/withy/beyond.hpp"
#include "withy/apps/withy/comparison.hpp"
#include "withy/core/simulation/accuracy.hpp"

namespace withy::app {

/// The error of a run's hinges and tips against the next model up, by integrating both coarsely with common steps.
struct ErrorEstimate {
  Distances distances;
  double cpu_seconds = 0;
  double end = 0;  ///< time the run reached [s]; distances.until is less where the evaluations allowed were spent
};

/// Estimates it for the time that the run went, with no more evaluations of the pair than the run had of its own.
/// \param used the equations of the run, from its start to its end
ErrorEstimate estimate_error(const Engine& engine, const EquationsOfMotion& used, const Beyond& beyond,
                             const RunSummary& summary);

/// How an indicator of validity stands against its limit (theory, section 5).
struct Indicator {
  std::string text;  ///< "tip deflection of 'link2' over its length"
  double value = 0;
  double limit = 0;
  std::string meaning;  ///< what happens past the limit
  [[nodiscard]] double use() const { return value / limit; }
};
/// Those that matter to the scene's formulation, the one nearest to its limit (or furthest past it) first.
/// \param used what the run kept in the end, where that is not what the scene's formulation says
std::vector<Indicator> indicators(const Scene& scene, const RunSummary& summary, std::optional<Terms> used = {});

/// What limited the steps of a run.
struct StepLimit {
  double mean = 0;     ///< [s]
  double fastest = 0;  ///< fastest mode [rad/s]
  double product = 0;  ///< mean step times the fastest mode; 0 where that is not known
  std::optional<double> limit;
  /// What helps against stability: the mode without which the fastest vibration is slowest, and the integrators of
  /// those there are that no vibration limits and that can integrate these equations. Empty where nothing is proposed.
  std::optional<Slowing> fewer;
  std::vector<std::string> unlimited;
  /// "stability", "accuracy" or "unknown". Error control that meets the limit goes to and fro about it, so the mean
  /// stays a little below.
  [[nodiscard]] std::string cause() const;
};
/// Of a run from a time `start` [s], without proposals.
StepLimit step_limit(const Integrator& integrator, double start, const RunSummary& summary);
/// Of the engine's own run; where stability limited it, with proposals.
StepLimit step_limit(const Engine& engine, const RunSummary& summary);
/// "limited by accuracy: mean step times fastest mode 0.11, stable to 1.73".
std::string step_limit_text(const StepLimit& s);

/// What the certificate is made from beside the run itself; null: not there.
struct Evidence {
  const Beyond* beyond = nullptr;
  const ErrorEstimate* estimate = nullptr;
  const EscalatedRun* escalated = nullptr;
};
nlohmann::ordered_json certificate_json(const Engine& engine, const RunSummary& summary, const Evidence& evidence);
/// The same in plain words, ending its last line.
std::string certificate_text(const Engine& engine, const RunSummary& summary, const Evidence& evidence);

}  // namespace withy::app
