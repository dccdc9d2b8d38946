#include "withy/study/vibrations_followed.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "withy/core/analysis/modes.hpp"
#include "withy/core/shape/vibrations.hpp"
#include "withy/core/simulation/diagnosis.hpp"
#include "withy/core/simulation/elastic_modes.hpp"
#include "withy/core/simulation/loop_following.hpp"

namespace withy::study {
namespace {

/// Six steps a period and more are to follow a vibration.
constexpr double most_radians_a_step = 1;
/// Of the kinetic energy of vibration: a vibration that has less moves little beside the others.
constexpr double share_that_counts = 0.1;
/// Of the energy that moves in the run: with less of it, speeds of vibration are below a thousandth of the others.
constexpr double energy_that_counts = 1e-6;
/// Of the kinetic energy: what rings by itself has as much in `by_acceleration` over its phases, and what follows a
/// load with a tenth of its frequency a hundredth.
constexpr double share_that_rings = 0.25;

/// What vibrates at a state.
struct Vibrating {
  double frequency = 0;    ///< [rad/s]
  double energy = 0;       ///< kinetic, η̇²/2 [J]
  Eigen::Index speed = 0;  ///< that has most of it
  Eigen::Index rank = 0;   ///< among the vibrations of its state
  /// (η̈/ω)²/2 [J]: the energy of ω² times how far it is from where the forces would hold it.
  double by_acceleration = 0;
};

std::vector<Eigen::Index> not_prescribed(const DenseSystem& system) {
  std::vector<bool> prescribed(system.size);
  for (const PrescribedRate& p : system.prescribed) prescribed[p.speed] = true;
  std::vector<Eigen::Index> free;
  for (std::size_t i = 0; i < system.size; ++i)
    if (!prescribed[i]) free.push_back(static_cast<Eigen::Index>(i));
  return free;
}

/// At a state: η̇ = vᵀ M u and η̈ = vᵀ M u̇ of each vibration v with vᵀ M v = 1. What hinges do that nothing bends is
/// orthogonal to all of them, and speeds that motions prescribe take no part. Of loops the vibrations are those that
/// keep them closed.
void add_vibrating(const EquationsOfMotion& equations, const Eigen::MatrixXd& stiffness, const State& state,
                   std::vector<Vibrating>& all) {
  const DenseSystem system = equations.system(state.time, state.y);
  const auto n = static_cast<Eigen::Index>(system.size);
  const std::vector<Eigen::Index> free = not_prescribed(system);
  if (free.empty()) return;
  // Strict formulations have no symmetric mass matrix.
  const Eigen::MatrixXd whole = Eigen::Map<const Eigen::MatrixXd>(system.mass.data(), n, n)(free, free),
                        mass = 0.5 * (whole + whole.transpose());
  const Eigen::MatrixXd closing = closing_rows(equations, state.y)(Eigen::all, free);
  const Eigen::MatrixXd moves = closing.rows() == 0
                                    ? Eigen::MatrixXd(Eigen::MatrixXd::Identity(mass.rows(), mass.cols()))
                                    : closed_motions(closing, mass.diagonal());
  if (moves.cols() == 0) return;
  const Vibrations found =
      vibrations(moves.transpose() * stiffness(free, free) * moves, moves.transpose() * mass * moves);
  const Eigen::MatrixXd vectors = moves * found.vectors;
  std::vector<double> y_dot(equations.size());
  Work work = equations.make_work();
  if (!equations.derivatives(state.time, state.y, y_dot, work).ok()) return;
  const auto speeds_of = [&](const std::vector<double>& y) -> Eigen::VectorXd {
    return Eigen::Map<const Eigen::VectorXd>(y.data() + equations.layout().positions, n)(free);
  };
  const Eigen::VectorXd rates = vectors.transpose() * (mass * speeds_of(state.y));
  const Eigen::VectorXd accelerations = vectors.transpose() * (mass * speeds_of(y_dot));
  for (Eigen::Index k = found.rigid(); k < found.squares.size(); ++k) {
    const double square = found.squares[k];
    Vibrating v{std::sqrt(square), 0.5 * rates[k] * rates[k], 0, k - found.rigid(),
                0.5 * accelerations[k] * accelerations[k] / square};
    kinetic_shares(mass, vectors.col(k).cast<std::complex<double>>()).maxCoeff(&v.speed);
    v.speed = free[static_cast<std::size_t>(v.speed)];
    all.push_back(v);
  }
}

/// Over states along a run: phases as they come. \param states how many were looked at
std::vector<Vibrating> vibrating_along(const Model& model, const EquationsOfMotion& equations,
                                       const std::vector<State>& along, double& states) {
  // Of many coordinates fewer states, so that this takes milliseconds.
  constexpr double most = 16, least = 2, elements = 4e6;
  const auto n = static_cast<double>(model.layout().speeds);
  const auto looks = static_cast<std::size_t>(std::clamp(elements / (n * n * n), least, most));
  const Eigen::MatrixXd stiffness = stiffness_of_modes(model);
  std::vector<Vibrating> all;
  states = 0;
  const std::size_t every = std::max<std::size_t>(along.size() / looks, 1);
  for (std::size_t i = 0; i < along.size(); i += every) {
    try {
      add_vibrating(equations, stiffness, along[i], all);
      ++states;
    } catch (const std::domain_error&) {  // the mass matrix is not positive definite there
    }
  }
  return all;
}

/// Gives what is carried along by a slower force, and does not ring, the frequency of its motion: ω² is then to the
/// square of that frequency as the kinetic energy of the vibration to its other one, over the states.
void take_frequencies_of_motion(std::vector<Vibrating>& all) {
  std::vector<double> energy, by_acceleration;
  for (const Vibrating& v : all) {
    const auto rank = static_cast<std::size_t>(v.rank);
    if (rank >= energy.size()) energy.resize(rank + 1), by_acceleration.resize(rank + 1);
    energy[rank] += v.energy, by_acceleration[rank] += v.by_acceleration;
  }
  for (Vibrating& v : all) {
    const auto rank = static_cast<std::size_t>(v.rank);
    if (by_acceleration[rank] < share_that_rings * energy[rank])
      v.frequency *= std::sqrt(by_acceleration[rank] / energy[rank]);
  }
}

}  // namespace

std::optional<Indicator> vibrations_followed(const Scene& scene, const EquationsOfMotion& equations,
                                             const RunSummary& summary) {
  const Model& model = *scene.model;
  if (scene.source.at("integrator").find("rtol") != nullptr || summary.steps.accepted == 0 ||
      model.layout().speeds > largest_examined)
    return {};
  double whole = 0, states = 0;
  std::vector<Vibrating> all = vibrating_along(model, equations, summary.validity.along, states);
  for (const Vibrating& v : all) whole += v.energy;
  if (!(whole > energy_that_counts * summary.energy_scale * states)) return {};
  take_frequencies_of_motion(all);
  std::sort(all.begin(), all.end(), [](const Vibrating& a, const Vibrating& b) { return a.frequency > b.frequency; });
  double above = 0;
  const auto counts = std::find_if(all.begin(), all.end(), [&](const Vibrating& v) {
    above += v.energy;
    return above >= share_that_counts * whole;
  });
  const double step = (summary.reached - scene.initial.time) / static_cast<double>(summary.steps.accepted);
  return Indicator{
      fmt::format("step times the frequency of what vibrates, {:.3g} rad/s, most of it {}", counts->frequency,
                  model.layout().speed_names[static_cast<std::size_t>(counts->speed)]),
      step * counts->frequency, most_radians_a_step,
      "steps do not follow it: the motion is another, whatever the energy says; take shorter ones, or an integrator "
      "with 'rtol'"};
}

}  // namespace withy::study
