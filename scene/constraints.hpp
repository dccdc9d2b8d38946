/// \file
/// From the constraints of a scene to loops of its model.
#pragma once

#include "withy/core/simulation/assembly.hpp"
#include "withy/scene/tree.hpp"

namespace withy {

/// Checks the constraints and adds them to the tree's model, if there is one. \returns the checked values
Value add_constraints(const Value& constraints, const SceneTree& tree, const Checker& checker);

/// An initial state without its `guess`, which goes to `state`: where closing loops begins.
Value without_guess(const Value& initial, const Model& model, const Checker& checker, State& state);

/// What an `initial` gives of positions and rates, by its hinges and bodies. \param initial null: nothing
GivenState given_state(const Value* initial, const Model& model);

/// Brings the model's loops to closure in the scene's formulation, by what its `initial` gives, if it has one.
/// \returns what was changed, a sentence; null where nothing was or problems are reported
Value close_loops(const Model& model, const Scene& scene, const Value* given, const Checker& checker, State& state);

}  // namespace withy
