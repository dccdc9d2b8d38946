#include "withy/scene/same_content.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>

namespace withy {
namespace {

template <class T>
void append_bytes(std::string& text, const T& number) {
  std::array<char, sizeof(T)> bytes;
  std::memcpy(bytes.data(), &number, sizeof(T));
  text.append(bytes.data(), bytes.size());
}

void append_text(std::string& text, const std::string& more) {
  append_bytes(text, more.size());
  text += more;
}

}  // namespace

bool same_content(const Value& a, const Value& b) {
  if (a.kind() != b.kind() || a.items().size() != b.items().size() || a.members().size() != b.members().size())
    return false;
  if (a.boolean() != b.boolean() || a.text() != b.text()) return false;
  if (std::bit_cast<std::uint64_t>(a.number()) != std::bit_cast<std::uint64_t>(b.number())) return false;
  if (a.shares(b)) return true;
  for (std::size_t i = 0; i < a.items().size(); ++i)
    if (!same_content(a.items()[i], b.items()[i])) return false;
  return std::all_of(a.members().begin(), a.members().end(), [&](const Value::Member& member) {
    const Value* other = b.find(member.first);
    return other != nullptr && same_content(member.second, *other);
  });
}

void append_content(std::string& text, const Value& value) {
  text += static_cast<char>(value.kind());
  switch (value.kind()) {
    case Value::Kind::null:
      break;
    case Value::Kind::boolean:
      text += value.boolean() ? '1' : '0';
      break;
    case Value::Kind::number:
      append_bytes(text, value.number());
      break;
    case Value::Kind::text:
      append_text(text, value.text());
      break;
    case Value::Kind::list:
      append_bytes(text, value.items().size());
      for (const Value& item : value.items()) append_content(text, item);
      break;
    case Value::Kind::map:
      append_bytes(text, value.members().size());
      for (const auto& [key, member] : value.members()) {
        append_text(text, key);
        append_content(text, member);
      }
      break;
  }
}

}  // namespace withy
