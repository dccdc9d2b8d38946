/// \file
/// Names in scenes: what they may be, and the nearest known one for messages.
#pragma once

#include <cstddef>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace withy {

class Value;

/// The candidate with the least edit distance (insertion, deletion, substitution, transposition), capitals counting
/// little; empty where none is near enough to be meant.
std::string nearest(std::string_view name, const std::vector<std::string>& candidates);

/// Empty where `name` may name a body, hinge, frame or load; otherwise the rule it breaks.
std::string name_problem(std::string_view name);

/// Whether every table of results has a column of this name, or columns as NAME.x: no hinge or output may have it too.
bool is_column_of_all(std::string_view name);

/// "a, b, c": for messages; long lists are cut.
std::string listed(const std::vector<std::string>& names);

/// Text for a message: quoted, control characters replaced, cut at 60 bytes.
std::string in_quotes(std::string_view text);

/// Whether a text holds control characters, ends of lines among them; of UTF-8 also those of two bytes.
bool has_controls(std::string_view text);

/// The place in a list of `count` items that a key of a path names, as "1" of "gravity.1"; none where it is no such.
std::optional<std::size_t> list_index(std::string_view key, std::size_t count);

/// Whether a text in a value holds one of the names, whole.
bool mentions(const Value& value, const std::set<std::string>& names);

}  // namespace withy
