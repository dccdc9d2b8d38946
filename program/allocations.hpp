/// \file
/// Memory of the whole program, libraries and plugins included.
#pragma once

#include <cstddef>

namespace withy::program {

/// Allocations so far, whichever function made them (malloc and its kin; operator new goes through them).
std::size_t allocations();

/// From here on memory that is freed waits for its next use, up to some MB of it. For a program's beginning: to give it
/// back and have it cleared anew, page by page, takes a short run a tenth of its time.
void keep_freed_memory();

}  // namespace withy::program
