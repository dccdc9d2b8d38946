/// \file
/// Where the numbers come from that loads measure by their names.
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

#include "withy/core/model/model.hpp"

namespace withy {

/// A number of a state.
struct SignalSource {
  enum class Kind {
    position,  ///< an element of State::y
    rate,      ///< likewise
    load,      ///< what a load gives to others
    output,    ///< of a sensor of Model::measured()
    unbound    ///< of one that has no sensor yet: it depends on loads that are bound later
  };
  Kind kind = Kind::position;
  std::size_t index = 0;   ///< of the position, the speed or the load; of an output among the numbers of all
  std::size_t number = 0;  ///< among what a load gives
};

/// A name that is no number of a model.
struct UnknownSignal : std::invalid_argument {
  UnknownSignal(std::string called, std::vector<std::string> there_are);

  std::string name;
  std::vector<std::string> known;  ///< what could have been meant
};

/// The source of a column of a hinge (`shoulder`, `shoulder.rate`), of what a load gives (`servo`, of several numbers
/// `servo.0`) or of a number of an output (`imu.z`), in this order where several have the name.
/// \throws UnknownSignal where there is no such number; the text has those that there are.
SignalSource find_signal(const Model& model, const std::string& name);

/// Whether a name is both that of a hinge's column, which find_signal takes, and that of what a load gives.
bool is_of_hinge_and_load(const Model& model, const std::string& name);
/// Whether a name is that of what a load gives, which find_signal takes before the number of an output.
bool is_of_load(const Model& model, const std::string& name);

}  // namespace withy
