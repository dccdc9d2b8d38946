#include <fmt/format.h>

#include "reduce.hpp"
#include "withy/bodies/modal/mass_integrals.hpp"

namespace withy::fem {
namespace {

/// Mode k as a field on the nodes, 3×N.
Matrix3X field(const Reduction& body, Eigen::Index k) {
  return Eigen::Map<const Matrix3X>(body.modes.col(k).data(), 3, body.X.cols());
}

MassIntegrals integrals(const Reduction& body) {
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
      if (body.second_order.empty()) continue;
      for (Eigen::Index c = 0; c < 3; ++c) {
        sum.gamma[kl][c] = body.second_order[static_cast<std::size_t>(c)](k, l);
        for (Eigen::Index i = 0; i < 3; ++i)
          sum.x_gamma[kl](i, c) = body.second_order[static_cast<std::size_t>(3 + 3 * i + c)](k, l);
      }
    }
  }
  return sum;
}

}  // namespace

sid::Data sid_of(const Reduction& body) {
  const Eigen::Index n = body.modes.cols();
  sid::Data data;
  data.title = "written by withy import";
  put_integrals(integrals(body), data);
  for (Eigen::Index k = 0; k < n; ++k)
    data.mode_names.push_back(fmt::format("Eigen Mode {} : {:.6g} Hz", k + 1, body.frequency(k)));
  data.nodes = body.nodes;
  data.Ke.m0 = body.omega.cwiseAbs2().asDiagonal();
  data.Me.m0 = 0.5 * (data.Me.m0 + data.Me.m0.transpose()).eval();
  if (!body.second_order.empty()) return data;
  // First orders that Γ would be part of: left out, so that readers say what is missing.
  data.Ct.m1.clear();
  data.Cr.m1.clear();
  data.Oe.m1.clear();
  return data;
}

}  // namespace withy::fem
