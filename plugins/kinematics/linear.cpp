/// \file
/// Linear strain-displacement relations: no second order, Γ = Θ = 0.
#include "kinematics_plugin.hpp"

namespace withy {
namespace {

class Linear final : public StrainKinematics {
 public:
  std::string_view name() const override { return "linear"; }
  StrainOrder order() const override { return StrainOrder::linear; }
};

}  // namespace

Plugin<StrainKinematics> linear_kinematics() { return kinematics_plugin<Linear>("linear", "Linear fields alone"); }

}  // namespace withy
