/// \file
/// Calls of an integrator's code, whatever it throws.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "withy/core/plugin/integrator.hpp"
#include "withy/core/plugin/plugin_call.hpp"

namespace withy {

/// The integrator of a simulation does what none may: no result can be trusted. what() says which in a sentence about
/// "the integrator of this scene", whose plugin only the scene knows.
class IntegratorError : public PluginError {
 public:
  /// \param deed the sentence without its subject: "does not step: out of order"
  explicit IntegratorError(const std::string& deed)
      : PluginError("the integrator of this scene " + deed), deed_(deed) {}
  [[nodiscard]] const std::string& deed() const { return deed_; }
  /// The same about an integrator by its name, for whoever knows the scene.
  [[nodiscard]] PluginError named(const std::string& integrator) const {
    return PluginError("integrator '" + integrator + "' " + deed_);
  }

 private:
  std::string deed_;
};

/// A stepper that begins at `state`. \param who the integrator in words: "integrator 'mine'"
/// \throws std::invalid_argument where the integrator cannot treat the equations, throws, gives no stepper or one that
/// begins at another state, or says of itself that it is stable to no positive step; the text says which. PluginError,
/// std::bad_alloc.
std::unique_ptr<Stepper> start_stepper(const Integrator& integrator, const EquationsOfMotion& equations,
                                       const State& state, const std::string& who = "the integrator");

/// Why a step that is said to be done is none: it did not go on, or went past where it was to end [s]. Times have all
/// their digits, which differ in the last one where times are added up.
std::string false_end(double from, double limit, double to);

/// Why a stepper is not where it was sent, or empty where it is, but for quaternions that it has scaled to unit length.
std::string false_jump(const State& sent, const State& here);

/// Stepper::interpolate. \throws IntegratorError
void interpolate_step(const Stepper& stepper, double t, std::span<double> y);

/// Stepper::remarks. \throws IntegratorError
std::vector<std::string> remarks_of(const Stepper& stepper);

}  // namespace withy
