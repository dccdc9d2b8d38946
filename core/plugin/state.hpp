/// \file
/// The state of a model: the only truth. Copy it, compare it, restart from it.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace withy {

/// Where a hinge or a body stands in the arrays of a State.
struct Slot {
  std::string name;
  std::size_t position = 0;   ///< first index among the positions
  std::size_t positions = 0;  ///< count
  std::size_t speed = 0;      ///< first index among the speeds
  std::size_t speeds = 0;     ///< count
};

/// Where the discrete states of a load stand in State::y.
struct DiscreteSlot {
  std::size_t load = 0;  ///< index in Model::loads()
  std::size_t first = 0;
  std::size_t count = 0;
};

/// Order of the numbers in a State: for each body, parents before children, its inboard hinge then its modes.
struct Layout {
  std::vector<Slot> hinges;
  std::vector<Slot> bodies;              ///< only flexible ones
  std::vector<int> modes_of;             ///< of each body its index in `bodies`; −1: it is rigid
  std::vector<std::string> speed_names;  ///< as `shoulder.0`, `link1.bending_y[1]`
  std::size_t positions = 0;
  std::size_t speeds = 0;
  std::size_t discrete = 0;                  ///< count of discrete states
  std::vector<DiscreteSlot> discrete_slots;  ///< of the loads that have any, in their order

  /// Number of elements of State::y.
  [[nodiscard]] std::size_t size() const { return positions + speeds + discrete + 1; }
  [[nodiscard]] const Slot* hinge(std::string_view name) const;
  [[nodiscard]] const Slot* body(std::string_view name) const;
  /// Modes of a body of the model, by its index; null where it has none.
  [[nodiscard]] const Slot* modes(std::size_t index) const {
    return modes_of[index] < 0 ? nullptr : &bodies[static_cast<std::size_t>(modes_of[index])];
  }
};

/// Time [s], then in one array y: positions (hinge coordinates [rad, m], modal coordinates), speeds (their rates; for
/// quaternions the angular velocity), discrete states of loads (constant between instants, so their derivatives are
/// zero), and last the work [J] done so far by loads, motions and damping.
struct State {
  double time = 0;
  std::vector<double> y;
};

}  // namespace withy
