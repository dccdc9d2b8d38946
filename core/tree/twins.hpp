/// \file
/// Which nodes of a tree are made of the same.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <unordered_map>

#include "withy/core/plugin/terms.hpp"
#include "withy/core/tree/tree.hpp"

namespace withy {

/// Finds for each node, asked in their order, the first one whose body's mass is the same in the same place and in the
/// same terms: what is computed of it alone is computed once.
class Twins {
 public:
  /// Index of that node; nothing where it is the first, or has no modes.
  std::optional<std::size_t> of(const NodeSpec& node, StrainOrder strain, Truncation truncation) {
    const std::size_t index = asked_++;
    std::string key = node.mass.identity();
    if (key.empty()) return {};
    key += static_cast<char>(strain);
    key += static_cast<char>(truncation);
    const auto [first, added] = first_.try_emplace(std::move(key), index);
    if (added) return {};
    return first->second;
  }

 private:
  std::unordered_map<std::string, std::size_t> first_;
  std::size_t asked_ = 0;
};

}  // namespace withy
