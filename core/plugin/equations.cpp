#include "withy/core/plugin/equations.hpp"

#include <Eigen/Dense>
#include <cstdint>
#include <cstring>
#include <limits>
#include <stdexcept>

#include "withy/core/plugin/forwarding_equations.hpp"
#include "withy/core/plugin/sensor.hpp"

namespace withy {
namespace {

using DenseMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

Eigen::Map<const DenseMatrix> mass_matrix(const DenseSystem& s) {
  const auto n = static_cast<Eigen::Index>(s.size);
  return {s.mass.data(), n, n};
}

/// Values of the free speeds with the accelerations of the prescribed ones, or zeros, in their places.
std::vector<double> of_all_speeds(const DenseSystem& system, const std::vector<double>& free, bool accelerations) {
  std::vector<double> all(system.size);
  std::vector<bool> prescribed(system.size);
  for (const PrescribedRate& p : system.prescribed) {
    prescribed[p.speed] = true;
    if (accelerations) all[p.speed] = p.acceleration;
  }
  std::size_t next = 0;
  for (std::size_t i = 0; i < system.size; ++i) {
    if (!prescribed[i]) all[i] = free[next++];
  }
  return all;
}

}  // namespace

Work::Work(std::size_t bytes) : storage_(bytes + 64), size_(bytes) {
  const auto address = reinterpret_cast<std::uintptr_t>(storage_.data());
  data_ = storage_.data() + (64 - address % 64) % 64;
}

std::unique_ptr<SensedState> EquationsOfMotion::make_sensed_state(std::span<const SectionPlace>) const {
  return nullptr;
}

std::unique_ptr<SensedState> ForwardingEquations::make_sensed_state(std::span<const SectionPlace> sections) const {
  return seen().make_sensed_state(sections);
}

void Work::poison() { std::memset(data_, 0xff, size_); }

DenseSystem free_part(const DenseSystem& system) {
  if (system.prescribed.empty()) return system;
  std::vector<bool> free(system.size, true);
  for (const PrescribedRate& p : system.prescribed) free[p.speed] = false;
  DenseSystem part;
  for (std::size_t i = 0; i < system.size; ++i) {
    if (!free[i]) continue;
    double force = system.force[i];
    for (const PrescribedRate& p : system.prescribed) force -= system.mass[i * system.size + p.speed] * p.acceleration;
    part.force.push_back(force);
    part.applied.push_back(system.applied[i]);
    for (std::size_t j = 0; j < system.size; ++j) {
      if (free[j]) part.mass.push_back(system.mass[i * system.size + j]);
    }
  }
  part.size = part.force.size();
  return part;
}

int determinant_sign(const DenseSystem& given) {
  const DenseSystem system = free_part(given);
  const auto M = mass_matrix(system);
  if (!M.allFinite()) return 0;
  // The sign alone: the determinant itself overflows for large systems.
  const Eigen::PartialPivLU<Eigen::MatrixXd> lu(M);
  double sign = lu.permutationP().determinant();
  for (Eigen::Index i = 0; i < M.rows(); ++i) {
    const double u = lu.matrixLU()(i, i);
    sign *= u > 0 ? 1.0 : (u < 0 ? -1.0 : 0.0);
  }
  return static_cast<int>(sign);
}

Conditioning conditioning(const DenseSystem& given) {
  Conditioning c;
  const DenseSystem system = free_part(given);
  if (system.size == 0) return c;
  const auto M = mass_matrix(system);
  if (!M.allFinite()) {
    c.condition = std::numeric_limits<double>::infinity();
    return c;
  }
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(M, Eigen::ComputeFullV);
  const auto& s = svd.singularValues();
  const Eigen::Index last = s.size() - 1;
  c.condition = s[last] > 0 ? s[0] / s[last] : std::numeric_limits<double>::infinity();
  const Eigen::VectorXd v = svd.matrixV().col(last);
  c.weakest = of_all_speeds(given, {v.data(), v.data() + v.size()}, false);
  c.determinant_sign = determinant_sign(system);
  const Eigen::MatrixXd symmetric = 0.5 * (M + M.transpose());
  c.smallest_eigenvalue =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(symmetric, Eigen::EigenvaluesOnly).eigenvalues()[0];
  return c;
}

std::vector<double> solve(const DenseSystem& given) {
  const DenseSystem system = free_part(given);
  const auto n = static_cast<Eigen::Index>(system.size);
  if (n == 0) return of_all_speeds(given, {}, true);
  // Scaled by the diagonal first: rows and columns carry different units.
  const Eigen::MatrixXd M = mass_matrix(system);
  const Eigen::VectorXd scale = M.diagonal().cwiseAbs().cwiseSqrt().cwiseInverse();
  if (!scale.allFinite()) throw std::domain_error("the mass matrix has a zero on its diagonal");
  const Eigen::MatrixXd scaled = scale.asDiagonal() * M * scale.asDiagonal();
  const Eigen::FullPivLU<Eigen::MatrixXd> lu(scaled);
  if (!lu.isInvertible()) throw std::domain_error("the mass matrix is singular");
  const Eigen::VectorXd f = Eigen::Map<const Eigen::VectorXd>(system.force.data(), n) +
                            Eigen::Map<const Eigen::VectorXd>(system.applied.data(), n);
  const Eigen::VectorXd a = scale.asDiagonal() * lu.solve(scale.asDiagonal() * f);
  return of_all_speeds(given, {a.data(), a.data() + n}, true);
}

}  // namespace withy
