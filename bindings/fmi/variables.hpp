/// \file
/// The variables of a scene's FMU: what modelDescription.xml lists and the library in the FMU answers to.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "withy/core/model/columns.hpp"
#include "withy/study/prepared.hpp"

namespace withy::fmi {

/// One number. Its value reference is its index in Variables::all.
struct Variable {
  enum class Kind {
    time,
    state,       ///< continuous; those that tables of results show are outputs too
    derivative,  ///< of the state of the same index
    input,       ///< a load of type `input`
    output,      ///< another column of the tables
    parameter,   ///< a number of the scene
    indicator    ///< whose zeros are events
  };
  Kind kind = Kind::output;
  std::size_t index = 0;         ///< of state or derivative; load in Model::loads(); column in ResultColumns; parameter
  std::string name;              ///< that of the column, the load, or the path in the scene; der(NAME)
  std::string unit;              ///< SI; empty: none
  std::string description = {};  ///< may be empty
  double start = 0;
  std::optional<double> minimum = {}, maximum = {};
  /// Of states: that of a load, which says where it begins at what else the start is, until it is set itself.
  bool begun = false;
  /// Of states: of a scene with loops, which are closed by what is not set.
  bool closes = false;
  /// Of outputs: the state alone decides them; else the inputs may as well.
  bool of_state_alone = false;
  /// Of parameters: may be set between the steps of a simulation; else they are fixed.
  bool tunable = false;
  /// Of states: what else is set may change where it begins.
  [[nodiscard]] bool approximate() const { return begun || closes; }
  /// "variable 'arm'", for messages.
  [[nodiscard]] std::string quoted() const { return "variable '" + name + "'"; }
};

struct Variables {
  std::vector<Variable> all;  ///< time, states, derivatives, inputs, outputs, parameters, indicators
  std::size_t states = 0, inputs = 0, outputs = 0, parameters = 0, indicators = 0;

  [[nodiscard]] std::size_t state(std::size_t i) const { return 1 + i; }
  [[nodiscard]] std::size_t derivative(std::size_t i) const { return 1 + states + i; }
  [[nodiscard]] std::size_t input(std::size_t i) const { return 1 + 2 * states + i; }
  [[nodiscard]] std::size_t output(std::size_t i) const { return input(inputs) + i; }
  [[nodiscard]] std::size_t parameter(std::size_t i) const { return output(outputs) + i; }
  [[nodiscard]] std::size_t indicator(std::size_t i) const { return parameter(parameters) + i; }
};

/// \param registry that the scene was made with: it knows the units and ranges of parameters
/// \throws study::InputError where two of them would have one name, or the formulation is `auto`.
Variables variables_of(const study::Prepared& prepared, Registry& registry);

/// Tells one FMU from another: a UUID made of the scene with its settings, the files it names and the variables.
std::string token_of(const study::Prepared& prepared, const Variables& variables);

/// Count of event indicators: switching functions of loads, then the scene's events that watch a number.
std::size_t indicator_count(const Scene& scene);

}  // namespace withy::fmi
