/// \file
/// Bringing the loops of a model to closure where it begins.
#pragma once

#include <string>
#include <vector>

#include "withy/core/model/model.hpp"
#include "withy/core/plugin/closed_loops.hpp"

namespace withy {

/// What of a state was given and is to stay, by speeds of the model.
struct GivenState {
  std::vector<bool> positions, rates;
};

struct Assembly {
  std::string fault;   ///< why the loops cannot be closed, in a clause; empty where they are
  std::string remedy;  ///< what of the state given may help, in a clause; may be empty
  /// Of the fault: the constraint that is farthest from closed, or the hinge for a rate of which no equations have a
  /// solution.
  std::string name;
  bool of_hinge = false;  ///< whose name it is
  std::string remark;     ///< what was changed, in a sentence; empty where nothing was
};

/// Closes the loops of a state: positions by Newton's method, each step the smallest in the sense of M, then speeds by
/// the smallest change. First the hinges that are not given move, then with them the modes that are not given. What is
/// given stays, but where it leaves no way and the gap is below 1 mm and a thousandth of ℓ (length_of_loops), or frames
/// part at less than 1 mm/s and a thousandth of how fast the loops move: then all moves. Speeds that motions prescribe
/// always stay.
/// \param equations of the model; ClosedLoops
/// \param kept what stays beside what is given where the other hinges can close the loops, positions and rates each for
/// themselves; null: nothing
Assembly assemble(const Model& model, const EquationsOfMotion& equations, const GivenState& given, State& state,
                  const GivenState* kept = nullptr);
/// Its fault with what may help where that is a state of a scene.
std::string fault_and_remedy(const Assembly& assembly);

}  // namespace withy
