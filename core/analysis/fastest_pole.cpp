#include "withy/core/analysis/fastest_pole.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "withy/core/analysis/modes.hpp"
#include "withy/core/analysis/named_parts.hpp"
#include "withy/core/model/event_plan.hpp"
#include "withy/core/simulation/diagnosis.hpp"

namespace withy {
namespace {

using Complex = std::complex<double>;
/// An inertia that is a smaller share than this of what the coordinate has alone is called little.
constexpr double little = 0.2;

/// How the cause of a pole begins that is one of a load's own states.
const std::string state_of_load = "the state of load '";

/// Null vector of Q, to which Q is close, by inverse iteration.
Eigen::VectorXcd null_vector(const Eigen::MatrixXcd& Q) {
  const Eigen::PartialPivLU<Eigen::MatrixXcd> lu(Q);
  Eigen::VectorXcd v = Eigen::VectorXcd::Ones(Q.rows());
  for (Eigen::Index i = 0; i < v.size(); ++i) v[i] += 0.1 * std::sin(static_cast<double>(i + 1));
  for (int k = 0; k < 3; ++k) {
    v = lu.solve(v).eval();
    if (!v.allFinite()) throw std::domain_error("the fastest motion was not found");
    v.normalize();
  }
  return v;
}

struct Cause {
  std::string name;
  bool of_load = false;
  Eigen::Index at = 0;  ///< the free displacement on which it acts most
};

/// A pole with its vectors: (M λ + G)(λ − C) δ + K δ = 0.
struct PoleVectors {
  Complex pole = 0;
  Eigen::VectorXcd left, right, rate;  ///< rate = (λ − C) right
  Complex inertia = 0;                 ///< wᴴ M v
  Complex slope = 0;                   ///< wᴴ Q′(λ) v, so that forces P change λ by −wᴴ P v / slope
};

/// Works wᴴ P v of forces K v + D (λ − C) v, one a free displacement.
Eigen::VectorXcd works_of(const PoleVectors& motion, const std::vector<Eigen::Index>& free,
                          const Eigen::MatrixXd* stiffness, const Eigen::MatrixXd* damping) {
  Eigen::VectorXcd forces = Eigen::VectorXcd::Zero(motion.right.size());
  if (stiffness != nullptr) forces += (*stiffness)(free, free).cast<Complex>() * motion.right;
  if (damping != nullptr) forces += (*damping)(free, free).cast<Complex>() * motion.rate;
  return motion.left.conjugate().cwiseProduct(forces);
}

/// Of the parts weighed the one with the greatest share.
class Greatest {
 public:
  /// \param over what the works are shares of, or change an eigenvalue by
  explicit Greatest(Complex over) : over_(over) {}
  void weigh(const Eigen::VectorXcd& works, const std::string& name, bool of_load) {
    const double share = (-works.sum() / over_).real();
    if (share <= share_) return;
    share_ = share;
    cause_.name = name;
    cause_.of_load = of_load;
    works.cwiseAbs().maxCoeff(&cause_.at);
  }
  [[nodiscard]] const Cause& cause() const { return cause_; }
  [[nodiscard]] double share() const { return share_; }

 private:
  Complex over_;
  double share_ = 0;
  Cause cause_;
};

/// Stiffness and damping of a part, each by itself.
void weigh(Greatest& greatest, const NamedPart& part, const std::vector<Eigen::Index>& free,
           const PoleVectors& motion) {
  greatest.weigh(works_of(motion, free, &part.by_position, nullptr), "stiffness of " + part.name, part.of_load);
  greatest.weigh(works_of(motion, free, nullptr, &part.by_speed), "damping of " + part.name, part.of_load);
}

/// What the greatest part of the motion's forces λ² M is.
Cause cause_of_speed(const std::vector<NamedPart>& parts, const std::vector<Eigen::Index>& free,
                     const PoleVectors& motion) {
  Greatest greatest(motion.pole * motion.pole * motion.inertia);
  for (const NamedPart& part : parts) weigh(greatest, part, free, motion);
  return greatest.cause();
}

/// What the motion grows by: without a hundredth of it Re λ is less by a hundredth of its share, more than without that
/// of any other. The greatest force, or the one that does the most work, may be none of the reasons: damping in a shaft
/// that turns above its critical speed takes energy in the axes of the shaft, and without it nothing grows.
///
/// Inertia and weight are one part, with M λ². In axes that turn, centrifugal and Coriolis forces and M λ² are terms
/// of one acceleration, hundreds of times their sum; each by itself would tell of the axes. Shares of all parts then
/// add up to nothing, and where no other has one, as of a pendulum that stands on its head, it is this one.
Cause cause_of_growth(const std::vector<NamedPart>& parts, const Eigen::MatrixXd& mass,
                      const std::vector<Eigen::Index>& free, const PoleVectors& motion) {
  Greatest greatest(motion.slope);
  const NamedPart& inertia = parts.back();
  for (const NamedPart& part : parts)
    if (&part != &inertia) weigh(greatest, part, free, motion);
  const Eigen::VectorXcd of_mass = motion.left.conjugate().cwiseProduct(
                             motion.pole * (mass(free, free).cast<Complex>() * motion.rate)),
                         works = works_of(motion, free, &inertia.by_position, &inertia.by_speed);
  greatest.weigh(works + of_mass, inertia.name, inertia.of_load);
  // What is left of terms that cancel is rounding of them.
  constexpr double rounding = 1e-9;
  if (greatest.share() > rounding * std::abs(works.cwiseAbs().sum() / motion.slope)) return greatest.cause();
  Cause cause{inertia.name, inertia.of_load};
  works.cwiseAbs().maxCoeff(&cause.at);
  return cause;
}

/// The eigenvalue that is greatest by a measure of it, of a matrix and its units.
template <class Measure>
Complex greatest_eigenvalue(const Eigen::MatrixXd& A, const Eigen::VectorXd& units, Measure&& measure) {
  const Eigen::MatrixXd balanced = units.asDiagonal() * A * units.cwiseInverse().asDiagonal();
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(balanced, false);
  if (solver.info() != Eigen::Success) throw std::domain_error("the eigenvalues were not found");
  Complex value = 0;
  bool any = false;
  for (const Complex& pole : solver.eigenvalues()) {
    if (pole.imag() >= 0 && (!any || measure(pole) > measure(value))) value = pole;
    any = true;
  }
  return value;
}

/// The continuous state of a load that has the greatest part in an eigenvector of the whole system.
const std::string& state_of(const Layout& layout, const Eigen::MatrixXd& A, Complex pole) {
  const Eigen::Index n = A.rows(), k = static_cast<Eigen::Index>(layout.continuous);
  const Eigen::MatrixXcd shifted = A.cast<Complex>() - pole * (1 + 1e-10) * Eigen::MatrixXcd::Identity(n, n);
  Eigen::Index most = 0;
  null_vector(shifted).tail(k).cwiseAbs().maxCoeff(&most);
  return layout.continuous_names[static_cast<std::size_t>(most)];
}

/// By what a pole is sought.
enum class Sought { modulus, growth };

double measure(Sought sought, Complex pole) { return sought == Sought::growth ? pole.real() : std::abs(pole); }

/// Whether states of loads add to what moves without them: more than this share of what is sought. A growth is a small
/// part of most poles, and a state that makes it may leave the modulus as it was.
bool made_by_states(Sought sought, Complex with, Complex without) {
  constexpr double more = 0.02;
  if (sought == Sought::growth) return with.real() - without.real() > more * std::abs(with.real());
  return std::abs(with - without) > more * std::abs(with);
}

/// Of the matrices of small motions at a pole, which rounding may not make exact.
PoleVectors vectors_at(Complex value, const Tangents& t, const std::vector<Eigen::Index>& free,
                       const Eigen::VectorXd& scale) {
  const Complex pole = value * (1 + 1e-10);
  const auto m = static_cast<Eigen::Index>(free.size());
  const auto of_free = [&](const Eigen::MatrixXd& x) -> Eigen::MatrixXcd { return x(free, free).cast<Complex>(); };
  const Eigen::MatrixXcd turn = pole * Eigen::MatrixXcd::Identity(m, m) - of_free(t.drift), mass = of_free(t.mass),
                         moving = pole * mass + of_free(t.by_speed);
  const Eigen::MatrixXcd Q = scale.cast<Complex>().asDiagonal() * (moving * turn + of_free(t.by_position)) *
                             scale.cast<Complex>().asDiagonal() / std::norm(pole);
  PoleVectors motion;
  motion.pole = value;
  motion.left = scale.cast<Complex>().cwiseProduct(null_vector(Q.adjoint()));
  motion.right = scale.cast<Complex>().cwiseProduct(null_vector(Q));
  motion.rate = turn * motion.right;
  motion.inertia = motion.left.dot(mass * motion.right);
  motion.slope = motion.left.dot(mass * motion.rate + moving * motion.right);
  return motion;
}

FastestPole pole_by(const TangentDynamics& dynamics, const State& state, const Held& held, Sought sought) {
  FastestPole result;
  const std::vector<Eigen::Index> free = free_speeds(held);
  if (free.empty()) return result;
  const auto by = [&](Complex pole) { return measure(sought, pole); };
  const Tangents t = dynamics.tangents(state.time, state.y, accelerations(dynamics, state, held));
  const Eigen::MatrixXd A = first_order_form(t, held).A;
  const auto m = static_cast<Eigen::Index>(free.size());
  const Eigen::VectorXd masses = t.mass.diagonal()(free).cwiseAbs();
  const Eigen::VectorXd units = balancing_units(A, masses);
  result.value = greatest_eigenvalue(A, units, by);
  if (t.by_state.cols() > 0) {
    const Eigen::MatrixXd whole = whole_first_order_form(t, held).A;
    Eigen::VectorXd all_units = Eigen::VectorXd::Ones(whole.rows());
    all_units.head(2 * m) = units;
    const Complex value = greatest_eigenvalue(whole, all_units, by);
    const bool of_state = made_by_states(sought, value, result.value);
    result.value = value;
    if (of_state && value != 0.0) {
      result.of_load = true;
      result.cause = state_of_load + state_of(dynamics.model().layout(), whole, value) + "'";
      return result;
    }
  }
  if (result.value == 0.0) return result;
  const PoleVectors motion = vectors_at(result.value, t, free, units.head(m).cwiseInverse());
  const std::vector<NamedPart> parts = named_parts(dynamics, state, t);
  const Cause cause =
      sought == Sought::growth ? cause_of_growth(parts, t.mass, free, motion) : cause_of_speed(parts, free, motion);
  result.cause = cause.name;
  result.of_load = cause.of_load;
  result.speed = static_cast<std::size_t>(free[static_cast<std::size_t>(cause.at)]);
  result.alone = masses[cause.at];
  result.inertia = std::abs(motion.inertia) / (std::abs(motion.left[cause.at]) * std::abs(motion.right[cause.at]));
  return result;
}

}  // namespace

Held driven_speeds(const Model& model, const State& state) {
  const Layout& layout = model.layout();
  Held held(layout.speeds, false);
  const auto hold = [&](std::size_t hinge) {
    const Slot& slot = layout.hinges[hinge];
    for (std::size_t i = 0; i < slot.speeds; ++i) held[slot.speed + i] = true;
  };
  for (const MotionNode& motion : model.motions()) hold(static_cast<std::size_t>(motion.hinge));
  for (const std::size_t hinge : locked_hinges(model, state)) hold(hinge);
  return held;
}

FastestPole fastest_pole(const TangentDynamics& dynamics, const State& state, const Held& held) {
  return pole_by(dynamics, state, held, Sought::modulus);
}

FastestPole growing_pole(const TangentDynamics& dynamics, const State& state, const Held& held) {
  return pole_by(dynamics, state, held, Sought::growth);
}

bool FastestPole::of_load_state() const { return cause.starts_with(state_of_load); }

std::string describe(const FastestPole& pole, const Layout& layout) {
  if (pole.value == 0.0) return {};
  constexpr double rounding = 1e-9;  // of what vibrates without growing or dying out
  const bool still = std::abs(pole.value.real()) < rounding * std::abs(pole.value.imag());
  std::string text = still ? "0" : brief(pole.value.real());
  if (pole.value.imag() != 0) text += " ± " + brief(pole.value.imag()) + "i";
  text += "/s: ";
  if (pole.of_load_state()) return text + pole.cause;
  if (!pole.cause.empty()) text += pole.cause + " on ";
  text += layout.speed_names[pole.speed];
  if (pole.inertia < little * pole.alone)
    text += ", with little inertia behind it (" + brief(pole.inertia) + "; " + brief(pole.alone) +
            " if the other coordinates are held)";
  return text;
}

}  // namespace withy
