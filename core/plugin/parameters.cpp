#include "withy/core/plugin/parameters.hpp"

namespace withy {
namespace {

ParameterSpec make(ParameterSpec::Kind kind, std::string key, std::string unit, std::string meaning) {
  ParameterSpec s;
  s.kind = kind;
  s.key = std::move(key);
  s.unit = std::move(unit);
  s.meaning = std::move(meaning);
  return s;
}

}  // namespace

ParameterSpec ParameterSpec::above(double x) && {
  minimum = x;
  exclusive_minimum = true;
  return std::move(*this);
}

ParameterSpec ParameterSpec::least(double x) && {
  minimum = x;
  return std::move(*this);
}

ParameterSpec ParameterSpec::most(double x) && {
  maximum = x;
  return std::move(*this);
}

ParameterSpec ParameterSpec::or_table(std::string abscissa_unit) && {
  columns = {std::move(abscissa_unit), unit};
  count = columns.size();
  return std::move(*this);
}

ParameterSpec ParameterSpec::otherwise(Value v) && {
  fallback = std::move(v);
  required = false;
  return std::move(*this);
}

ParameterSpec ParameterSpec::otherwise(double x) && { return std::move(*this).otherwise(Value(x)); }

ParameterSpec ParameterSpec::otherwise(const char* s) && { return std::move(*this).otherwise(Value(std::string(s))); }

ParameterSpec ParameterSpec::optional() && {
  required = false;
  return std::move(*this);
}

ParameterSpec ParameterSpec::one_of(std::vector<std::string> names) && {
  choices = std::move(names);
  return std::move(*this);
}

ParameterSpec ParameterSpec::naming(Refers what) && {
  refers = what;
  return std::move(*this);
}

ParameterSpec ParameterSpec::as(Role what) && {
  role = what;
  return std::move(*this);
}

ParameterSpec number(std::string key, std::string unit, std::string meaning) {
  return make(ParameterSpec::Kind::number, std::move(key), std::move(unit), std::move(meaning));
}

ParameterSpec integer(std::string key, std::string meaning) {
  return make(ParameterSpec::Kind::integer, std::move(key), "1", std::move(meaning));
}

ParameterSpec boolean(std::string key, std::string meaning) {
  return make(ParameterSpec::Kind::boolean, std::move(key), "1", std::move(meaning));
}

ParameterSpec text(std::string key, std::string meaning) {
  return make(ParameterSpec::Kind::text, std::move(key), "", std::move(meaning));
}

ParameterSpec vector(std::string key, std::size_t count, std::string unit, std::string meaning) {
  ParameterSpec s = make(ParameterSpec::Kind::vector, std::move(key), std::move(unit), std::move(meaning));
  s.count = count;
  return s;
}

ParameterSpec table(std::string key, std::vector<std::string> column_units, std::string meaning) {
  ParameterSpec s = make(ParameterSpec::Kind::table, std::move(key), "", std::move(meaning));
  s.count = column_units.size();
  s.columns = std::move(column_units);
  return s;
}

ParameterSpec map(std::string key, std::vector<ParameterSpec> members, std::string meaning) {
  ParameterSpec s = make(ParameterSpec::Kind::map, std::move(key), "", std::move(meaning));
  s.members = std::move(members);
  return s;
}

ParameterSpec named(std::string key, std::vector<ParameterSpec> members, std::string meaning) {
  ParameterSpec s = make(ParameterSpec::Kind::named, std::move(key), "", std::move(meaning));
  s.members = std::move(members);
  return s;
}

ParameterSpec matrix(std::string key, std::string unit, std::string meaning) {
  return make(ParameterSpec::Kind::matrix, std::move(key), std::move(unit), std::move(meaning));
}

ParameterSpec texts(std::string key, std::string meaning) {
  return make(ParameterSpec::Kind::texts, std::move(key), "", std::move(meaning));
}

}  // namespace withy
