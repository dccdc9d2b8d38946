/// \file
/// The models and integrations that a trade study goes through.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "withy/apps/withy/engine.hpp"
#include "withy/apps/withy/variation.hpp"

namespace withy::app {

/// One of them.
struct TradePoint {
  std::string formulation;
  std::string family;
  int modes = 0;
  std::string integrator;
  double tolerance = 0;
  std::vector<std::string> over;  ///< `path=value`
  /// Bodies whose formulation is another, with its name.
  std::vector<std::pair<std::string, std::string>> bodies{};

  /// The same for the same point, and fit for a file's name.
  [[nodiscard]] std::string key() const;
  /// "quadratic", "quadratic (boom, mast: ruthless)".
  [[nodiscard]] std::string formulation_text() const;
  /// "quadratic, 2 modes, dopri5 at 1e-06".
  [[nodiscard]] std::string text() const;
};

/// The product of the axes, formulations varying slowest. \throws InputError where a value cannot be.
std::vector<TradePoint> trade_points(const TradeAxes& axes);

/// The arguments with which the scene becomes the point's. Initial modal coordinates keep their numbers; modes that are
/// new start at rest.
SceneArguments arguments_at(const SceneArguments& base, const Scene& scene, const TradePoint& point);

}  // namespace withy::app
