/// \file
/// Numbers as text, for tables of many.
#pragma once

#include <cstddef>

namespace withy {

/// The longest text of a number: "-1.2345678901234567e-308".
constexpr std::size_t longest_number = 24;
/// Room that write_number asks for: it copies more than it needs, in pieces of one size.
constexpr std::size_t room_of_number = 48;

/// Writes the shortest decimal number that reads back as this one, as fmt's "{}" writes it, in less than half the time:
/// digits with a point for sizes from 1e-4 up to 1e16, an exponent beyond. \param to room_of_number characters; what is
/// behind the text afterwards means nothing \param number finite \returns the end of the text
char* write_number(char* to, double number);

}  // namespace withy
