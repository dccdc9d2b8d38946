/// \file
/// Counts memory allocations of the whole program, libraries and plugins included.
#pragma once

#include <cstddef>

namespace withy::program {

/// Allocations so far, whichever function made them (malloc and its kin; operator new goes through them).
std::size_t allocations();

}  // namespace withy::program
