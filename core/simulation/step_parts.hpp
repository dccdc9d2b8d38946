/// \file
/// How closely a step is looked into.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "withy/core/model/model.hpp"

namespace withy {

/// Divides steps into equal parts for what looks into them. A step is as long as the motion allows, which says nothing
/// of what is watched: a rotor that turns freely has the same rate for ever, and its coordinate is followed exactly
/// over a hundred turns, where a place on it goes to and fro. No hinge turns further than half a radian in a part, by
/// its rates at both ends, and a run has 256 parts or more.
class StepParts {
 public:
  /// \param start, end of the run [s]; an infinite end: of unknown length
  StepParts(const Model& model, double start, double end);
  /// Leaves out what turns a coordinate, an element of y, that nothing watched depends on, as a reaction wheel beside a
  /// relay on the hull: where `matters` is false of it.
  void leave_out(const std::function<bool(std::size_t coordinate)>& matters);
  /// \param length of the step [s]
  /// \param before, after the states y at its ends
  [[nodiscard]] std::size_t operator()(double length, std::span<const double> before,
                                       std::span<const double> after) const;

 private:
  /// Elements of y: a rate that turns something, and the coordinate that is its integral; −1: there is none.
  struct Turning {
    std::size_t rate;
    std::ptrdiff_t coordinate;
  };
  std::vector<Turning> turning_;
  double longest_ = 0;  ///< part [s]
};

}  // namespace withy
