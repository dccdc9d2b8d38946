#include "withy/study/narrow_loads.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>

#include "withy/study/load_efforts.hpp"
#include "withy/study/timed_loads.hpp"

namespace withy::study {
namespace {

constexpr int fine_angles = 719, finer_angles = 4127;  // primes: nothing repeats with them
/// What counts as rounding, of an effort's greatest size and of the greatest of all.
constexpr double effort_rounding = 1e-9, effort_rounding_of_all = 1e-12;
/// A mean error of this share of the greatest is seen by nobody.
constexpr double unseen_share = 1e-3;

/// Efforts of loads on the free speeds, a column an angle: at the states, then what a displacement makes of them.
class EffortsOverATurn {
 public:
  EffortsOverATurn(const Configuration& c, const State& steady, const Turning& turning, double over)
      : c_(c),
        steady_(steady),
        turning_(turning),
        over_(over),
        free_(free_speeds(c.held())),
        work_(c.prepared().equations->make_work()) {}

  [[nodiscard]] State at(double share) const {
    return carried(c_.prepared().model(), turning_, steady_, over_ * share);
  }
  /// At a state and a time [s], of one load or all: efforts, then what a displacement makes of them.
  [[nodiscard]] Eigen::VectorXd of(const State& state, double time, int load = EquationsOfMotion::all_loads) {
    const auto m = static_cast<Eigen::Index>(free_.size());
    Eigen::VectorXd both(2 * m);
    both.head(m) = efforts(time, state, load);
    both.tail(m) = efforts(time, displaced_anyhow(c_, state), load) - both.head(m);
    return both;
  }
  /// A column an angle.
  [[nodiscard]] Eigen::MatrixXd all(int angles) {
    Eigen::MatrixXd columns(2 * static_cast<Eigen::Index>(free_.size()), angles);
    for (int k = 0; k < angles; ++k) {
      const State state = at(static_cast<double>(k) / angles);
      columns.col(k) = of(state, state.time);
    }
    return columns;
  }
  [[nodiscard]] const std::vector<Eigen::Index>& free() const { return free_; }
  /// Derivatives of efforts along the displacement, at a state and the start's time, of one load or all.
  [[nodiscard]] Differenced slopes(const State& place, int load = EquationsOfMotion::all_loads) {
    return slopes_anyhow(c_, place, [&](const State& state) { return efforts(steady_.time, state, load); });
  }
  /// What of an effort's change is asked for.
  enum class Change { any, at_the_states, of_small_motions };
  /// The load that acts most otherwise at a share of the turn than at its start.
  [[nodiscard]] std::string load_at(double share, Change asked) {
    const State there = at(share);
    std::string name;
    double most = 0;
    const std::vector<LoadNode>& loads = c_.prepared().model().loads();
    for (std::size_t l = 0; l < loads.size(); ++l)
      if (const double by = change(there, static_cast<int>(l), asked); by > most) most = by, name = loads[l].name;
    return name;
  }

 private:
  double change(const State& there, int load, Change asked) {
    if (asked == Change::of_small_motions) return other_slopes(slopes(steady_, load), slopes(there, load)).maxCoeff();
    const Eigen::VectorXd by = (of(there, there.time, load) - of(steady_, steady_.time, load)).cwiseAbs();
    return asked == Change::any ? by.maxCoeff() : by.head(by.size() / 2).maxCoeff();
  }
  Eigen::VectorXd efforts(double time, const State& state, int load) {
    return c_.dynamics().on_motions(state.y, load_efforts(*c_.prepared().equations, time, state, load, work_))(free_,
                                                                                                               0);
  }

  const Configuration& c_;
  const State& steady_;
  const Turning& turning_;
  double over_;  ///< [s]
  std::vector<Eigen::Index> free_;
  Work work_;
};

/// What counts as rounding of each row.
Eigen::VectorXd rounding_of_rows(const Eigen::MatrixXd& efforts) {
  const Eigen::VectorXd greatest = efforts.cwiseAbs().rowwise().maxCoeff();
  return (effort_rounding * greatest.array() + effort_rounding_of_all * greatest.maxCoeff()).matrix();
}

/// The trigonometric polynomials through equal instants (an odd count), at other equal ones.
Eigen::MatrixXd between_equal_instants(const Eigen::MatrixXd& efforts, Eigen::Index angles) {
  const auto count = static_cast<double>(efforts.cols());
  Eigen::MatrixXd weights(efforts.cols(), angles);
  for (Eigen::Index j = 0; j < weights.rows(); ++j) {
    for (Eigen::Index k = 0; k < angles; ++k) {
      const double half =
          std::numbers::pi * (static_cast<double>(k) / static_cast<double>(angles) - static_cast<double>(j) / count);
      weights(j, k) = std::abs(std::sin(half)) < 1e-14 ? 1.0 : std::sin(count * half) / (count * std::sin(half));
    }
  }
  return efforts * weights;
}

/// Where, as a share of the period, what equal instants say of an effort is most off, if they do not show it.
std::optional<double> missed_between(const Eigen::MatrixXd& instants, const Eigen::MatrixXd& fine) {
  const Eigen::MatrixXd off = (fine - between_equal_instants(instants, fine.cols())).cwiseAbs();
  const Eigen::VectorXd rounding = rounding_of_rows(fine);
  for (Eigen::Index row = 0; row < fine.rows(); ++row) {
    const auto varies = [&](const Eigen::MatrixXd& efforts) {
      return efforts.row(row).maxCoeff() - efforts.row(row).minCoeff() > rounding[row];
    };
    const double size = fine.row(row).cwiseAbs().maxCoeff();
    if (!varies(fine) || (varies(instants) && off.row(row).mean() <= unseen_share * size + rounding[row])) continue;
    Eigen::Index most = 0;
    off.row(row).maxCoeff(&most);
    return static_cast<double>(most) / static_cast<double>(fine.cols());
  }
  return {};
}

}  // namespace

std::string meet_narrow_loads(const Configuration& c, const State& steady, TurnCheck& check) {
  const double over = one_turn(c.prepared().model(), check.turning, steady);
  if (check.periodic() || over == 0 || c.prepared().model().loads().empty()) return {};
  EffortsOverATurn turn(c, steady, check.turning, over);
  const auto m = static_cast<Eigen::Index>(turn.free().size());
  if (m == 0) return {};
  const Eigen::MatrixXd efforts = turn.all(fine_angles);
  const Eigen::VectorXd rounding = rounding_of_rows(efforts), start = efforts.col(0);
  using Rows = Eigen::Array<bool, Eigen::Dynamic, 1>;
  const auto others = [&](const Eigen::VectorXd& there) -> Rows {
    return (there - start).array().abs() > rounding.array();
  };
  const Differenced slopes = turn.slopes(steady);
  // What a displacement makes of an effort's square is nothing to small motions.
  const auto bends = [&](const State& there, const Rows& changed) {
    return (changed && other_equations(slopes, turn.slopes(there), differenced_equations, Eigen::VectorXd::Zero(m)))
        .any();
  };
  using Change = EffortsOverATurn::Change;
  std::string name;
  for (int k = 1; k < fine_angles && (check.steady || check.constant); ++k) {
    const Rows changed = others(efforts.col(k));
    if ((!check.steady || !changed.head(m).any()) && (!check.constant || !changed.tail(m).any())) continue;
    const double share = static_cast<double>(k) / fine_angles;
    const State there = turn.at(share);
    // What time alone makes of it is not of the angle.
    const Rows of_place = changed && others(turn.of(there, steady.time));
    if (check.steady && of_place.head(m).any()) {
      check.steady = false;
      if (name.empty()) name = turn.load_at(share, Change::at_the_states);
    }
    if (check.constant && of_place.tail(m).any() && bends(there, of_place.tail(m))) {
      check.constant = false;
      if (name.empty()) name = turn.load_at(share, Change::of_small_motions);
    }
  }
  return name;
}

std::size_t instants_of_loads(const Configuration& c, const State& steady, const Turning& turning) {
  constexpr std::size_t fewest = 15, most = 1023;
  if (c.prepared().model().loads().empty() || !(turning.period > 0) || free_speeds(c.held()).empty()) return fewest;
  EffortsOverATurn turn(c, steady, turning, turning.period);
  Eigen::MatrixXd fine = turn.all(fine_angles);
  double share = 0;
  for (std::size_t count = fewest; count <= most; count = 2 * count + 1) {
    if (4 * count > static_cast<std::size_t>(fine.cols())) fine = turn.all(finer_angles);
    const std::optional<double> missed = missed_between(turn.all(static_cast<int>(count)), fine);
    if (!missed) return count;
    share = *missed;
  }
  throw std::domain_error(
      fmt::format("load '{}' acts in so narrow a part of it that {} instants do not show it, and whether small motions "
                  "grow is not known",
                  turn.load_at(share, EffortsOverATurn::Change::any), most));
}

}  // namespace withy::study
