/// \file
/// The interface of formulations: a strain kinematics times a truncation.
#pragma once

#include <memory>

#include "withy/core/plugin/equations.hpp"
#include "withy/core/plugin/terms.hpp"

namespace withy {

class Model;

/// Turns a model into equations of motion.
class Formulation {
 public:
  virtual ~Formulation() = default;
  /// What it keeps; a body that names this formulation as its own takes these terms into the scene's.
  [[nodiscard]] virtual Terms terms() const = 0;
  /// \throws std::invalid_argument where the formulation cannot treat the model; the text says which body and why.
  [[nodiscard]] virtual std::unique_ptr<EquationsOfMotion> compile(std::shared_ptr<const Model> model) const = 0;
};

}  // namespace withy
