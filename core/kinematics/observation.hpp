/// \file
/// What a run reports of a model beside its coordinates, by one pass outward over the tree.
#pragma once

#include <memory>

#include "withy/core/model/model.hpp"
#include "withy/core/plugin/equations.hpp"
#include "withy/core/plugin/terms.hpp"

namespace withy {

struct PlacedTree;

/// The constants of observations of a model: made once, shared by threads.
class ObservedModel {
 public:
  virtual ~ObservedModel() = default;
  /// One for a thread; it keeps the constants alive.
  [[nodiscard]] virtual std::unique_ptr<Observation> make_observation() const = 0;
};

/// `terms` hold for every body that has none of its own; of them only the strain kinematics matters, since reports are
/// of what it says without truncation. The constants take memory in proportion to the bodies and their frames.
[[gnu::visibility("default")]] std::shared_ptr<const ObservedModel> observed_model(const Model& model, Terms terms);
/// The same for who has compile_placed_tree(model).
std::shared_ptr<const ObservedModel> observed_model(const Model& model, Terms terms, PlacedTree tree);

}  // namespace withy
