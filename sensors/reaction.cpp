/// \file
/// What a hinge carries.
#include <stdexcept>

#include "frame_sensor.hpp"
#include "withy/core/model/closing.hpp"
#include "withy/core/plugin/closed_loops.hpp"

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

/// What closes a loop exerts on the body of its frame b.
class BoundClosing final : public BoundSensor {
 public:
  explicit BoundClosing(std::size_t loop) : loop_(loop) {}
  std::vector<SensorColumn> columns() const override { return BoundReaction(0).columns(); }
  void read(SensedState& state, const SensorInputs& /*inputs*/, std::span<double> values) const noexcept override {
    auto* const loops = dynamic_cast<SensedLoops*>(&state);
    const Wrench wrench = loops != nullptr ? loops->closing_reaction(loop_) : Wrench{};
    put(wrench.force, values);
    put(wrench.moment, values);
  }

 private:
  std::size_t loop_;
};

class ClosingSensor final : public Sensor {
 public:
  explicit ClosingSensor(std::string constraint) : constraint_(std::move(constraint)) {}
  std::unique_ptr<BoundSensor> bind(const Model& model, std::span<const SensorNode> /*before*/) const override {
    const auto loops = loops_of(model);
    for (std::size_t i = 0; i < loops.size(); ++i)
      if (loops[i]->name() == constraint_) return std::make_unique<BoundClosing>(i);
    throw std::invalid_argument("there is no constraint '" + constraint_ + "'");
  }

 private:
  std::string constraint_;
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

std::unique_ptr<Sensor> make_reaction(const Value& p, const MakeContext& context) {
  const bool hinge = p.has("hinge"), constraint = p.has("constraint");
  if (hinge == constraint) {
    context.diagnostics.error(p.place(), std::string("got ") + (hinge ? "both" : "neither") +
                                             " of 'hinge' and 'constraint'; need one of them");
    return nullptr;
  }
  if (constraint) return std::make_unique<ClosingSensor>(p.text_at("constraint"));
  return std::make_unique<ReactionSensor>(p.text_at("hinge"));
}

}  // namespace

void enroll_reaction(Enrollment& enrollment) {
  enrollment.add<Sensor>(
      {.id = "reaction",
       .summary = "Force and moment that the parent exerts on the child through a hinge or weld, or that a constraint "
                  "exerts on its frame b, in the axes of F",
       .parameters = {text("hinge", "hinge or weld that carries them").naming(ParameterSpec::Refers::hinge).optional(),
                      text("constraint", "constraint that exerts them, in the place of a hinge").optional()},
       .make = &make_reaction});
}

}  // namespace withy
