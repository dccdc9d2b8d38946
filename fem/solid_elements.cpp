#include "solid_elements.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <map>

#include "element_shape.hpp"

namespace withy::fem {
namespace {

/// Of every element that has one.
std::map<long, Elastic> materials_of(const Mesh& mesh) {
  std::map<long, Elastic> all;
  for (const SolidSection& section : mesh.sections) {
    const auto material = mesh.materials.find(section.material);
    const auto set = mesh.element_sets.find(section.elements);
    if (set == mesh.element_sets.end()) continue;
    if (material == mesh.materials.end())
      throw InputError(fmt::format("material {} has no constant isotropic *ELASTIC", section.material));
    for (const long element : set->second) all[element] = material->second;
  }
  return all;
}

}  // namespace

SolidElements::SolidElements(const Mesh& mesh, const Matrices& matrices) : nodes_(matrices.X.cols()) {
  // Of shells and others beside solids it is seen later whether they bear anything: by what the stresses miss.
  std::string unknown = mesh.other_elements.empty() ? "" : *mesh.other_elements.begin();
  if (mesh.elements.empty() && !mesh.drawn_only.empty()) unknown = mesh.drawn_only.begin()->second.type;
  if (!unknown.empty())
    throw InputError(
        fmt::format("the deck has elements of type {}, whose stresses are not known; known are those of C3D4, C3D6, "
                    "C3D8, C3D10, C3D15, C3D20 and C3D20R",
                    unknown));
  if (mesh.elements.empty()) throw InputError("there are no elements in the mesh's file; need the input deck");
  const std::map<long, Elastic> materials = materials_of(mesh);
  for (const auto& [number, element] : mesh.elements) {
    const auto material = materials.find(number);
    if (material == materials.end())
      throw InputError(fmt::format("element {} has no *SOLID SECTION with a material and without orientation", number));
    const auto [modulus, ratio] = material->second;
    const ElementShape& shape = *element_shape(element.type);
    Solid& solid = solids_.emplace_back();
    solid.shear = modulus / (2 * (1 + ratio));
    solid.lame = modulus * ratio / ((1 + ratio) * (1 - 2 * ratio));
    if (element.nodes.size() != static_cast<std::size_t>(shape.nodes))
      throw InputError(fmt::format("element {} lacks nodes", number));
    Matrix3X X(3, shape.nodes);
    for (const long node : element.nodes) {
      const auto it = std::lower_bound(matrices.nodes.begin(), matrices.nodes.end(), node);
      if (it == matrices.nodes.end() || *it != node)
        throw InputError(fmt::format("node {} of element {} is not in the matrices", node, number));
      X.col(static_cast<Eigen::Index>(solid.rows.size())) = matrices.X.col(it - matrices.nodes.begin());
      solid.rows.push_back(it - matrices.nodes.begin());
    }
    for (std::size_t p = 0; p < shape.weights.size(); ++p) {
      const Matrix3 jacobian = shape.gradients[p] * X.transpose();  // ∂x_j/∂s_i
      const double part = jacobian.determinant() * shape.weights[p];
      if (!(part > 0)) throw InputError(fmt::format("element {} is inside out", number));
      solid.points.push_back({part, jacobian.inverse() * shape.gradients[p]});
    }
  }
}

Matrix3X SolidElements::at_nodes(const Solid& solid, const Eigen::MatrixXd& fields, Eigen::Index column) {
  Matrix3X u(3, static_cast<Eigen::Index>(solid.rows.size()));
  for (std::size_t a = 0; a < solid.rows.size(); ++a)
    u.col(static_cast<Eigen::Index>(a)) = fields.col(column).segment<3>(3 * solid.rows[a]);
  return u;
}

Matrix3 SolidElements::stress(const Solid& solid, const Point& point, const Matrix3X& u) {
  const Matrix3 H = u * point.gradient.transpose();
  return stress_of(solid, 0.5 * (H + H.transpose()));
}

Matrix3 SolidElements::stress_of(const Solid& solid, const Matrix3& strain) {
  return 2 * solid.shear * strain + solid.lame * strain.trace() * Matrix3::Identity();
}

Eigen::MatrixXd SolidElements::forces(const Eigen::MatrixXd& displacements) const {
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(3 * nodes_, displacements.cols());
  for (const Solid& solid : solids_) {
    for (Eigen::Index j = 0; j < displacements.cols(); ++j) {
      const Matrix3X u = at_nodes(solid, displacements, j);
      Matrix3X f = Matrix3X::Zero(3, u.cols());
      for (const Point& point : solid.points) f += point.volume * stress(solid, point, u) * point.gradient;
      for (std::size_t a = 0; a < solid.rows.size(); ++a)
        all.col(j).segment<3>(3 * solid.rows[a]) += f.col(static_cast<Eigen::Index>(a));
    }
  }
  return all;
}

std::vector<Eigen::MatrixXd> SolidElements::geometric_stiffness(const Eigen::MatrixXd& displacements,
                                                                const Eigen::MatrixXd& fields) const {
  const Eigen::Index n = fields.cols(), m = displacements.cols();
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(n * (n + 1) / 2, m);  // one row a pair k ≤ l
  // σ : W = Σ of six products, those off the diagonal twice.
  Eigen::MatrixXd products(sum.rows(), 6), stresses(6, m);
  const auto six = [](const Matrix3& s) {
    return Eigen::Matrix<double, 6, 1>(s(0, 0), s(1, 1), s(2, 2), s(0, 1), s(0, 2), s(1, 2));
  };
  std::vector<Matrix3X> u(static_cast<std::size_t>(m)), phi(static_cast<std::size_t>(n));
  std::vector<Matrix3> H(static_cast<std::size_t>(n));
  for (const Solid& solid : solids_) {
    for (Eigen::Index j = 0; j < m; ++j) u[static_cast<std::size_t>(j)] = at_nodes(solid, displacements, j);
    for (Eigen::Index k = 0; k < n; ++k) phi[static_cast<std::size_t>(k)] = at_nodes(solid, fields, k);
    for (const Point& point : solid.points) {
      for (std::size_t k = 0; k < phi.size(); ++k) H[k] = phi[k] * point.gradient.transpose();
      Eigen::Index pair = 0;
      for (std::size_t k = 0; k < phi.size(); ++k) {
        for (std::size_t l = k; l < phi.size(); ++l, ++pair) {
          const Matrix3 W = H[k].transpose() * H[l];
          products.row(pair) << W(0, 0), W(1, 1), W(2, 2), W(0, 1) + W(1, 0), W(0, 2) + W(2, 0), W(1, 2) + W(2, 1);
        }
      }
      for (Eigen::Index j = 0; j < m; ++j)
        stresses.col(j) = point.volume * six(stress(solid, point, u[static_cast<std::size_t>(j)]));
      sum.noalias() += products * stresses;
    }
  }
  std::vector<Eigen::MatrixXd> all(static_cast<std::size_t>(m), Eigen::MatrixXd(n, n));
  for (Eigen::Index j = 0; j < m; ++j) {
    Eigen::Index pair = 0;
    for (Eigen::Index k = 0; k < n; ++k) {
      for (Eigen::Index l = k; l < n; ++l, ++pair)
        all[static_cast<std::size_t>(j)](k, l) = all[static_cast<std::size_t>(j)](l, k) = sum(pair, j);
    }
  }
  return all;
}

Eigen::MatrixXd SolidElements::second_order_forces(const Eigen::MatrixXd& fields) const {
  const Eigen::Index n = fields.cols();
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(3 * nodes_, n * (n + 1) / 2);
  std::vector<Matrix3> H(static_cast<std::size_t>(n));
  for (const Solid& solid : solids_) {
    std::vector<Matrix3X> phi;
    for (Eigen::Index k = 0; k < n; ++k) phi.push_back(at_nodes(solid, fields, k));
    for (const Point& point : solid.points) {
      for (std::size_t k = 0; k < H.size(); ++k) H[k] = phi[k] * point.gradient.transpose();
      Eigen::Index pair = 0;
      for (std::size_t k = 0; k < H.size(); ++k) {
        for (std::size_t l = k; l < H.size(); ++l, ++pair) {
          const Matrix3 W = H[k].transpose() * H[l];
          const Matrix3X f = -point.volume * stress_of(solid, 0.5 * (W + W.transpose())) * point.gradient;
          for (std::size_t a = 0; a < solid.rows.size(); ++a)
            all.col(pair).segment<3>(3 * solid.rows[a]) += f.col(static_cast<Eigen::Index>(a));
        }
      }
    }
  }
  return all;
}

}  // namespace withy::fem
