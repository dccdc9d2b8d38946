/// \file
/// What a hinge carries.
#include <stdexcept>

#include "frame_sensor.hpp"

namespace withy {
namespace {

class BoundReaction final : public BoundSensor {
 public:
  explicit BoundReaction(int hinge) : hinge_(hinge) {}
  std::vector<SensorColumn> columns() const override {
    std::vector<SensorColumn> c;
    add_columns(c, "f", "N");
    add_columns(c, "m", "N m");
    return c;
  }
  void read(SensedState& state, const SensorInputs& /*inputs*/, std::span<double> values) const noexcept override {
    const Wrench wrench = state.reaction(hinge_);
    put(wrench.force, values);
    put(wrench.moment, values);
  }

 private:
  int hinge_;
};

class ReactionSensor final : public Sensor {
 public:
  explicit ReactionSensor(std::string hinge) : hinge_(std::move(hinge)) {}
  std::unique_ptr<BoundSensor> bind(const Model& model, std::span<const SensorNode> /*before*/) const override {
    const int index = model.hinge(hinge_);
    if (index < 0) throw std::invalid_argument("there is no hinge '" + hinge_ + "'");
    return std::make_unique<BoundReaction>(index);
  }

 private:
  std::string hinge_;
};

std::unique_ptr<Sensor> make_reaction(const Value& p, const MakeContext& /*context*/) {
  return std::make_unique<ReactionSensor>(p.text_at("hinge"));
}

}  // namespace

void enroll_reaction(Enrollment& enrollment) {
  enrollment.add<Sensor>(
      {.id = "reaction",
       .summary = "Force and moment that the parent exerts on the child through a hinge or weld, in the axes of F",
       .parameters = {text("hinge", "hinge or weld that carries them").naming(ParameterSpec::Refers::hinge)},
       .make = &make_reaction});
}

}  // namespace withy
