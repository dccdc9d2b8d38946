#include "relaxation.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "withy/core/model/compiled_model.hpp"
#include "withy/core/plugin/equations.hpp"
#include "withy/core/plugin/formulation.hpp"
#include "withy/scene/names.hpp"
#include "withy/scene/scene.hpp"

namespace withy::exchange {

bool has_relaxation(const Tree& tree) {
  return std::any_of(tree.joints.begin(), tree.joints.end(), [](const Joint& j) { return j.relaxation.has_value(); });
}

void settle_relaxation(Tree& tree, const Scene& rigid, Diagnostics& diagnostics) {
  const auto equations = compile_model(*rigid.formulation, rigid.model);
  const DenseSystem system = equations->system(rigid.initial.time, rigid.initial.y);
  const auto size = static_cast<Eigen::Index>(system.size);
  Eigen::MatrixXd M = Eigen::Map<const Eigen::MatrixXd>(system.mass.data(), size, size);
  const auto slot_of = [&](const Joint& joint) { return *equations->layout().hinge(joint.name); };
  for (const Joint& joint : tree.joints) {
    if (joint.has_reflected_inertia()) continue;  // M has it
    const Slot slot = slot_of(joint);
    const auto first = static_cast<Eigen::Index>(slot.speed), count = static_cast<Eigen::Index>(slot.speeds);
    M.diagonal().segment(first, count).array() += joint.armature;
  }
  // Rows and columns by the roots of M's diagonal, so that units and sizes do not decide what is singular.
  const Eigen::VectorXd diagonal = M.diagonal(), scale = diagonal.cwiseSqrt().cwiseInverse();
  const Eigen::FullPivLU<Eigen::MatrixXd> solver(scale.asDiagonal() * M * scale.asDiagonal());
  for (Joint& joint : tree.joints) {
    if (!joint.relaxation) continue;
    const Relaxation& r = *joint.relaxation;
    const auto i = static_cast<Eigen::Index>(slot_of(joint).speed);
    const double inertia = diagonal[i] / solver.solve(Eigen::VectorXd::Unit(size, i))[i];
    if (!solver.isInvertible() || !std::isfinite(inertia)) {
      diagnostics.error(joint.place, fmt::format("the joint {} has a springdamper, and the mass matrix of the tree is "
                                                 "singular; need inertias, or stiffness and damping",
                                                 in_quotes(joint.name)));
      return;
    }
    if (r.spring) joint.stiffness = inertia / (r.time * r.time * r.ratio * r.ratio);
    if (r.damper) joint.damping = 2 * inertia / r.time;
    tree.remarks.push_back(
        fmt::format("joint {}: springdamper {} {} is the stiffness {:.6g} and the damping {:.6g} for "
                    "the inertia {:.6g} that the joint feels in the pose of the file",
                    in_quotes(joint.name), r.time, r.ratio, joint.stiffness, joint.damping, inertia));
  }
}

}  // namespace withy::exchange
