/// \file
/// Finds ports by their names.
#pragma once

#include <span>
#include <string_view>

#include "withy/host/library.hpp"

namespace withy::host {

/// Index of the port of that name. \throws std::out_of_range with the nearest name where there is none of this.
/// \param what a port of this list is called in the message, as "output"
std::size_t index_of(std::span<const Port> ports, std::string_view name, const char* what);

}  // namespace withy::host
