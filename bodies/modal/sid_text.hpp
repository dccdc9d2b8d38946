/// \file
/// Lines, numbers and element names of files of Standard Input Data.
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <utility>

namespace withy::sid {

std::string_view trimmed(std::string_view s);

/// One line that is not blank: `key` or `key = value`.
struct Line {
  int number = 0;
  std::string_view key, value;
  bool assigns = false;
};

class Lines {
 public:
  explicit Lines(std::string_view text) : rest_(text) {}
  /// The next line, whatever it is, trimmed.
  std::string_view raw();
  /// The next line that is not blank. \throws FormatError at the end of the text, with what was expected.
  Line next(std::string_view expected);

 private:
  std::string_view rest_;
  int number_ = 0;
};

/// The line's value. \throws FormatError where it is not a finite number.
double number(const Line& line);
/// \throws FormatError where it is not a whole number in that range.
int whole(const Line& line, int least, int most);

/// Order and indices of "m0( 1, 2)" or "m1(1,2,3)"; nothing where the key is none of these.
std::optional<std::pair<int, std::array<int, 3>>> element(std::string_view key);

}  // namespace withy::sid
