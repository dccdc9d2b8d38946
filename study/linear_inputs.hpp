/// \file
/// What goes into linear models: values of input loads, efforts on speeds.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "withy/study/small_motions.hpp"

namespace withy::study {

/// Something that pushes: what one unit of it does to the speeds, and the state with so much more of it.
struct LinearInput {
  Column column;
  Eigen::VectorXd efforts;
  std::function<State(double)> state_at;
};
/// Those of Ports::inputs; they refer to `motions`. \throws InputError where there is no such input, or it is held
std::vector<LinearInput> chosen_inputs(const Configuration& configuration, const SmallMotions& motions,
                                       const std::vector<std::string>& names);

}  // namespace withy::study
