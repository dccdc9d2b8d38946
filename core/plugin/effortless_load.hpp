/// \file
/// What most loads say that act by their parts or by wrenches.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "withy/core/plugin/load.hpp"

namespace withy {

/// A load without efforts of its own: what there is of it is in its parts, as its discrete states, or in wrenches that
/// those who ask for them differentiate. It does not jump, has no end and wants no beginning, unless a class says so.
class EffortlessLoad : public BoundLoad {
 public:
  [[nodiscard]] std::size_t scratch() const override { return 0; }
  void add(double /*t*/, std::span<const double> /*positions*/, std::span<const double> /*speeds*/,
           std::span<double> /*efforts*/, std::span<double> /*scratch*/) const noexcept override {}
  bool add_derivatives(double /*t*/, std::span<const double> /*positions*/, std::span<const double> /*speeds*/,
                       Eigen::Ref<Eigen::MatrixXd> /*by_position*/,
                       Eigen::Ref<Eigen::MatrixXd> /*by_speed*/) const override {
    return true;
  }
  [[nodiscard]] std::vector<double> discontinuities() const override { return {}; }
  [[nodiscard]] double end() const override { return 0; }
  void begin(State& /*state*/) const override {}
};

}  // namespace withy
