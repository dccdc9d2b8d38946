/// \file
/// One case: its scene made, run, and what is kept of it.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "withy/campaign/cases.hpp"
#include "withy/campaign/kept.hpp"
#include "withy/scene/scene_parts.hpp"
#include "withy/study/control.hpp"

namespace withy::campaign {

struct CaseResult {
  std::uint64_t index = 0;
  std::string status;           ///< of the run; "refused" where the values make no scene or no equations
  std::string message;          ///< why it is not "completed"
  CaseValues values;            ///< as Cases::values
  std::vector<double> numbers;  ///< as kept_columns; none where it is not completed, not finite where one is none
  double seconds = 0;           ///< CPU time, which differs from run to run
  [[nodiscard]] bool completed() const { return status == "completed"; }
};

/// What the cases of one thread have in common. The plan must outlive it.
struct CaseParts {
  explicit CaseParts(const Plan& plan) : kept(kept_places(plan)) { values.reserve(most_at_once); }
  static constexpr std::size_t most_at_once = 16;  ///< cases
  SceneParts scene;
  KeptPlaces kept;                  ///< of the plan
  std::vector<SceneValues> values;  ///< of cases that are over, for Cases::scene; no more than are reserved
};

/// A case on its way.
class CaseRun {
 public:
  /// Makes its scene and its equations; where they cannot be had, that is its result. All that it is given must outlive
  /// it. \throws PluginError; what a plugin throws, as does the other.
  /// \param parts what the cases before it have in common with it
  CaseRun(const Plan& plan, const Cases& cases, std::uint64_t index, Registry& registry, CaseParts& parts);
  ~CaseRun();
  CaseRun(const CaseRun&) = delete;
  CaseRun& operator=(const CaseRun&) = delete;

  /// Null where it has its result already.
  [[nodiscard]] const EquationsOfMotion* equations() const { return prepared_ ? prepared_->equations.get() : nullptr; }
  /// Why it is evaluated by itself; empty where its equations have lanes and its integrator spends its time in them.
  [[nodiscard]] std::string alone_because() const;
  /// Runs it, with its own equations or with others of the same model.
  void run(const EquationsOfMotion& equations, const study::Control& control);
  /// Status "interrupted" is no result.
  [[nodiscard]] CaseResult& result() { return result_; }

 private:
  template <class Action>
  void refusing(Action&& action);
  RunSummary simulate(const EquationsOfMotion& equations, const study::Control& control);

  const Plan& plan_;
  const Cases& cases_;
  Registry& registry_;
  CaseParts& parts_;
  std::optional<study::Prepared> prepared_;
  std::optional<KeptNumbers> kept_;
  std::vector<OutputStatistics> statistics_;  ///< of what `kept_` watches
  CaseResult result_;
};

}  // namespace withy::campaign
