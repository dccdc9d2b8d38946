/// \file
/// The cases of a plan: each has a number, and its values follow from plan and number alone.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "withy/campaign/plan.hpp"
#include "withy/campaign/random.hpp"

namespace withy::campaign {

class Cases {
 public:
  /// The plan must outlive it.
  explicit Cases(const Plan& plan);
  /// Numbered from 0; of a product the grids vary slowest, the first of them most slowly, and the draws fastest.
  [[nodiscard]] std::uint64_t size() const { return size_; }
  /// \param index below size()
  [[nodiscard]] CaseValues values(std::uint64_t index) const;
  /// The scene with these values. \param origin of messages: "case 17"
  [[nodiscard]] SceneValues scene(const CaseValues& values, const std::string& origin) const;
  /// The same, made of one that another case is done with where there is one in `spare`: a copy costs more.
  [[nodiscard]] SceneValues scene(const CaseValues& values, const std::string& origin,
                                  std::vector<SceneValues>& spare) const;
  /// Whether the scene of a case with these values, which nobody has changed since, may be one of the spare.
  [[nodiscard]] bool spares(const CaseValues& values) const;

 private:
  [[nodiscard]] CaseValues of_axes(std::uint64_t index) const;
  [[nodiscard]] CaseValues of_product(std::uint64_t index) const;
  [[nodiscard]] CaseValues alone(std::uint64_t index) const;
  [[nodiscard]] CaseValues on_trajectory(std::uint64_t index) const;
  [[nodiscard]] CaseValues of_samples(std::uint64_t index) const;
  [[nodiscard]] std::vector<double> drawn(const Key& key, std::uint64_t draw) const;

  void set(SceneValues& scene, const CaseValues& values, const std::string& origin) const;

  const Plan& plan_;
  std::vector<std::string> paths_;  ///< of the values
  bool apart_;                      ///< none of them is within another
  std::vector<std::size_t> sobol_;  ///< axes, in the order of the sequence's dimensions
  std::uint64_t size_ = 0;
};

/// A step of a Morris trajectory: which axis, and by which share of its distribution.
struct MorrisStep {
  std::size_t axis = 0;
  double step = 0;
};
/// The steps of a trajectory, in their order, and the shares of each axis it begins at.
struct MorrisTrajectory {
  std::vector<double> begin;
  std::vector<MorrisStep> steps;
};
MorrisTrajectory morris_trajectory(const Plan& plan, std::uint64_t number);

}  // namespace withy::campaign
