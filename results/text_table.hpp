/// \file
/// Tables for people: columns as wide as they need to be, lines of at most 100 characters.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace withy {

class TextTable {
 public:
  /// Columns whose head begins with '<' are set flush left (the sign is not printed), the others flush right. A head
  /// may have two lines, divided by '\n'.
  explicit TextTable(std::vector<std::string> head);
  /// One cell a column.
  void add(std::vector<std::string> cells) { rows_.push_back(std::move(cells)); }
  /// Head, a rule, the rows. What does not fit stands in tables of its own below, behind the columns that name the
  /// rows; or, where the last column is of words, these go on below each other.
  [[nodiscard]] std::string str() const;

 private:
  TextTable() = default;
  [[nodiscard]] std::vector<std::size_t> widths() const;
  [[nodiscard]] std::size_t leading() const;
  [[nodiscard]] static std::size_t total(const std::vector<std::size_t>& columns,
                                         const std::vector<std::size_t>& widths);
  [[nodiscard]] std::string line(const std::vector<std::string>& cells, const std::vector<std::size_t>& columns,
                                 const std::vector<std::size_t>& widths) const;
  [[nodiscard]] std::string block(const std::vector<std::size_t>& columns,
                                  const std::vector<std::size_t>& widths) const;
  [[nodiscard]] std::string folded(std::vector<std::size_t> widths) const;

  std::vector<std::string> head_;   ///< upper lines; empty where the head has one
  std::vector<std::string> lower_;  ///< lower lines
  std::vector<bool> flush_left_;
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace withy
