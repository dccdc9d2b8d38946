/// \file
/// What is wrong with matrices that plugins give, in a few words, or empty.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <cmath>
#include <sstream>
#include <string>

namespace withy {

/// Of the greatest element: far above the rounding of any quadrature, far below an error of formulation.
constexpr double symmetry_tolerance = 1e-10;

using ConstMatrix = Eigen::Ref<const Eigen::MatrixXd>;

inline std::string size_fault(const std::string& name, const ConstMatrix& m, Eigen::Index rows, Eigen::Index columns) {
  if (m.rows() == rows && m.cols() == columns) return {};
  std::ostringstream text;
  text << name << " is " << m.rows() << " by " << m.cols() << ", not " << rows << " by " << columns;
  return text.str();
}

inline std::string finite_fault(const std::string& name, const ConstMatrix& m) {
  for (Eigen::Index i = 0; i < m.rows(); ++i) {
    for (Eigen::Index j = 0; j < m.cols(); ++j) {
      if (std::isfinite(m(i, j))) continue;
      std::ostringstream text;
      text << name << " has " << m(i, j) << " in row " << i + 1 << ", column " << j + 1;
      return text.str();
    }
  }
  return {};
}

inline std::string symmetry_fault(const std::string& name, const ConstMatrix& m) {
  if (m.size() == 0) return {};
  if ((m - m.transpose()).cwiseAbs().maxCoeff() <= symmetry_tolerance * m.cwiseAbs().maxCoeff()) return {};
  return name + " is not symmetric";
}

inline std::string square_fault(const std::string& name, const ConstMatrix& m, Eigen::Index size) {
  if (std::string fault = size_fault(name, m, size, size); !fault.empty()) return fault;
  if (std::string fault = finite_fault(name, m); !fault.empty()) return fault;
  return symmetry_fault(name, m);
}

/// Of a symmetric matrix: it is semidefinite where the smallest shift makes it definite.
inline std::string sign_fault(const std::string& name, const ConstMatrix& m) {
  const double greatest = m.size() == 0 ? 0 : m.cwiseAbs().maxCoeff();
  if (greatest == 0) return {};
  const auto shift = symmetry_tolerance * greatest * Eigen::MatrixXd::Identity(m.rows(), m.cols());
  if (Eigen::LLT<Eigen::MatrixXd>(m + shift).info() == Eigen::Success) return {};
  return name + " is not positive semidefinite";
}

}  // namespace withy
