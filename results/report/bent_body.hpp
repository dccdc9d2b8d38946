/// \file
/// A flexible body by itself: where its points are at modal coordinates.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "withy/core/model/model.hpp"
#include "withy/core/plugin/equations.hpp"

namespace withy {

/// Moves by the body's own strain kinematics, whatever the body hangs on. Equal bodies of a tree share one, so that
/// what a long chain is drawn with is as large as one link. Of one thread.
class BentBody {
 public:
  /// \param node its frames do not matter
  /// \param hinge any that the body can hang on; its motion does not matter
  /// \param terms of the formulation, where the body has none of its own
  BentBody(const BodyNode& node, const std::shared_ptr<const Hinge>& hinge, const Terms& terms,
           std::span<const PointExpansion> points);

  /// Goes to the modal coordinates q of the body, all of them.
  void bend(std::span<const double> q);
  /// Where a point's section is then, in the body's frame [m].
  [[nodiscard]] Pose section(std::size_t point) const;

 private:
  std::shared_ptr<const Model> model_;
  std::unique_ptr<Observation> seen_;
  std::size_t first_;  ///< of the modal coordinates in a state
  State state_;
  Pose X_BW_;
};

}  // namespace withy
