/// \file
/// What is thrown for bad input.
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include "withy/core/plugin/value.hpp"

namespace withy {

/// Thrown for bad input. what() is the whole report, one problem a line, each as
/// `arm.yaml:66:14: /bodies/boom/bending_y/stiffness: got nan; need finite > 0 [N m^2]`.
class SceneError : public std::runtime_error {
 public:
  /// `origins` describe places that are not in the file: those with line −1−k stand in origins[k].
  SceneError(std::string file, std::vector<Diagnostic> problems, const std::vector<std::string>& origins = {});
  /// In the order of the file.
  [[nodiscard]] const std::vector<Diagnostic>& problems() const { return problems_; }

 private:
  std::vector<Diagnostic> problems_;
};

}  // namespace withy
