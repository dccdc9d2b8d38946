/// \file
/// Counts allocations of a test program that links allocations.cpp.
#pragma once

#include <cstddef>

namespace withy {

/// Calls of operator new in this program so far, by any thread.
std::size_t allocations();

}  // namespace withy
