#include <pinocchio/multibody/model.hpp>
// Its algorithms need the model's definition before them.
#include <pinocchio/algorithm/aba.hpp>
#include <string>

#include "rival_chains.hpp"

namespace withy::bench {
namespace {

class PinocchioChain final : public RivalChain {
 public:
  explicit PinocchioChain(const std::vector<Joint>& chain) {
    model_.gravity.setZero();
    Eigen::Matrix3d about_center;
    about_center << 0.02, 0.001, 0, 0.001, 0.03, 0.002, 0, 0.002, 0.035;
    const pinocchio::Inertia body(1.5, Eigen::Vector3d(0.2, 0.01, 0.02), about_center);
    pinocchio::JointIndex parent = 0;
    for (std::size_t i = 0; i < chain.size(); ++i) {
      const Joint& j = chain[i];
      const Eigen::Vector3d axis(j.axis[0], j.axis[1], j.axis[2]);
      const Eigen::Vector3d at = i == 0 ? Eigen::Vector3d(0, 0, 0) : Eigen::Vector3d(j.at[0], j.at[1], j.at[2]);
      parent = model_.addJoint(parent, pinocchio::JointModelRevoluteUnaligned(axis),
                               pinocchio::SE3(Eigen::Matrix3d::Identity(), at), "joint" + std::to_string(i));
      model_.appendBodyToJoint(parent, body);
    }
    data_ = pinocchio::Data(model_);
    const auto n = static_cast<Eigen::Index>(chain.size());
    angles_.resize(n);
    rates_.resize(n);
    efforts_ = Eigen::VectorXd::Zero(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      angles_[i] = chain[static_cast<std::size_t>(i)].angle;
      rates_[i] = chain[static_cast<std::size_t>(i)].rate;
    }
    first_ = angles_[0];
  }
  void evaluate(double offset) override {
    angles_[0] = first_ + offset;
    pinocchio::aba(model_, data_, angles_, rates_, efforts_);
  }
  double acceleration(int joint) const override { return data_.ddq[joint]; }

 private:
  pinocchio::Model model_;
  pinocchio::Data data_;
  Eigen::VectorXd angles_, rates_, efforts_;
  double first_ = 0;
};

}  // namespace

std::unique_ptr<RivalChain> pinocchio_chain(const std::vector<Joint>& chain) {
  return std::make_unique<PinocchioChain>(chain);
}

}  // namespace withy::bench
