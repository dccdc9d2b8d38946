#include "withy/results/number_text.hpp"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

namespace withy {
namespace {

constexpr std::size_t most_digits = 18;  ///< that are written; doubles have up to 17
constexpr std::size_t piece = 24;        ///< characters that are copied at once

constexpr auto pairs = [] {
  std::array<char, 200> digits{};
  for (std::size_t i = 0; i < 100; ++i) {
    digits[2 * i] = static_cast<char>('0' + i / 10);
    digits[2 * i + 1] = static_cast<char>('0' + i % 10);
  }
  return digits;
}();

constexpr auto powers = [] {
  std::array<std::uint64_t, most_digits> of_ten{1};
  for (std::size_t i = 1; i < of_ten.size(); ++i) of_ten[i] = 10 * of_ten[i - 1];
  return of_ten;
}();

/// How many digits a number above 0 has.
std::size_t digits_of(std::uint64_t number) {
  const auto guess = static_cast<std::size_t>((std::bit_width(number) * 1233) >> 12);  // by log10(2)
  return guess + (number >= powers[guess] ? 1 : 0);
}

/// Two digits.
void put_pair(char* to, std::uint32_t number) { std::memcpy(to, &pairs[std::size_t{2} * number], 2); }

/// Eight digits.
void put_eight(char* to, std::uint32_t number) {
  const std::uint32_t high = number / 10000, low = number % 10000;
  put_pair(to, high / 100);
  put_pair(to + 2, high % 100);
  put_pair(to + 4, low / 100);
  put_pair(to + 6, low % 100);
}

/// Eighteen digits, zeros before the number.
void put_all(char* to, std::uint64_t number) {
  constexpr std::uint64_t eight = 100'000'000;
  const std::uint64_t high = number / eight;
  put_pair(to, static_cast<std::uint32_t>(high / eight));
  put_eight(to + 2, static_cast<std::uint32_t>(high % eight));
  put_eight(to + 10, static_cast<std::uint32_t>(number % eight));
}

char* put_exponent(char* to, int exponent) {
  *to++ = 'e';
  *to++ = exponent < 0 ? '-' : '+';
  const auto size = static_cast<std::uint32_t>(std::abs(exponent));
  if (size >= 100) *to++ = static_cast<char>('0' + size / 100);
  put_pair(to, size % 100);
  return to + 2;
}

/// Digits with a point after so many of them, where there are more. \returns the end
char* put_with_point(char* to, const char* digits, std::size_t count, std::size_t before) {
  std::memcpy(to, digits, piece);
  if (count <= before) return to + count;
  std::memcpy(to + before + 1, digits + before, piece);
  to[before] = '.';
  return to + count + 1;
}

}  // namespace

char* write_number(char* to, double number) {
  *to = '-';
  to += std::signbit(number) ? 1 : 0;
  if (number == 0) {
    *to = '0';
    return to + 1;
  }
  const auto decimal = fmt::detail::dragonbox::to_decimal(std::abs(number));
  const std::size_t count = digits_of(decimal.significand);
  const int power = decimal.exponent + static_cast<int>(count) - 1;  // of the first digit
  std::array<char, most_digits + 2 * piece> all;
  all.fill('0');
  put_all(all.data(), decimal.significand);
  const char* const digits = all.data() + most_digits - count;
  if (power >= 0 && power < 16) {
    const auto whole = static_cast<std::size_t>(power) + 1;
    char* const end = put_with_point(to, digits, count, whole);
    return count < whole ? to + whole : end;  // zeros follow the digits
  }
  if (power < 0 && power >= -4) {
    std::memcpy(to, "0.000000", 8);
    to += 1 - power;
    std::memcpy(to, digits, piece);
    return to + count;
  }
  return put_exponent(put_with_point(to, digits, count, 1), power);
}

}  // namespace withy
