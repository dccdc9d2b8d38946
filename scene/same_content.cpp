#include "withy/scene/same_content.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>

namespace withy {

bool same_content(const Value& a, const Value& b) {
  if (a.kind() != b.kind() || a.items().size() != b.items().size() || a.members().size() != b.members().size())
    return false;
  if (a.boolean() != b.boolean() || a.text() != b.text()) return false;
  if (std::bit_cast<std::uint64_t>(a.number()) != std::bit_cast<std::uint64_t>(b.number())) return false;
  for (std::size_t i = 0; i < a.items().size(); ++i)
    if (!same_content(a.items()[i], b.items()[i])) return false;
  return std::all_of(a.members().begin(), a.members().end(), [&](const Value::Member& member) {
    const Value* other = b.find(member.first);
    return other != nullptr && same_content(member.second, *other);
  });
}

}  // namespace withy
