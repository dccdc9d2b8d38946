/// \file
/// Whether loads are right about their own derivatives.
#pragma once

#include <optional>
#include <string>
#include <utility>

#include "withy/core/model/model.hpp"
#include "withy/core/plugin/plugin_call.hpp"

namespace withy {

/// Calls an add_derivatives of a load. \returns what that does
/// \throws PluginError that names the load, with the text of what the call throws; std::bad_alloc
template <class Call>
bool derivatives_call(const std::string& load, Call&& call) {
  return plugin_call<PluginError>("load '" + load + "' does not say its derivatives", std::forward<Call>(call));
}

/// A load that is wrong about its derivatives.
struct FalseDerivative {
  std::size_t load = 0;  ///< index in Model::loads()
  std::string what;      ///< "load 'spring' says that …", without a full stop
};

/// Compares what BoundLoad::add_derivatives and ContinuousPart::add_derivatives say with differences of what the load
/// gives, along one direction each of displacements, speeds and states of the load, at two states beside this one. Told
/// is what is wrong at both by more than a millionth and more than differences leave open, as far from the origin,
/// where coordinates have few digits left: at a kink there is no derivative to be right about. What an add_derivatives
/// throws is told likewise. Nothing where all are right, and of more than 200 speeds. \param state with the discrete
/// states of a run
std::optional<FalseDerivative> false_derivative(const Model& model, const State& state);

}  // namespace withy
