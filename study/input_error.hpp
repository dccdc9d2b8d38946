/// \file
/// Bad input that stands in no file: what a study was asked for.
#pragma once

#include <stdexcept>

namespace withy::study {

/// what() says in a sentence what was asked and what could be.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace withy::study
