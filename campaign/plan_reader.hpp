/// \file
/// Reads the parts of a plan; every problem is reported at its place.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "withy/campaign/plan.hpp"
#include "withy/scene/document.hpp"
#include "withy/scene/units.hpp"

namespace withy::campaign {

/// Members of the maps of a plan, in the order of messages and schema.
namespace keys {
inline const std::vector<std::string> plan = {"format", "name",     "scene",     "set",         "vary",
                                              "cases",  "seed",     "keep",      "correlation", "derived",
                                              "design", "failures", "evaluation"};
inline const std::vector<std::string> axis = {"grid", "list", "uniform", "normal", "lognormal", "latin", "sobol"};
inline const std::vector<std::string> range = {"from", "to", "count"};
inline const std::vector<std::string> list = {"file", "column"};
inline const std::vector<std::string> uniform = {"from", "to"};
inline const std::vector<std::string> normal = {"mean", "deviation", "from", "to"};
inline const std::vector<std::string> distributions = {"uniform", "normal", "lognormal"};
inline const std::vector<std::string> keep = {"final", "peak", "history"};
inline const std::vector<std::string> history = {"of", "every"};
inline const std::vector<std::string> correlation = {"of", "matrix"};
inline const std::vector<std::string> design = {"type", "levels"};
inline const std::vector<std::string> designs = {"product", "one-at-a-time", "morris", "saltelli"};
inline const std::vector<std::string> failures = {"continue", "stop"};
inline const std::vector<std::string> evaluations = {"one-at-a-time", "in-lanes"};
}  // namespace keys

inline constexpr double most_cases = 1e12;

/// Values of a plan's document as numbers, texts and maps.
class PlanReader {
 public:
  PlanReader(const Document& document, Diagnostics& diagnostics) : document_(document), diagnostics_(diagnostics) {}

  /// Whether it is a map whose keys are all known; reports what is not.
  bool is_map(const Value& value, const std::vector<std::string>& known) const;
  /// One of these texts; the first where the value is null.
  std::optional<std::size_t> choice(const Value* value, const std::vector<std::string>& names) const;
  std::optional<std::string> text(const Value& value) const;
  std::vector<std::string> texts(const Value* value) const;
  /// A whole number of this range; `otherwise` where there is none.
  std::uint64_t whole(const Value* value, double least, double most, std::uint64_t otherwise) const;
  /// A number in SI units, from a number or a text with any unit, with the unit's dimension.
  struct Number {
    double si = 0;
    Dimension dimension{};
  };
  std::optional<Number> number(const Value& value) const;
  /// The distribution named `kind` with these members, whose units are of one kind.
  std::optional<Distribution> distribution(const std::string& kind, const Value& value) const;
  /// A list of values, or from, to and count.
  Levels grid(const Value& value) const;

  void error(const Place& place, std::string message) const { diagnostics_.error(place, std::move(message)); }
  void key_error(const std::string& path, std::string message) const {
    diagnostics_.error(document_.key_place(path), std::move(message));
  }
  [[nodiscard]] Place key_place(const std::string& path) const { return document_.key_place(path); }
  [[nodiscard]] const std::string& directory() const { return document_.directory; }

 private:
  Levels range(const Value& value) const;

  const Document& document_;
  Diagnostics& diagnostics_;
};

}  // namespace withy::campaign
