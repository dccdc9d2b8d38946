/// \file
/// Sequences of calls that bytes choose: what a host does to the interface in C, an importer to an FMU.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <string>
#include <string_view>

namespace withy::fuzz {

void call_the_c_interface(std::string_view bytes);
/// The first byte says of which version and kind.
void call_an_fmu(std::string_view bytes);

/// Choices that bytes make; zeros behind their end.
class Choices {
 public:
  explicit Choices(std::string_view bytes) : rest_(bytes) {}
  [[nodiscard]] bool any() const { return !rest_.empty(); }
  std::size_t below(std::size_t n) {
    if (rest_.empty()) return 0;
    const auto byte = static_cast<unsigned char>(rest_.front());
    rest_.remove_prefix(1);
    return byte % n;
  }
  bool rarely() { return below(16) == 15; }
  /// A number that may be set; now and then one that must not be.
  double number() {
    constexpr double some[] = {0, 0.1, -0.3, 1, 2.5, 1e-3, 1e300, -1e-310};
    constexpr double wrong[] = {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()};
    return rarely() ? wrong[below(2)] : some[below(std::size(some))];
  }
  /// A count that is right; now and then another.
  std::size_t count(std::size_t right) { return rarely() ? below(40) : right; }
  template <class T>
  T* maybe(T* pointer) {
    return rarely() ? nullptr : pointer;
  }

 private:
  std::string_view rest_;
};

/// A bad status without a reason is a finding.
inline void expect(bool condition, const std::string& what) {
  if (!condition) throw std::logic_error(what);
}

/// An arm with inputs, a sampled controller and events, in steps of one length: every call takes a bounded time.
inline constexpr const char* called_scene = R"(format: withy/1
time: {end: 0.04, output: 0.01}
integrator: {name: rk4, step: 0.01}
bodies:
  hub: {type: rigid, mass: 1, inertia: [0.1, 0.1, 0.2, 0, 0, 0]}
  boom: {type: beam, length: 1, mass_per_length: 0.5, bending_y: {stiffness: 3, modes: 1}, damping_ratio: 0.01}
hinges:
  base: {type: spherical, parent: world, child: hub}
  axle: {type: revolute, axis: [0, 0, 1], parent: hub, child: boom}
loads:
  torque: {type: input, hinge: axle}
  ramp: {type: input, hinge: base, component: 2, hold: linear}
  hold: {type: pd-controller, law: constant, sample: 0.02, hinges: {axle: {to: 0.3, stiffness: 1, damping: 0.2}}}
)";

}  // namespace withy::fuzz
