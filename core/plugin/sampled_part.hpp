/// \file
/// Discrete parts of loads that measure more than coordinates.
#pragma once

#include <string>
#include <vector>

#include "withy/core/plugin/load.hpp"

namespace withy {

/// A DiscretePart that is renewed with numbers which it knows by name: columns of hinges, what other loads give, and
/// numbers of the scene's outputs, accelerations and efforts among them. They are those of the state just before the
/// instant, with the efforts held until then: there is no loop. Its DiscretePart::renew does nothing.
class SampledPart {
 public:
  virtual ~SampledPart() = default;
  /// Names of what it is renewed with, as find_signal knows them.
  [[nodiscard]] virtual std::vector<std::string> measures() const = 0;
  /// As DiscretePart::renew. \param measured one number a name of `measures`
  virtual void renew_measured(double t, const Crossing& crossing, std::span<const double> measured,
                              std::span<double> discrete) const noexcept = 0;
};

/// A SensedState that reads what loads give to others, each bound to the bodies of the equations that it is of.
class SensedLoads {
 public:
  virtual ~SensedLoads() = default;
  /// One of the numbers of the load's LoadOutput, with the accelerations of the state observed and other discrete
  /// states: those of `y`, laid out as State::y.
  [[nodiscard]] virtual double given(std::size_t load, std::size_t number, std::span<const double> y) noexcept = 0;
  /// What a load that has LoadNumbers tells of itself at the state observed; until the next call.
  [[nodiscard]] virtual std::span<const double> numbers(std::size_t load) noexcept = 0;
};

}  // namespace withy
