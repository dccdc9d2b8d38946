#include "withy/loads/time_optimal.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <random>

namespace withy {

LimitedTree::LimitedTree(const Model& model, std::vector<LimitedAxis> axes)
    : dynamics_(model),
      axes_(std::move(axes)),
      x_(model.reference_state().y),
      u_(model.layout().speeds),
      u_dot_(u_),
      tau_(u_),
      scratch_(dynamics_.scratch()) {
  x_.resize(model.layout().positions);
}

void LimitedTree::inverse(const Vector& state, int moving, double* efforts) const {
  const auto n = static_cast<Eigen::Index>(axes_.size());
  for (Eigen::Index i = 0; i < n; ++i) {
    const LimitedAxis& axis = axes_[static_cast<std::size_t>(i)];
    x_[axis.position] = state[i];
    u_[axis.speed] = state[n + i];
    u_dot_[axis.speed] = i == moving ? 1 : 0;
  }
  dynamics_.efforts(x_, u_, u_dot_, tau_, scratch_);
  for (std::size_t i = 0; i < axes_.size(); ++i) efforts[i] = tau_[axes_[i].speed];
}

LimitedTree::Vector LimitedTree::derivative(const Vector& state, const double* efforts) const {
  const auto n = static_cast<Eigen::Index>(axes_.size());
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 2, 2> M(n, n);
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 2, 1> bias(n), applied(n);
  inverse(state, -1, bias.data());
  for (Eigen::Index i = 0; i < n; ++i) {
    inverse(state, static_cast<int>(i), M.col(i).data());
    M.col(i) -= bias;
    applied[i] = efforts[i] - bias[i];
  }
  Vector rate(2 * n);
  rate << state.tail(n), M.partialPivLu().solve(applied);
  return rate;
}

std::vector<double> LimitedTree::holding() const {
  Vector rest = Vector::Zero(2 * static_cast<Eigen::Index>(axes_.size()));
  for (std::size_t i = 0; i < axes_.size(); ++i) rest[static_cast<Eigen::Index>(i)] = axes_[i].to;
  std::vector<double> efforts(axes_.size());
  inverse(rest, -1, efforts.data());
  return efforts;
}

namespace {

using Vector = LimitedTree::Vector;
using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 4, 4>;

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

/// Bang-bang motions of one structure; `times` are the switches, axis by axis, then the end.
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

  /// Times that Newton's method makes of `times`: the motion then ends at rest at the target.
  std::optional<Vector> solve(Vector times, int steps) const {
    Vector miss = end(times, steps) - target_;
    for (int iteration = 0; iteration < 40; ++iteration) {
      if (miss.norm() < 1e-10) return times;
      const Vector change = -slopes(times, steps).partialPivLu().solve(miss);
      double part = 1;
      for (; part > 1e-3; part *= 0.5) {
        const Vector next = times + part * change;
        if (!ordered(next)) continue;
        const Vector left = end(next, steps) - target_;
        if (left.norm() > (1 - 0.1 * part) * miss.norm()) continue;
        times = next;
        miss = left;
        break;
      }
      if (part <= 1e-3) return {};
    }
    return {};
  }

  /// Pontryagin's principle for least time. The costate λ at the end is orthogonal to what any switch does to the final
  /// state and has λ·(ẋ, ẍ) = 1; back in time it obeys λ̇ = −(∂f/∂x)ᵀ λ. Wherever λ·∂f/∂τ_i > 0 the effort τ_i must be
  /// at its upper limit, and at its lower where it is negative.
  bool extremal(const Vector& times, int steps) const {
    const Eigen::Index n = times.size();
    Vector goal = Vector::Zero(n);
    goal[n - 1] = 1;
    Vector costate = slopes(times, steps).transpose().partialPivLu().solve(goal);
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

  SwitchingPlan plan(const Vector& times) const {
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
  bool ordered(const Vector& times) const {
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
  std::vector<Segment> segments(const Vector& times) const {
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
  Vector end(const Vector& times, int steps) const {
    Vector y = start_;
    for (const Segment& s : segments(times)) y = moved(y, s, 1, steps);
    return y;
  }
  /// Derivatives of the final state with respect to the times.
  Matrix slopes(const Vector& times, int steps) const {
    Matrix J(start_.size(), times.size());
    const double h = 1e-6 * times[times.size() - 1];
    const Vector here = end(times, steps);
    for (Eigen::Index k = 0; k < times.size(); ++k) {
      Vector ahead = times;
      ahead[k] += h;
      J.col(k) = (end(ahead, steps) - here) / h;
    }
    return J;
  }

  const LimitedTree& tree_;
  Structure structure_;
  Vector start_, target_;
};

/// Every way to share 2n − 1 switches among n axes, with every choice of signs.
std::vector<Structure> structures(std::size_t axes) {
  if (axes == 1) return {{{1}, {1}}, {{1}, {-1}}};
  std::vector<Structure> all;
  for (const auto& [first, second] : {std::pair(1, 2), std::pair(2, 1), std::pair(0, 3), std::pair(3, 0)}) {
    for (const int a : {1, -1}) {
      for (const int b : {1, -1}) all.push_back({{first, second}, {a, b}});
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

}  // namespace

std::optional<SwitchingPlan> least_time(const LimitedTree& tree) {
  // Guesses are spread by a generator of fixed seed, so that the same scene has the same plan. Few steps suffice to
  // find the switches; many then make them exact.
  constexpr int guesses = 12, coarse = 4, fine = 24;
  const double scale = time_scale(tree);
  std::mt19937 random(1);
  const auto number = [&] { return static_cast<double>(random()) / 4294967296.0; };
  std::optional<SwitchingPlan> best;
  for (const Structure& structure : structures(tree.axes().size())) {
    const Family family(tree, structure);
    std::vector<Vector> known;
    for (int guess = 0; guess < guesses; ++guess) {
      Vector times(2 * static_cast<Eigen::Index>(tree.axes().size()));
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
      const auto same = [&](const Vector& other) { return (other - *rough).norm() < 1e-4 * scale; };
      if (std::any_of(known.begin(), known.end(), same)) continue;
      known.push_back(*rough);
      const auto exact = family.solve(*rough, fine);
      if (!exact || (best && best->end <= (*exact)[first])) continue;
      if (family.extremal(*exact, fine)) best = family.plan(*exact);
    }
  }
  return best;
}

}  // namespace withy
