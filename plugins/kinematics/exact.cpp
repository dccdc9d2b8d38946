/// \file
/// Rods of exact kinematics, not expanded (rod.hpp). Truncated to first order it is `quadratic`.
#include "kinematics_plugin.hpp"

namespace withy {
namespace {

class Exact final : public CompleteSecondOrder {
 public:
  std::string_view name() const override { return "exact"; }
  StrainOrder order() const override { return StrainOrder::exact; }
};

}  // namespace

Plugin<StrainKinematics> exact_kinematics() { return kinematics_plugin<Exact>("exact", "Rods, not expanded"); }

}  // namespace withy
