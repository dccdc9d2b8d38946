#include "withy/scene/one_line.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <string_view>

#include "withy/scene/units.hpp"

namespace withy {
namespace {

/// Whether YAML reads the bare word as this text, inside lists and maps too.
bool is_plain(const std::string& text) {
  if (text.empty() || text.front() == ' ' || text.back() == ' ') return false;
  for (const std::string_view word : {"null", "true", "false", ".nan", ".inf", "-.inf", "+.inf", "-"})
    if (text == word) return false;
  const auto harmless = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || static_cast<unsigned char>(c) >= 0x80 ||
           std::string_view("_-./ ^+%()=").find(c) != std::string_view::npos;
  };
  return text.front() != '%' && text.front() != '=' && !text.starts_with("- ") && !text.starts_with("--") &&
         std::all_of(text.begin(), text.end(), harmless) && !plain_number(text);
}

std::string quoted_text(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '\n') {
      quoted += "\\n";
      continue;
    }
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted + '"';
}

}  // namespace

std::string in_one_line(const Value& value) {
  std::string all;
  switch (value.kind()) {
    case Value::Kind::null:
      return "null";
    case Value::Kind::boolean:
      return value.boolean() ? "true" : "false";
    case Value::Kind::number:
      return fmt::format("{}", value.number());
    case Value::Kind::text:
      return is_plain(value.text()) ? value.text() : quoted_text(value.text());
    case Value::Kind::list:
      for (const Value& item : value.items()) all += (all.empty() ? "" : ", ") + in_one_line(item);
      return '[' + all + ']';
    case Value::Kind::map:
      for (const auto& [key, member] : value.members())
        all += (all.empty() ? "" : ", ") + key + ": " + in_one_line(member);
      return '{' + all + '}';
  }
  return all;
}

}  // namespace withy
