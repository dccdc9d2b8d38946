/// \file
/// The smallest honest body, for libraries that are bad in other ways: a point mass of 1 kg at its root.
#pragma once

#include "withy/core/plugin/body.hpp"
#include "withy/core/plugin/registry.hpp"

namespace zoo {

class PointMass : public withy::Body {
 public:
  PointMass() {
    shape_.particles.push_back({1.0, withy::PointExpansion::rigid(withy::Vector3::Zero(), 0)});
    shape_.stiffness = shape_.damping = Eigen::MatrixXd::Zero(0, 0);
  }
  const withy::ModalShape& shape() const override { return shape_; }
  std::optional<withy::PointExpansion> station(const StationName& name) const override {
    if (name != StationName("root")) return {};
    return withy::PointExpansion::rigid(withy::Vector3::Zero(), 0);
  }
  std::string stations() const override { return "root"; }

 protected:
  withy::ModalShape shape_;
};

inline std::unique_ptr<withy::Body> make_point_mass(const withy::Value&, const withy::MakeContext&) {
  return std::make_unique<PointMass>();
}

inline withy::Plugin<withy::Body> point_mass(const char* id) {
  return {.id = id, .summary = "a point mass of 1 kg", .parameters = {}, .make = &make_point_mass};
}

}  // namespace zoo
