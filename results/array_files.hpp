/// \file
/// Named arrays in the files of other programs: MATLAB's level 5 and NumPy's .npz.
#pragma once

#include <Eigen/Core>
#include <string>
#include <variant>
#include <vector>

namespace withy {

/// A matrix, or a list of texts in UTF-8.
struct NamedArray {
  std::string name;
  std::variant<Eigen::MatrixXd, std::vector<std::string>> content;
};

/// The bytes of a MAT-file of level 5, without compression: matrices of doubles, texts as a cell array (a column).
std::string mat_file(const std::vector<NamedArray>& arrays);
/// The bytes of an archive for `numpy.load`: arrays of float64, texts as an array of unicode strings; nothing pickled.
std::string npz_file(const std::vector<NamedArray>& arrays);

}  // namespace withy
