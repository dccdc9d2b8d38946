#include "withy/campaign/plan_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "withy/scene/describe.hpp"
#include "withy/scene/names.hpp"

namespace withy::campaign {
namespace {

constexpr double most_levels = 1e6;

bool known(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// Numbers as numbers alone, where all are.
Levels levels_of(const std::vector<Value>& values) {
  Levels levels;
  const auto plain = [](const Value& v) { return v.kind() == Value::Kind::number; };
  if (!std::all_of(values.begin(), values.end(), plain)) {
    levels.values = values;
    return levels;
  }
  for (const Value& v : values) levels.numbers.push_back(v.number());
  return levels;
}

}  // namespace

bool PlanReader::is_map(const Value& value, const std::vector<std::string>& names) const {
  if (value.kind() != Value::Kind::map) {
    error(value.place(), fmt::format("got {}; need a map with {}", shown(value), listed(names)));
    return false;
  }
  bool good = true;
  for (const auto& [key, member] : value.members()) {
    if (known(names, key)) continue;
    key_error(value.place().path + "/" + key, fmt::format("unknown key {}{}", in_quotes(key), suggestion(key, names)));
    good = false;
  }
  return good;
}

std::optional<std::size_t> PlanReader::choice(const Value* value, const std::vector<std::string>& names) const {
  if (value == nullptr) return 0;
  if (value->kind() == Value::Kind::text && known(names, value->text()))
    return std::find(names.begin(), names.end(), value->text()) - names.begin();
  const std::string guess = value->kind() == Value::Kind::text ? nearest(value->text(), names) : "";
  error(value->place(), fmt::format("got {}{}; need one of: {}", shown(*value),
                                    guess.empty() ? "" : fmt::format("; did you mean '{}'?", guess), listed(names)));
  return {};
}

std::optional<std::string> PlanReader::text(const Value& value) const {
  if (value.kind() == Value::Kind::text) return value.text();
  error(value.place(), fmt::format("got {}; need text", shown(value)));
  return {};
}

std::vector<std::string> PlanReader::texts(const Value* value) const {
  std::vector<std::string> all;
  if (value == nullptr) return all;
  if (value->kind() != Value::Kind::list) {
    error(value->place(), fmt::format("got {}; need a list of names, as [shoulder]", shown(*value)));
    return all;
  }
  for (const Value& item : value->items())
    if (auto name = text(item)) all.push_back(std::move(*name));
  return all;
}

std::uint64_t PlanReader::whole(const Value* value, double least, double most, std::uint64_t otherwise) const {
  if (value == nullptr) return otherwise;
  const double x = value->kind() == Value::Kind::number ? value->number() : std::nan("");
  if (x >= least && x <= most && std::floor(x) == x) return static_cast<std::uint64_t>(x);
  error(value->place(), fmt::format("got {}; need a whole number from {:g} to {:g}", shown(*value), least, most));
  return otherwise;
}

std::optional<PlanReader::Number> PlanReader::number(const Value& value) const {
  if (value.kind() == Value::Kind::number && std::isfinite(value.number())) return Number{value.number(), {}};
  std::string why;
  if (value.kind() == Value::Kind::text) {
    const AnyQuantity read = read_any_quantity(value.text());
    if (read.value) return Number{*read.value, read.dimension};
    why = read.problem.empty() ? "" : ": " + read.problem;
  }
  error(value.place(), fmt::format("got {}{}; need a finite number, in SI units or with its unit", shown(value), why));
  return {};
}

std::optional<Distribution> PlanReader::distribution(const std::string& kind, const Value& value) const {
  const bool uniform = kind == "uniform";
  const std::vector<std::string>& members = uniform ? keys::uniform : keys::normal;
  if (!is_map(value, members)) return {};
  Distribution d;
  d.kind = uniform ? Distribution::Kind::uniform
                   : (kind == "normal" ? Distribution::Kind::normal : Distribution::Kind::lognormal);
  std::optional<Dimension> dimension;
  bool good = true;
  const auto take = [&](const std::string& key, auto& target, bool required) {
    const Value* given = value.find(key);
    if (given == nullptr) {
      if (required) key_error(value.place().path + "/" + key, "missing; need a number");
      good = good && !required;
      return;
    }
    const auto read = number(*given);
    good = good && read;
    if (!read) return;
    if (dimension && *dimension != read->dimension) {
      error(given->place(), "its unit is another than that of the numbers before: give all of them units, or none");
      good = false;
    }
    dimension = read->dimension;
    target = read->si;
  };
  if (!uniform) {
    take("mean", d.mean, true);
    take("deviation", d.deviation, true);
  }
  take("from", d.from, uniform);
  take("to", d.to, uniform);
  if (!good) return {};
  if (const std::string problem = d.problem(); !problem.empty()) {
    error(value.place(), problem);
    return {};
  }
  return d;
}

Levels PlanReader::grid(const Value& value) const {
  if (value.kind() == Value::Kind::list && !value.items().empty()) return levels_of(value.items());
  if (value.kind() == Value::Kind::map) return range(value);
  error(value.place(), fmt::format("got {}; need a list of values, or from, to and count", shown(value)));
  return {};
}

Levels PlanReader::range(const Value& value) const {
  Levels levels;
  if (!is_map(value, keys::range)) return levels;
  for (const std::string& key : keys::range)
    if (!value.has(key)) {
      key_error(value.place().path + "/" + key, "missing; need from, to and count");
      return levels;
    }
  const auto from = number(value.at("from")), to = number(value.at("to"));
  const std::uint64_t count = whole(value.find("count"), 2, most_levels, 0);
  if (!from || !to || count == 0) return levels;
  if (from->dimension != to->dimension) {
    error(value.at("to").place(), "its unit is another than that of 'from'");
    return levels;
  }
  for (std::uint64_t i = 0; i + 1 < count; ++i)
    levels.numbers.push_back(from->si +
                             (to->si - from->si) * (static_cast<double>(i) / static_cast<double>(count - 1)));
  levels.numbers.push_back(to->si);
  return levels;
}

}  // namespace withy::campaign
