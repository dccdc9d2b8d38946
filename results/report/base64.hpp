/// \file
/// Arrays of numbers as text that pages can hold.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace withy {

/// RFC 4648, with padding.
std::string base64(std::span<const std::byte> bytes);

/// Of numbers as they lie in memory.
template <class Number>
std::string base64_of(const std::vector<Number>& numbers) {
  return base64(std::as_bytes(std::span(numbers)));
}

/// What such a text says. \throws ResultsError where it is none
std::vector<std::byte> bytes_of_base64(std::string_view text);

/// The numbers that base64_of was given; bytes that make no whole number are left out.
template <class Number>
std::vector<Number> numbers_of(std::string_view text) {
  const std::vector<std::byte> bytes = bytes_of_base64(text);
  std::vector<Number> numbers(bytes.size() / sizeof(Number));
  if (!numbers.empty()) std::memcpy(numbers.data(), bytes.data(), numbers.size() * sizeof(Number));
  return numbers;
}

}  // namespace withy
