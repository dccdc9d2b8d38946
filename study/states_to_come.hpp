/// \file
/// A state as hinges go on that move, and as time does: whether numbers that are read off it, or their derivatives, are
/// others then.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "withy/core/analysis/turn.hpp"
#include "withy/study/small_motions.hpp"

namespace withy::study {

/// What becomes of one number. Of its derivatives nobody has looked where there is no displacement.
struct GoingOn {
  bool moves = false;   ///< it is another as hinges go on
  bool timed = false;   ///< it is another as time goes on by itself
  bool turns = false;   ///< its derivatives are others as hinges go on
  bool shakes = false;  ///< its derivatives are others as time goes on by itself
};

/// What is read off states that are as SmallMotions::state().
using Reading = std::function<Eigen::VectorXd(const State&)>;
/// The state displaced by so many steps, of which one is small.
using Displacement = std::function<State(const State&, double)>;

class StatesToCome {
 public:
  /// \param motions must outlive it, as the configuration \param turning of its state; where it has no common period, a
  /// turn of the slowest hinge is looked at \param pushed loads push with time: derivatives by time are those soon
  /// after \param timed whether time is looked at beside a turn, up to the end of the run
  StatesToCome(const Configuration& configuration, const SmallMotions& motions, const Turning& turning, bool pushed,
               bool timed);

  /// \param groups of each number: rounding is measured against all that are of one
  /// \param displacement none: derivatives are not looked at \param few at some instants, not at all
  /// \returns one a number; nothing of states at which the reading throws std::domain_error
  [[nodiscard]] std::vector<GoingOn> look(const Reading& reading, const std::vector<std::string>& groups,
                                          const Displacement& displacement, bool few = false) const;
  /// Displaces all that small motions have, and moves it, no two alike, by about a step each.
  [[nodiscard]] Displacement everything() const;
  [[nodiscard]] bool pushed() const { return pushed_; }

 private:
  struct Instant {
    double after = 0;  ///< [s]
    bool soon = true;
  };
  struct Read {
    Eigen::VectorXd here, by;  ///< `by`: what the displacement makes of it
  };
  struct Looked;
  [[nodiscard]] State carried_on(double after) const;
  [[nodiscard]] State of_place(double after) const;

  const Configuration& c_;
  const SmallMotions& motions_;
  Turning turning_;
  State state_;  ///< inputs hold what they have, whatever a run is given later
  bool pushed_;
  std::vector<Instant> few_, more_;
};

}  // namespace withy::study
