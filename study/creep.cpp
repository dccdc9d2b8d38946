#include "withy/study/creep.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace withy::study {
namespace {

/// The greatest rate of a hinge none of whose speeds is held; nothing where it does not move, or moves at a rate that
/// no rest has.
std::optional<double> slow_rate(const Layout& layout, const Slot& slot, const State& state, const Held& held) {
  constexpr double fastest = 1e-6;
  double greatest = 0;
  for (std::size_t i = slot.speed; i < slot.speed + slot.speeds; ++i) {
    if (held[i]) return {};
    greatest = std::max(greatest, std::abs(state.y[layout.positions + i]));
  }
  return greatest > 0 && greatest <= fastest ? std::optional(greatest) : std::nullopt;
}

/// How long a hinge takes of itself to come and go along its rates [s]; infinite where nothing pulls it.
double own_time(const Tangents& t, const Slot& slot, const Eigen::VectorXd& rates) {
  const auto first = static_cast<Eigen::Index>(slot.speed), count = static_cast<Eigen::Index>(slot.speeds);
  const auto along = [&](const Eigen::MatrixXd& by) {
    return std::abs(rates.dot(by.block(first, first, count, count) * rates));
  };
  const double k = along(t.by_position);
  return k > 0 ? std::max(std::sqrt(along(t.mass) / k), along(t.by_speed) / k)
               : std::numeric_limits<double>::infinity();
}

}  // namespace

State without_creep(const TangentDynamics& dynamics, State state, const Held& held, double resolved) {
  constexpr double typed_share = 1e-9;  // as of is_steady_state
  const Layout& layout = dynamics.model().layout();
  double size = 1e-6;
  for (std::size_t i = 0; i < layout.positions; ++i) size = std::max(size, std::abs(state.y[i]));
  const double far = std::max(resolved, typed_share * size);
  std::optional<Tangents> t;  // where a hinge is slow
  for (const Slot& slot : layout.hinges) {
    const std::optional<double> rate = slow_rate(layout, slot, state, held);
    if (!rate) continue;
    if (!t) t = dynamics.tangents(state.time, state.y, dynamics.steady_accelerations(state.time));
    const auto first = state.y.begin() + static_cast<std::ptrdiff_t>(layout.positions + slot.speed);
    const Eigen::VectorXd rates =
        Eigen::Map<const Eigen::VectorXd>(&*first, static_cast<Eigen::Index>(slot.speeds)) / *rate;
    if (*rate * own_time(*t, slot, rates) <= far)
      std::fill(first, first + static_cast<std::ptrdiff_t>(slot.speeds), 0.0);
  }
  return state;
}

}  // namespace withy::study
