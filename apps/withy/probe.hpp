/// \file
/// Probes: runs of a scene in another model, measured against a reference while they go and ended as soon as it is
/// clear that they will not do.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "withy/apps/withy/engine.hpp"
#include "withy/apps/withy/measures.hpp"
#include "withy/apps/withy/trade_plan.hpp"

namespace withy::app {

/// A scene in one formulation, but for the bodies that the point names, with a number of modes of a family.
struct ProbedModel {
  TradePoint point;  ///< its integrator and tolerance mean nothing
  Scene scene;
  std::unique_ptr<EquationsOfMotion> equations;
  double fastest = 0;   ///< greatest √ of the eigenvalues of M⁻¹K at the start [rad/s]; 0: not known
  double seconds = 0;   ///< CPU time of an evaluation [s], the least of some batches
  std::string refusal;  ///< why there is no such model; empty: there is
  [[nodiscard]] bool refused() const { return equations == nullptr; }
};
/// The overrides with which the scene becomes the point's, formulations of single bodies replaced.
std::vector<std::string> overrides_at(const SceneArguments& base, const Scene& scene, const TradePoint& point);
/// \throws PluginError
ProbedModel probed_model(const Engine& engine, const SceneArguments& base, const TradePoint& point);

/// What stepping through a scene gave.
struct Walk {
  enum class End { reached, cut, stopped, interrupted };
  End end = End::reached;
  std::string reason;  ///< of `stopped`
  double time = 0;     ///< reached [s]
  std::size_t steps = 0, evaluations = 0;
  double seconds = 0;  ///< CPU time of stepping alone
};
/// Steps from the scene's initial state to its end as a run does of a scene without switching functions and events.
/// `output` gets the state at each output and says whether to go on; `afford` is asked at the same times and says
/// whether the cost so far may be spent. \throws std::invalid_argument where the integrator cannot treat the equations.
Walk walk(const ProbedModel& model, const Integrator& integrator, const std::function<bool(const State&)>& output,
          const std::function<bool(const Walk&)>& afford = {});
/// The point's integrator, its absolute tolerance a hundredth of the relative one.
std::unique_ptr<Integrator> integrator_at(Registry& registry, const TradePoint& point);

/// A run whose outputs are the truth, and how true they are.
struct Reference {
  TradePoint point;
  std::vector<std::vector<double>> values;  ///< one reading an output
  PerMeasure ways{};                        ///< greatest distances from the start
  PerMeasure limits{};                      ///< greatest distances that the accuracy allows
  PerMeasure own{};                         ///< distances of a coarser run: fewer modes, looser tolerance
  Walk walk;
  /// Greatest share of what is allowed.
  [[nodiscard]] double use(const PerMeasure& distances) const;
  [[nodiscard]] double own_use() const { return use(own); }
};

struct Probe {
  enum class Outcome { passed, inaccurate, too_costly, stopped, refused, interrupted };
  TradePoint point;
  Outcome outcome = Outcome::refused;
  std::string reason;      ///< of `stopped` and `refused`
  PerMeasure distances{};  ///< greatest ones from the reference up to the time reached
  double use = 0;          ///< of the accuracy; the reference's own error comes on top
  Walk walk;
  [[nodiscard]] bool passed() const { return outcome == Outcome::passed; }
};
/// "passed", "inaccurate", "too-costly", "stopped", "refused", "interrupted".
const char* outcome_name(Probe::Outcome outcome);

/// Runs the point until its error passes `most_use` of the accuracy or its CPU time `most_seconds`. It passes where
/// error and the reference's own together keep within the accuracy.
Probe probe(const Engine& engine, const ProbedModel& model, const TradePoint& point, const MeasuredOutputs& outputs,
            const Reference& reference, double most_use, double most_seconds);

}  // namespace withy::app
