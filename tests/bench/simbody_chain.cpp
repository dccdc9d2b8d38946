#include <Simbody.h>

#include "rival_chains.hpp"

namespace withy::bench {
namespace {

using namespace SimTK;

class SimbodyChain final : public RivalChain {
 public:
  explicit SimbodyChain(const std::vector<Joint>& chain) {
    const Vec3 center(0.2, 0.01, 0.02);
    const Inertia about_center(0.02, 0.03, 0.035, 0.001, 0, 0.002);
    const Body::Rigid body(MassProperties(1.5, center, about_center.shiftFromMassCenter(center, 1.5)));
    MobilizedBody parent = matter_.Ground();
    for (std::size_t i = 0; i < chain.size(); ++i) {
      const Joint& j = chain[i];
      const Rotation R(UnitVec3(j.axis[0], j.axis[1], j.axis[2]), ZAxis);
      const Vec3 at = i == 0 ? Vec3(0) : Vec3(j.at[0], j.at[1], j.at[2]);
      parent = MobilizedBody::Pin(parent, Transform(R, at), body, Transform(R, Vec3(0)));
    }
    state_ = system_.realizeTopology();
    system_.realizeModel(state_);
    for (std::size_t i = 0; i < chain.size(); ++i) {
      state_.updQ()[static_cast<int>(i)] = chain[i].angle;
      state_.updU()[static_cast<int>(i)] = chain[i].rate;
    }
    first_ = state_.getQ()[0];
  }
  void evaluate(double offset) override {
    state_.updQ()[0] = first_ + offset;
    system_.realize(state_, Stage::Acceleration);
  }
  double acceleration(int joint) const override { return state_.getUDot()[joint]; }

 private:
  MultibodySystem system_;
  SimbodyMatterSubsystem matter_{system_};
  State state_;
  double first_ = 0;
};

}  // namespace

std::unique_ptr<RivalChain> simbody_chain(const std::vector<Joint>& chain) {
  return std::make_unique<SimbodyChain>(chain);
}

}  // namespace withy::bench
