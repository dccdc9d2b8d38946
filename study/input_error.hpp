/// \file
/// Bad input that stands in no file: what a study was asked for.
#pragma once

#include <stdexcept>
#include <string>

namespace withy::study {

/// what() says in a sentence what was asked and what could be.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// One of the things asked for cannot be: what() begins with its name, as "accuracy: got '3 kg'; need …".
class OptionError : public InputError {
 public:
  OptionError(const std::string& option, const std::string& message) : InputError(option + ": " + message) {}
};

}  // namespace withy::study
