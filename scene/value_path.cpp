#include "withy/scene/value_path.hpp"

#include <algorithm>

#include "withy/core/plugin/value.hpp"
#include "withy/scene/names.hpp"

namespace withy {

std::vector<std::string> keys_of_path(std::string_view path) {
  std::vector<std::string> keys;
  for (std::size_t start = 0; start <= path.size();) {
    const std::size_t stop = std::min(path.find('.', start), path.size());
    keys.emplace_back(path.substr(start, stop - start));
    start = stop + 1;
  }
  return keys;
}

const Value* value_at(const Value& whole, std::string_view path) {
  const Value* at = &whole;
  for (const std::string& key : keys_of_path(path)) {
    if (at == nullptr) break;
    if (at->kind() == Value::Kind::list) {
      const auto index = list_index(key, at->items().size());
      at = index ? &at->items()[*index] : nullptr;
    } else {
      at = at->find(key);
    }
  }
  return at;
}

}  // namespace withy
