/// \file
/// Errors of natural frequencies about steady states, as a value of the scene changes.
#pragma once

#include <Eigen/Core>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "withy/apps/withy/modes_report.hpp"
#include "withy/apps/withy/trade_plan.hpp"

namespace withy::study {

/// Frequencies of models of one scene against a reference: `exact` where every flexible body offers it, else
/// `quadratic`, with one mode more than any model. A mode bears the name of a coordinate: it is the one of whose
/// |δ_i|² M_ii this coordinate has the greatest share.
class FrequencyStudy {
 public:
  /// \param sweep a path of the scene, or `spin.hinge`: the hinge is held at that rate.
  /// \throws InputError, SceneError, PluginError
  FrequencyStudy(const TradeArguments& arguments, const std::vector<TradePoint>& points, Sweep sweep);

  /// The lowest modes of the reference, none of them rigid, named after what dominates them at the sweep's second value
  /// (at its first a symmetry of the scene at rest may mix them).
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  /// |ω / ω of the reference − 1|; infinite where the model has no steady state, or the mode grows.
  /// \throws InputError where the reference has no such frequency.
  double error(const TradePoint& point, const std::string& name, double value);
  /// Of the reference [rad/s].
  double reference_frequency(const std::string& name, double value);
  /// Formulation, modes, and the greatest error of the named frequencies with one mode less, at the sweep's ends.
  nlohmann::ordered_json reference_json();

 private:
  struct Found {
    ModesAt at;
    Eigen::VectorXd masses;  ///< M_ii, one a speed
  };
  [[nodiscard]] Found find(const TradePoint& point, double value) const;
  [[nodiscard]] static std::optional<double> frequency(const Found& found, const std::string& name);
  const Found& reference(double value);

  const TradeArguments& arguments_;
  Engine engine_;
  Sweep sweep_;
  TradePoint reference_;
  std::map<double, Found> references_;
  std::map<std::pair<std::string, double>, Found> found_;  ///< of points, by their text and value
  std::vector<std::string> names_;
};

}  // namespace withy::study
