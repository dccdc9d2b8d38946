/// \file
/// modelDescription.xml of FMI 2.0 and 3.0.
#pragma once

#include <string>

#include "withy/bindings/fmi/variables.hpp"

namespace withy::fmi {

/// What a user asks of an FMU.
struct Description {
  int version = 2;             ///< of the standard, 2 or 3
  bool model_exchange = true;  ///< one of the two at least
  bool co_simulation = true;
  std::string identifier;  ///< name of the library in binaries/, an identifier in C
  std::string token;
};

std::string model_description(const Description& description, const study::Prepared& prepared,
                              const Variables& variables);

/// What categories its log has, with their meanings.
struct LogCategory {
  const char *name, *meaning;
};
inline constexpr LogCategory log_category_list[] = {
    {"logStatusError", "calls that are wrong, scenes that cannot be made"},
    {"logStatusDiscard", "states and steps that cannot be computed, with the reason"},
    {"logEvents", "events of the scene that a step has passed"},
    {"logAll", "all of them, and remarks of the integrator"}};

}  // namespace withy::fmi
