/// \file
/// The weld: no motion, X_FM = identity.
#include "hinge_plugin.hpp"

namespace withy {
namespace {

class Weld final : public HolonomicHinge {
 public:
  std::size_t speeds() const override { return 0; }
  void motion(std::span<const double> /*x*/, std::span<const double> /*rates*/,
              HingeMotion& out) const noexcept override {
    out.pose = Pose{};
    out.H.resize(6, 0);
    out.bias.setZero();
  }
  void motion_derivative(std::span<const double> /*x*/, std::span<const double> /*rates*/, std::size_t /*along*/,
                         HingeMotion& out) const override {
    no_motion_derivative(*this, out);
  }
  std::optional<HingeKernel> kernel() const override { return HingeKernel{HingeKernel::Kind::weld, Vector3::UnitZ()}; }
};

std::unique_ptr<Hinge> make_weld(const Value& /*p*/, const MakeContext& /*context*/) {
  return std::make_unique<Weld>();
}

}  // namespace

void enroll_weld(Enrollment& enrollment) {
  enrollment.add<Hinge>(
      {.id = "weld", .summary = "Fixes the child to the parent", .parameters = {}, .make = &make_weld});
}

}  // namespace withy
