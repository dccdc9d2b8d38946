/// \file
/// What a plugin expects in a scene. The reader checks values against these specifications, converts their units and
/// fills in defaults; `withy schema` and `withy plugins` print them.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "withy/core/plugin/value.hpp"

namespace withy {

/// Specification of one parameter. Make it with the functions below and refine it by chaining:
/// `number("length", "m", "length of the undeformed beam").above(0)`. A parameter is required unless it has a default
/// (`otherwise`) or may be left out (`optional`).
struct ParameterSpec {
  enum class Kind {
    number,   ///< finite number in `unit`; with `columns` a table of it as well (`or_table`)
    integer,  ///< whole number
    boolean,  ///< true or false
    text,     ///< a name; with `choices` one of them; with `refers` the name of a hinge, body, frame, load or plugin;
              ///< with both either
    vector,   ///< `count` numbers in `unit`
    table,    ///< rows of `count` numbers, the first column strictly increasing; column units are `columns`; ranges are
              ///< of the other columns
    map,      ///< the members given in `members`
    named,    ///< any number of named maps, each with `members`; the names refer as `refers` says
    matrix,   ///< rows of numbers in `unit`, one row at least and all of one length, at least one
    texts,    ///< a text, or a list of them, at least one: as `text`; becomes a list
  };
  /// What a name must be the name of; the reader reports dangling names.
  enum class Refers {
    nothing,
    body,
    hinge,
    frame,
    load,
    mode_family,
    motion,
    strain_kinematics,
    formulation,
    signal,  ///< a number that loads measure: a column of a hinge, a number of an output, what a load gives
             ///< (signals.hpp)
    input    ///< a load of type input
  };
  /// What a parameter is to studies, whatever its key: they vary those that have a role (mode_parameters.hpp).
  enum class Role {
    none,
    modes,          ///< number of modes of a body or of one of its strains: more make a finer model
    bending_family  ///< family of the modes in bending whose number stands in the same map
  };

  Kind kind = Kind::number;
  std::string key;
  std::string unit;     ///< SI unit, as "N m^2"; "1" where there is none
  std::string meaning;  ///< one sentence for the schema
  bool required = true;
  std::optional<Value> fallback;     ///< value where the scene gives none
  std::optional<double> minimum;     ///< least value allowed
  std::optional<double> maximum;     ///< greatest value allowed
  bool exclusive_minimum = false;    ///< the minimum itself is not allowed
  std::vector<std::string> choices;  ///< texts allowed
  Refers refers = Refers::nothing;
  Role role = Role::none;
  std::size_t count = 0;
  std::vector<std::string> columns;
  std::vector<ParameterSpec> members;

  ParameterSpec above(double x) &&;  ///< value > x
  ParameterSpec least(double x) &&;  ///< value ≥ x
  ParameterSpec most(double x) &&;   ///< value ≤ x
  /// For a number: or a table of it over an abscissa of this unit.
  ParameterSpec or_table(std::string abscissa_unit) &&;
  ParameterSpec otherwise(Value v) &&;        ///< default
  ParameterSpec otherwise(double x) &&;       ///< default
  ParameterSpec otherwise(const char* s) &&;  ///< default
  ParameterSpec optional() &&;                ///< may be left out, without a default
  ParameterSpec one_of(std::vector<std::string> names) &&;
  ParameterSpec naming(Refers what) &&;
  ParameterSpec as(Role what) &&;
};

ParameterSpec number(std::string key, std::string unit, std::string meaning);
ParameterSpec integer(std::string key, std::string meaning);
ParameterSpec boolean(std::string key, std::string meaning);
ParameterSpec text(std::string key, std::string meaning);
ParameterSpec vector(std::string key, std::size_t count, std::string unit, std::string meaning);
ParameterSpec table(std::string key, std::vector<std::string> column_units, std::string meaning);
ParameterSpec map(std::string key, std::vector<ParameterSpec> members, std::string meaning);
ParameterSpec named(std::string key, std::vector<ParameterSpec> members, std::string meaning);
ParameterSpec matrix(std::string key, std::string unit, std::string meaning);
ParameterSpec texts(std::string key, std::string meaning);

}  // namespace withy
