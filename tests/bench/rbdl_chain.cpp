#include <rbdl/rbdl.h>

#include "rival_chains.hpp"

namespace withy::bench {
namespace {

using namespace RigidBodyDynamics;

class RbdlChain final : public RivalChain {
 public:
  explicit RbdlChain(const std::vector<Joint>& chain) {
    model_.gravity.setZero();
    Math::Matrix3d about_center;
    about_center << 0.02, 0.001, 0, 0.001, 0.03, 0.002, 0, 0.002, 0.035;
    const Body body(1.5, Math::Vector3d(0.2, 0.01, 0.02), about_center);
    unsigned int parent = 0;
    for (std::size_t i = 0; i < chain.size(); ++i) {
      const bench::Joint& j = chain[i];
      const Math::Vector3d axis(j.axis[0], j.axis[1], j.axis[2]);
      const Math::Vector3d at = i == 0 ? Math::Vector3d(0, 0, 0) : Math::Vector3d(j.at[0], j.at[1], j.at[2]);
      parent = model_.AddBody(parent, Math::Xtrans(at), RigidBodyDynamics::Joint(JointTypeRevolute, axis), body);
    }
    const auto n = static_cast<Eigen::Index>(chain.size());
    angles_.resize(n);
    rates_.resize(n);
    efforts_ = accelerations_ = Math::VectorNd::Zero(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      angles_[i] = chain[static_cast<std::size_t>(i)].angle;
      rates_[i] = chain[static_cast<std::size_t>(i)].rate;
    }
    first_ = angles_[0];
  }
  void evaluate(double offset) override {
    angles_[0] = first_ + offset;
    ForwardDynamics(model_, angles_, rates_, efforts_, accelerations_);
  }
  double acceleration(int joint) const override { return accelerations_[joint]; }

 private:
  Model model_;
  Math::VectorNd angles_, rates_, efforts_, accelerations_;
  double first_ = 0;
};

}  // namespace

std::unique_ptr<RivalChain> rbdl_chain(const std::vector<bench::Joint>& chain) {
  return std::make_unique<RbdlChain>(chain);
}

}  // namespace withy::bench
