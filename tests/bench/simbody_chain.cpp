#include "simbody_chain.hpp"

#include <Simbody.h>

namespace withy::bench {

struct SimbodyChain::Parts {
  SimTK::MultibodySystem system;
  SimTK::SimbodyMatterSubsystem matter{system};
  SimTK::State state;
  double first = 0;
};

SimbodyChain::SimbodyChain(const std::vector<Joint>& chain) : parts_(std::make_unique<Parts>()) {
  using namespace SimTK;
  const Vec3 center(0.2, 0.01, 0.02);
  const Inertia about_center(0.02, 0.03, 0.035, 0.001, 0, 0.002);
  const Body::Rigid body(MassProperties(1.5, center, about_center.shiftFromMassCenter(center, 1.5)));
  MobilizedBody parent = parts_->matter.Ground();
  for (std::size_t i = 0; i < chain.size(); ++i) {
    const Joint& j = chain[i];
    const Rotation R(UnitVec3(j.axis[0], j.axis[1], j.axis[2]), ZAxis);
    const Vec3 at = i == 0 ? Vec3(0) : Vec3(j.at[0], j.at[1], j.at[2]);
    parent = MobilizedBody::Pin(parent, Transform(R, at), body, Transform(R, Vec3(0)));
  }
  parts_->state = parts_->system.realizeTopology();
  parts_->system.realizeModel(parts_->state);
  for (std::size_t i = 0; i < chain.size(); ++i) {
    parts_->state.updQ()[static_cast<int>(i)] = chain[i].angle;
    parts_->state.updU()[static_cast<int>(i)] = chain[i].rate;
  }
  parts_->first = parts_->state.getQ()[0];
}

SimbodyChain::~SimbodyChain() = default;

void SimbodyChain::evaluate(double offset) {
  parts_->state.updQ()[0] = parts_->first + offset;
  parts_->system.realize(parts_->state, SimTK::Stage::Acceleration);
}

double SimbodyChain::acceleration(int joint) const { return parts_->state.getUDot()[joint]; }

}  // namespace withy::bench
