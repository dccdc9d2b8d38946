#include "withy/core/sweep/rigid_inverse_dynamics.hpp"

#include <cstdint>

#include "withy/core/model/closing.hpp"
#include "withy/core/sweep/joint_step.hpp"
#include "withy/core/tree/invariants.hpp"

namespace withy {

class RigidInverseDynamics::Algorithm {
 public:
  virtual ~Algorithm() = default;
  [[nodiscard]] virtual std::size_t scratch() const = 0;
  virtual void efforts(const double* x, const double* u, const double* u_dot, double* efforts,
                       double* scratch) const noexcept = 0;
};

namespace {

using namespace sweep;  // NOLINT(google-build-using-namespace): the words of the kernels, in this file alone

template <class Space>
class NewtonEuler final : public RigidInverseDynamics::Algorithm {
  using Twist = typename Space::Twist;

 public:
  NewtonEuler(const NodeTree& tree, const Vector3& gravity) {
    for (const NodeSpec& spec : tree.nodes) {
      const NodeSpec at_hinge = rooted(in_strain_order(spec, StrainOrder::linear));
      Link link{JointData<Space>(spec), RigidPart<Space>(Invariants(spec, StrainOrder::linear).I0), spec.parent};
      if (spec.parent >= 0) {
        // The undeformed section is parallel to its node's frame, so the hinge is fixed to that frame.
        const NodeSpec& parent = tree.nodes[static_cast<std::size_t>(spec.parent)];
        Pose F = spec.F;
        if (spec.parent_station >= 0) {
          if (parent.root_station >= 0) F = Pose{parent.M.R.transpose(), Vector3::Zero()} * F;
          F.p += stations_[static_cast<std::size_t>(spec.parent)][static_cast<std::size_t>(spec.parent_station)];
        }
        link.joint.F = Space::make(F);
      }
      link.joint.pose_matters = spec.parent >= 0 || !gravity.isZero(0);
      links_.push_back(std::move(link));
      stations_.emplace_back();
      for (const StationSpec& s : at_hinge.stations) stations_.back().push_back(s.at.X);
    }
    const Vector3 g = tree.planar ? Vector3(tree.plane.R.transpose() * gravity) : gravity;
    world_ = Space::Twist::of(Space::angle(Vector3::Zero()), Space::position(-g));
  }

  std::size_t scratch() const override { return (links_.size() * sizeof(Motion) + alignof(Motion)) / sizeof(double); }

  // Outward, for each link, parents first:  V = X V_P + H ẋ,   A = X A_P + H ẍ + Ḣ ẋ + V × (H ẋ),   A_world = −g,
  //   F = I A + V ×* (I V).
  // Inward, children first:  τ = Hᵀ F,   F_P += Xᵀ F.
  void efforts(const double* x, const double* u, const double* u_dot, double* efforts,
               double* scratch) const noexcept override {
    auto* motions = reinterpret_cast<Motion*>((reinterpret_cast<std::uintptr_t>(scratch) + alignof(Motion) - 1) /
                                              alignof(Motion) * alignof(Motion));
    for (std::size_t i = 0; i < links_.size(); ++i) {
      const Link& link = links_[i];
      Motion& m = motions[i];
      JointMotion<Space> joint;
      joint_motion<Space>(link.joint, x + link.joint.position, u + link.joint.speed, joint);
      m.SM = joint.SM;
      m.V = joint.rate;
      if (link.parent >= 0) m.V += Space::to_child(m.SM, motions[link.parent].V);
      m.A = Space::to_child(m.SM, link.parent < 0 ? world_ : motions[link.parent].A) + Space::cross(m.V, joint.rate) +
            joint.bias;
      if (single(link.joint.kind)) {
        m.A += along<Space>(link.joint.kind, link.joint.direction * u_dot[link.joint.speed]);
      } else if constexpr (Space::angular == 3) {
        if (link.joint.kind != Joint::fixed) {
          const HingeMotion h = general_motion(link.joint, x + link.joint.position, u + link.joint.speed);
          for (Eigen::Index k = 0; k < h.H.cols(); ++k)
            m.A += Space::Twist::of(h.H.col(k)) * u_dot[link.joint.speed + static_cast<std::size_t>(k)];
        }
      }
      m.F = link.inertia.inertia * m.A + link.inertia.velocity_wrench(m.V);
    }
    for (std::size_t i = links_.size(); i-- > 0;) {
      const Link& link = links_[i];
      const Twist& F = motions[i].F;
      if (single(link.joint.kind)) {
        efforts[link.joint.speed] = link.joint.direction * component<Space>(link.joint.kind, F);
      } else if constexpr (Space::angular == 3) {
        if (link.joint.kind != Joint::fixed) {
          const HingeMotion h = general_motion(link.joint, x + link.joint.position, u + link.joint.speed);
          for (Eigen::Index k = 0; k < h.H.cols(); ++k)
            efforts[link.joint.speed + static_cast<std::size_t>(k)] = Space::dot(Space::Twist::of(h.H.col(k)), F);
        }
      }
      if (link.joint.kind != Joint::fixed)
        add_reflected<Space>(link.joint, u_dot[link.joint.speed], efforts + link.joint.speed);
      if (link.parent >= 0) motions[link.parent].F += Space::to_parent(motions[i].SM, F);
    }
  }

 private:
  struct Link {
    JointData<Space> joint;
    RigidPart<Space> inertia;
    int parent;  ///< −1: world
  };
  struct Motion {
    typename Space::Frame SM;
    Twist V, A;  ///< acceleration less gravity
    Twist F;     ///< wrench that the hinge transmits
  };
  std::vector<Link> links_;
  std::vector<std::vector<Vector3>> stations_;  ///< of each node, in its hinge frame
  Twist world_;
};

}  // namespace

RigidInverseDynamics::RigidInverseDynamics(const Model& model) {
  require_tree(model, "the inverse dynamics of the rigid tree, which this load takes its efforts from,");
  const NodeTree tree = compile_tree(model);
  if (tree.planar) {
    algorithm_ = std::make_shared<NewtonEuler<Planar>>(tree, model.gravity());
  } else {
    algorithm_ = std::make_shared<NewtonEuler<Spatial>>(tree, model.gravity());
  }
}

std::size_t RigidInverseDynamics::scratch() const { return algorithm_->scratch(); }

void RigidInverseDynamics::efforts(std::span<const double> x, std::span<const double> u, std::span<const double> u_dot,
                                   std::span<double> efforts, std::span<double> scratch) const noexcept {
  algorithm_->efforts(x.data(), u.data(), u_dot.data(), efforts.data(), scratch.data());
}

}  // namespace withy
