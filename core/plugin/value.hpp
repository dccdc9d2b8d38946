/// \file
/// Values read from a scene, with the place they came from: what every plugin is made from.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace withy {

/// Where a value stands in its file (1-based; 0 where it came from no file) and its path, as `/bodies/link1/length`.
struct Place {
  int line = 0;
  int column = 0;
  std::string path;
};

/// One problem found in the input: what was got, what was expected.
struct Diagnostic {
  Place place;
  std::string message;
};

/// Collects every problem of an input, so that all of them are reported at once.
class Diagnostics {
 public:
  void error(const Place& place, std::string message) { errors_.push_back({place, std::move(message)}); }
  [[nodiscard]] bool ok() const { return errors_.empty(); }
  [[nodiscard]] const std::vector<Diagnostic>& errors() const { return errors_; }

 private:
  std::vector<Diagnostic> errors_;
};

/// A value of a scene: null, boolean, number, text, list or map. Once checked against its ParameterSpec, numbers are
/// in SI units (radians for angles) and optional members with a default are present. Copies share their items and
/// members until one of them is changed: the cases of a sweep are copies of one scene, and differ in a few numbers.
class Value {
 public:
  enum class Kind { null, boolean, number, text, list, map };
  using Member = std::pair<std::string, Value>;

  Value() = default;
  explicit Value(bool b, Place where = {}) : kind_(Kind::boolean), boolean_(b), place_(std::move(where)) {}
  explicit Value(double x, Place where = {}) : kind_(Kind::number), number_(x), place_(std::move(where)) {}
  explicit Value(std::string s, Place where = {}) : kind_(Kind::text), text_(std::move(s)), place_(std::move(where)) {}
  static Value list(std::vector<Value> items, Place where = {});
  static Value map(std::vector<Member> members, Place where = {});

  [[nodiscard]] Kind kind() const { return kind_; }
  [[nodiscard]] const Place& place() const { return place_; }
  [[nodiscard]] bool boolean() const { return boolean_; }
  [[nodiscard]] double number() const { return number_; }
  [[nodiscard]] const std::string& text() const { return text_; }
  [[nodiscard]] const std::vector<Value>& items() const { return items_ == nullptr ? no_items() : *items_; }
  [[nodiscard]] const std::vector<Member>& members() const { return members_ == nullptr ? no_members() : *members_; }
  /// Whether items and members are those of another value, not only equal to them: it takes no time to find out.
  [[nodiscard]] bool shares(const Value& other) const { return items_ == other.items_ && members_ == other.members_; }

  /// Member of a map; null where there is none.
  [[nodiscard]] const Value* find(std::string_view key) const;
  [[nodiscard]] bool has(std::string_view key) const { return find(key) != nullptr; }
  /// Member of a checked map that its specification makes sure of.
  /// \throws std::logic_error where it is absent: the specification and its reader disagree.
  [[nodiscard]] const Value& at(std::string_view key) const;
  [[nodiscard]] double number_at(std::string_view key) const { return at(key).number(); }
  [[nodiscard]] std::size_t count_at(std::string_view key) const { return static_cast<std::size_t>(at(key).number()); }
  [[nodiscard]] const std::string& text_at(std::string_view key) const { return at(key).text(); }
  /// The numbers of a list, in its order.
  [[nodiscard]] std::vector<double> numbers() const;

  /// For those that build or edit a tree: the reader and `--set`. The reference is to be used before the value is
  /// copied: what is changed by it afterwards would change in the copy too.
  [[nodiscard]] std::vector<Value>& items();
  [[nodiscard]] std::vector<Member>& members();
  void set(std::string_view key, Value value);
  void set_place(Place where) { place_ = std::move(where); }

 private:
  static const std::vector<Value>& no_items();
  static const std::vector<Member>& no_members();

  Kind kind_ = Kind::null;
  bool boolean_ = false;
  double number_ = 0;
  std::string text_;
  std::shared_ptr<std::vector<Value>> items_;     ///< null: none
  std::shared_ptr<std::vector<Member>> members_;  ///< likewise
  Place place_;
};

}  // namespace withy
