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

/// Where the discrete or the continuous states of a load stand in State::y.
struct LoadSlot {
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
  std::size_t prescribed = 0;                 ///< count of the speeds that motions prescribe
  std::size_t continuous = 0;                 ///< count of continuous states of loads
  std::size_t discrete = 0;                   ///< count of discrete states of loads
  std::vector<LoadSlot> continuous_slots;     ///< of the loads with a continuous part, in their order
  std::vector<LoadSlot> discrete_slots;       ///< of the loads that have discrete states, in their order
  std::vector<std::string> continuous_names;  ///< as `servo.integral`

  /// Number of elements of State::y.
  [[nodiscard]] std::size_t size() const { return moving() + discrete + 1; }
  /// Those that change between instants and on which derivatives depend: positions, speeds and continuous states.
  [[nodiscard]] std::size_t moving() const { return positions + speeds + continuous; }
  [[nodiscard]] const Slot* hinge(std::string_view name) const;
  [[nodiscard]] const Slot* body(std::string_view name) const;
  /// Modes of a body of the model, by its index; null where it has none.
  [[nodiscard]] const Slot* modes(std::size_t index) const {
    return modes_of[index] < 0 ? nullptr : &bodies[static_cast<std::size_t>(modes_of[index])];
  }
};

/// Time [s], then in one array y: positions (hinge coordinates [rad, m], modal coordinates), speeds (their rates; for
/// quaternions the angular velocity), continuous states of loads (with differential equations of their own), discrete
/// states of loads (constant between instants, so their derivatives are zero), and last the work [J] done so far by
/// loads, motions and damping.
struct State {
  double time = 0;
  std::vector<double> y;
};

}  // namespace withy
