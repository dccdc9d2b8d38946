/// \file
/// The equations of motion of one model in one formulation: what integrators and analyses call.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "withy/core/plugin/state.hpp"

namespace withy {

class SensedState;
struct SectionPlace;

/// How an evaluation ended.
struct Evaluation {
  enum class Outcome { ok, singular, nonfinite };
  Outcome outcome = Outcome::ok;
  int body = -1;             ///< index in Model::bodies() of the body whose block could not be solved, or −1
  int determinant_sign = 1;  ///< of M, the product of its pivots' signs; meaningless unless ok
  [[nodiscard]] bool ok() const { return outcome == Outcome::ok; }
};

/// Scratch memory of an evaluation: allocated once, owned by a caller, never shared between threads. Its content
/// between two calls does not matter.
class Work {
 public:
  explicit Work(std::size_t bytes);
  [[nodiscard]] std::byte* data() { return data_; }
  [[nodiscard]] std::size_t size() const { return size_; }
  /// Fills the memory with NaN patterns, for tests.
  void poison();

 private:
  std::vector<std::byte> storage_;
  std::byte* data_ = nullptr;  ///< aligned to 64
  std::size_t size_ = 0;
};

/// Energies [J] and momenta [kg m/s, kg m²/s] of a state. They are those of the formulation's strain kinematics without
/// truncation, so that a truncated formulation shows what it neglects.
struct Energies {
  double kinetic = 0;
  double potential = 0;                      ///< strain energy, and weight measured from the world origin
  std::array<double, 3> linear_momentum{};   ///< world axes
  std::array<double, 3> angular_momentum{};  ///< about the world origin, world axes
};

/// The acceleration that a motion prescribes for a speed.
struct PrescribedRate {
  std::size_t speed = 0;    ///< index
  double acceleration = 0;  ///< [rad/s², m/s²]
};

/// The dense system M u̇ = f + applied + motion efforts, for eyes, tests and analyses. Row-major, all speeds. The
/// efforts of motions are unknowns on the prescribed speeds, in the place of their accelerations.
struct DenseSystem {
  std::size_t size = 0;
  std::vector<double> mass;     ///< M; not symmetric in the strict formulations
  std::vector<double> force;    ///< f: weight, stiffness, damping and velocity terms
  std::vector<double> applied;  ///< efforts of the loads
  std::vector<PrescribedRate> prescribed = {};
};

/// What is known of the mass matrix of the free speeds at a state.
struct Conditioning {
  double condition = 0;            ///< κ(M), ratio of the extreme singular values
  int determinant_sign = 0;        ///< sign of det M: −1, 0, +1
  double smallest_eigenvalue = 0;  ///< of the symmetric part of M
  std::vector<double> weakest;     ///< unit vector of generalized speeds along which M acts least
};

/// Position of a frame and rotation (row-major R_WF) in the world.
struct WorldPose {
  std::array<double, 3> position{};
  std::array<double, 9> rotation{};
};

/// Velocities of a frame, world axes.
struct WorldVelocity {
  std::array<double, 3> angular{};  ///< [rad/s]
  std::array<double, 3> linear{};   ///< of its origin [m/s]
};

/// What there is to see of a state beside its coordinates, in time and memory proportional to the number of bodies.
/// Every body moves by its own strain kinematics without truncation. Allocates nothing once made; of one thread.
class Observation {
 public:
  virtual ~Observation() = default;
  /// Goes to a state, y as in State; all else tells of it until the next.
  virtual void observe(std::span<const double> y) noexcept = 0;
  [[nodiscard]] virtual Energies energies() const noexcept = 0;
  [[nodiscard]] virtual WorldPose frame_pose(int body, int frame) const noexcept = 0;
  [[nodiscard]] virtual WorldVelocity frame_velocity(int body, int frame) const noexcept = 0;
  /// |ω| of the body frame [rad/s].
  [[nodiscard]] virtual double turning(int body) const noexcept = 0;
  /// Displacement r − X of the section at a frame relative to the body frame, body axes [m].
  [[nodiscard]] virtual std::array<double, 3> deflection(int body, int frame) const noexcept = 0;
  /// Whether a body's deflections are those of its stations' expansion to the second order, Φq + ½qᵀΓq with maps of its
  /// own: who has these need not ask.
  [[nodiscard]] virtual bool expands(int /*body*/) const noexcept { return false; }
};

/// Linear systems with W = 1 − δ A, where A is what makes flexible trees stiff: the part of ∂ẏ/∂y that comes from modal
/// stiffness and damping,
///   q' = u_q,   u' = −M⁻¹ (K q + D u_q),
/// and nothing else; and evaluations in which that part is implicit. Linearly implicit integrators ask for them.
class LinearlyImplicit {
 public:
  virtual ~LinearlyImplicit() = default;
  /// Memory for the factors, allocated once.
  [[nodiscard]] virtual Work make_factors() const = 0;
  /// Factors of M(y) + δ D + δ² K, by two of an evaluation's three passes. δ > 0 [s].
  virtual Evaluation factorize(std::span<const double> y, double delta, Work& factors) const noexcept = 0;
  /// Replaces r, laid out as y, by the solution of W z = r: two of an evaluation's three passes.
  virtual void solve(std::span<double> r, Work& factors) const noexcept = 0;
  /// ẏ with stiffness and damping implicit, for the price of one evaluation: loads, velocity terms, N and M are those
  /// at (t, y); the forces of stiffness and damping, and the speeds that move the positions, are those at
  /// z = base + δ ẏ,
  ///   ẋ = N(x) u_z,   (M + δ D + δ² K) u̇ = f(t, y) + K (q − q_base − δ u_base) + D (u_q − u_base),
  /// f with the forces of stiffness and damping at y. The rate of the work element takes the speeds at z.
  /// \param work of EquationsOfMotion::make_work
  virtual Evaluation implicit_derivatives(double t, std::span<const double> y, std::span<const double> base,
                                          double delta, std::span<double> y_dot, Work& work) const noexcept = 0;
};

/// The exact ∂ẏ/∂y. Implicit integrators may ask for it.
class Linearization {
 public:
  virtual ~Linearization() = default;
  /// Sets the derivatives of ẋ, u̇ and ż (rows) with respect to positions, speeds and continuous states of loads
  /// (columns), Layout::moving() of each, column-major, at (t, y) where ẏ is `y_dot`. Discrete states are constant and
  /// the work is a quadrature, on which nothing depends: they have no rows and no columns. With respect to a quaternion
  /// they are those along its unit sphere, and zero across it, but for its own rate, which is linear in all four of its
  /// components. O(size²) memory, O(size²) to O(size³) time; may
  /// allocate, as it is asked for once in many steps.
  virtual Evaluation jacobian(double t, std::span<const double> y, std::span<const double> y_dot,
                              std::span<double> jacobian) const = 0;
  /// Names of loads whose part in it at (t, y) is numerical.
  [[nodiscard]] virtual std::vector<std::string> differenced(double t, std::span<const double> y) const = 0;
};

/// Made by Formulation::compile for one model; const, so that threads share it, each with its own Work.
class EquationsOfMotion {
 public:
  virtual ~EquationsOfMotion() = default;
  [[nodiscard]] virtual const Layout& layout() const = 0;
  /// Number of elements of State::y.
  [[nodiscard]] std::size_t size() const { return layout().size(); }
  [[nodiscard]] virtual Work make_work() const = 0;

  /// The hot call: time derivatives of y at (t, y). Allocates nothing, throws nothing, logs nothing.
  /// On an outcome other than ok the content of y_dot is meaningless.
  virtual Evaluation derivatives(double t, std::span<const double> y, std::span<double> y_dot,
                                 Work& work) const noexcept = 0;
  /// Efforts [N m, N] on all speeds of the model's loads at (t, y), or of one of them alone; for reports and audits.
  /// \param load index in Model::loads(), or `all_loads`
  virtual void load_efforts(double t, std::span<const double> y, int load, std::span<double> efforts,
                            Work& work) const noexcept = 0;
  static constexpr int all_loads = -1;
  /// Efforts [N m, N] that the model's motions need at (t, y) on their speeds, zero on all others: what inverse
  /// dynamics asks for there beyond the loads. For reports.
  virtual Evaluation motion_efforts(double t, std::span<const double> y, std::span<double> efforts,
                                    Work& work) const noexcept = 0;
  /// The same two, of all loads and of the motions, as the last call of `derivatives` with this work memory has found
  /// them on its way: for watching a run at the price of a copy. \returns false where these equations do not keep them.
  virtual bool found_efforts(Work& /*work*/, std::span<double> /*loads*/,
                             std::span<double> /*motions*/) const noexcept {
    return false;
  }
  /// Inverse dynamics: efforts [N m, N] on all speeds that, with weight, stiffness, damping and velocity terms, give
  /// the accelerations u_dot at y: M u_dot − f. In time proportional to the number of bodies where the mass matrix is
  /// symmetric; the strict forms assemble M. The loads' efforts are not taken off, and motions do not matter.
  virtual void inverse_dynamics(std::span<const double> y, std::span<const double> u_dot, std::span<double> efforts,
                                Work& work) const = 0;
  /// M(y) a, in the same time.
  virtual void mass_times(std::span<const double> y, std::span<const double> a, std::span<double> product,
                          Work& work) const = 0;
  /// Potential energy of weight [J] whose gradient these equations have, where that is not Energies': in truncation
  /// `symmetric` that of second order in the elastic coordinates. With ½ uᵀ M u and ½ qᵀ K q it is what they conserve.
  [[nodiscard]] virtual std::optional<double> weight_potential(std::span<const double> /*y*/,
                                                               Work& /*work*/) const noexcept {
    return std::nullopt;
  }
  /// Solves linear systems for linearly implicit integrators; null where the formulation has no way to.
  [[nodiscard]] virtual const LinearlyImplicit* linearly_implicit() const { return nullptr; }
  /// The exact ∂ẏ/∂y for implicit integrators; null where the formulation has none.
  [[nodiscard]] virtual const Linearization* linearization() const { return nullptr; }
  /// ẋ of the positions alone, into the first elements of y_dot, which has those of y; the others become meaningless.
  virtual Evaluation position_rates(double t, std::span<const double> y, std::span<double> y_dot,
                                    Work& work) const noexcept {
    return derivatives(t, y, y_dot, work);
  }
  /// Scales quaternions in y back to unit length.
  virtual void normalize(std::span<double> y) const noexcept = 0;

  /// For what a run reports: energies, poses and deflections of many states.
  [[nodiscard]] virtual std::unique_ptr<Observation> make_observation() const = 0;
  /// For the outputs that a scene names (sensor.hpp); the equations must outlive it. Null where they are no model's.
  /// \param sections where inner forces will be asked for
  /// \throws std::invalid_argument where a body cannot be cut there.
  [[nodiscard]] virtual std::unique_ptr<SensedState> make_sensed_state(std::span<const SectionPlace> sections) const;

  /// M, f and applied efforts, assembled by an algorithm independent of `derivatives`; with the three below it is the
  /// dense reference, for eyes and tests: O(bodies · speeds) memory and more time.
  [[nodiscard]] virtual DenseSystem system(double t, std::span<const double> y) const = 0;
  [[nodiscard]] virtual Energies energies(std::span<const double> y) const = 0;
  [[nodiscard]] virtual WorldPose frame_pose(std::span<const double> y, int body, int frame) const = 0;
  /// Displacement r − X of the section at a frame relative to the body frame, body axes [m].
  [[nodiscard]] virtual std::array<double, 3> deflection(std::span<const double> y, int body, int frame) const = 0;
  /// What the compilation merged, specialised or dropped, a line each, for `withy inspect`.
  [[nodiscard]] virtual std::vector<std::string> savings() const = 0;
};

/// The rows and columns of the free speeds, in their order, with what the prescribed ones ask of them in `force`.
DenseSystem free_part(const DenseSystem& system);
/// Sign of det M of the free speeds: −1, 0, +1; 0 too where M is not finite.
int determinant_sign(const DenseSystem& system);
/// κ(M), the sign of det M and M's weakest direction, of the free speeds; the direction has all speeds.
Conditioning conditioning(const DenseSystem& system);
/// Accelerations of all speeds: M u̇ = f + applied in the free rows by LU with complete pivoting.
/// \throws std::domain_error where M is singular to working accuracy.
std::vector<double> solve(const DenseSystem& system);

}  // namespace withy
