/// \file
/// States with what of them a file names, for what goes on from them.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "withy/core/simulation/assembly.hpp"
#include "withy/scene/scene.hpp"

namespace withy {

struct StateAsGiven {
  State state;
  GivenState named;         ///< by the file; without elements: nothing
  std::vector<bool> begun;  ///< numbers of y that begin where the others have them begin; the same

  /// A state of which nothing is known to be named.
  StateAsGiven(State whole) : state(std::move(whole)) {}  // NOLINT(google-explicit-constructor): it is one
};

/// As read_state and parse_state for a scene. \throws SceneError
StateAsGiven read_state_as_given(const std::string& file, const Scene& scene);
StateAsGiven parse_state_as_given(std::string_view text, const std::string& file, const Scene& scene);

}  // namespace withy
