/// \file
/// Power that loads and motions put into the tree.
#include <numeric>

#include "effort_share.hpp"

namespace withy {
namespace {

class BoundPower final : public BoundSensor {
 public:
  explicit BoundPower(EffortShare share) : share_(share) {}
  std::vector<SensorColumn> columns() const override { return {{"", "W"}}; }
  void read(SensedState& state, const SensorInputs& /*inputs*/, std::span<double> values) const noexcept override {
    const auto speeds = state.y().subspan(state.layout().positions, state.layout().speeds);
    const auto power = [&](std::span<const double> efforts) {
      return std::inner_product(efforts.begin(), efforts.end(), speeds.begin(), 0.0);
    };
    values[0] = 0;
    if (share_.load) values[0] += power(state.load_efforts(*share_.load));
    if (share_.motion) values[0] += power(state.motion_efforts());
  }

 private:
  EffortShare share_;
};

class PowerSensor final : public Sensor {
 public:
  explicit PowerSensor(std::string of) : of_(std::move(of)) {}
  std::unique_ptr<BoundSensor> bind(const Model& model, std::span<const SensorNode> /*before*/) const override {
    return std::make_unique<BoundPower>(effort_share(model, of_));
  }

 private:
  std::string of_;
};

std::unique_ptr<Sensor> make_power(const Value& p, const MakeContext& /*context*/) {
  return std::make_unique<PowerSensor>(p.text_at("of"));
}

}  // namespace

void enroll_power(Enrollment& enrollment) {
  enrollment.add<Sensor>({.id = "power",
                          .summary = "Power of all loads and motions, or of one load",
                          .parameters = {effort_share_parameter()},
                          .make = &make_power});
}

}  // namespace withy
