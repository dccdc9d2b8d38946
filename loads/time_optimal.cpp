#include "withy/loads/time_optimal.hpp"

#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <random>

namespace withy {

namespace {

using Vector = LimitedTree::Vector;
using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 4, 4>;
/// Switches, axis by axis, then the end: as many as the state has elements, or one more.
using Times = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 5, 1>;
/// Derivatives of the final state with respect to the times.
using Slopes = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 4, 5>;

/// How often each axis switches, and the signs it starts with.
struct Structure {
  std::vector<int> switches;
  std::vector<int> signs;
};

/// Between two switches the efforts are constant.
struct Segment {
  double duration;
  double efforts[2];
};

/// Bang-bang motions of one structure.
class Family {
 public:
  Family(const LimitedTree& tree, Structure structure) : tree_(tree), structure_(std::move(structure)) {
    const auto n = static_cast<Eigen::Index>(tree.axes().size());
    start_ = target_ = Vector::Zero(2 * n);
    for (Eigen::Index i = 0; i < n; ++i) {
      start_[i] = tree.axes()[static_cast<std::size_t>(i)].from;
      target_[i] = tree.axes()[static_cast<std::size_t>(i)].to;
    }
  }

  /// Times at which the motion ends at rest at the target, by Newton's method with the least change.
  std::optional<Times> reach(Times times, int steps) const {
    constexpr double least = 1.0 / 50;  // of Newton's step: guesses that crawl are given up
    Vector miss = end(times, steps) - target_;
    for (int iteration = 0; iteration < 30; ++iteration) {
      if (miss.norm() < 1e-10) return times;
      const Eigen::MatrixXd J = rough_slopes(times, miss + target_, steps);
      const Eigen::VectorXd wanted = -miss, change = J.completeOrthogonalDecomposition().solve(wanted);
      double part = 1;
      for (; part > least; part *= 0.5) {
        const Times next = times + part * change;
        if (!ordered(next)) continue;
        const Vector left = end(next, steps) - target_;
        if (left.norm() > (1 - 0.1 * part) * miss.norm()) continue;
        times = next;
        miss = left;
        break;
      }
      if (part <= least) return {};
    }
    return {};
  }

  /// The same, and of the least time. With one switch more than reaching takes there is a curve of such times: it is
  /// followed downhill, by steps along its tangent and back onto it, to where the end is stationary.
  std::optional<Times> solve(const Times& guess, int steps) const {
    std::optional<Times> times = reach(guess, steps);
    if (!times || times->size() == target_.size()) return times;
    const Eigen::Index last = times->size() - 1;
    Times tangent = downhill(*times, steps);
    double length = 0.02 * (*times)[last];
    for (int step = 0; step < 60; ++step) {
      if (std::abs(tangent[last]) < 1e-7) return times;
      const Times next = *times + length * tangent;
      const auto landed = ordered(next) ? reach(next, steps) : std::nullopt;
      if (!landed) {
        length *= 0.3;
        if (length < 1e-6 * (*times)[last]) return {};  // two switches meet: the curve ends here, still falling
        continue;
      }
      const Times onward = downhill(*landed, steps);
      const bool passed = onward.dot(tangent) < 0;
      const double slope = std::abs(tangent[last]), left = (passed ? -1 : 1) * std::abs(onward[last]);
      // The secant of the slopes points at the minimum.
      length = std::min(2 * length, length * std::abs(left / (slope - left)));
      times = landed;
      tangent = onward;
    }
    return {};
  }

  /// Pontryagin's principle for least time. The costate λ at the end is orthogonal to what any switch does to the final
  /// state and has λ·(ẋ, ẍ) = 1; back in time it obeys λ̇ = −(∂f/∂x)ᵀ λ. Wherever λ·∂f/∂τ_i > 0 the effort τ_i must be
  /// at its upper limit, and at its lower where it is negative.
  bool extremal(const Times& times, int steps) const {
    const Eigen::Index n = target_.size();
    const Eigen::VectorXd goal = Eigen::VectorXd::Unit(times.size(), times.size() - 1);
    const Eigen::MatrixXd adjoint = slopes(times, steps).transpose();
    const Eigen::VectorXd nearest = adjoint.colPivHouseholderQr().solve(goal);
    Vector costate = nearest;
    struct Sample {
      Vector state;
      const Segment* segment;
    };
    const std::vector<Segment> segments = this->segments(times);
    std::vector<Sample> samples;
    Vector state = start_;
    for (const Segment& s : segments) {
      for (int k = 0; k < steps; ++k) {
        samples.push_back({state, &s});
        state = moved(state, s, 1.0 / steps, 1);
      }
    }
    double most[2] = {0, 0}, worst[2] = {0, 0};
    for (std::size_t k = samples.size(); k-- > 0;) {
      const Sample& sample = samples[k];
      Matrix transition(n, n);
      const double h = 1e-6;
      for (Eigen::Index j = 0; j < n; ++j) {
        Vector ahead = sample.state, behind = sample.state;
        ahead[j] += h;
        behind[j] -= h;
        transition.col(j) =
            (moved(ahead, *sample.segment, 1.0 / steps, 1) - moved(behind, *sample.segment, 1.0 / steps, 1)) / (2 * h);
      }
      costate = (transition.transpose() * costate).eval();
      for (std::size_t i = 0; i < tree_.axes().size(); ++i) {
        const double idle[2] = {0, 0};
        double unit[2] = {0, 0};
        unit[i] = 1;
        const Vector gain = tree_.derivative(sample.state, unit) - tree_.derivative(sample.state, idle);
        const double agreement = costate.dot(gain) * (sample.segment->efforts[i] > 0 ? 1 : -1);
        most[i] = std::max(most[i], std::abs(agreement));
        worst[i] = std::min(worst[i], agreement);
      }
    }
    // At the switches the function is zero but for the error of differences. It is zero throughout, and any effort
    // extremal, for an axis that has time to spare because another decides; λ·(ẋ, ẍ) = 1 gives zero its scale.
    for (std::size_t i = 0; i < tree_.axes().size(); ++i) {
      if (!(worst[i] >= -1e-4 * (most[i] + 1 / tree_.axes()[i].limit))) return false;
    }
    return true;
  }

  SwitchingPlan plan(const Times& times) const {
    SwitchingPlan result;
    Eigen::Index next = 0;
    for (std::size_t i = 0; i < tree_.axes().size(); ++i) {
      SwitchingPlan::Axis axis{structure_.signs[i] * tree_.axes()[i].limit, {}};
      for (int k = 0; k < structure_.switches[i]; ++k) axis.switches.push_back(times[next++]);
      result.axes.push_back(std::move(axis));
    }
    result.end = times[times.size() - 1];
    return result;
  }

  /// Switches in the order of each axis, between 0 and the end.
  bool ordered(const Times& times) const {
    Eigen::Index next = 0;
    for (const int count : structure_.switches) {
      double before = 0;
      for (int k = 0; k <= count; ++k) {
        const double t = k < count ? times[next++] : times[times.size() - 1];
        if (!(t > before)) return false;
        before = t;
      }
    }
    return true;
  }

 private:
  std::vector<Segment> segments(const Times& times) const {
    std::vector<std::pair<double, std::size_t>> events;
    Eigen::Index next = 0;
    Segment now{};
    for (std::size_t i = 0; i < structure_.switches.size(); ++i) {
      now.efforts[i] = structure_.signs[i] * tree_.axes()[i].limit;
      for (int k = 0; k < structure_.switches[i]; ++k) events.emplace_back(times[next++], i);
    }
    std::sort(events.begin(), events.end());
    std::vector<Segment> all;
    double t = 0;
    for (const auto& [at, axis] : events) {
      now.duration = at - t;
      all.push_back(now);
      now.efforts[axis] = -now.efforts[axis];
      t = at;
    }
    now.duration = times[times.size() - 1] - t;
    all.push_back(now);
    return all;
  }

  /// After a part of a segment, by the classical Runge–Kutta method.
  Vector moved(Vector y, const Segment& s, double part, int steps) const {
    const double h = part * s.duration / steps;
    for (int k = 0; k < steps; ++k) {
      const Vector k1 = tree_.derivative(y, s.efforts);
      const Vector k2 = tree_.derivative(y + 0.5 * h * k1, s.efforts);
      const Vector k3 = tree_.derivative(y + 0.5 * h * k2, s.efforts);
      const Vector k4 = tree_.derivative(y + h * k3, s.efforts);
      y += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
    }
    return y;
  }
  Vector end(const Times& times, int steps) const {
    Vector y = start_;
    for (const Segment& s : segments(times)) y = moved(y, s, 1, steps);
    return y;
  }
  Slopes slopes(const Times& times, int steps) const {
    Slopes J(target_.size(), times.size());
    const double h = 1e-5 * times[times.size() - 1];
    for (Eigen::Index k = 0; k < times.size(); ++k) {
      Times ahead = times, behind = times;
      ahead[k] += h;
      behind[k] -= h;
      J.col(k) = (end(ahead, steps) - end(behind, steps)) / (2 * h);
    }
    return J;
  }
  /// The same to half the digits and at half the cost, from the final state itself: enough to converge.
  Slopes rough_slopes(const Times& times, const Vector& final, int steps) const {
    Slopes J(target_.size(), times.size());
    const double h = 1e-7 * times[times.size() - 1];
    for (Eigen::Index k = 0; k < times.size(); ++k) {
      Times ahead = times;
      ahead[k] += h;
      J.col(k) = (end(ahead, steps) - final) / h;
    }
    return J;
  }
  /// Unit tangent of the curve of times that reach the target, in the sense of less time.
  Times downhill(const Times& times, int steps) const {
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(Eigen::MatrixXd(slopes(times, steps)), Eigen::ComputeFullV);
    const Times tangent = svd.matrixV().col(times.size() - 1);
    return tangent[times.size() - 1] > 0 ? Times(-tangent) : tangent;
  }

  const LimitedTree& tree_;
  Structure structure_;
  Vector start_, target_;
};

/// Every way to share switches among the axes, with every choice of signs.
std::vector<Structure> structures(std::size_t axes, int switches) {
  if (axes == 1) return {{{switches}, {1}}, {{switches}, {-1}}};
  std::vector<Structure> all;
  for (int first = 0; first <= switches; ++first) {
    for (const int a : {1, -1}) {
      for (const int b : {1, -1}) all.push_back({{first, switches - first}, {a, b}});
    }
  }
  return all;
}

/// Time each axis would take alone from its start, the longest of all: the scale of guesses.
double time_scale(const LimitedTree& tree) {
  const auto n = static_cast<Eigen::Index>(tree.axes().size());
  Vector start = Vector::Zero(2 * n);
  for (Eigen::Index i = 0; i < n; ++i) start[i] = tree.axes()[static_cast<std::size_t>(i)].from;
  double longest = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    const LimitedAxis& axis = tree.axes()[static_cast<std::size_t>(i)];
    const double idle[2] = {0, 0};
    double full[2] = {0, 0};
    full[i] = axis.limit;
    const double a = (tree.derivative(start, full) - tree.derivative(start, idle))[n + i];
    longest = std::max(longest, 2 * std::sqrt(std::abs(axis.to - axis.from) / a));
  }
  return longest;
}

/// The fastest of the extremals found that have this number of switches; nothing where none is.
std::optional<SwitchingPlan> least_time_with(const LimitedTree& tree, int switches, int guesses) {
  // Guesses are spread by a generator of fixed seed, so that the same scene has the same plan. Few steps suffice to
  // find the switches; many then make them exact.
  constexpr int coarse = 4, fine = 24;
  const double scale = time_scale(tree);
  std::mt19937 random(1);
  const auto number = [&] { return static_cast<double>(random()) / 4294967296.0; };
  std::optional<SwitchingPlan> best;
  for (const Structure& structure : structures(tree.axes().size(), switches)) {
    const Family family(tree, structure);
    std::vector<Times> known;
    for (int guess = 0; guess < guesses; ++guess) {
      Times times(switches + 1);
      const double end = scale * (0.5 + 1.5 * number());
      Eigen::Index first = 0;
      for (const int count : structure.switches) {
        for (int k = 0; k < count; ++k) times[first + k] = end * number();
        std::sort(times.data() + first, times.data() + first + count);
        first += count;
      }
      times[first] = end;
      const auto rough = family.ordered(times) ? family.solve(times, coarse) : std::nullopt;
      if (!rough) continue;
      const auto same = [&](const Times& other) { return (other - *rough).norm() < 1e-4 * scale; };
      if (std::any_of(known.begin(), known.end(), same)) continue;
      known.push_back(*rough);
      const auto exact = family.solve(*rough, fine);
      if (!exact || (best && best->end <= (*exact)[first])) continue;
      if (family.extremal(*exact, fine)) best = family.plan(*exact);
    }
  }
  return best;
}

}  // namespace

std::optional<SwitchingPlan> least_time(const LimitedTree& tree) {
  const int state = 2 * static_cast<int>(tree.axes().size());
  // As many times as conditions first. One switch more is rarer, and dearer to find.
  if (auto plan = least_time_with(tree, state - 1, 12)) return plan;
  return state > 2 ? least_time_with(tree, state, 6) : std::nullopt;
}

}  // namespace withy
