/// \file
/// The value of a scene at which the error of a model passes a limit.
#pragma once

#include <functional>
#include <vector>

namespace withy::study {

/// Where an error passes a limit.
struct Crossing {
  enum class Kind {
    passes,  ///< at a value within the range
    holds,   ///< nowhere in the range
    exceeds  ///< the error is above the limit where the range begins
  };
  Kind kind = Kind::holds;
  double value = 0;    ///< of `passes`
  bool fails = false;  ///< of `passes`: just beyond, the model has no answer at all
};

/// The first of the values' intervals in which the error goes from below the limit to above, and the value in it where
/// it does, by the algorithm TOMS 748 (Alefeld, Potra & Shi 1995).
/// \param error relative, at a value; infinite where the model has no answer.
/// \param accuracy of the value, relative to the greatest of `values`.
Crossing find_crossing(const std::function<double(double)>& error, const std::vector<double>& values, double limit,
                       double accuracy);

}  // namespace withy::study
