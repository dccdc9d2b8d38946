/// \file
/// Arrays of numbers as text that pages can hold.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace withy {

/// RFC 4648, with padding.
std::string base64(std::span<const std::byte> bytes);

/// Of numbers as they lie in memory.
template <class Number>
std::string base64_of(const std::vector<Number>& numbers) {
  return base64(std::as_bytes(std::span(numbers)));
}

}  // namespace withy
