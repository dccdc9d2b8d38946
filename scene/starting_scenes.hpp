/// \file
/// Commented scenes to start from, kept in the library.
#pragma once

#include <span>

namespace withy {

struct StartingScene {
  const char* kind;  ///< "beam"
  const char* text;  ///< the file of scenes/new
};

std::span<const StartingScene> starting_scenes();

}  // namespace withy
