#include "withy/core/analysis/fastest_pole.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "withy/core/analysis/modes.hpp"
#include "withy/core/model/event_plan.hpp"
#include "withy/core/simulation/diagnosis.hpp"
#include "withy/core/tangents/load_wrenches.hpp"
#include "withy/core/tangents/refined_difference.hpp"

namespace withy {
namespace {

using Complex = std::complex<double>;
/// An inertia that is a smaller share than this of what the coordinate has alone is called little.
constexpr double little = 0.2;

/// How the cause of a pole begins that is one of a load's own states.
const std::string state_of_load = "the state of load '";

/// A part of the derivatives that can be named.
struct Part {
  std::string name;
  Eigen::MatrixXd by_position, by_speed;
  bool of_load = false;
};

/// Efforts of a load on speeds, those that go by its states too.
Eigen::VectorXd efforts_of(const Model& model, std::size_t load, double t, std::span<const double> y) {
  const Layout& layout = model.layout();
  Eigen::VectorXd efforts = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(layout.speeds));
  const std::span<double> own(efforts.data(), layout.speeds);
  std::vector<double> scratch(model.load_scratch());
  model.loads()[load].load->add(t, y.first(layout.positions), y.subspan(layout.positions, layout.speeds), own, scratch);
  model.add_state_efforts(t, y, own, scratch, static_cast<int>(load));
  return efforts;
}

/// Their derivatives by differences.
void add_differences(const TangentDynamics& dynamics, std::size_t load, const State& state, Part& part) {
  const Model& model = dynamics.model();
  const Eigen::Index n = part.by_speed.rows();
  for (Eigen::Index j = 0; j < n; ++j) {
    const auto slope = [&](auto&& move) {
      return refined_difference(
          [&](double h) {
            std::vector<double> moved = state.y;
            move(moved, h);
            return efforts_of(model, load, state.time, moved);
          },
          analysis::difference_step);
    };
    part.by_position.col(j) +=
        slope([&](std::vector<double>& y, double h) { dynamics.displace(y, h * Eigen::VectorXd::Unit(n, j)); });
    part.by_speed.col(j) += slope(
        [&](std::vector<double>& y, double h) { y[model.layout().positions + static_cast<std::size_t>(j)] += h; });
  }
}

/// Adds what a load's continuous part does by displacements and speeds, where it says so.
bool add_of_states(const LoadNode& node, const Model& model, const State& state, Part& part) {
  const Layout& layout = model.layout();
  const auto slot = std::find_if(layout.continuous_slots.begin(), layout.continuous_slots.end(),
                                 [&](const LoadSlot& s) { return &model.loads()[s.load] == &node; });
  if (slot == layout.continuous_slots.end()) return false;
  const auto n = static_cast<Eigen::Index>(layout.speeds), z = static_cast<Eigen::Index>(slot->count);
  Eigen::MatrixXd by_state(n, z), rate_by_position(z, n), rate_by_speed(z, n), rate_by_state(z, z);
  ContinuousDerivatives to{part.by_position, part.by_speed, by_state, rate_by_position, rate_by_speed, rate_by_state};
  std::vector<double> scratch(model.load_scratch());
  return node.continuous->add_derivatives(node.view(state.time, state.y, layout, scratch), to);
}

/// Stiffness and damping of bodies, and what loads do on speeds; the rest last.
std::vector<Part> parts_of(const TangentDynamics& dynamics, const State& state, const Tangents& tangents) {
  const Model& model = dynamics.model();
  const Layout& layout = model.layout();
  const auto n = static_cast<Eigen::Index>(layout.speeds);
  const Eigen::MatrixXd none = Eigen::MatrixXd::Zero(n, n);
  std::vector<Part> parts;
  Part rest{"inertia and weight", tangents.by_position, tangents.by_speed};
  const auto take = [&](Part part) {
    rest.by_position -= part.by_position;
    rest.by_speed -= part.by_speed;
    parts.push_back(std::move(part));
  };
  for (const BodyNode& body : model.bodies()) {
    const Slot* slot = layout.body(body.name);
    if (slot == nullptr) continue;
    const ModalShape& shape = body.body->shape();
    const auto at = static_cast<Eigen::Index>(slot->speed);
    Part part{"'" + body.name + "'", none, none};
    part.by_position.block(at, at, shape.modes(), shape.modes()) = shape.stiffness;
    part.by_speed.block(at, at, shape.modes(), shape.modes()) = shape.damping;
    take(std::move(part));
  }
  const std::span<const double> y(state.y);
  bool at_frames = false;
  for (std::size_t l = 0; l < model.loads().size(); ++l) {
    const LoadNode& node = model.loads()[l];
    at_frames = at_frames || !node.load->frames().empty();
    Part part{"load '" + node.name + "'", none, none, true};
    const auto& differenced = tangents.differenced;
    const bool by_itself =
        node.load->add_derivatives(state.time, y.first(layout.positions), y.subspan(layout.positions, layout.speeds),
                                   part.by_position, part.by_speed);
    const bool by_states = add_of_states(node, model, state, part);
    if (node.load->frames().empty() &&
        std::find(differenced.begin(), differenced.end(), node.name) != differenced.end()) {
      part.by_position.setZero();
      part.by_speed.setZero();
      add_differences(dynamics, l, state, part);
    } else if (!by_itself && !by_states) {
      continue;
    }
    // Efforts stand on the other side of the equation.
    part.by_position = -part.by_position;
    part.by_speed = -part.by_speed;
    take(std::move(part));
  }
  // Wrenches at frames are not told from what the frames' bodies do.
  if (at_frames) rest.name += ", and loads at frames", rest.of_load = true;
  parts.push_back(std::move(rest));
  return parts;
}

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

/// What the greatest part of the motion's forces is.
Cause cause_of(const std::vector<Part>& parts, const std::vector<Eigen::Index>& free, Complex pole,
               const Eigen::VectorXcd& left, const Eigen::VectorXcd& right, Complex inertial) {
  double greatest = 0;
  Cause cause;
  const auto weigh = [&](const Eigen::MatrixXd& part, Complex factor, const std::string& name, bool of_load) {
    const Eigen::VectorXcd works = left.conjugate().cwiseProduct(factor * (part(free, free).cast<Complex>() * right));
    const double share = (-works.sum() / inertial).real();
    if (share <= greatest) return;
    greatest = share;
    cause.name = name;
    cause.of_load = of_load;
    works.cwiseAbs().maxCoeff(&cause.at);
  };
  for (const Part& part : parts) {
    weigh(part.by_position, 1.0, "stiffness of " + part.name, part.of_load);
    weigh(part.by_speed, pole, "damping of " + part.name, part.of_load);
  }
  return cause;
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

namespace {

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

/// The eigenvalue that is greatest by a measure of it.
template <class Measure>
FastestPole pole_by(const TangentDynamics& dynamics, const State& state, const Held& held, Measure&& measure) {
  // A state of a load is the cause where it adds more than this to what moves without it.
  constexpr double more = 0.02;
  FastestPole result;
  const std::vector<Eigen::Index> free = free_speeds(held);
  if (free.empty()) return result;
  const Tangents t = dynamics.tangents(state.time, state.y, accelerations(dynamics, state, held));
  const Eigen::MatrixXd A = first_order_form(t, held).A;
  const auto m = static_cast<Eigen::Index>(free.size());
  const Eigen::VectorXd masses = t.mass.diagonal()(free).cwiseAbs();
  const Eigen::VectorXd units = balancing_units(A, masses);
  result.value = greatest_eigenvalue(A, units, measure);
  if (t.by_state.cols() > 0) {
    const Eigen::MatrixXd whole = whole_first_order_form(t, held).A;
    Eigen::VectorXd all_units = Eigen::VectorXd::Ones(whole.rows());
    all_units.head(2 * m) = units;
    const Complex value = greatest_eigenvalue(whole, all_units, measure);
    const bool of_state = std::abs(value - result.value) > more * std::abs(value);
    result.value = value;
    if (of_state && value != 0.0) {
      result.of_load = true;
      result.cause = state_of_load + state_of(dynamics.model().layout(), whole, value) + "'";
      return result;
    }
  }
  if (result.value == 0.0) return result;

  // (M λ + G)(λ − C) δ + K δ = 0 with a λ that rounding may not make exact.
  const Complex pole = result.value * (1 + 1e-10);
  const Eigen::VectorXd scale = units.head(m).cwiseInverse();
  const auto of_free = [&](const Eigen::MatrixXd& x) -> Eigen::MatrixXcd { return x(free, free).cast<Complex>(); };
  const Eigen::MatrixXcd turn = pole * Eigen::MatrixXcd::Identity(m, m) - of_free(t.drift);
  const Eigen::MatrixXcd Q = scale.cast<Complex>().asDiagonal() *
                             ((pole * of_free(t.mass) + of_free(t.by_speed)) * turn + of_free(t.by_position)) *
                             scale.cast<Complex>().asDiagonal() / std::norm(pole);
  const Eigen::VectorXcd right = scale.cast<Complex>().cwiseProduct(null_vector(Q)),
                         left = scale.cast<Complex>().cwiseProduct(null_vector(Q.adjoint()));
  const Complex inertia = left.dot(of_free(t.mass) * right);
  const Cause cause =
      cause_of(parts_of(dynamics, state, t), free, result.value, left, right, result.value * result.value * inertia);
  result.cause = cause.name;
  result.of_load = cause.of_load;
  result.speed = static_cast<std::size_t>(free[static_cast<std::size_t>(cause.at)]);
  result.alone = masses[cause.at];
  result.inertia = std::abs(inertia) / (std::abs(left[cause.at]) * std::abs(right[cause.at]));
  return result;
}

}  // namespace

FastestPole fastest_pole(const TangentDynamics& dynamics, const State& state, const Held& held) {
  return pole_by(dynamics, state, held, [](Complex pole) { return std::abs(pole); });
}

FastestPole growing_pole(const TangentDynamics& dynamics, const State& state, const Held& held) {
  return pole_by(dynamics, state, held, [](Complex pole) { return pole.real(); });
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
    text += ", behind which there is little inertia (" + brief(pole.inertia) + " where the others stay " +
            brief(pole.alone) + ")";
  return text;
}

}  // namespace withy
