/// \file
/// Efforts of loads and of a prescribed motion at a hinge.
#include <algorithm>
#include <stdexcept>

#include "effort_share.hpp"
#include "withy/core/model/hinge_rates.hpp"

namespace withy {
namespace {

class BoundEffort final : public BoundSensor {
 public:
  BoundEffort(const HingeNode& hinge, Slot slot, EffortShare share)
      : rates_(hinge_rates(*hinge.hinge)), slot_(std::move(slot)), share_(share) {}
  std::vector<SensorColumn> columns() const override {
    std::vector<SensorColumn> c;
    for (const HingeRate& rate : rates_)
      c.push_back({rates_.size() == 1 ? "" : std::to_string(c.size()), rate.angular ? "N m" : "N"});
    return c;
  }
  void read(SensedState& state, const SensorInputs& /*inputs*/, std::span<double> values) const noexcept override {
    std::fill(values.begin(), values.end(), 0.0);
    const auto add = [&](std::span<const double> efforts) {
      for (std::size_t i = 0; i < values.size(); ++i) values[i] += efforts[slot_.speed + i];
    };
    if (share_.load) add(state.load_efforts(*share_.load));
    if (share_.motion) add(state.motion_efforts());
  }

 private:
  std::vector<HingeRate> rates_;
  Slot slot_;
  EffortShare share_;
};

class EffortSensor final : public Sensor {
 public:
  EffortSensor(std::string hinge, std::string of) : hinge_(std::move(hinge)), of_(std::move(of)) {}
  std::unique_ptr<BoundSensor> bind(const Model& model, std::span<const SensorNode> /*before*/) const override {
    const int index = model.hinge(hinge_);
    if (index < 0) throw std::invalid_argument("there is no hinge '" + hinge_ + "'");
    const auto h = static_cast<std::size_t>(index);
    const Slot& slot = model.layout().hinges[h];
    if (slot.speeds == 0)
      throw std::invalid_argument("hinge '" + hinge_ +
                                  "' has no rate that an effort could act on; what it carries is its reaction");
    const EffortShare share = effort_share(model, of_);
    if (of_ == "motion" && !model.driven(h) && !model.may_be_locked(h))
      throw std::invalid_argument("no motion moves hinge '" + hinge_ + "'");
    return std::make_unique<BoundEffort>(model.hinges()[h], slot, share);
  }

 private:
  std::string hinge_, of_;
};

std::unique_ptr<Sensor> make_effort(const Value& p, const MakeContext& /*context*/) {
  return std::make_unique<EffortSensor>(p.text_at("hinge"), p.text_at("of"));
}

}  // namespace

void enroll_effort(Enrollment& enrollment) {
  enrollment.add<Sensor>(
      {.id = "effort",
       .summary = "Efforts at a hinge: of all loads and the motion together, or of one of them",
       .parameters = {text("hinge", "hinge at which the efforts act").naming(ParameterSpec::Refers::hinge),
                      effort_share_parameter()},
       .make = &make_effort});
}

}  // namespace withy
