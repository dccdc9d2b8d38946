/// \file
/// Characters that JSON writes as two escapes.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace withy {

/// A text for a parser of YAML. JSON writes what is beyond the first 65536 characters as a surrogate pair,
/// "\ud83d\ude00"; YAML knows such a character by one escape, "\U0001f600". Any text but JSON stays as it is.
class WholeEscapes {
 public:
  /// \param text outlives this
  explicit WholeEscapes(std::string_view text);
  WholeEscapes(const WholeEscapes&) = delete;
  WholeEscapes& operator=(const WholeEscapes&) = delete;

  [[nodiscard]] std::string_view text() const { return text_; }
  /// The column in the text that was given, of one in `text`; lines are the same. All from 1.
  [[nodiscard]] int column(int line, int column) const;

 private:
  struct Pair {
    int line, column;  ///< behind its escape in `text`
  };
  std::string own_;  ///< of a text that is changed
  std::string_view text_;
  std::vector<Pair> pairs_;
};

}  // namespace withy
