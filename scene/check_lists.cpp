// Values with many items: vectors, tables, matrices, lists of texts, maps of names.
#include <fmt/format.h>

#include <utility>

#include "withy/scene/check.hpp"
#include "withy/scene/names.hpp"

namespace withy {
namespace {

/// The list of what a check makes of each item; nothing where it makes nothing of one.
template <class Check>
std::optional<Value> each_checked(const Value& list, Check&& check) {
  Value result = Value::list({}, list.place());
  bool good = true;
  for (const Value& item : list.items()) {
    std::optional<Value> checked = check(item);
    good = good && checked.has_value();
    if (good) result.items().push_back(std::move(*checked));
  }
  if (!good) return {};
  return result;
}

}  // namespace

std::optional<Value> Checker::row(const Value& value, const ParameterSpec& spec) const {
  if (value.kind() != Value::Kind::list || (spec.count != 0 && value.items().size() != spec.count)) {
    got(value, spec);
    return {};
  }
  Value result = Value::list({}, value.place());
  result.items().reserve(value.items().size());
  bool good = true;
  const bool alike = spec.kind != ParameterSpec::Kind::table;  // the items of a table have units of their own
  for (std::size_t i = 0; i < value.items().size(); ++i) {
    if (const Value& given = value.items()[i];
        alike && given.kind() == Value::Kind::number && in_range(given.number(), spec)) {
      result.items().push_back(given);
      continue;
    }
    ParameterSpec item = spec;
    item.kind = ParameterSpec::Kind::number;
    if (spec.kind == ParameterSpec::Kind::table) {
      item.unit = spec.columns[i];
      item.columns.clear();
      if (i == 0) item.minimum = item.maximum = {};
    }
    if (auto x = number(value.items()[i], item, item.unit)) {
      result.items().push_back(std::move(*x));
    } else {
      good = false;
    }
  }
  if (!good) return {};
  return result;
}

std::optional<Value> Checker::table(const Value& value, const ParameterSpec& spec) const {
  if (value.kind() != Value::Kind::list || value.items().empty()) {
    got(value, spec);
    return {};
  }
  Value result = Value::list({}, value.place());
  bool good = true;
  for (const Value& item : value.items()) {
    auto r = row(item, spec);
    if (!r) {
      good = false;
      continue;
    }
    if (good && !result.items().empty()) {
      const double before = result.items().back().items()[0].number();
      const double now = r->items()[0].number();
      if (now <= before) {
        diagnostics_.error(item.items()[0].place(),
                           fmt::format("got {} after {}; the first column must increase", now, before));
        good = false;
      }
    }
    result.items().push_back(std::move(*r));
  }
  if (!good) return {};
  return result;
}

std::optional<Value> Checker::matrix(const Value& value, const ParameterSpec& spec) const {
  const auto is_row = [](const Value& item) { return item.kind() == Value::Kind::list && !item.items().empty(); };
  if (value.kind() != Value::Kind::list || value.items().empty() || !is_row(value.items()[0])) {
    got(value, spec);
    return {};
  }
  ParameterSpec line = spec;
  line.kind = ParameterSpec::Kind::vector;
  line.count = value.items()[0].items().size();
  return each_checked(value, [&](const Value& item) { return row(item, line); });
}

std::optional<Value> Checker::texts(const Value& value, const ParameterSpec& spec) const {
  ParameterSpec one = spec;
  one.kind = ParameterSpec::Kind::text;
  if (value.kind() != Value::Kind::list) {
    auto single = text(value, one);
    if (!single) return {};
    return Value::list({std::move(*single)}, value.place());
  }
  if (value.items().empty()) {
    got(value, spec);
    return {};
  }
  return each_checked(value, [&](const Value& item) { return text(item, one); });
}

std::optional<Value> Checker::named(const Value& value, const ParameterSpec& spec) const {
  if (!is_map(value, [&] { return expectation(spec); })) return {};
  Value result = Value::map({}, value.place());
  bool good = true;
  for (const auto& [name, member] : value.members()) {
    const std::string& path = member.place().path;
    if (spec.refers == ParameterSpec::Refers::nothing) {
      if (const std::string problem = name_problem(name); !problem.empty()) {
        key_error(path, fmt::format("got name {}; {}", in_quotes(name), problem));
        good = false;
      }
    } else if (!refers(document_.key_place(path), name, spec.refers)) {
      good = false;
    }
    const Subject outside = subject_;
    if (spec.refers == ParameterSpec::Refers::hinge) subject_ = {moves(name, member), moves(name, member), {}};
    auto checked = check_members(member, spec.members);
    subject_ = outside;
    if (checked) {
      result.members().emplace_back(name, std::move(*checked));
    } else {
      good = false;
    }
  }
  if (!good) return {};
  return result;
}

}  // namespace withy
