/// \file
/// What modelDescription.xml of an FMU says that an importer for co-simulation needs.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace withy::fmu_load {

struct FmuVariable {
  std::string name;
  std::uint32_t reference = 0;
  std::string type;       ///< as the standard's element: Real, Float64, Boolean …
  std::string causality;  ///< local where the description says nothing
  bool array = false;

  [[nodiscard]] bool is_number() const { return !array && (type == "Real" || type == "Float64"); }
};

struct FmuDescription {
  int version = 2;  ///< of the standard
  std::string token, identifier;
  bool keeps_states = false;        ///< its state can be had as bytes and set again
  bool once_only = false;           ///< one instance a process
  std::optional<double> step = {};  ///< [s] that the model proposes
  std::vector<FmuVariable> variables;
};

/// \throws FmuError where it is no description of an FMU for co-simulation in version 2.0 or 3.0 that can be imported.
FmuDescription read_description(const std::string& text);

}  // namespace withy::fmu_load
