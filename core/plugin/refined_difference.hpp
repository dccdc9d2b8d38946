/// \file
/// Numerical derivatives of what says nothing of its scale.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <type_traits>
#include <utility>

#include "withy/core/plugin/central_difference.hpp"

namespace withy {

inline constexpr double golden_section = std::numbers::phi - 1;

/// Derivatives with what is left between the two steps that told them.
template <class Matrix>
struct RefinedDifference {
  Matrix slope, change;  ///< `change` is infinite where there were no two steps
  Matrix rounding;       ///< what digits of f, and of the place where it is differentiated, may make of the slope
  Matrix step;           ///< the shorter of the two
};

/// Where a function has treads, element by element: over the short step `fine` its differences about multiples of the
/// long one, `wide`, are what they are about 0, and between these multiples it goes otherwise. So does what rounds its
/// argument, as (x + 1e10) − 1e10: steps shorter than a tread see nothing of how it climbs. A kink, a dead zone, a
/// limit and one jump have none: short steps see another slope beside them, or long ones in one place alone.
template <class Function, class Matrix>
Eigen::ArrayXX<bool> has_treads(Function&& f, double wide, double fine, const Matrix& wide_slope,
                                const Matrix& fine_slope) {
  constexpr std::array<double, 8> places = {-4, -3, -2, -1, 1, 2, 3, 4};
  constexpr int fewest_same = 6, fewest_risen = 3;  // of 8, some of which may lie at a jump, and of 7
  const Eigen::ArrayXXd near = 0.1 * (wide_slope - fine_slope).array().abs();
  const auto is_another = [&](const Eigen::ArrayXXd& slope) -> Eigen::ArrayXXi {
    return (!((slope - fine_slope.array()).abs() <= near)).template cast<int>();
  };
  Eigen::ArrayXXi others = Eigen::ArrayXXi::Zero(near.rows(), near.cols()), risen = others;
  Eigen::ArrayXXd before;
  for (std::size_t k = 0; k < places.size(); ++k) {
    const Eigen::ArrayXXd behind = f(places[k] * wide - fine), ahead = f(places[k] * wide + fine);
    Eigen::ArrayXXd value = (behind + ahead) / 2;
    others += is_another((ahead - behind) / (2 * fine));
    if (k > 0) risen += is_another((value - before) / ((places[k] - places[k - 1]) * wide));
    before = std::move(value);
  }
  return others <= static_cast<int>(places.size()) - fewest_same && risen >= fewest_risen;
}

/// Of how stairs climb, what steps of different lengths may make of it: twenty treads to a step.
inline constexpr double same_climb = 0.05;

/// Where treads are those of stairs: they climb, and long steps see it alike whatever their length. What repeats is
/// none, as a phase that is wrapped: within a pitch it climbs faster than in the whole, and of the whole long steps see
/// what their length makes of it.
template <class Function, class Matrix>
Eigen::ArrayXX<bool> in_stairs(Function&& f, double wide, double fine, const Matrix& wide_slope,
                               const Matrix& fine_slope) {
  const Matrix shorter = central_difference(f, golden_section * wide);
  const Eigen::ArrayXXd apart = (wide_slope - fine_slope).array().abs();
  const Eigen::ArrayXX<bool> climbs =
      (shorter - wide_slope).array().abs() <= same_climb * apart && wide_slope.array().abs() > fine_slope.array().abs();
  if (!climbs.any()) return climbs;
  return climbs && has_treads(f, wide, fine, wide_slope, fine_slope);
}

/// Finds the derivatives of refine_difference().
template <class Function>
class Refinement {
 public:
  Refinement(Function& f, double h, double place)
      : f_(f), place_(std::abs(place)), shortest_(16 * epsilon * place_), h_(first_step(h)), wide_(h_) {
    first_ = before_ = difference();
    best_ = {before_, before_, before_, before_};
    best_.change.setConstant(std::numeric_limits<double>::infinity());
    best_.rounding = best_.change;
    best_.step.setConstant(h_);
    settled_.setConstant(before_.rows(), before_.cols(), false);
  }
  [[nodiscard]] bool done() const { return settled_.all() || h_ / 8 < shortest_; }

  void refine() {
    const Eigen::ArrayXXd sizes_before = sizes_, left_before = rounding * sizes_ / h_;
    h_ /= 8;
    Matrix finer = difference();
    Eigen::ArrayXX<bool> stairs;  // found where they are asked for
    for (Eigen::Index i = 0; i < finer.size(); ++i) {
      if (settled_(i)) continue;
      const double left = std::abs(before_(i) - finer(i)), least = left_before(i) + rounding * sizes_(i) / h_;
      // What is greater nearby than far off was out of reach of longer steps, and nothing but their zeros agreed.
      if (sizes_(i) > 2 * sizes_before(i)) best_.change(i) = std::numeric_limits<double>::infinity();
      // Steps of which rounding is most may agree by chance, the shortest on nothing at all.
      settled_(i) = least > best_.change(i);
      if (settled_(i)) continue;
      settled_(i) = left <= agreed * std::abs(finer(i)) + least && !(finer(i) == 0 && left == 0 && acts_beside(i));
      if (settled_(i) && is_new(finer, i)) {
        if (stairs.size() == 0) stairs = in_stairs(f_, wide_, h_, first_, finer);
        if (stairs(i)) {  // what longer steps have told stands
          best_.change(i) = std::min(best_.change(i), same_climb * std::abs(first_(i) - finer(i)));
          continue;
        }
      }
      if (!settled_(i) && !(left < best_.change(i))) continue;
      best_.slope(i) = before_(i);
      best_.change(i) = left;
      best_.rounding(i) = least + 4 * epsilon * std::abs(place_ * before_(i)) / h_;
      best_.step(i) = h_;
    }
    before_ = std::move(finer);
  }
  [[nodiscard]] auto result() && { return std::move(best_); }

 private:
  using Matrix = std::decay_t<std::invoke_result_t<Function&, double>>;
  static constexpr double epsilon = std::numeric_limits<double>::epsilon(), agreed = 1e-12, rounding = 64 * epsilon;

  /// The power of two next to h: places that are not far out are exact then, and f alone rounds. It is no whole
  /// multiple of what divides a millimetre or a turn: of what repeats in it a whole number of times, as teeth and
  /// magnets do, neither it nor an eighth of it would see anything. None is below 16 of the least digits of the place.
  [[nodiscard]] double first_step(double h) const {
    if (!(h > 0) || !std::isfinite(h)) return h;
    const double power = std::exp2(std::round(std::log2(h)));
    return power < 8 * shortest_ && std::isfinite(shortest_) ? std::exp2(std::ceil(std::log2(8 * shortest_))) : power;
  }
  Matrix difference() {
    sizes_.resize(0, 0);
    return central_difference(
        [&](double at) -> Matrix {
          Matrix values = f_(at);
          if (sizes_.size() == 0) sizes_.setZero(values.rows(), values.cols());
          sizes_ = sizes_.max(values.array().abs());
          return values;
        },
        h_);
  }
  /// Whether an element changes over the shortest step: one that two steps find zero may act nearer than these reach.
  bool acts_beside(Eigen::Index i) {
    if (beside_.size() == 0) {
      const double step = std::max(0x1p-20 * h_, shortest_);
      const Matrix ahead = f_(step), behind = f_(-step);
      beside_ = (ahead - behind).array();
    }
    return beside_(i) != 0;
  }
  /// Whether an element is what the first step knew nothing of.
  [[nodiscard]] bool is_new(const Matrix& slope, Eigen::Index i) const {
    constexpr double same = 1e-6;
    const double first = first_(i), now = slope(i);
    return std::abs(first - now) > same * std::max(std::abs(first), std::abs(now));
  }

  Function& f_;
  double place_, shortest_, h_, wide_;
  Eigen::ArrayXXd sizes_;  ///< greatest |f| of a step, for the rounding of its difference
  Matrix first_, before_;
  Eigen::ArrayXXd beside_;  ///< what the shortest step changes, once that is asked
  RefinedDifference<Matrix> best_;
  Eigen::ArrayXX<bool> settled_;
};

/// f′(0) of a function that returns an Eigen matrix which owns its elements, by the central difference of eighth order
/// with a step near h where an eighth of it gives the same, element by element; else by shorter ones until two agree,
/// or until rounding is more than what two have left. Truncation falls by 8⁸ from one to the next: a spring of a
/// millimetre is as exact as one of a metre, whose numbers are those of h, and a controller is seen within its limit.
/// What no two of `levels` pairs agree on is told as the two do that are nearest: a jump as h has it. What short steps
/// agree on is not believed of a function that goes in stairs, as rounding makes them: mostly nothing at all.
/// \param place the number that steps are added to, where it is known: none is shorter than it resolves
template <class Function>
auto refine_difference(Function&& f, double h, int levels, double place = 0) {
  Refinement refinement(f, h, place);
  for (int level = 0; level < levels && !refinement.done(); ++level) refinement.refine();
  return std::move(refinement).result();
}

/// Of what says nothing of its scale: steps of a unit come to 4e-15 of it, within limits of a nanonewton.
inline constexpr int most_refinements = 16;

/// The derivatives alone, with steps down to h/8¹⁶.
template <class Function>
auto refined_difference(Function&& f, double h, double place = 0) {
  return refine_difference(f, h, most_refinements, place).slope;
}

}  // namespace withy
