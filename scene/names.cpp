#include "withy/scene/names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>

#include "withy/core/plugin/value.hpp"

namespace withy {
namespace {

constexpr std::size_t longest_name = 64;
// More candidates or errors than a person reads must not make an answer slow.
constexpr std::size_t most_candidates = 2000;
constexpr std::size_t most_listed = 30;

char lower(char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); }

/// Optimal string alignment distance, two for a substitution by anything but the other case, which counts one; so that
/// all costs are whole.
std::size_t distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) last[j] = 2 * j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = 2 * i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t change = a[i - 1] == b[j - 1] ? 0 : lower(a[i - 1]) == lower(b[j - 1]) ? 1 : 2;
      row[j] = std::min({last[j] + 2, row[j - 1] + 2, last[j - 1] + change});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) row[j] = std::min(row[j], before[j - 2] + 2);
    }
    std::swap(before, last);
    std::swap(last, row);
  }
  return last[b.size()];
}

}  // namespace

std::string nearest(std::string_view name, const std::vector<std::string>& candidates) {
  if (name.empty() || name.size() > longest_name) return {};
  std::string best;
  // A third of the letters may be wrong, at least one, and never all of them.
  std::size_t least = 2 * std::max<std::size_t>(1, (name.size() + 1) / 3) + 1;
  for (std::size_t i = 0; i < std::min(candidates.size(), most_candidates); ++i) {
    const std::string& candidate = candidates[i];
    const std::size_t difference =
        candidate.size() > name.size() ? candidate.size() - name.size() : name.size() - candidate.size();
    if (2 * difference >= least) continue;
    const std::size_t d = distance(name, candidate);
    if (d < least && d < 2 * std::max(name.size(), candidate.size())) {
      least = d;
      best = candidate;
    }
  }
  return best;
}

std::string name_problem(std::string_view name) {
  if (name.empty()) return "a name cannot be empty";
  if (name.size() > longest_name) return fmt::format("a name has at most {} characters", longest_name);
  if (name == "world") return "'world' is the name of the ground";
  const auto allowed = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  };
  if (!std::all_of(name.begin(), name.end(), allowed)) return "names are made of letters, digits, '_' and '-'";
  if (!std::isalpha(static_cast<unsigned char>(name[0])) && name[0] != '_') return "names begin with a letter or '_'";
  return {};
}

bool is_column_of_all(std::string_view name) {
  constexpr std::array<std::string_view, 6> names = {
      "t", "work", "kinetic_energy", "potential_energy", "linear_momentum", "angular_momentum"};
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), most_listed); ++i) text += (i == 0 ? "" : ", ") + names[i];
  if (names.size() > most_listed) text += fmt::format(", … ({} in all)", names.size());
  return text;
}

bool has_controls(std::string_view text) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto c = static_cast<unsigned char>(text[i]);
    const auto next = static_cast<unsigned char>(i + 1 < text.size() ? text[i + 1] : ' ');
    if (c < 0x20 || c == 0x7F || (c == 0xC2 && next >= 0x80 && next < 0xA0)) return true;
  }
  return false;
}

std::string in_quotes(std::string_view text) {
  constexpr std::size_t most = 60;
  std::string shown(text.substr(0, most));
  // Never half a UTF-8 character: messages end up in JSON.
  if (text.size() > most) {
    while (!shown.empty() && (static_cast<unsigned char>(shown.back()) & 0xC0) == 0x80) shown.pop_back();
    if (!shown.empty() && static_cast<unsigned char>(shown.back()) >= 0xC0) shown.pop_back();
  }
  for (char& c : shown) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  }
  return fmt::format("\"{}{}\"", shown, text.size() > most ? "…" : "");
}

std::optional<std::size_t> list_index(std::string_view key, std::size_t count) {
  std::size_t index = 0;
  const auto [end, problem] = std::from_chars(key.data(), key.data() + key.size(), index);
  if (problem != std::errc() || end != key.data() + key.size() || index >= count) return {};
  return index;
}

bool mentions(const Value& value, const std::set<std::string>& names) {
  if (value.kind() == Value::Kind::text) {
    const std::string& text = value.text();
    const auto in_name = [](char c) {
      return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-';
    };
    for (auto at = text.begin(); at != text.end();) {
      at = std::find_if(at, text.end(), in_name);
      const auto end = std::find_if_not(at, text.end(), in_name);
      std::string word(at, end);
      if (names.contains(word)) return true;
      // In a formula it may be a difference, and a sign may stand before it.
      for (std::size_t dash = word.find('-'); dash != std::string::npos; dash = word.find('-')) {
        if (names.contains(word.substr(0, dash))) return true;
        word.erase(0, dash + 1);
      }
      if (names.contains(word)) return true;
      at = end;
    }
  }
  return std::any_of(value.items().begin(), value.items().end(), [&](const Value& v) { return mentions(v, names); }) ||
         std::any_of(value.members().begin(), value.members().end(),
                     [&](const Value::Member& m) { return mentions(m.second, names); });
}

}  // namespace withy
