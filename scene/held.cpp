#include "withy/scene/held.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "withy/core/model/held_numbers.hpp"
#include "withy/scene/describe.hpp"
#include "withy/scene/names.hpp"

namespace withy {
namespace {

bool read_numbers(const Value& value, const Checker& checker, std::span<double> held) {
  if (value.kind() != Value::Kind::list || value.items().size() != held.size()) {
    checker.diagnostics().error(value.place(), fmt::format("got {}; need a list of {} finite numbers, as a run has "
                                                           "written it",
                                                           shown(value), held.size()));
    return false;
  }
  bool good = true;
  for (std::size_t i = 0; i < held.size(); ++i) {
    const auto x = checker.check(value.items()[i], number("", "1", ""));
    if (x) held[i] = x->number();
    good = good && x.has_value();
  }
  return good;
}

}  // namespace

bool read_held(const Value& value, const Model& model, const Checker& checker, State& state) {
  if (!checker.is_map(value, "a map of names of loads that hold numbers between instants")) return false;
  bool good = true;
  std::vector<std::string> names;
  for (const LoadNode& load : model.loads()) {
    const std::span<double> held = held_numbers(load, std::span(state.y));
    if (held.empty()) continue;
    names.push_back(load.name);
    if (const Value* own = value.find(load.name)) {
      good = read_numbers(*own, checker, held) && good;
    } else {
      checker.diagnostics().error(
          value.place(), fmt::format("nothing of load {}; need all that hold numbers, or leave out 'held' for all to "
                                     "begin anew",
                                     in_quotes(load.name)));
      good = false;
    }
  }
  for (const auto& [name, member] : value.members()) {
    if (std::find(names.begin(), names.end(), name) != names.end()) continue;
    checker.key_error(member.place().path,
                      fmt::format("no load that holds numbers {}{}", in_quotes(name), checker.suggest(name, names)));
    good = false;
  }
  if (const auto begun = place_of_begun(model); begun && good) state.y[*begun] = 1;
  return good;
}

}  // namespace withy
