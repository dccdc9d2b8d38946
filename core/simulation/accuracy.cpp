#include "withy/core/simulation/accuracy.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "withy/core/model/hinge_rates.hpp"
#include "withy/core/simulation/diagnosis.hpp"
#include "withy/core/simulation/elastic_modes.hpp"
#include "withy/core/simulation/round_trip.hpp"

namespace withy {
namespace {

using DenseMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr double epsilon = 0x1p-52;

/// M of the free speeds, scaled, and the scale of each speed; prescribed ones have none.
struct Scaled {
  Eigen::MatrixXd M;
  std::vector<Eigen::Index> free;
  Eigen::VectorXd scale;  ///< 1/√M_ii of the free speeds
};

Scaled scaled_mass(const DenseSystem& system) {
  const auto n = static_cast<Eigen::Index>(system.size);
  std::vector<bool> prescribed(system.size);
  for (const PrescribedRate& p : system.prescribed) prescribed[p.speed] = true;
  Scaled s;
  for (Eigen::Index i = 0; i < n; ++i) {
    if (!prescribed[static_cast<std::size_t>(i)]) s.free.push_back(i);
  }
  const Eigen::MatrixXd M = Eigen::Map<const DenseMatrix>(system.mass.data(), n, n)(s.free, s.free);
  s.scale = M.diagonal().cwiseAbs().cwiseSqrt().cwiseInverse();
  s.M = s.scale.asDiagonal() * M * s.scale.asDiagonal();
  return s;
}

std::size_t greatest_index(const std::vector<double>& v) {
  const auto less = [](double a, double b) { return std::abs(a) < std::abs(b); };
  return static_cast<std::size_t>(std::max_element(v.begin(), v.end(), less) - v.begin());
}

std::vector<double> of_all(const Scaled& s, const Eigen::VectorXd& v, std::size_t size) {
  std::vector<double> all(size);
  for (std::size_t i = 0; i < s.free.size(); ++i)
    all[static_cast<std::size_t>(s.free[i])] = v[static_cast<Eigen::Index>(i)];
  return all;
}

/// Moment of inertia about a hinge's place, over all axes, of what the hinge carries [kg m²].
double carried_inertia(const Model& model, const Observation& seen, int hinge) {
  const auto h = static_cast<std::size_t>(hinge);
  const auto place = [&](int body, int frame) {
    const WorldPose pose = seen.frame_pose(body, frame);
    return std::pair(Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(pose.rotation.data()).eval(),
                     Eigen::Map<const Vector3>(pose.position.data()).eval());
  };
  const Vector3 at = place(model.hinges()[h].child, model.hinges()[h].child_frame).second;
  std::vector<bool> carried(model.bodies().size());
  double inertia = 0;
  for (std::size_t b = h; b < model.bodies().size(); ++b) {
    const int parent = model.hinges()[b].parent;
    carried[b] = b == h || (parent >= 0 && carried[static_cast<std::size_t>(parent)]);
    if (!carried[b]) continue;
    const auto [R, p] = place(static_cast<int>(b), 0);
    const ModalShape& shape = model.bodies()[b].body->shape();
    for (const Particle& m : shape.particles) inertia += m.mass * (p + R * m.at.X - at).squaredNorm();
    for (const Section& s : shape.sections) inertia += s.inertia.trace();
  }
  return inertia;
}

/// Whether its own inertia is what rounding leaves of what its hinge carries, or not a number that can be told.
enum class RateFault { none, no_mass, no_number };
struct FaultyRate {
  RateFault fault = RateFault::none;
  std::size_t hinge = 0, speed = 0;
};

/// The first hinge rate that turns nothing but rounding. κ of the scaled M does not see it.
FaultyRate faulty_rate(const Model& model, const EquationsOfMotion& equations, const State& state,
                       const DenseSystem& system) {
  const auto seen = equations.make_observation();
  seen->observe(state.y);
  for (std::size_t h = 0; h < model.hinges().size(); ++h) {
    if (model.driven(h)) continue;
    const Slot& slot = model.layout().hinges[h];
    double carried = -1;
    std::size_t i = slot.speed;
    for (const HingeRate& rate : hinge_rates(*model.hinges()[h].hinge)) {
      const double own = system.mass[i * system.size + i];
      if (rate.angular && carried < 0) carried = carried_inertia(model, *seen, static_cast<int>(h));
      if (!std::isfinite(own) || !std::isfinite(carried)) return {RateFault::no_number, h, i};
      if (own <= (rate.angular ? 4 * epsilon * carried : 0)) return {RateFault::no_mass, h, i};
      ++i;
    }
  }
  return {};
}

std::string body_of_speed(const Model& model, std::size_t speed) {
  for (std::size_t h = 0; h < model.hinges().size(); ++h) {
    const Slot& slot = model.layout().hinges[h];
    if (speed >= slot.speed && speed < slot.speed + slot.speeds) return model.bodies()[h].name;
  }
  return {};
}

/// Hinges that move no mass together, of which each moves some.
std::optional<UnsolvableRate> massless_together(const Model& model, const DenseSystem& system) {
  const AttainableAccuracy a = attainable_accuracy(system);
  if (a.accuracy < 1 || a.weakest.empty()) return {};
  const Eigen::Map<const Eigen::VectorXd> weakest(a.weakest.data(), static_cast<Eigen::Index>(a.weakest.size()));
  double all = 0, most = 0;
  std::size_t greatest = 0;
  for (std::size_t h = 0; h < model.hinges().size(); ++h) {
    const Slot& slot = model.layout().hinges[h];
    const double share =
        weakest.segment(static_cast<Eigen::Index>(slot.speed), static_cast<Eigen::Index>(slot.speeds)).squaredNorm();
    all += share;
    if (share > most) most = share, greatest = h;
  }
  if (all < 0.5) return {};  // modes: what is told of accuracy names them, and which to leave out
  return UnsolvableRate{greatest,
                        "the mass matrix is singular here: these move no mass together beyond rounding: " +
                            owners_of(model.layout(), a.weakest) +
                            "; give the bodies between them mass or inertia, lock a hinge, or begin elsewhere",
                        true};
}

/// Calls act(speed, system without it) for the highest mode of every family of every body that is not prescribed.
template <class Act>
void without_highest_modes(const Model& model, const DenseSystem& system, Act&& act) {
  for (std::size_t b = 0; b < model.bodies().size(); ++b) {
    const Slot* slot = model.layout().modes(b);
    if (slot == nullptr) continue;
    for (const ModeGroup& group : mode_groups(model.bodies()[b].body->shape())) {
      // As a prescribed speed it takes no part.
      const std::size_t speed = slot->speed + static_cast<std::size_t>(group.coordinates.back());
      if (std::any_of(system.prescribed.begin(), system.prescribed.end(),
                      [speed](const PrescribedRate& p) { return p.speed == speed; }))
        continue;
      DenseSystem without = system;
      without.prescribed.push_back({speed, 0});
      act(speed, without);
    }
  }
}

}  // namespace

RoundingError rounding_error(const Model& model, const EquationsOfMotion& equations, const State& state,
                             Probing probing) {
  const Layout& layout = model.layout();
  RoundingError error;
  if (layout.speeds == 0) return error;
  RoundTrip trip(model, equations, state);
  if (!trip.possible()) {
    if (layout.speeds <= largest_examined)
      error.relative = attainable_accuracy(equations.system(state.time, state.y)).accuracy;
    return error;
  }
  std::vector<double> rates(equations.size());
  Work work = equations.make_work();
  const bool solved = equations.derivatives(state.time, state.y, rates, work).ok();
  const bool seen = solved && trip.of(std::span(rates).subspan(layout.positions, layout.speeds), error);
  if (!seen || probing == Probing::any) static_cast<void>(trip.of(trip.everywhere(), error));
  if (layout.speeds <= largest_examined) {
    // A way there and back along directions that M hardly moves may look well where no digit of M tells it from zero.
    const AttainableAccuracy bound = attainable_accuracy(equations.system(state.time, state.y));
    if (bound.accuracy >= 1) error = {bound.accuracy, bound.weakest.empty() ? 0 : greatest_index(bound.weakest)};
  }
  return error;
}

AttainableAccuracy attainable_accuracy(const DenseSystem& system) {
  AttainableAccuracy a;
  const Scaled s = scaled_mass(system);
  if (s.free.empty()) return a;
  if (!s.M.allFinite()) {
    a.condition = a.accuracy = std::numeric_limits<double>::infinity();
    return a;
  }
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(s.M, Eigen::ComputeFullV);
  const Eigen::Index last = svd.singularValues().size() - 1;
  const double least = svd.singularValues()[last];
  a.condition = least > 0 ? svd.singularValues()[0] / least : std::numeric_limits<double>::infinity();
  a.accuracy = a.condition * epsilon;
  const Eigen::VectorXd v = svd.matrixV().col(last);
  a.weakest = of_all(s, v, system.size);
  a.share = v.dot(s.M * v);
  return a;
}

std::vector<MasslessDirection> massless_directions(const Model& model, const DenseSystem& system, double share) {
  std::vector<MasslessDirection> found;
  const Scaled s = scaled_mass(system);
  if (s.free.empty() || !s.M.allFinite()) return found;
  const Eigen::MatrixXd K = stiffness_of_modes(model)(s.free, s.free);
  const Eigen::MatrixXd symmetric = 0.5 * (s.M + s.M.transpose());
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(symmetric);
  for (Eigen::Index k = 0; k < solver.eigenvalues().size() && solver.eigenvalues()[k] < share; ++k) {
    const Eigen::VectorXd v = solver.eigenvectors().col(k);
    const std::vector<double> all = of_all(s, v, system.size);
    double modal = 0;
    for (const Slot& slot : model.layout().bodies) {
      for (std::size_t i = slot.speed; i < slot.speed + slot.speeds; ++i) modal += all[i] * all[i];
    }
    if (modal < 0.5) continue;
    MasslessDirection d;
    d.share = solver.eigenvalues()[k];
    const Eigen::VectorXd u = s.scale.asDiagonal() * v;
    d.frequency = d.share > 0 ? std::sqrt(std::max(0.0, u.dot(K * u)) / d.share) : 0;
    d.owners = owners_of(model.layout(), all);
    found.push_back(std::move(d));
  }
  return found;
}

std::optional<Removal> best_removal(const Model& model, const DenseSystem& system) {
  std::optional<Removal> best;
  without_highest_modes(model, system, [&](std::size_t speed, const DenseSystem& without) {
    const double condition = attainable_accuracy(without).condition;
    if (!best || condition < best->condition) best = {model.layout().speed_names[speed], condition};
  });
  return best;
}

std::optional<Slowing> best_slowing(const Model& model, const DenseSystem& system, const Eigen::MatrixXd& rows) {
  std::optional<Slowing> best;
  without_highest_modes(model, system, [&](std::size_t speed, const DenseSystem& without) {
    const double fastest = fastest_mode(model, without, rows);
    if (!best || fastest < best->fastest) best = {model.layout().speed_names[speed], fastest};
  });
  return best;
}

std::optional<UnsolvableRate> unsolvable_rate(const Model& model, const EquationsOfMotion& equations,
                                              const State& state) {
  const Layout& layout = model.layout();
  if (const auto hinge = nonfinite_hinge(model, state, 0)) return UnsolvableRate{hinge->hinge, hinge->why};
  if (layout.speeds == 0 || layout.speeds > largest_examined) return {};
  const DenseSystem system = equations.system(state.time, state.y);
  const FaultyRate rate = faulty_rate(model, equations, state, system);
  const std::string& name = layout.speed_names[rate.speed];
  if (rate.fault == RateFault::no_number)
    return UnsolvableRate{
        rate.hinge,
        "the inertia that " + name + " moves is beyond the range of numbers: masses or lengths on it are too great"};
  if (rate.fault == RateFault::no_mass)
    return UnsolvableRate{rate.hinge, "the mass matrix is singular: " + name +
                                          " moves no mass beyond rounding; give body '" +
                                          body_of_speed(model, rate.speed) +
                                          "', or what hangs on it, mass or inertia there, or lock the hinge"};
  return massless_together(model, system);
}

std::string unattainable(const Model& model, const EquationsOfMotion& equations, const State& state, double tolerance) {
  const Layout& layout = model.layout();
  if (layout.speeds == 0) return {};
  if (std::optional<UnsolvableRate> rate = unsolvable_rate(model, equations, state)) return std::move(rate->why);
  const RoundingError error = rounding_error(model, equations, state);
  if (tolerance >= error.relative) return {};
  std::string text = "rounding leaves accelerations an error of " + brief(error.relative) + ", most in " +
                     layout.speed_names[error.speed];
  const bool examined = layout.speeds <= largest_examined;
  const DenseSystem system = examined ? equations.system(state.time, state.y) : DenseSystem{};
  const AttainableAccuracy a = examined ? attainable_accuracy(system) : AttainableAccuracy{};
  if (!std::isfinite(error.relative)) {
    if (a.accuracy >= 1 && !a.weakest.empty())
      return "the mass matrix is singular: what moves no mass is " + owners_of(layout, a.weakest);
    return "the accelerations of " + layout.speed_names[error.speed] + " are beyond the range of numbers";
  }
  if (!examined) return text;
  text += "; the condition of the mass matrix is " + brief(a.condition) +
          " with each coordinate in the unit of its own inertia, and the direction that moves least mass, " +
          brief(a.share) + " of its coordinates' own, is " +
          (a.weakest.empty() ? "not known" : owners_of(layout, a.weakest));
  if (const std::optional<Removal> removal = best_removal(model, system))
    text += "; without " + removal->mode + " the condition is " + brief(removal->condition);
  return text;
}

}  // namespace withy
