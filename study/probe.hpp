/// \file
/// Probes: runs of a scene in another model, measured against a reference while they go and ended as soon as it is
/// clear that they will not do.
#pragma once

#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "withy/study/reference.hpp"

namespace withy::study {

/// A reference, and how far from it runs may be.
struct Yardstick {
  Reference reference;
  Distances limits;  ///< infinite where nothing is asked
  /// Greatest share of what is allowed.
  [[nodiscard]] double use(const Distances& distances) const;
  /// The same with what the reference itself may be off by on top, output by output: up to 1 the accuracy is held.
  [[nodiscard]] double use_with_own(const Distances& distances) const;
  /// Index of the output of which `use` is so.
  [[nodiscard]] std::size_t worst(const Distances& distances) const;
  /// That of the reference itself.
  [[nodiscard]] double own_use() const { return use(reference.own); }
};

struct Probe {
  enum class Outcome {
    passed,
    inaccurate,
    too_costly,
    stopped,       ///< it does not come to the end
    refused,       ///< there is no such model
    no_candidate,  ///< it holds the accuracy, but was run to know the model alone
    interrupted
  };
  Point point;
  Outcome outcome = Outcome::refused;
  std::string reason;   ///< of `stopped` and `refused`
  Distances distances;  ///< greatest ones from the reference up to the time reached; empty where refused
  double use = 0;       ///< of the accuracy; the reference's own error comes on top
  Walk walk;
  double cost = 0;  ///< [s], by Evaluator::cost when the search had ended
  [[nodiscard]] bool passed() const { return outcome == Outcome::passed; }
};
/// "passed", "inaccurate", "too-costly", "stopped", "refused", "no-candidate", "interrupted".
const char* outcome_name(Probe::Outcome outcome);

/// What a probe may use up before it is cut.
struct Allowance {
  double use = std::numeric_limits<double>::infinity();      ///< of the accuracy
  double seconds = std::numeric_limits<double>::infinity();  ///< of CPU time
};

/// Makes the models of one scene, runs probes of them and knows what they cost.
class Evaluator {
 public:
  /// All must outlive it. \throws SceneError as check_loads
  Evaluator(const Prepared& base, Registry& registry, const Outputs& outputs, Control control);

  [[nodiscard]] const Prepared& base() const { return base_; }
  [[nodiscard]] Registry& registry() const { return registry_; }
  [[nodiscard]] const Outputs& outputs() const { return outputs_; }
  [[nodiscard]] const Control& control() const { return control_; }
  /// Ends all runs of the scene there [s], and not at its own end. To be said before any model is made.
  void end_at(double time) { end_ = time; }
  /// Of all runs [s].
  [[nodiscard]] double end() const { return end_ ? *end_ : end_of_run(base_.scene); }
  /// Made once, kept as long as this.
  const ModelAt& model(const Point& point);
  /// Runs the point until its allowance is used up. It passes where error and the reference's own together keep within
  /// the accuracy.
  Probe run(const Point& point, const Yardstick& yardstick, const Allowance& allowance = {});
  /// What a run that was made while a reference was looked for is as a probe.
  Probe judge(const Reference& run, const Yardstick& yardstick);
  /// Evaluations times their least CPU time in runs of the same point that came to their end [s]: what a run costs
  /// without the noise of other work on the machine. Runs that are cut early are timed too briefly, and at a tighter
  /// tolerance an evaluation has less of the outputs to bear. \param probe that came to its end
  [[nodiscard]] double cost(const Probe& probe) const;
  /// CPU time since this was made [s], of the thread that made it.
  [[nodiscard]] double spent() const;
  /// Runs are cut where that passes the limit, as too costly. Without one, never.
  void limit(double seconds) { limit_ = seconds; }
  [[nodiscard]] double limit() const { return limit_; }
  [[nodiscard]] bool out_of_time() const { return spent() > limit_; }

 private:
  void note_cost(const Probe& probe);

  const Prepared& base_;
  Registry& registry_;
  const Outputs& outputs_;
  Control control_;
  std::vector<std::unique_ptr<ModelAt>> models_;
  std::map<std::string, double> unit_costs_;  ///< by point [s an evaluation]
  double began_;
  double limit_ = std::numeric_limits<double>::infinity();
  std::optional<double> end_;
};

}  // namespace withy::study
