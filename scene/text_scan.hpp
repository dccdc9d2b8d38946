/// \file
/// A first look at a text, before a parser spends memory on it.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace withy {

/// Why a text is not to be parsed, and where: line and column in bytes, from 1.
struct TextFault {
  int line = 1;
  int column = 1;
  std::string message;
};

/// Nothing for a text that may be YAML within the limits of documents. The YAML parser takes a whole bracketed list or
/// map apart before it hands out the first value of it: brackets never closed and marks beyond counting are found here.
std::optional<TextFault> scan_text(std::string_view text);

}  // namespace withy
