/// \file
/// The frequency response of a scene from one input to one output.
#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "withy/core/analysis/balanced_truncation.hpp"
#include "withy/core/analysis/frequency_response.hpp"
#include "withy/study/linear_model.hpp"

namespace withy::study {

struct ResponseQuestion {
  /// As Ports::inputs; or a load that feeds states back, whose loop is then opened (open_loop.hpp).
  std::string input;
  std::string output;              ///< as Ports::outputs, of one component; empty of an opened loop
  std::optional<double> from, to;  ///< [Hz]; nothing: a decade around poles and zeros
  int per_decade = 100;            ///< 5 to 100000
  std::optional<int> reduce;       ///< states of a reduced system, at least none
};

/// An output that nothing of the input reaches: of these two there is no response.
class Unfelt : public std::domain_error {
 public:
  using std::domain_error::domain_error;
};

struct Response {
  LinearModel model;    ///< of one input and one output
  bool opened = false;  ///< the loop of a load; else the scene as it is
  /// Of an opened loop, as commands_followed.
  std::vector<std::string> follows = {};
  Eigen::VectorXcd every;  ///< all poles: of sampled systems multipliers e^{sT}
  SeenRoots roots;         ///< what the input moves and the output sees
  /// Poles at s = 0 that the output sees: the static response is then like gain/s^integrators.
  int integrators = 0;
  double static_gain = 0;  ///< G(0), or the limit of s^integrators G
  /// Of each of roots.poles: |r/λ| over the sum of all, r its residue in G; 0 of poles at 0 and of sampled systems.
  std::vector<double> participation;
  std::vector<ResponseAt> values;
  std::vector<Peak> peaks;
  std::optional<Margins> margins;  ///< of the loop v = −k y; nothing where that is not well posed, or frozen
  std::optional<Reduction> reduction;
  double reduction_error = 0;  ///< greatest difference of the reduced system over `values`
};

/// \throws InputError; std::domain_error where the mass matrix is singular; Unfelt.
Response response(const Configuration& configuration, const ResponseQuestion& question);

}  // namespace withy::study
