/// \file
/// What a run of formulation `auto` and its coarse run have in common.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "withy/core/plugin/memory.hpp"
#include "withy/core/simulation/changing_equations.hpp"
#include "withy/study/output_reader.hpp"
#include "withy/study/rung_plan.hpp"
#include "withy/study/sensitive_motion.hpp"

namespace withy::study {

/// What looks at a run's outputs beside who asked for it, and is taken up with its checkpoints.
class Looking {
 public:
  virtual ~Looking() = default;
  virtual void look(const State& state) = 0;
  virtual void remember(Memory& memory) = 0;
};

/// How far the run is from the coarse one that its formulations were chosen by.
class Agreement final : public Looking {
 public:
  /// All must outlive it.
  Agreement(const Prepared& prepared, const ChangingEquations& equations, const RungPlan& plan);
  void look(const State& state) override;
  void remember(Memory& memory) override;
  /// The greatest part of an output's range.
  [[nodiscard]] double apart() const;
  /// What the run was at the times of the plan's readings; empty where it was not looked at.
  [[nodiscard]] const std::vector<std::vector<double>>& own() const { return own_; }
  /// Where the motion itself is another, so are its errors: that, in a sentence.
  [[nodiscard]] std::string text() const;

 private:
  const RungPlan& plan_;
  const ChangingEquations& equations_;
  std::optional<Outputs> outputs_;
  std::vector<std::unique_ptr<OutputReader>> readers_;
  std::size_t next_ = 0;
  Distances apart_;
  std::vector<std::vector<double>> own_;
};

/// Of a run that is in one rung throughout, and has no error against it: how it agrees with others of its equations.
/// It need not with the coarse one, whose steps are longer. \throws InputError where an integrator is missing
OtherRuns others_of(const Prepared& prepared, Registry& registry, const Control& control, const Agreement& agreement,
                    const RunSummary& summary, RungPlan& plan);

/// What there is to say of the error of such a run.
std::string without_difference(const Prepared& prepared, const RungPlan& plan, const RunSummary& summary);

}  // namespace withy::study
