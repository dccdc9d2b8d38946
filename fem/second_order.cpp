#include <fmt/format.h>

#include <Eigen/Dense>

#include "reduce.hpp"
#include "sections.hpp"
#include "solid_elements.hpp"
#include "withy/core/shape/modal_mass.hpp"

namespace withy::fem {
namespace {

/// Greatest share of the loads' forces that stresses may leave unbalanced.
constexpr double tolerated = 1e-3;

double imbalance(const SolidElements& elements, const Matrices& matrices, const Eigen::MatrixXd& displacements) {
  const Eigen::MatrixXd forces = matrices.K * displacements;
  const Eigen::MatrixXd miss = elements.forces(displacements) - forces;
  double worst = 0;
  for (Eigen::Index j = 0; j < forces.cols(); ++j) {
    if (const double size = forces.col(j).norm(); size > 0) worst = std::max(worst, miss.col(j).norm() / size);
  }
  return worst;
}

/// Work that forces on a rigid section do in the second order of its finite rotation, ½ θ × (θ × r) of exp(θ̂) r.
void subtract_turning(const Section& section, const Matrix3X& psi, const Eigen::MatrixXd& held, Reduction& body) {
  for (std::size_t load = 0; load < body.second_order.size(); ++load) {
    Matrix3 dipole = Matrix3::Zero();  // Σ r fᵀ
    for (std::size_t s = 0; s < section.rows.size(); ++s) {
      dipole += section.arms.col(static_cast<Eigen::Index>(s)) *
                held.col(static_cast<Eigen::Index>(load)).segment<3>(3 * section.rows[s]).transpose();
    }
    // f · (a × (b × r)) = (f·b)(a·r) − (a·b)(f·r), symmetric in the modes.
    const Matrix3 symmetric = 0.5 * (dipole + dipole.transpose());
    const Matrix3 form = symmetric - dipole.trace() * Matrix3::Identity();
    add_products(Matrix3(-form), psi, body.second_order[load]);
  }
}

}  // namespace

double add_second_order(const Mesh& mesh, const Matrices& matrices, const ReductionOptions& options, Reduction& body) {
  const SolidElements elements(mesh, matrices);
  const double miss = imbalance(elements, matrices, body.loaded);
  if (!(miss < tolerated))
    throw InputError(fmt::format(
        "the stresses that the deck's elements and materials give leave {:.1g} of the unit loads unbalanced; "
        "need the deck that the stiffness matrix was made from{}",
        miss,
        mesh.drawn_only.empty() ? ""
                                : fmt::format(", without elements like its {}, whose stresses are not known",
                                              mesh.drawn_only.begin()->second.type)));
  body.second_order = elements.geometric_stiffness(body.loaded, body.modes);
  for (Eigen::MatrixXd& work : body.second_order) work *= -1;
  for (std::size_t i = 0; i < options.interfaces.size(); ++i) {
    if (options.interfaces[i].nodes.size() > 1)
      subtract_turning(section_of(options.interfaces[i].nodes, matrices), body.nodes[i + 1].psi.m0, body.held, body);
  }
  // The nodes: Γ, and of ψ's first order Θ and half the product of two rotations.
  const Eigen::Index n = body.modes.cols();
  std::size_t load = inertial_loads;
  for (std::size_t i = 1; i < body.nodes.size(); ++i) {
    sid::Node& node = body.nodes[i];
    const bool turns = i <= options.interfaces.size() && options.interfaces[i - 1].nodes.size() > 1;
    for (Eigen::Index l = 0; l < n; ++l) {
      const auto rows = [&](std::size_t first) {
        Matrix3X field(3, n);
        for (std::size_t c = 0; c < 3; ++c)
          field.row(static_cast<Eigen::Index>(c)) = body.second_order[first + c].col(l).transpose();
        return field;
      };
      node.origin.m1.emplace_back(node.phi.m0.col(l));
      node.phi.m1.emplace_back(rows(load));
      if (!turns) continue;
      const Vector3 turn = node.psi.m0.col(l);
      node.psi.m1.emplace_back(rows(load + 3) + 0.5 * skew<double>(turn) * node.psi.m0);
      node.axes.m1.emplace_back(skew<double>(turn));
    }
    load += turns ? 6 : 3;
  }
  return miss;
}

Eigen::MatrixXd second_order_displacements(const Mesh& mesh, const Matrices& matrices, const ReductionOptions& options,
                                           const Reduction& body) {
  const SolidElements elements(mesh, matrices);
  const Eigen::Index n = body.modes.cols();
  // Rigid sections turn by exp(θ̂), whose second order is no motion that the mesh could choose; all else follows.
  Eigen::MatrixXd turned = Eigen::MatrixXd::Zero(body.modes.rows(), n * (n + 1) / 2);
  for (std::size_t i = 0; i < options.interfaces.size(); ++i) {
    if (options.interfaces[i].nodes.size() == 1) continue;
    const Section section = section_of(options.interfaces[i].nodes, matrices);
    const Matrix3X& psi = body.nodes[i + 1].psi.m0;
    Eigen::Index pair = 0;
    for (Eigen::Index k = 0; k < n; ++k) {
      for (Eigen::Index l = k; l < n; ++l, ++pair) {
        const Vector3 a = psi.col(k), b = psi.col(l);
        for (std::size_t s = 0; s < section.rows.size(); ++s) {
          const Vector3 r = section.arms.col(static_cast<Eigen::Index>(s));
          turned.col(pair).segment<3>(3 * section.rows[s]) = 0.5 * (a.cross(b.cross(r)) + b.cross(a.cross(r)));
        }
      }
    }
  }
  return turned + body.statics(elements.second_order_forces(body.modes) - matrices.K * turned);
}

}  // namespace withy::fem
