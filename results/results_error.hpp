/// \file
/// What is thrown where results on disk are not those that were asked for.
#pragma once

#include <stdexcept>

namespace withy {

/// Results are damaged, or another run's; what() names the file or folder and says what to do. They are left as they
/// are.
class ResultsError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace withy
