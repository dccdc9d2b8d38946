/// \file
/// The interface of formulations: a strain kinematics times a truncation.
#pragma once

#include <memory>

#include "withy/core/plugin/equations.hpp"
#include "withy/core/plugin/terms.hpp"

namespace withy {

class Model;

/// Where a formulation stands among the others: what studies that go through formulations go by.
struct Standing {
  int rank = 0;         ///< of two, the one of higher rank neglects less
  bool rung = false;    ///< runs of `auto` may go through it, and errors of those below are measured against it
  bool studied = true;  ///< trade studies and advice take it where the user names no formulations
};

/// A rank from what is kept: none elastic first, then by strain kinematics, and within one by truncation.
inline int rank_of(const Terms& terms) {
  if (terms.truncation == Truncation::ruthless) return 0;
  const int kept = terms.products_of_speeds ? static_cast<int>(terms.truncation) : 0;
  return 10 * (1 + static_cast<int>(terms.strain)) + kept;
}

/// Turns a model into equations of motion.
class Formulation {
 public:
  virtual ~Formulation() = default;
  /// What it keeps; a body that names this formulation as its own takes these terms into the scene's.
  [[nodiscard]] virtual Terms terms() const = 0;
  /// By default that of its terms, no rung, studied.
  [[nodiscard]] virtual Standing standing() const { return {.rank = rank_of(terms())}; }
  /// \throws std::invalid_argument where the formulation cannot treat the model; the text says which body and why.
  [[nodiscard]] virtual std::unique_ptr<EquationsOfMotion> compile(std::shared_ptr<const Model> model) const = 0;
};

}  // namespace withy
