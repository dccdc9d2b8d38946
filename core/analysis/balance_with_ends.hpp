/// \file
/// Units of states by what input and output make of them too.
#pragma once

#include "withy/core/analysis/linear_system.hpp"

namespace withy {

/// Balances A with B and C of one input and one output, as if y were the input: a state that A does not move, or that
/// moves none, has units all the same, by which the others are not to be measured.
void balance_with_ends(LinearSystem& system);

}  // namespace withy
