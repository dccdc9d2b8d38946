/// \file
/// Tables for people: columns as wide as they need to be.
#pragma once

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
  /// Head, a rule, the rows.
  [[nodiscard]] std::string str() const;

 private:
  std::vector<std::string> head_;   ///< upper lines; empty where the head has one
  std::vector<std::string> lower_;  ///< lower lines
  std::vector<bool> flush_left_;
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace withy
