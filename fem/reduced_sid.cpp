#include <fmt/format.h>

#include "reduce.hpp"
#include "sections.hpp"
#include "withy/bodies/modal/mass_integrals.hpp"

namespace withy::fem {
namespace {

constexpr std::size_t inertial_loads = 12;

/// Mode k as a field on the nodes, 3×N.
Matrix3X field(const Reduction& body, Eigen::Index k) {
  return Eigen::Map<const Matrix3X>(body.modes.col(k).data(), 3, body.X.cols());
}

MassIntegrals integrals(const Reduction& body, const GeometricStiffness& geometric) {
  const Eigen::Index n = body.modes.cols();
  MassIntegrals sum(n);
  const Eigen::VectorXd ones = Eigen::VectorXd::Ones(body.X.cols());
  const Eigen::VectorXd mass = body.node_mass * ones;
  const Matrix3X weighted = (body.node_mass * body.X.transpose()).transpose();
  sum.mass = mass.sum();
  sum.x = body.X * mass;
  sum.xx = weighted * body.X.transpose();
  for (Eigen::Index k = 0; k < n; ++k) {
    const Matrix3X phi = field(body, k);
    const Matrix3X weighted_phi = (body.node_mass * phi.transpose()).transpose();
    sum.phi.col(k) = phi * mass;
    sum.x_phi[static_cast<std::size_t>(k)] = weighted * phi.transpose();
    for (Eigen::Index l = 0; l < n; ++l) {
      const std::size_t kl = sum.pair(k, l);
      sum.phi_phi[kl] = weighted_phi * field(body, l).transpose();
      for (Eigen::Index i = 0; i < 3 && !geometric.empty(); ++i) {
        sum.gamma[kl][i] = -geometric[static_cast<std::size_t>(i)](k, l);
        for (Eigen::Index j = 0; j < 3; ++j)
          sum.x_gamma[kl](j, i) = -geometric[static_cast<std::size_t>(3 + 3 * j + i)](k, l);
      }
    }
  }
  return sum;
}

/// First orders of a node from the geometric stiffness of what acts on it, `loads` on: Γ by the forces; of a rigid
/// section Θ by the moments. These are dead forces w × r on its nodes, which work on the second-order displacement
/// Θ × r + ½ (ψ_k × (ψ_l × r) + …) too: ψ_kᵀ sym(Σ (w × r) rᵀ) ψ_l, to be taken off.
void add_first_order(sid::Node& node, const Section& section, const Eigen::MatrixXd* loads) {
  const Eigen::Index n = node.phi.m0.cols();
  const Matrix3X psi = node.psi.m0;
  node.phi.m1.assign(static_cast<std::size_t>(n), Eigen::MatrixXd::Zero(3, n));
  if (section.rigid()) node.psi.m1 = node.phi.m1;
  for (Eigen::Index l = 0; l < n; ++l) {
    const auto mode = static_cast<std::size_t>(l);
    node.origin.m1.emplace_back(node.phi.m0.col(l));
    const Vector3 turn = psi.col(l);
    if (section.rigid()) node.axes.m1.emplace_back(skew<double>(turn));
    for (Eigen::Index c = 0; c < 3; ++c) {
      node.phi.m1[mode].row(c) = -loads[c].col(l).transpose();
      if (!section.rigid()) continue;
      const Matrix3 couple = skew<double>(section.twist_of_moment(c)) * section.spread();
      const Matrix3 F = 0.5 * (couple + couple.transpose());
      node.psi.m1[mode].row(c) = -loads[3 + c].col(l).transpose() - turn.transpose() * F * psi;
    }
    for (Eigen::Index k = 0; section.rigid() && k < n; ++k)
      node.psi.m1[mode].col(k) += 0.5 * turn.cross(Vector3(psi.col(k)));
  }
}

}  // namespace

sid::Data sid_of(const Reduction& body, const Matrices& matrices, const ReductionOptions& options,
                 const GeometricStiffness& geometric) {
  const Eigen::Index n = body.modes.cols();
  sid::Data data;
  data.title = "written by withy import";
  put_integrals(integrals(body, geometric), data);
  for (Eigen::Index k = 0; k < n; ++k)
    data.mode_names.push_back(fmt::format("Eigen Mode {} : {:.6g} Hz", k + 1, body.frequency(k)));
  data.nodes = body.nodes;
  data.Ke.m0 = body.omega.cwiseAbs2().asDiagonal();
  data.Me.m0 = 0.5 * (data.Me.m0 + data.Me.m0.transpose()).eval();
  if (geometric.empty()) {
    data.Ct.m1.clear();
    data.Cr.m1.clear();
    data.Oe.m1.clear();
    return data;
  }
  const Eigen::MatrixXd* loads = geometric.data() + inertial_loads;
  for (std::size_t i = 0; i < options.interfaces.size(); ++i) {
    const Section section = section_of(options.interfaces[i].nodes, matrices);
    add_first_order(data.nodes[1 + i], section, loads);
    loads += section.rigid() ? 6 : 3;
  }
  return data;
}

}  // namespace withy::fem
