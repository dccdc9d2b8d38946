/// \file
/// What kinematics of second order leaves out of a motion.
#pragma once

#include <memory>
#include <vector>

#include "withy/core/simulation/tips.hpp"
#include "withy/study/prepared.hpp"

namespace withy::study {

/// The share of ranges that terms of third order may have is (deflection over length)² of the body that bends most, of
/// those whose kinematics is not exact; of bodies in segments the segments bend little.
class ThirdOrder {
 public:
  /// The model must outlive the object.
  explicit ThirdOrder(const Prepared& model);
  /// At a state of the run.
  void look(const State& state);
  /// Greatest deflection over length so far.
  [[nodiscard]] double deflection() const { return deflection_; }
  [[nodiscard]] double share() const { return deflection_ * deflection_; }

 private:
  std::vector<Tip> ends_;
  std::unique_ptr<Observation> seen_;
  double deflection_ = 0;
};

}  // namespace withy::study
