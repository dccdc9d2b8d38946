/// \file
/// Lines and numbers of the text files of finite-element programs.
#pragma once

#include <charconv>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "mesh.hpp"

namespace withy::fem {

/// The bytes of a file, without the mark of UTF-8 that some editors put before them. \throws InputError
inline std::string text_of(const std::filesystem::path& file) {
  constexpr std::uintmax_t most_bytes = std::uintmax_t{4} << 30;
  std::error_code none;
  if (!std::filesystem::is_regular_file(file, none)) throw InputError(file.string() + ": there is no such file");
  if (std::filesystem::file_size(file, none) > most_bytes) throw InputError(file.string() + ": more than 4 GiB");
  std::ifstream stream(file, std::ios::binary);
  std::string text((std::istreambuf_iterator<char>(stream)), {});
  if (!stream) throw InputError(file.string() + ": cannot be read");
  if (text.starts_with("\xef\xbb\xbf")) text.erase(0, 3);
  return text;
}

/// Goes through a text line by line.
class Lines {
 public:
  explicit Lines(std::string_view text) : rest_(text) {}
  bool next(std::string_view& line) {
    if (rest_.empty()) return false;
    const std::size_t end = rest_.find('\n');
    line = rest_.substr(0, end);
    rest_ = end == std::string_view::npos ? std::string_view() : rest_.substr(end + 1);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    ++number_;
    return true;
  }
  [[nodiscard]] int number() const { return number_; }  ///< of the line given last, from 1

 private:
  std::string_view rest_;
  int number_ = 0;
};

inline std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

inline std::vector<std::string_view> split(std::string_view line, std::string_view separators) {
  std::vector<std::string_view> fields;
  while (!line.empty()) {
    const std::size_t end = line.find_first_of(separators);
    fields.push_back(trimmed(line.substr(0, end)));
    line = end == std::string_view::npos ? std::string_view() : line.substr(end + 1);
  }
  return fields;
}

/// The whole text as a number; nothing where it is none. Fortran's D may stand for the exponent.
template <class Number>
std::optional<Number> number_of(std::string_view text) {
  text = trimmed(text);
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  Number value{};
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  if (!text.empty() && result.ec == std::errc{} && result.ptr == text.data() + text.size()) return value;
  if constexpr (std::is_floating_point_v<Number>) {
    if (const std::size_t d = text.find_first_of("dD"); d != std::string_view::npos) {
      std::string other(text);
      other[d] = 'e';
      if (other.find_first_of("dD") == std::string::npos) return number_of<Number>(other);
    }
  }
  return {};
}

}  // namespace withy::fem
