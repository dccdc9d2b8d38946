/// \file
/// What studies of a scene are asked for, by the names of the program's options.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace withy::host {

/// A table or a state: a file or, in its place, its text, for which the name then stands in messages.
struct Given {
  std::string file = {};
  std::optional<std::string> text = {};
  /// Whether there is one at all.
  [[nodiscard]] bool any() const { return text.has_value() || !file.empty(); }
};

/// Where small motions are looked at, and what turns or slides there at a constant rate.
struct Place {
  Given at = {};  ///< a state, in the form of `initial` in a scene; none: the scene's initial state
  /// `hinge=rate`, as "axle=6.0" [rad/s, m/s] or "axle=60 rev/min": held at that rate.
  std::vector<std::string> spin = {};
};

/// What is asked of modes beside what is held.
struct ModesWish {
  Place place = {};
  std::string sweep = {};  ///< `path=from:to:count`, a number of the scene or `spin.HINGE`; empty: one configuration
  std::size_t count = 6;   ///< lowest frequencies that are set against the next model up; 0: none
  bool as_is = false;      ///< about the state as it is given, without finding the steady one
  bool floquet = false;    ///< characteristic exponents over a whole turn
  /// Names of equal blades, or `auto`; nothing: they are not looked at.
  std::optional<std::vector<std::string>> blades = {};
  double period = 0;                   ///< of motions and loads [s]; 0: that of the hinges' rates
  bool effective_mass = false;         ///< how much of the mass each mode moves
  std::vector<std::string> damp = {};  ///< ratios that the lowest vibrations shall have, as "0.01" or "1 %"
};

struct ResponseWish {
  std::string input = {};   ///< a load of the type input, a hinge, or a load that feeds back: its loop is opened
  std::string output = {};  ///< one component of an output, a coordinate or a tip; empty of an opened loop
  std::optional<double> from = {}, to = {};  ///< [Hz]; nothing: a decade beyond the poles
  int points = 100;                          ///< a decade, 5 to 100000
  std::optional<int> reduce = {};            ///< balanced truncation to so many states
};

}  // namespace withy::host
